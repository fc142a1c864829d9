//! Meshes whose neighbouring faces share their corner positions bit for bit.

use glam::{DVec3, Vec3};
use lumel_scene::{Face, MaterialId, ObjectMesh, Smoothing};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// The side of a closed surface that is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// Towards its inside: a room.
    Inward,
    /// Away from it: a thing.
    Outward,
}

/// A parallelogram-like patch of `cells[0] × cells[1]` cells; the corners run counter-clockwise seen from the front.
///
/// Texture coordinates run from (0, 1) at the first corner to (1, 0) at the third.
pub fn quad(corners: [Vec3; 4], cells: [u32; 2], material: u32) -> ObjectMesh {
    let [a, b, c, d] = corners.map(|p| p.as_dvec3());
    let [columns, rows] = cells;
    let mut mesh = empty("quad");
    for j in 0..=rows {
        for i in 0..=columns {
            let point = between(between(a, b, i, columns), between(d, c, i, columns), j, rows);
            mesh.positions.push(point.as_vec3());
            let uv = [f64::from(i) / f64::from(columns), 1.0 - f64::from(j) / f64::from(rows)];
            mesh.uvs.push(uv.map(|x| x as f32).into());
        }
    }
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        mesh.faces.extend([[p, q, r], [p, r, s]].map(|vertices| face(vertices, material)));
    }
    mesh
}

/// The six sides of a box, each of `cells × cells` cells: first −x, then +x, −y, +y, −z, +z.
pub fn cuboid(min: Vec3, max: Vec3, cells: u32, facing: Facing, materials: [u32; 6]) -> Vec<ObjectMesh> {
    let corner = |axis: usize, along: [f32; 3]| {
        // `along` is (axis, axis + 1, axis + 2) from 0 to 1.
        let mut point = Vec3::ZERO;
        for (k, share) in along.into_iter().enumerate() {
            let k = (axis + k) % 3;
            point[k] = if share == 0.0 { min[k] } else { max[k] };
        }
        point
    };
    let side = |n: usize| {
        let (axis, end) = (n / 2, (n % 2) as f32);
        let mut corners =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[s, t]| corner(axis, [end, s, t]));
        // In this order they run counter-clockwise seen from +axis.
        if (end == 1.0) != (facing == Facing::Outward) {
            corners.reverse();
        }
        quad(corners, [cells; 2], materials[n])
    };
    (0..6).map(side).collect()
}

/// An icosphere of `20 · 4^level` triangles with the normals of the sphere.
pub fn sphere(center: Vec3, radius: f64, level: u32, facing: Facing, material: u32) -> ObjectMesh {
    let (directions, triangles) = icosphere(level);
    let mut mesh = empty("sphere");
    let outward = if facing == Facing::Outward { 1.0 } else { -1.0 };
    mesh.positions = directions.iter().map(|d| (center.as_dvec3() + *d * radius).as_vec3()).collect();
    mesh.normals = directions.iter().map(|d| (*d * outward).as_vec3()).collect();
    let turned = |[a, b, c]: [u32; 3]| if facing == Facing::Outward { [a, b, c] } else { [a, c, b] };
    mesh.faces = triangles.into_iter().map(|t| face(turned(t), material)).collect();
    mesh
}

/// The radius of an icosphere that has the area of a sphere of `radius`.
pub fn equal_area_radius(radius: f64, level: u32) -> f64 {
    let (directions, triangles) = icosphere(level);
    let area: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| directions[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    radius * (2.0 * TAU / area).sqrt()
}

/// A regular polygon of `n` corners with the area of a disk of `radius`, as a fan that faces down from the plane `z`.
pub fn disk_facing_down(center: Vec3, radius: f64, n: u32, material: u32) -> ObjectMesh {
    let step = TAU / f64::from(n);
    let radius = radius * (PI / (0.5 * f64::from(n) * step.sin())).sqrt();
    let mut mesh = empty("disk");
    mesh.positions.push(center);
    mesh.positions.extend((0..n).map(|i| {
        let (sin, cos) = (step * f64::from(i)).sin_cos();
        (center.as_dvec3() + DVec3::new(radius * cos, radius * sin, 0.0)).as_vec3()
    }));
    mesh.faces = (0..n).map(|i| face([0, (i + 1) % n + 1, i + 1], material)).collect();
    mesh
}

/// The front sides of a mesh's triangles, for [`form_factor::polygon`](crate::form_factor::polygon).
pub fn triangles(mesh: &ObjectMesh) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    mesh.faces.iter().map(|f| mesh.corners(f).map(|p| p.as_dvec3()))
}

fn empty(name: &str) -> ObjectMesh {
    ObjectMesh { name: name.to_owned(), ..ObjectMesh::default() }
}

fn face(vertices: [u32; 3], material: u32) -> Face {
    Face { vertices, material: MaterialId(material), smoothing: Smoothing::Crease }
}

/// The point `k/n` of the way; exact in the ends, and the same bits from either end.
fn between(a: DVec3, b: DVec3, k: u32, n: u32) -> DVec3 {
    (a * f64::from(n - k) + b * f64::from(k)) / f64::from(n)
}

/// Unit vectors and outward triangles.
fn icosphere(level: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..level {
        let mut middles = BTreeMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    (points, triangles)
}

/// Its corners lie at the poles and in two rings of five, at heights ±1/√5.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let height = 0.2f64.sqrt();
    let ring = |k: u32, half_steps: u32, z: f64| {
        let (sin, cos) = (TAU * f64::from(2 * k + half_steps) / 10.0).sin_cos();
        DVec3::new(2.0 * height * cos, 2.0 * height * sin, z)
    };
    let mut points = vec![DVec3::Z];
    points.extend((0..5).map(|k| ring(k, 0, height)));
    points.extend((0..5).map(|k| ring(k, 1, -height)));
    points.push(DVec3::NEG_Z);
    let strip = |k: u32| {
        let (upper, next_upper) = (1 + k, 1 + (k + 1) % 5);
        let (lower, next_lower) = (6 + k, 6 + (k + 1) % 5);
        [
            [0, upper, next_upper],
            [upper, lower, next_upper],
            [next_upper, lower, next_lower],
            [11, next_lower, lower],
        ]
    };
    (points, (0..5).flat_map(strip).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(mesh: &ObjectMesh) -> f64 {
        triangles(mesh).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    /// The volume that a closed mesh encloses, negative if it faces inward.
    fn volume<'a>(meshes: impl IntoIterator<Item = &'a ObjectMesh>) -> f64 {
        meshes.into_iter().flat_map(triangles).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn a_cuboid_encloses_its_volume_on_the_side_it_does_not_face() {
        let (min, max) = (Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 0.5, 5.0));
        let outward = cuboid(min, max, 3, Facing::Outward, [0; 6]);
        let inward = cuboid(min, max, 3, Facing::Inward, [0; 6]);
        assert!((volume(&outward) - 3.0).abs() < 1e-6 && (volume(&inward) + 3.0).abs() < 1e-6);
        assert!(inward[0].positions.iter().all(|p| p.x == -1.0), "the first side is -x");
        assert!(inward[5].positions.iter().all(|p| p.z == 5.0), "the last side is +z");
    }

    #[test]
    fn an_icosphere_has_the_area_it_should() {
        for level in [0, 1, 3] {
            let mesh = sphere(Vec3::ZERO, equal_area_radius(1.0, level), level, Facing::Outward, 0);
            assert_eq!(mesh.faces.len(), 20 << (2 * level));
            assert!((area(&mesh) / (2.0 * TAU) - 1.0).abs() < 1e-6 && volume([&mesh]) > 0.0);
        }
    }

    #[test]
    fn a_disk_has_the_area_it_should_and_faces_down() {
        let disk = disk_facing_down(Vec3::Z, 0.5, 24, 0);
        assert!((area(&disk) / (0.25 * PI) - 1.0).abs() < 1e-6);
        assert!(triangles(&disk).all(|[a, b, c]| (b - a).cross(c - a).z < 0.0));
    }
}
