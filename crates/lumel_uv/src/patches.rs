//! What is flat, and the rest in patches: flattening takes time that grows faster than the number of triangles.

use crate::planar::MOST_TURNED;
use crate::topology::{NONE, Topology};
use lumel_scene::Scene;
use std::collections::VecDeque;

/// Faces that turn by less lie in one plane: seen from there, they lose a thousandth of their area. The cosine of 2.6°.
const FLAT_COS: f32 = 0.999;

/// The part of an area whose faces may turn more, up to what [`MOST_TURNED`] says: rounding turns small triangles.
const UNEVEN: f32 = 0.01;

/// Whether connected triangles lie in one plane.
pub(crate) fn is_flat(scene: &Scene, topology: &Topology, part: &[u32]) -> bool {
    let area = |face: u32| scene.area(topology.tri(face));
    let normal = |face: u32| scene.geometric_normal(topology.tri(face));
    let largest = part.iter().copied().max_by(|&a, &b| area(a).total_cmp(&area(b)));
    let Some(plane) = largest.map(normal) else { return true };
    let (mut whole, mut uneven) = (0.0, 0.0);
    for &face in part {
        let cos = plane.dot(normal(face));
        if f64::from(cos) <= MOST_TURNED {
            return false;
        }
        whole += area(face);
        uneven += if cos > FLAT_COS { 0.0 } else { area(face) };
    }
    uneven <= UNEVEN * whole
}

/// Divides the triangles that are free into connected patches of up to `most`; returns the patch of each, [`NONE`] for
/// those that are not free.
pub(crate) fn patches(topology: &Topology, is_free: &[bool], most: usize) -> Vec<u32> {
    let mut patch = vec![NONE; topology.len()];
    let mut n_patches = 0;
    for seed in 0..topology.len() as u32 {
        let (mut n, mut waiting) = (0, VecDeque::from([seed]));
        while let Some(face) = waiting.pop_front().filter(|_| n < most) {
            if !is_free[face as usize] || patch[face as usize] != NONE {
                continue;
            }
            (patch[face as usize], n) = (n_patches, n + 1);
            waiting.extend(topology.across[face as usize].iter().filter(|&&other| other != NONE));
        }
        n_patches += u32::from(n > 0);
    }
    patch
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene_of;
    use glam::Vec3;
    use lumel_testkit::mesh::{Facing, quad, sphere};

    #[test]
    fn a_wall_is_flat_and_a_sphere_is_divided() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let ball = sphere(Vec3::ZERO, 1.0, 4, Facing::Outward, 0);
        let mut rounded = quad(corners.map(|c| c + Vec3::X), [20, 20], 0);
        rounded.positions.iter_mut().enumerate().for_each(|(i, p)| p.z = 5e-4 * (i % 2) as f32);
        let scene = scene_of(vec![quad(corners, [50, 50], 0), ball, rounded]);
        let flat = |range: std::ops::Range<u32>| {
            let topology = Topology::new(&scene, range);
            let parts = topology.parts();
            assert_eq!(parts.len(), 1);
            is_flat(&scene, &topology, &parts[0])
        };
        assert!(flat(0..5000) && !flat(5000..5000 + 5120));
        assert!(flat(5000 + 5120..5000 + 5120 + 800), "rounded to half a millimetre");
        let ball = Topology::new(&scene, 5000..5000 + 5120);
        let patch = patches(&ball, &[true; 5120], 1000);
        let n_patches = patch.iter().max().unwrap() + 1;
        assert!((6..20).contains(&n_patches), "{n_patches}");
        let largest = (0..n_patches).map(|p| patch.iter().filter(|&&q| q == p).count()).max();
        assert_eq!(largest, Some(1000));
    }
}
