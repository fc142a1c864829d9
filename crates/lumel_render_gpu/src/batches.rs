//! Triangles in the order they are drawn: grouped by material.

use crate::corners::Corners;
use crate::pipelines::Detail;
use glam::Vec3;
use lumel_scene::{Material, Scene, Transparency, TriId};
use lumel_uv::Atlas;
use std::ops::Range;

/// Triangles that are drawn at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// Index of the material.
    pub(crate) material: usize,
    /// Range of the indices.
    pub(crate) indices: Range<u32>,
    /// Their attributes.
    pub(crate) detail: Detail,
}

/// Corners of all triangles by material, each in the scene's order, and where the groups are.
pub(crate) fn grouped(scene: &Scene, atlas: Option<&Atlas>) -> (Corners, Vec<Group>) {
    let slot = |tri: TriId| scene.material_id(tri).index();
    let triangles = || (0..scene.triangle_count() as u32).map(TriId);
    let mut counts = vec![0_u32; scene.materials().len()];
    triangles().for_each(|tri| counts[slot(tri)] += 1);
    let mut end = 0;
    let ranges: Vec<Range<u32>> = counts
        .iter()
        .map(|count| {
            let start = end;
            end += count;
            start..end
        })
        .collect();
    let mut next: Vec<u32> = ranges.iter().map(|range| range.start).collect();
    let mut tris = vec![TriId(0); scene.triangle_count()];
    for tri in triangles() {
        let place = &mut next[slot(tri)];
        tris[*place as usize] = tri;
        *place += 1;
    }
    let indices: Vec<[u32; 3]> = tris.iter().map(|&tri| scene.triangle(tri)).collect();
    let group = |(material, range): (usize, Range<u32>)| {
        let vertices = indices[range.start as usize..range.end as usize].as_flattened();
        let Material { albedo_texture, emission_texture, transparency, .. } = &scene.materials()[material];
        let emits = scene.materials()[material].emits();
        Group {
            material,
            detail: Detail {
                albedo_map: albedo_texture.is_some(),
                emission_map: emission_texture.is_some() && emits,
                transparent: scene.has_transparent() && *transparency != Transparency::default(),
                tint: vertices.iter().any(|v| scene.tints()[*v as usize] != Vec3::ONE),
            },
            indices: 3 * range.start..3 * range.end,
        }
    };
    let filled = ranges.into_iter().enumerate().filter(|(_, range)| !range.is_empty());
    let groups = filled.map(group).collect();
    let corners = match atlas {
        Some(atlas) => Corners::split(&indices, &tris, atlas),
        None => Corners::new(indices),
    };
    (corners, groups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_testkit::{mesh, scene};

    #[test]
    fn every_triangle_is_in_the_group_of_its_material() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let wall = |material, z| mesh::quad(corners.map(|p| p + Vec3::Z * z), [2, 1], material);
        let mut tinted = wall(0, 0.0);
        tinted.tints = vec![Vec3::splat(0.5); tinted.positions.len()];
        let materials =
            vec![scene::grey(0.5, 0.0), scene::two_sided(scene::grey(0.2, 0.0)), scene::grey(0.1, 0.0)];
        let (scene, _) =
            scene::scene(vec![wall(1, 1.0), tinted, wall(1, 2.0)], materials, vec![]).build().unwrap();
        let (corners, groups) = grouped(&scene, None);
        let found: Vec<_> = groups.iter().map(|g| (g.material, g.indices.clone(), g.detail.tint)).collect();
        assert_eq!(found, [(0, 0..12, true), (1, 12..60, false)]);
        let mut ours = corners.indices.clone();
        let mut theirs = scene.triangles().to_vec();
        ours.sort_unstable();
        theirs.sort_unstable();
        assert_eq!(ours, theirs);
    }
}
