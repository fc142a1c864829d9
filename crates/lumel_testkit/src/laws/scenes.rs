//! Scenes of every kind that bases lie on.

use crate::mesh::{Facing, cuboid, quad, sphere};
use crate::scene::{grey, scene, two_sided};
use glam::{Quat, Vec3};
use lumel_scene::{ObjectMesh, SceneBuilder};

/// Named scenes: closed, open, two-sided, creased, with seams, with doubled faces, far from the origin, turned, scaled
/// and with reordered faces.
///
/// Some have one node where they have several vertices, some several at one position.
pub fn scenes() -> Vec<(&'static str, SceneBuilder)> {
    let plain = |objects: Vec<ObjectMesh>| scene(objects, vec![grey(0.5, 0.0)], vec![]);
    let closed = || cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5), 3, Facing::Inward, [0; 6]);
    let round = || sphere(Vec3::ZERO, 1.0, 1, Facing::Outward, 0);
    let moved = |place: &dyn Fn(Vec3) -> Vec3| {
        let mut objects = closed();
        objects.iter_mut().flat_map(|o| &mut o.positions).for_each(|p| *p = place(*p));
        plain(objects)
    };
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
    vec![
        ("closed", plain(closed())),
        ("round", plain(vec![round()])),
        ("open", plain(vec![flat(3)])),
        ("two-sided", scene(vec![flat(2)], vec![two_sided(grey(0.5, 0.0))], vec![])),
        ("creased", plain(vec![roof()])),
        ("with seams", plain(vec![seams()])),
        ("with doubled faces", plain(vec![doubled()])),
        ("far away", moved(&|p| p + Vec3::new(3000.0, -500.0, 80.0))),
        ("turned", moved(&|p| turn * p)),
        ("small", moved(&|p| p * 1e-3)),
        ("large", moved(&|p| p * 1e4)),
        ("with reordered faces", plain(vec![reordered(round())])),
    ]
}

/// A square of `cells × cells` cells in the xy plane.
fn flat(cells: u32) -> ObjectMesh {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    quad(corners, [cells; 2], 0)
}

/// A square with a sharp ridge between two columns of cells.
fn roof() -> ObjectMesh {
    let mut mesh = flat(2);
    mesh.positions.iter_mut().for_each(|p| p.z = 1.0 - (p.x - 1.0).abs());
    mesh
}

/// A square in which no two triangles share a vertex, but share their positions.
fn seams() -> ObjectMesh {
    let mut mesh = flat(2);
    let corners: Vec<usize> = mesh.faces.iter().flat_map(|f| f.vertices).map(|v| v as usize).collect();
    mesh.positions = corners.iter().map(|&v| mesh.positions[v]).collect();
    mesh.uvs = corners.iter().enumerate().map(|(i, &v)| mesh.uvs[v] + 2.0 * i as f32).collect();
    for (face, first) in mesh.faces.iter_mut().zip((0..).step_by(3)) {
        face.vertices = [first, first + 1, first + 2];
    }
    mesh
}

/// A square with two copies of one of its triangles, one of them turned over.
fn doubled() -> ObjectMesh {
    let mut mesh = flat(2);
    let first = mesh.faces[0];
    let mut back = first;
    back.vertices.reverse();
    mesh.faces.extend([first, back]);
    mesh
}

/// The same surface from faces in another order, starting at other corners.
fn reordered(mut mesh: ObjectMesh) -> ObjectMesh {
    // 7 has no factor in common with the number of faces of an icosphere.
    let n = mesh.faces.len();
    mesh.faces = (0..n).map(|i| mesh.faces[i * 7 % n]).collect();
    for (i, face) in mesh.faces.iter_mut().enumerate() {
        face.vertices.rotate_left(i % 3);
    }
    mesh
}
