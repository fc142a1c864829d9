//! Surface patches: the shapes all built-in scenes are made of.

use glam::{DVec2, Vec2, Vec3};
use lumel_scene::{Face, MaterialId, ObjectMesh, Smoothing};

/// An empty object.
pub(crate) fn object(name: &str) -> ObjectMesh {
    ObjectMesh { name: name.to_owned(), ..ObjectMesh::default() }
}

/// Adds a patch of `cells[0] × cells[1]` cells, two triangles each, with vertices of its own.
///
/// `surface(i, j)` is the position and texture coordinate of a grid point. The front is on the side of `∂i × ∂j`.
/// Diagonals alternate, so that shading has no grain. Triangles that a pole collapses are left out.
pub(crate) fn add_grid(
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
                if (q - p).cross(r - p) != Vec3::ZERO {
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
pub(crate) fn add_quad(mesh: &mut ObjectMesh, material: MaterialId, corners: [Vec3; 4], cells: [u32; 2]) {
    let [a, b, c, d] = corners;
    let [columns, rows] = cells;
    add_grid(mesh, material, cells, |i, j| {
        let position = between(between(a, b, i, columns), between(d, c, i, columns), j, rows);
        (position, Vec2::new(i as f32 / columns as f32, 1.0 - j as f32 / rows as f32))
    });
}

/// The point `k/n` of the way from `a` to `b`: exact at the ends, and with the same bits counted from either.
pub(crate) fn between(a: Vec3, b: Vec3, k: u32, n: u32) -> Vec3 {
    let sum = a.as_dvec3() * f64::from(n - k) + b.as_dvec3() * f64::from(k);
    (sum / f64::from(n)).as_vec3()
}

/// Adds a surface through polylines that may differ in their number of points: where a surface narrows it gets fewer
/// triangles instead of thinner ones.
///
/// The front is on the side of `∂line × ∂point`.
pub(crate) fn add_strips(mesh: &mut ObjectMesh, material: MaterialId, lines: &[Vec<(Vec3, Vec2)>]) {
    let mut first = mesh.positions.len() as u32;
    for line in lines {
        mesh.positions.extend(line.iter().map(|point| point.0));
        mesh.uvs.extend(line.iter().map(|point| point.1));
    }
    for pair in lines.windows(2) {
        let (left, right) = (pair[0].len() as u32, pair[1].len() as u32);
        let (mut i, mut j) = (0, 0);
        while i + 1 < left || j + 1 < right {
            let [a, b] = [first + i, first + left + j];
            // Advance on the side that lags behind, compared as fractions of the whole line.
            let advance_left =
                j + 1 >= right || (i + 1 < left && (i + 1) * (right - 1) <= (j + 1) * (left - 1));
            let vertices = if advance_left { [a, b, a + 1] } else { [a, b, b + 1] };
            mesh.faces.push(Face { vertices, material, smoothing: Smoothing::Crease });
            if advance_left { i += 1 } else { j += 1 }
        }
        first += left;
    }
}

/// A horizontal outline around an axis, at a height in metres along it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Ring {
    /// A circle: height and radius.
    Round(f64, f64),
    /// A square: height and half its side.
    Square(f64, f64),
}

impl Ring {
    /// Where the ring is in the direction `unit`, and at which height.
    fn at(self, unit: DVec2) -> (DVec2, f64) {
        match self {
            Self::Round(height, radius) => (unit * radius, height),
            Self::Square(height, half) => (unit * (half / unit.abs().max_element()), height),
        }
    }
}

/// Adds the surface between rings in the order given, upwards for a front that looks away from the axis.
///
/// `place` turns a point across the axis and a height into a position. Rows between rings are cut into `fine` parts.
/// Texture coordinates are in units of `tile` metres.
pub(crate) fn add_loft(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    rings: &[Ring],
    [segments, fine]: [u32; 2],
    tile: f64,
    place: impl Fn(DVec2, f64) -> Vec3,
) {
    let Some(&last) = rings.last() else { return };
    let rows = (rings.len() as u32 - 1) * fine;
    // Textures run along the profile, so that plates do not smear.
    let mut along = vec![0.0];
    for pair in rings.windows(2) {
        let [(p, y), (q, z)] = [pair[0].at(DVec2::X), pair[1].at(DVec2::X)];
        along.push(along[along.len() - 1] + (q - p).length().hypot(z - y));
    }
    let girth = 2.5 * rings.iter().map(|r| r.at(DVec2::X).0.x).fold(0.0, f64::max) / tile;
    add_grid(mesh, material, [segments, rows], |i, j| {
        let angle = (-360.0 * f64::from(i % segments) / f64::from(segments)).to_radians();
        let unit = DVec2::new(angle.cos(), angle.sin());
        let (k, t) = ((j / fine) as usize, f64::from(j % fine) / f64::from(fine));
        let (from, to) = (rings[k].at(unit), rings.get(k + 1).unwrap_or(&last).at(unit));
        let next = along.get(k + 1).unwrap_or(&along[k]);
        let v = -(along[k] + (next - along[k]) * t) / tile;
        let u = girth * f64::from(i) / f64::from(segments);
        (place(from.0.lerp(to.0, t), from.1 + (to.1 - from.1) * t), DVec2::new(u, v).as_vec2())
    });
}
