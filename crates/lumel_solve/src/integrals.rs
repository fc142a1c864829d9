//! How much light is on its way, and how much is still to come.

use crate::PowerLog;
use glam::{DVec3, Vec3};
use lumel_basis::Field;
use lumel_scene::luminance;

/// Above this ratio of successive bounces the geometric series is not trusted.
const MAX_RATIO: f64 = 0.98;

/// Integrals of a field over the surfaces.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// Area of each node, m².
    areas: Vec<f32>,
    /// Integral of albedo times the node's basis function, m².
    reflecting: Vec<Vec3>,
}

impl Integrals {
    /// The integrals of a basis: `areas` is that of each basis function over the surfaces, `reflecting` that of albedo
    /// times each, both m².
    pub fn new(areas: Vec<f32>, reflecting: Vec<Vec3>) -> Self {
        Self { areas, reflecting }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.areas.len()
    }

    /// The mean albedo of all surfaces, by luminance.
    pub fn mean_albedo(&self) -> f64 {
        let area: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        let reflecting: f64 = self.reflecting.iter().map(|&area| f64::from(luminance(area))).sum();
        if area > 0.0 { reflecting / area } else { 0.0 }
    }

    /// Power that arrives, W per channel.
    pub fn incident(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.areas.iter().map(|&area| Vec3::splat(area)))
    }

    /// The mean irradiance over all surfaces, by luminance, W·m⁻².
    pub fn mean(&self, field: &Field) -> f64 {
        let area: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        if area > 0.0 { self.power(field) / area } else { 0.0 }
    }

    /// The mean over all surfaces of the squared irradiance at nodes, by luminance, W²·m⁻⁴.
    pub fn mean_square(&self, field: &Field) -> f64 {
        let area: f64 = self.areas.iter().map(|&area| f64::from(area)).sum();
        let nodes = self.areas.iter().zip(field.values().iter().step_by(field.channels()));
        let sum: f64 = nodes.map(|(&area, e)| f64::from(area) * f64::from(luminance(*e)).powi(2)).sum();
        if area > 0.0 { sum / area } else { 0.0 }
    }

    /// Power that is reflected and so arrives again, W per channel.
    pub fn reflected(&self, field: &Field) -> DVec3 {
        field.weighted_sum(self.reflecting.iter().copied())
    }

    /// Power that arrives, W by luminance.
    pub fn power(&self, field: &Field) -> f64 {
        f64::from(luminance(self.incident(field).as_vec3()))
    }

    /// [`PowerLog::remainder`] of these bounces.
    pub fn remainder(&self, bounces: &[Field]) -> Option<f64> {
        PowerLog::of(self, bounces).remainder()
    }

    /// The bounces after the last one, as a geometric series of the last one: `λ/(1 − λ)` of it per channel.
    ///
    /// Consistent in shape only: the last bounce's pattern stands for all later ones, whose differences from it are
    /// of second order once light is well mixed. `None` when there is no ratio below 0.98 in any channel.
    pub fn tail(&self, bounces: &[Field]) -> Option<Field> {
        let factors = self.tail_factors(bounces)?;
        Some(scaled(bounces.last()?, factors))
    }

    /// What the last bounce is multiplied by to give its [`tail`](Self::tail), per colour channel.
    pub(crate) fn tail_factors(&self, bounces: &[Field]) -> Option<Vec3> {
        let [.., before, last] = bounces else { return None };
        let (before, last) = (self.incident(before), self.incident(last));
        let factor = |k: usize| {
            let ratio = last[k] / before[k];
            if ratio > 0.0 && ratio < MAX_RATIO { (ratio / (1.0 - ratio)) as f32 } else { 0.0 }
        };
        let factors = Vec3::new(factor(0), factor(1), factor(2));
        (factors != Vec3::ZERO).then_some(factors)
    }
}

/// A field with every coefficient multiplied per colour channel.
pub(crate) fn scaled(field: &Field, factors: Vec3) -> Field {
    Field::with_channels(field.channels(), field.values().iter().map(|&value| value * factors).collect())
}
