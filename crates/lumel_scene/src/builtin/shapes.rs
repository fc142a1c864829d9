//! Surface patches: the shapes all built-in scenes are made of.

use crate::{Face, MaterialId, ObjectMesh, Smoothing};
use glam::{Vec2, Vec3};

/// An empty object.
pub(super) fn object(name: &str) -> ObjectMesh {
    ObjectMesh { name: name.to_owned(), ..ObjectMesh::default() }
}

/// Adds a patch of `cells[0] × cells[1]` cells, two triangles each, with vertices of its own.
///
/// `surface(i, j)` is the position and texture coordinate of a grid point. The front is on the side of `∂i × ∂j`.
/// Diagonals alternate, so that shading has no grain. Triangles that a pole collapses to a line are left out.
pub(super) fn add_grid(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    cells: [u32; 2],
    surface: impl Fn(u32, u32) -> (Vec3, Vec2),
) {
    let [columns, rows] = cells;
    let first = mesh.positions.len() as u32;
    for j in 0..=rows {
        for i in 0..=columns {
            let (position, uv) = surface(i, j);
            mesh.positions.push(position);
            mesh.uvs.push(uv);
        }
    }
    let at = |i: u32, j: u32| first + j * (columns + 1) + i;
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for vertices in halves {
                let [p, q, r] = vertices.map(|v| mesh.positions[v as usize]);
                if p != q && q != r && r != p {
                    mesh.faces.push(Face { vertices, material, smoothing: Smoothing::Crease });
                }
            }
        }
    }
}

/// Adds a four-sided patch between corners that run counter-clockwise seen from the front.
///
/// Edges are straight and divided evenly, so that patches with a common edge and number of cells along it share its
/// points bit for bit. Texture coordinates run from (0, 1) at the first corner to (1, 0) at the third: upright for a
/// viewer in front who has the first corner at the bottom left.
pub(super) fn add_quad(mesh: &mut ObjectMesh, material: MaterialId, corners: [Vec3; 4], cells: [u32; 2]) {
    let [a, b, c, d] = corners;
    let [columns, rows] = cells;
    add_grid(mesh, material, cells, |i, j| {
        let position = between(between(a, b, i, columns), between(d, c, i, columns), j, rows);
        (position, Vec2::new(i as f32 / columns as f32, 1.0 - j as f32 / rows as f32))
    });
}

/// The point `k/n` of the way from `a` to `b`: exact at the ends, and with the same bits counted from either.
pub(super) fn between(a: Vec3, b: Vec3, k: u32, n: u32) -> Vec3 {
    let sum = a.as_dvec3() * f64::from(n - k) + b.as_dvec3() * f64::from(k);
    (sum / f64::from(n)).as_vec3()
}
