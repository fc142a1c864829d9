//! Normals for vertices that have none.

use crate::corners::{Corners, split_vertices};
use crate::mesh::{ObjectMesh, Smoothing};
use crate::{Warnings, triangle};
use glam::{DVec3, Vec3};

/// Cosine of the 40° beyond which [`Smoothing::Crease`] makes an edge sharp.
const CREASE_COS: f32 = 0.766_044_4;

/// Faces within about 1° of each other count as one plane: quads in files are rounded to a few digits.
const COPLANAR_COS: f32 = 0.999_85;

/// Normalises the given normals and makes the missing ones, splitting vertices at creases.
///
/// A made normal is the mean of its group's face normals weighted by the angle at the corner (Thürmer and Wüthrich
/// 1998), which does not depend on how the surface is triangulated. Returns which vertex each added one is a copy of.
pub(crate) fn fill_missing(mesh: &mut ObjectMesh, warnings: &mut Warnings) -> Vec<u32> {
    let given = given_normals(mesh, warnings);
    let used = mesh.faces.iter().flat_map(|f| f.vertices);
    if used.into_iter().all(|v| given[v as usize].is_some()) {
        mesh.normals = given.into_iter().map(Option::unwrap_or_default).collect();
        return Vec::new();
    }
    let face_normals = mesh.face_normals();
    let faces = mesh.faces.clone();
    let smooth = |a: usize, b: usize| {
        let cos = face_normals[a].dot(face_normals[b]);
        match (faces[a].smoothing, faces[b].smoothing) {
            (Smoothing::Group(a), Smoothing::Group(b)) => a == b || cos > COPLANAR_COS,
            (Smoothing::Crease, Smoothing::Crease) => cos > CREASE_COS,
            _ => cos > COPLANAR_COS,
        }
    };
    let groups = Corners::by_position(mesh).groups(&faces, smooth);
    let angle = |corner: usize| triangle::angle(mesh.corners(&faces[corner / 3]), corner % 3);
    let mut sums = vec![DVec3::ZERO; groups.len()];
    for (corner, &group) in groups.iter().enumerate() {
        sums[group as usize] += face_normals[corner / 3].as_dvec3() * angle(corner);
    }
    mesh.normals = given.iter().map(|n| n.unwrap_or_default()).collect();
    // A given normal joins all corners of its vertex; the others part where their groups do.
    let given_group = |corner: usize| given[faces[corner / 3].vertices[corner % 3] as usize].is_some();
    let parted: Vec<u32> =
        (0..groups.len()).map(|c| if given_group(c) { u32::MAX } else { groups[c] }).collect();
    let copies = split_vertices(mesh, &parted);
    for (corner, &group) in parted.iter().enumerate() {
        if group != u32::MAX {
            let vertex = mesh.faces[corner / 3].vertices[corner % 3];
            let made = sums[group as usize].as_vec3().try_normalize();
            mesh.normals[vertex as usize] = made.unwrap_or(face_normals[corner / 3]);
        }
    }
    copies
}

/// The file's normals, unit length; `None` where there is none that can be used.
fn given_normals(mesh: &ObjectMesh, warnings: &mut Warnings) -> Vec<Option<Vec3>> {
    if mesh.normals.is_empty() {
        return vec![None; mesh.positions.len()];
    }
    let mut n_bad = 0;
    let mut usable = |n: &Vec3| {
        let unit = n.as_dvec3().try_normalize().map(|n| n.as_vec3());
        n_bad += usize::from(unit.is_none() && *n != Vec3::ZERO);
        // Keep unit normals as they are, bit for bit.
        unit.map(|unit| if n.is_normalized() { *n } else { unit })
    };
    let given = mesh.normals.iter().map(&mut usable).collect();
    if n_bad > 0 {
        let subject = format!("object \"{}\"", mesh.name);
        warnings.push(
            subject,
            format!("{n_bad} normals are not finite numbers: replaced by normals of the faces"),
        );
    }
    given
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Face;
    use crate::{Material, MaterialId, SceneBuilder};

    fn cube(smoothing: Smoothing) -> ObjectMesh {
        let positions =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32)).collect();
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing };
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [face([a, b, c]), face([a, c, d])]).collect();
        ObjectMesh { name: "cube".into(), positions, faces, ..ObjectMesh::default() }
    }

    fn vertices_of(mesh: ObjectMesh) -> (usize, Vec<Vec3>) {
        let builder =
            SceneBuilder { objects: vec![mesh], materials: vec![Material::default()], ..Default::default() };
        let (scene, _) = builder.build().unwrap();
        (scene.vertex_count(), scene.normals().to_vec())
    }

    #[test]
    fn a_cube_is_split_into_six_faces_of_four_vertices() {
        for smoothing in [Smoothing::Flat, Smoothing::Crease] {
            let (n, normals) = vertices_of(cube(smoothing));
            assert_eq!(n, 24, "{smoothing:?}");
            assert!(normals.iter().all(|n| n.abs().max_element() == 1.0), "{smoothing:?}");
        }
    }

    #[test]
    fn a_smoothing_group_makes_one_normal_that_does_not_depend_on_the_diagonals() {
        let mut mesh = cube(Smoothing::Group(1));
        fill_missing(&mut mesh, &mut Warnings::default());
        assert_eq!(mesh.positions.len(), 8);
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((*n - (*p - Vec3::splat(0.5)).normalize()).length() < 1e-6, "{p} {n}");
        }
    }

    #[test]
    fn vertices_that_the_file_duplicates_are_smoothed_together() {
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
        let roof = Vec3::new(0.0, 1.0, 0.2);
        let mut mesh = ObjectMesh {
            positions: vec![Vec3::ZERO, Vec3::X, roof, Vec3::X, Vec3::ZERO, Vec3::new(0.0, -1.0, 0.2)],
            faces: vec![face([0, 1, 2]), face([4, 5, 3])],
            ..ObjectMesh::default()
        };
        fill_missing(&mut mesh, &mut Warnings::default());
        assert!((mesh.normals[0] - mesh.normals[4]).length() < 1e-6);
        assert!((mesh.normals[0] - Vec3::Z).length() < 1e-6, "{}", mesh.normals[0]);
    }

    #[test]
    fn normals_of_wrong_length_are_scaled_and_useless_ones_made_anew() {
        let mut mesh = cube(Smoothing::Flat);
        mesh.normals = vec![Vec3::X * 7.0; 8];
        mesh.normals[0] = Vec3::new(f32::INFINITY, 0.0, 0.0);
        let mut warnings = Warnings::default();
        fill_missing(&mut mesh, &mut warnings);
        assert!(mesh.normals.iter().all(|n| n.is_normalized()));
        assert_eq!(warnings.len(), 1);
    }
}
