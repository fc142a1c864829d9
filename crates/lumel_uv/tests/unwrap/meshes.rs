//! Scenes that are easy, and scenes that are not.

use glam::Vec3;
use lumel_scene::{Face, MaterialId, ObjectMesh, SceneBuilder, Smoothing};
use lumel_testkit::mesh::{Facing, cuboid, quad, sphere};
use lumel_testkit::scene::{cube, grey, scene, two_sided};

fn mesh(name: &str, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> ObjectMesh {
    let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
    let faces = triangles.into_iter().map(face).collect();
    ObjectMesh { name: name.into(), positions, faces, ..ObjectMesh::default() }
}

fn of(objects: Vec<ObjectMesh>) -> SceneBuilder {
    scene(objects, vec![grey(0.5, 0.0)], Vec::new())
}

/// Numbers in 0..1 that look random.
fn noise(i: u32) -> f32 {
    let mixed = i.wrapping_mul(0x9e37_79b9) ^ (i.wrapping_mul(0x85eb_ca6b) >> 13);
    (mixed.wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// A closed room with a block in it, finely divided.
pub(crate) fn room() -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::new(4.0, 3.0, 5.0), 6, Facing::Inward, [0; 6]);
    objects.extend(cuboid(Vec3::ONE, Vec3::new(2.0, 2.5, 1.7), 3, Facing::Outward, [0; 6]));
    of(objects)
}

/// Loose triangles of all sizes and directions.
pub(crate) fn soup(n: u32) -> SceneBuilder {
    let at = |i: u32| Vec3::new(noise(i), noise(i + 0x1000_0000), noise(i + 0x2000_0000));
    let corner = |i: u32| at(i / 3) * 10.0 + (at(i + 0x3000_0000) - 0.5) * (0.05 + noise(i / 3));
    of(vec![mesh(
        "soup",
        (0..3 * n).map(corner).collect(),
        (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )])
}

/// A sheet with lit sides that differ.
pub(crate) fn sheet() -> SceneBuilder {
    let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::X * 2.0 + Vec3::Y, Vec3::Y];
    scene(vec![quad(corners, [4, 3], 0)], vec![two_sided(grey(0.5, 0.0))], Vec::new())
}

/// A wall of two triangles beside slivers and specks.
fn slivers() -> ObjectMesh {
    let mut positions = vec![Vec3::ZERO, Vec3::X * 5.0, Vec3::new(5.0, 5.0, 0.0), Vec3::Y * 5.0];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for i in 0..40 {
        let (from, n) = (Vec3::new(noise(i), 0.0, 1.0 + noise(i + 99)), positions.len() as u32);
        let size = 10f32.powf(-5.0 * noise(i + 7));
        positions.extend([from, from + Vec3::X * size, from + Vec3::new(0.5 * size, 1e-4, 0.0)]);
        triangles.push([n, n + 1, n + 2]);
    }
    mesh("slivers", positions, triangles)
}

/// Five walls that meet in one edge, and two squares in one place that face away from each other.
fn shared_edges() -> Vec<ObjectMesh> {
    let mut positions = vec![Vec3::ZERO, Vec3::Y];
    let mut triangles = Vec::new();
    for i in 0..5 {
        let (sin, cos) = (i as f32).sin_cos();
        positions.extend([Vec3::new(cos, 1.0, sin), Vec3::new(cos, 0.0, sin)]);
        triangles.extend([[0, 1, 2 + 2 * i], [0, 2 + 2 * i, 3 + 2 * i]]);
    }
    let square = [Vec3::Z, Vec3::Z + Vec3::X, Vec3::new(1.0, 1.0, 1.0), Vec3::Z + Vec3::Y].map(|p| p * 3.0);
    let doubled = [[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
    vec![mesh("book", positions, triangles), mesh("doubled", square.into(), doubled.into())]
}

/// All of them, by name.
pub(crate) fn all() -> Vec<(&'static str, SceneBuilder)> {
    let ball = sphere(Vec3::ZERO, 1.0, 4, Facing::Outward, 0);
    vec![
        ("cube", cube(1, [0; 6].map(|_| grey(0.5, 0.0)))),
        ("sphere", of(vec![ball])),
        ("room", room()),
        ("slivers", of(vec![slivers()])),
        ("shared edges", of(shared_edges())),
        ("soup", soup(10_000)),
        ("sheet", sheet()),
    ]
}
