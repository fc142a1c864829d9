//! Uniform sampling of a cone of directions.

use super::concentric_disk;
use crate::Frame;
use glam::Vec3;
use std::f64::consts::TAU;

/// All directions within an angle of up to 90° of an axis: a sphere seen from a point, or a sun.
///
/// Set up in f64 from the square of the sine, so that narrow cones keep their digits.
#[derive(Clone, Copy, Debug)]
pub struct SphericalCap {
    frame: Frame,
    /// One minus the cosine of the half-angle.
    height: f64,
}

impl SphericalCap {
    /// The directions around the unit vector `axis` within the angle whose sine has this square, 0 to 1.
    #[must_use]
    pub fn new(axis: Vec3, sin_squared: f64) -> Self {
        let cos = (1.0 - sin_squared).max(0.0).sqrt();
        Self { frame: Frame::from_normal(axis), height: sin_squared / (1.0 + cos) }
    }

    /// Solid angle, sr.
    #[inline]
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        TAU * self.height
    }

    /// Density of [`sample`](Self::sample), sr⁻¹: one over the solid angle.
    #[inline]
    #[must_use]
    pub fn pdf(&self) -> f64 {
        1.0 / self.solid_angle()
    }

    /// A unit direction, uniform in solid angle, and one minus its cosine to the axis.
    ///
    /// Concentric circles of the square become circles around the axis.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> (Vec3, f64) {
        let disk = concentric_disk(u);
        let drop = f64::from(disk.length_squared()).min(1.0) * self.height;
        let sine_per_radius = (self.height * (2.0 - drop)).max(0.0).sqrt() as f32;
        let local = (disk * sine_per_radius).extend((1.0 - drop) as f32);
        (self.frame.to_world(local), drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dim, Sampler, StreamKey};

    #[test]
    fn directions_fill_the_cap_evenly_however_narrow() {
        let stream = Sampler::Sobol.stream(StreamKey::new(3), Dim::Hemisphere);
        let axis = Vec3::new(0.6, -0.64, 0.48);
        for sin_squared in [1.0, 0.3, 2e-5, 1e-10] {
            let cap = SphericalCap::new(axis, sin_squared);
            let n = 4096;
            let (mut mean, mut within_half) = (0.0, 0);
            for i in 0..n {
                let (direction, drop) = cap.sample(stream.sample_2d(i));
                assert!((direction.length() - 1.0).abs() < 1e-6);
                assert!((0.0..=cap.height).contains(&drop), "{drop} {}", cap.height);
                // The chord's square is twice the drop, and keeps more digits than the cosine.
                let chord = (direction - axis).as_dvec3().length_squared();
                assert!((chord - 2.0 * drop).abs() < 1e-3 * chord + 1e-12, "{sin_squared}: {chord} {drop}");
                mean += drop / cap.height / f64::from(n);
                within_half += usize::from(drop < 0.5 * cap.height);
            }
            assert!((mean - 0.5).abs() < 2e-3, "{sin_squared}: {mean}");
            assert!(within_half.abs_diff(n as usize / 2) < 20, "{sin_squared}: {within_half}");
        }
    }

    #[test]
    fn the_solid_angle_is_that_of_the_cone() {
        let half_angle = 0.2f64;
        let cap = SphericalCap::new(Vec3::Z, half_angle.sin().powi(2));
        assert!((cap.solid_angle() - TAU * (1.0 - half_angle.cos())).abs() < 1e-12);
        assert!((cap.pdf() * cap.solid_angle() - 1.0).abs() < 1e-12);
    }
}
