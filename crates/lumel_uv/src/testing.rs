//! Meshes that unwrapping finds hard.

use glam::Vec3;
use lumel_scene::{Face, Material, MaterialId, ObjectMesh, Scene, SceneBuilder, Smoothing};

pub(crate) fn face(vertices: [u32; 3]) -> Face {
    Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease }
}

pub(crate) fn scene_of(objects: Vec<ObjectMesh>) -> Scene {
    let materials = vec![Material::default(), Material::default().two_sided()];
    SceneBuilder { objects, materials, ..SceneBuilder::new("test") }.build().unwrap().0
}

/// Triangles around one edge.
pub(crate) fn fan(n: u32) -> ObjectMesh {
    let mut positions = vec![Vec3::ZERO, Vec3::Y];
    positions.extend((0..n).map(|i| Vec3::new((i as f32 * 0.3).cos(), 0.5, (i as f32 * 0.3).sin())));
    let faces = (0..n).map(|i| face([0, 1, 2 + i])).collect();
    // Normals of a file, so that no crease splits the edge.
    let normals = vec![Vec3::Z; positions.len()];
    ObjectMesh { name: "fan".into(), positions, normals, faces, ..ObjectMesh::default() }
}

/// A square with a second one in its place that faces the other way.
pub(crate) fn doubled() -> ObjectMesh {
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]].map(face).into();
    let positions = square.iter().chain(&square).copied().collect();
    ObjectMesh { name: "doubled".into(), positions, faces, ..ObjectMesh::default() }
}

/// A ramp that winds up, each turn above the last.
pub(crate) fn spiral(turns: u32) -> ObjectMesh {
    const STEPS: u32 = 24;
    let mut positions = Vec::new();
    for i in 0..=turns * STEPS {
        let angle = (i as f32 / STEPS as f32 * 360.0).to_radians();
        let out = Vec3::new(angle.cos(), 0.0, -angle.sin());
        let up = Vec3::Y * (i as f32 * 0.01);
        positions.extend([out + up, out * 2.0 + up]);
    }
    let step = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
    let faces = (0..turns * STEPS).flat_map(step).map(face).collect();
    ObjectMesh { name: "spiral".into(), positions, faces, ..ObjectMesh::default() }
}

/// A unit cube of one object with eight vertices.
pub(crate) fn cube() -> ObjectMesh {
    let at = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let sides: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(face).collect();
    ObjectMesh { name: "cube".into(), positions: (0..8).map(at).collect(), faces, ..ObjectMesh::default() }
}
