//! Scenes from arrays.

use crate::{
    Face, Light, Material, MaterialId, ObjectId, ObjectMesh, Radiance, RectLight, SceneBuilder, Sides,
    Smoothing,
};
use glam::Vec3;

impl SceneBuilder {
    /// A scene without anything in it.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a material.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a mesh of triangles in one material.
    ///
    /// Positions are in metres. Corners of triangles run counter-clockwise seen from the lit side; they index
    /// `positions`. Normals are made, smooth where neighbouring faces turn by less than 40°. For anything else, such as
    /// normals of your own, texture coordinates or several materials, push an [`ObjectMesh`] to `objects`.
    pub fn add_mesh(
        &mut self,
        name: impl Into<String>,
        positions: impl IntoIterator<Item = impl Into<Vec3>>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
        material: MaterialId,
    ) -> ObjectId {
        let face = |vertices| Face { vertices, material, smoothing: Smoothing::Crease };
        self.objects.push(ObjectMesh {
            name: name.into(),
            positions: positions.into_iter().map(Into::into).collect(),
            faces: triangles.into_iter().map(face).collect(),
            ..ObjectMesh::default()
        });
        ObjectId(self.objects.len() as u32 - 1)
    }

    /// Adds a light. Returns its place among the lights.
    pub fn add_light(&mut self, light: impl Into<Light>) -> usize {
        self.lights.push(light.into());
        self.lights.len() - 1
    }

    /// Adds a light with a [name](Self::light_names); an empty one leaves it unnamed. Returns its place among the lights.
    pub fn add_named_light(&mut self, name: impl Into<String>, light: impl Into<Light>) -> usize {
        self.light_names.resize(self.lights.len(), String::new());
        self.light_names.push(name.into());
        self.add_light(light)
    }

    /// Removes all lights, with their names.
    pub fn clear_lights(&mut self) {
        self.lights.clear();
        self.light_names.clear();
    }
}

impl Material {
    /// The same on both sides.
    #[must_use]
    pub fn two_sided(self) -> Self {
        Self { sides: Sides::Both, ..self }
    }
}

impl RectLight {
    /// A rectangle from its centre and half of its edges, metres, with this radiance, W·m⁻²·sr⁻¹.
    ///
    /// Light leaves on the `u × v` side.
    pub fn new(
        center: impl Into<Vec3>,
        u: impl Into<Vec3>,
        v: impl Into<Vec3>,
        radiance: impl Into<Vec3>,
    ) -> Self {
        let (center, u, v) = (center.into(), u.into(), v.into());
        Self { center, u, v, radiance: Radiance(radiance.into()), texture: None }
    }
}

macro_rules! lights {
    ($($kind:ident($light:ty)),+) => {
        $(impl From<$light> for Light {
            fn from(light: $light) -> Self {
                Self::$kind(light)
            }
        })+
    };
}

lights!(
    Rect(RectLight),
    Point(crate::PointLight),
    Spot(crate::SpotLight),
    Directional(crate::DirectionalLight),
    Sun(crate::SunLight),
    Disk(crate::DiskLight),
    Sphere(crate::SphereLight)
);
