//! Meshes for tests.

use crate::{Face, MaterialId, ObjectMesh, Smoothing};
use glam::Vec3;

/// The unit square on z = 0, facing +Z: two triangles of material 0.
pub(crate) fn quad(name: &str) -> ObjectMesh {
    let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
    ObjectMesh {
        name: name.to_owned(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        faces: vec![face([0, 1, 2]), face([0, 2, 3])],
        ..ObjectMesh::default()
    }
}
