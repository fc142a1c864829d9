//! A scene in the making.

use crate::{Camera, Light, Material, ObjectMesh, Sky, Texture};
use glam::{DVec3, Vec3};

/// A scene in the making: plain data that importers and generators fill in.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    /// The name messages and output files use.
    pub name: String,
    /// Where the coordinates of meshes, lights and cameras have their zero in world space, metres.
    ///
    /// It is zero but for scenes far from there, whose coordinates would not leave enough digits to the surfaces.
    /// Importers set it, and [`recenter`](Self::recenter) does.
    pub origin: DVec3,
    /// Meshes, relative to the origin.
    pub objects: Vec<ObjectMesh>,
    /// Materials that faces refer to.
    pub materials: Vec<Material>,
    /// Textures that materials and lights refer to.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// What the lights are called, in their order; may be shorter. A light whose name is missing or empty is
    /// "light 1", "light 2" and so on by its place. Lights that share a name belong together.
    pub light_names: Vec<String>,
    /// Viewpoints; the first is the default.
    pub cameras: Vec<Camera>,
    /// Light that arrives from outside the scene.
    pub sky: Sky,
}

impl SceneBuilder {
    /// Squared diagonal of the bounds of all finite positions of objects that have faces; in f64, where it cannot overflow.
    pub(crate) fn diagonal_squared(&self) -> f64 {
        let with_faces = self.objects.iter().filter(|o| !o.faces.is_empty());
        let finite = with_faces.flat_map(|o| &o.positions).filter(|p| p.is_finite());
        let (min, max) = finite.fold((Vec3::MAX, Vec3::MIN), |(min, max), p| (min.min(*p), max.max(*p)));
        if min.x > max.x { 0.0 } else { (max.as_dvec3() - min.as_dvec3()).length_squared() }
    }
}
