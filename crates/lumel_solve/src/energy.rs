//! How much light is on its way, and how much is still to come.

use glam::{DVec3, Vec3};
use lumel_basis::{Basis, Field, NodeWeights};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId, luminance};

/// Above this ratio of successive bounces the geometric series is not trusted.
const MAX_RATIO: f64 = 0.98;

/// Integrals of a field over the surfaces.
#[derive(Clone, Debug)]
pub struct Energy {
    /// Area of each node, m².
    areas: Vec<f32>,
    /// Integral of albedo times the node's basis function, m².
    reflecting: Vec<Vec3>,
}

impl Energy {
    /// Prepares the integrals of a basis.
    ///
    /// Albedo is taken at seven points of each triangle, which is exact for what varies linearly and an estimate for
    /// finer textures; it only decides when to stop.
    pub fn new(scene: &Scene, basis: &dyn Basis) -> Self {
        let mut reflecting = vec![Vec3::ZERO; basis.node_count()];
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
        Self { areas: basis.node_areas(), reflecting }
    }

    /// Power that arrives, W per channel.
    pub fn incident(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.areas.iter().map(|&area| Vec3::splat(area)))
    }

    /// The mean irradiance over all surfaces, by luminance, W·m⁻².
    pub fn mean(&self, field: &Field) -> f64 {
        let area: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        if area > 0.0 { f64::from(luminance(self.incident(field).as_vec3())) / area } else { 0.0 }
    }

    /// Power that is reflected and so arrives again, W per channel.
    pub fn reflected(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.reflecting.iter().copied())
    }

    /// Share of all light, by luminance of the incident power, that bounces after the last one would bring.
    ///
    /// Assumes that each goes on shrinking by the ratio of the last two. `None` while there is no ratio or the last
    /// bounce was no weaker than the one before.
    pub fn remainder(&self, bounces: &[Field]) -> Option<f64> {
        let power = |field| f64::from(luminance(self.incident(field).as_vec3()));
        let total: f64 = bounces.iter().map(power).sum();
        let [.., before, last] = bounces else {
            let [only] = bounces else { return None };
            let nothing_reflected = self.reflected(only) == DVec3::ZERO;
            return nothing_reflected.then_some(0.0);
        };
        let (before, last) = (power(before), power(last));
        if last <= 0.0 {
            return Some(0.0);
        }
        let ratio = last / before;
        (ratio < 1.0).then(|| last * ratio / (1.0 - ratio) / total)
    }

    /// The bounces after the last one, as a geometric series of the last one: `λ/(1 − λ)` of it per channel.
    ///
    /// Consistent in shape only: the last bounce's pattern stands for all later ones, whose differences from it are
    /// of second order once light is well mixed. `None` when there is no ratio below 0.98 in any channel.
    pub fn tail(&self, bounces: &[Field]) -> Option<Field> {
        let [.., before, last] = bounces else { return None };
        let (before, last_power) = (self.incident(before), self.incident(last));
        let factor = |k: usize| {
            let ratio = last_power[k] / before[k];
            if ratio > 0.0 && ratio < MAX_RATIO { (ratio / (1.0 - ratio)) as f32 } else { 0.0 }
        };
        let factors = Vec3::new(factor(0), factor(1), factor(2));
        let values = last.values().iter().map(|&value| value * factors).collect();
        (factors != Vec3::ZERO).then(|| Field::from_values(values))
    }
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
