//! Which lights, surfaces and skies shine.

use lumel_scene::{MaterialId, Scene};

/// Something that shines by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Emitter {
    /// A light, by its place in [`Scene::lights`].
    Light(u32),
    /// The sky.
    Sky,
    /// All surfaces of an emissive material.
    Surfaces(MaterialId),
}

impl Emitter {
    /// All emitters of a scene that are not black: lights, sky, emissive materials.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let lights = (0..scene.lights().len() as u32).map(Self::Light);
        let sky = (!scene.sky().is_zero()).then_some(Self::Sky);
        let materials = (0u32..).map(MaterialId).zip(scene.materials());
        let surfaces = materials.filter(|(_, material)| material.emits()).map(|(id, _)| Self::Surfaces(id));
        lights.chain(sky).chain(surfaces).collect()
    }
}

/// The emitters of a scene that shine in a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmitterMask {
    lights: Vec<bool>,
    sky: bool,
    surfaces: Vec<bool>,
}

impl EmitterMask {
    /// The mask of some emitters of a scene; others stay dark.
    pub fn only(scene: &Scene, emitters: &[Emitter]) -> Self {
        let mut mask = Self {
            lights: vec![false; scene.lights().len()],
            sky: false,
            surfaces: vec![false; scene.materials().len()],
        };
        for emitter in emitters {
            match *emitter {
                Emitter::Light(light) => mask.lights[light as usize] = true,
                Emitter::Sky => mask.sky = true,
                Emitter::Surfaces(material) => mask.surfaces[material.index()] = true,
            }
        }
        mask
    }

    /// Whether an emitter shines.
    #[inline]
    pub fn shines(&self, emitter: Emitter) -> bool {
        match emitter {
            Emitter::Light(light) => self.lights[light as usize],
            Emitter::Sky => self.sky,
            Emitter::Surfaces(material) => self.surfaces[material.index()],
        }
    }
}
