//! Pushing ray origins off the surfaces they start on.

use glam::Vec3;

/// Moves a point on a surface along its geometric unit normal by just more than its rounding error.
///
/// The step is 256 units in the last place of each coordinate, so it has no scale of its own: at most 3.1e-5 of the
/// coordinate, or 1.5e-5 near the origin. The point must be computed from barycentrics, not as `o + t d`.
///
/// Wächter and Binder, *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems, 2019.
pub fn offset_along(point: Vec3, normal: Vec3) -> Vec3 {
    Vec3::new(offset(point.x, normal.x), offset(point.y, normal.y), offset(point.z, normal.z))
}

/// Below this the spacing of floats is finer than the rounding error of a point, and a fixed step is taken.
const NEAR_ORIGIN: f32 = 1.0 / 32.0;
const FIXED_STEP: f32 = 1.0 / 65536.0;
const ULPS: f32 = 256.0;

fn offset(p: f32, n: f32) -> f32 {
    if p.abs() < NEAR_ORIGIN {
        return p + FIXED_STEP * n;
    }
    let ulps = (ULPS * n) as i32;
    // Bits of a float grow with its magnitude: away from zero is "up" for either sign.
    let moved = p.to_bits() as i32 + if p < 0.0 { -ulps } else { ulps };
    f32::from_bits(moved as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_is_small_and_goes_along_the_normal() {
        for scale in [1e-3, 1.0, 1e3, 1e6] {
            for p in [Vec3::new(1.0, -2.0, 3.0), Vec3::new(-0.01, 0.02, -1.5)] {
                let p = p * scale;
                for normal in [Vec3::X, -Vec3::Y, Vec3::new(0.6, 0.0, -0.8)] {
                    let step = offset_along(p, normal) - p;
                    assert!(step.dot(normal) > 0.0, "{p} {normal}");
                    let limit = p.abs() * 3.1e-5 + Vec3::splat(1.53e-5);
                    assert!(step.abs().cmple(limit).all(), "{p} {normal} {step}");
                }
            }
        }
    }
}
