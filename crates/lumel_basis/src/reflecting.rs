//! Integrals of albedo.

use crate::parts::for_each_weight;
use crate::{Basis, NodeWeights};
use glam::Vec3;
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

/// The integral of albedo times each basis function over the surfaces, m².
///
/// Albedo is taken at seven points of each triangle, which is exact for what varies linearly and an estimate for
/// finer textures; where the basis asks for [more](Basis::resolution), in the middle of parts of the triangles. Good enough to decide
/// when to stop; not for carrying light.
pub fn reflecting_areas(scene: &Scene, basis: &dyn Basis) -> Vec<Vec3> {
    let mut reflecting = vec![Vec3::ZERO; basis.node_count()];
    if basis.resolution().is_finite() {
        for_each_weight(scene, basis, |part, node, weight| {
            reflecting[node.index()] += scene.albedo(part.middle).0 * (part.area as f32 * weight);
        });
        return reflecting;
    }
    let mut weights = NodeWeights::default();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let share = scene.area(tri) / POINTS.len() as f32;
        for [u, v] in POINTS {
            let at = SurfacePoint { tri, bary: Barycentrics { u, v } };
            let albedo = scene.albedo(at).0;
            weights.clear();
            basis.weights_at(at, &mut weights);
            for (node, weight) in weights.iter() {
                reflecting[node.index()] += albedo * (share * weight);
            }
        }
    }
    reflecting
}

/// Centres of the triangle and of its six parts around the middle, as `u, v`.
const POINTS: [[f32; 2]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0],
    [11.0 / 18.0, 5.0 / 18.0],
    [11.0 / 18.0, 2.0 / 18.0],
    [5.0 / 18.0, 11.0 / 18.0],
    [2.0 / 18.0, 11.0 / 18.0],
    [5.0 / 18.0, 2.0 / 18.0],
    [2.0 / 18.0, 5.0 / 18.0],
];
