//! What arrives by direction: irradiance, and the coefficients of harmonics beside it.

use glam::{DVec3, Vec3};
use lumel_basis::{Directional, HARMONICS, spherical_harmonics};

/// What light of one direction counts in each channel of a [`Directional`] field, per irradiance of a surface that faces it:
/// the cosine to the normal, then every harmonic.
#[inline]
pub(crate) fn factors(normal: Vec3, direction: Vec3) -> [f32; 1 + HARMONICS] {
    let mut factors = [normal.dot(direction).max(0.0); 1 + HARMONICS];
    factors[1..].copy_from_slice(&spherical_harmonics(direction));
    factors
}

/// Sums in all channels at some places.
#[derive(Default)]
pub(crate) struct Moments {
    channels: usize,
    /// Place by place.
    values: Vec<DVec3>,
}

impl Moments {
    /// Makes them darkness, in the memory that they have.
    pub(crate) fn reset(&mut self, kind: Directional, places: usize) {
        self.channels = kind.channels();
        self.values.clear();
        self.values.resize(self.channels * places, DVec3::ZERO);
    }

    /// Adds light that counts as `factors` say and brings `facing` to a surface that faces it, W·m⁻².
    #[inline]
    pub(crate) fn add<F: Copy + Into<f64>>(
        &mut self,
        at: usize,
        factors: &[F; 1 + HARMONICS],
        facing: DVec3,
    ) {
        let sums = &mut self.values[at * self.channels..][..self.channels];
        for (sum, factor) in sums.iter_mut().zip(factors) {
            *sum += facing * (*factor).into();
        }
    }

    /// All channels of a place.
    pub(crate) fn of(&self, at: usize) -> &[DVec3] {
        &self.values[at * self.channels..][..self.channels]
    }
}
