//! A hemisphere sampled half by cosine and half evenly.

use super::{concentric_disk_inverse, inside_disk};
use glam::Vec3;
use std::f32::consts::TAU;

/// A unit direction with z > 0 whose density is the mean of those of [`cosine_hemisphere`](crate::cosine_hemisphere) and
/// [`uniform_hemisphere`](crate::uniform_hemisphere).
///
/// For functions that do not vanish at the horizon, as moments of radiance: the cosine density alone gives their estimates
/// infinite variance. With this one no sample weighs more than 4π, and irradiance is estimated nearly as well. One continuous
/// map, not a choice between two.
#[inline]
#[must_use]
pub fn mixed_hemisphere(u: [f32; 2]) -> Vec3 {
    let (point, below_one) = inside_disk(u);
    // The root of z² + z = 2 (1 − r²); neither it nor 1 − z suffers cancellation.
    let root = (1.0 + 8.0 * below_one).sqrt();
    let z = 4.0 * below_one / (1.0 + root);
    (point * stretch(z)).extend(z)
}

/// How much farther from the axis a direction of height `z` is than its point in the disk.
#[inline]
fn stretch(z: f32) -> f32 {
    (2.0 * (1.0 + z) / (2.0 + z)).sqrt()
}

/// Density of [`mixed_hemisphere`] in sr⁻¹; `cos` is the cosine to +z. Zero below the horizon.
#[inline]
#[must_use]
pub fn mixed_hemisphere_pdf(cos: f32) -> f32 {
    if cos >= 0.0 { (cos + 0.5) / TAU } else { 0.0 }
}

/// The point of the unit square that [`mixed_hemisphere`] maps to the unit `direction`.
#[inline]
#[must_use]
pub fn mixed_hemisphere_inverse(direction: Vec3) -> [f32; 2] {
    concentric_disk_inverse(direction.truncate() / stretch(direction.z))
}
