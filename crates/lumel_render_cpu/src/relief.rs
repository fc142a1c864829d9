//! Which normals are shown, and how light on them is found.

use crate::View;
use crate::names::named;
use glam::{Vec2, Vec3};
use lumel_basis::Shading;
use lumel_scene::{Irradiance, SurfacePoint};

/// Whether normal maps are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalMaps {
    /// Surfaces are as smooth as their meshes.
    Off,
    /// As files have them: green points up.
    #[default]
    Up,
    /// For files whose green points down.
    Down,
}

named!(NormalMaps, "normal maps", Off = "off", Up = "up", Down = "down");

/// Which normals are shown, and how irradiance on them is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Relief {
    /// Whether normal maps are shown.
    pub maps: NormalMaps,
    /// How light that is known by direction lights tilted normals. Other light does not depend on them.
    pub shading: Shading,
}

impl View<'_> {
    /// The unit normal of a surface point where something tilts it.
    fn tilted_normal(&self, at: SurfacePoint) -> Option<Vec3> {
        let Self { scene, relief, ripple, .. } = *self;
        let scale = match relief.maps {
            NormalMaps::Off => None,
            NormalMaps::Up => Some(Vec2::ONE),
            NormalMaps::Down => Some(Vec2::new(1.0, -1.0)),
        };
        let mapped = scale.and_then(|scale| scene.mapped_normal(at, scale));
        let Some(rippled) = ripple.filter(|r| r.materials.contains(&scene.material_id(at.tri))) else {
            return mapped;
        };
        let normal = mapped.unwrap_or_else(|| scene.shading_normal(at));
        Some(rippled.ripple.tilted(scene.position(at), normal))
    }

    /// The unit normal that is shown.
    pub(crate) fn shown_normal(&self, at: SurfacePoint) -> Vec3 {
        self.tilted_normal(at).unwrap_or_else(|| self.scene.shading_normal(at))
    }

    /// The light that arrives at a surface point whose normal is the one that is shown.
    pub(crate) fn irradiance(&self, at: SurfacePoint) -> Irradiance {
        let (flat, lighting) = (self.scene.shading_normal(at), self.lighting);
        let Some(normal) = self.tilted_normal(at) else { return lighting.irradiance(at, flat) };
        match lighting.incident(at) {
            Some(light) => self.relief.shading.shade(lighting.irradiance(at, flat), &light, flat, normal),
            None => lighting.irradiance(at, normal),
        }
    }
}
