//! The closed forms of a round patch of directions.

use glam::{DMat3, DVec3};
use lumel_basis::{HARMONICS, integrals_of_harmonics};
use std::f64::consts::PI;

/// Unblocked irradiance of a cone of directions per unit of its constant radiance.
///
/// `cos` is that of the angle between the receiver's normal and the axis, `sin_squared` the square of the sine of the
/// half-angle, which is at most 90°. What lies below the horizon is left out; above it altogether, this is `π sin² cos`.
///
/// Snyder, *Area Light Sources for Real-Time Graphics*, 1996, in the form of Lagarde and de Rousiers, *Moving Frostbite to
/// Physically Based Rendering*, 2014.
pub(crate) fn unit_irradiance(cos: f64, sin_squared: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let cot = ((1.0 - sin_squared).max(0.0) / sin_squared).sqrt();
    // -1 where all of it is above the horizon, 1 where nothing is; an axis along the normal divides by zero.
    let horizon = (-cot * cos / sin).clamp(-1.0, 1.0);
    if horizon.is_nan() {
        return if cos > 0.0 { (-1.0f64).acos() * cos * sin_squared } else { 0.0 };
    }
    let half_chord = sin * ((1.0 - horizon) * (1.0 + horizon)).sqrt();
    let fringe = if half_chord > 0.0 { (half_chord / cot).atan() } else { 0.0 };
    ((cos * horizon.acos() - cot * half_chord) * sin_squared + fringe).max(0.0)
}

/// The same for all channels of light by direction: irradiance, and the integrals of the harmonics over the part of the cone above
/// the horizon. All vectors have unit length. Exact to about 1e-15 of the sphere.
pub(crate) fn unit_moments(axis: DVec3, sin_squared: f64, normal: DVec3) -> [f64; 1 + HARMONICS] {
    let (solid_angle, first, second) = Clipped::new(axis, sin_squared, normal).moments();
    let mut moments = [unit_irradiance(axis.dot(normal), sin_squared); 1 + HARMONICS];
    moments[1..].copy_from_slice(&integrals_of_harmonics(solid_angle, first, second));
    moments
}

/// A cone of directions above the horizon: its rim, and what of the horizon is in it.
///
/// Its moments are integrals along the border, by Gauss's theorem on the sphere, with `m` the unit vector along the sphere and into the cone:
/// of directions `½ ∮ m`, of their products `⅓ (Ω I + ∮ ω mᵀ)`, and `Ω` by the theorem of Gauss and Bonnet.
enum Clipped {
    /// Above the horizon altogether.
    Whole { axis: DVec3, cos: f64, sin_squared: f64 },
    /// Of the rim, what is not farther than the angle `half_turn` from its highest point.
    Partly { axis: DVec3, cos: f64, sin: f64, half_turn: f64, normal: DVec3 },
    /// Below it altogether.
    Hidden,
}

impl Clipped {
    fn new(axis: DVec3, sin_squared: f64, normal: DVec3) -> Self {
        let (cos, sin) = ((1.0 - sin_squared).max(0.0).sqrt(), sin_squared.sqrt());
        let height = axis.dot(normal);
        let across = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        let edge = -cos * height / (sin * across);
        if edge > -1.0 && edge < 1.0 {
            return Self::Partly { axis, cos, sin, half_turn: edge.acos(), normal };
        }
        if height > 0.0 { Self::Whole { axis, cos, sin_squared } } else { Self::Hidden }
    }

    /// The integrals of 1, of directions and of their products.
    fn moments(&self) -> (f64, DVec3, DMat3) {
        match *self {
            Self::Hidden => (0.0, DVec3::ZERO, DMat3::ZERO),
            Self::Whole { axis, cos, sin_squared } => {
                // 1 - cos, without losing digits of narrow cones.
                let height = sin_squared / (1.0 + cos);
                let solid_angle = 2.0 * PI * height;
                let along = 2.0 * PI / 3.0 * height * (1.0 + cos + cos * cos);
                let across = 0.5 * (solid_angle - along);
                let second =
                    DMat3::from_diagonal(DVec3::splat(across)) + (along - across) * outer(axis, axis);
                (solid_angle, PI * sin_squared * axis, second)
            }
            Self::Partly { axis, cos, sin, half_turn, normal } => {
                let height = axis.dot(normal);
                // From the axis to the highest point of the rim, and along the horizon to below the axis and aside.
                let up = (normal - height * axis).normalize_or_zero();
                let ahead = (axis - height * normal).normalize_or_zero();
                let aside = axis.cross(up);
                let (turn_sin, turn_cos) = half_turn.sin_cos();
                // Where the rim meets the horizon, as seen along it.
                let chord_sin = sin * turn_sin;
                let chord_cos = cos * axis.dot(ahead) + sin * turn_cos * up.dot(ahead);
                let half_chord = chord_sin.atan2(chord_cos);
                // There, the border turns by the angle between what points into the cone and what points up.
                let inwards = sin * axis - cos * (turn_cos * up + turn_sin * aside);
                let along_horizon = chord_cos * aside - chord_sin * ahead;
                let corner = (-inwards.dot(along_horizon)).atan2(inwards.dot(normal));
                let solid_angle = 2.0 * (PI - cos * half_turn - corner);
                let rim = sin * (2.0 * sin * half_turn * axis - 2.0 * cos * turn_sin * up);
                let first = 0.5 * (rim + 2.0 * half_chord * normal);
                let mixed = turn_sin * turn_cos;
                let round = (half_turn + mixed) * outer(up, up) + (half_turn - mixed) * outer(aside, aside);
                let of_rim = 2.0 * cos * sin * half_turn * outer(axis, axis) - sin * cos * round
                    + 2.0 * turn_sin * (sin * sin * outer(up, axis) - cos * cos * outer(axis, up));
                let products = sin * of_rim + 2.0 * chord_sin * outer(ahead, normal);
                let second = (products + DMat3::from_diagonal(DVec3::splat(solid_angle))) * (1.0 / 3.0);
                (solid_angle, first, second)
            }
        }
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_basis::spherical_harmonics;

    /// The integral of the cosine over the cone, by the midpoint rule.
    fn by_quadrature(cos: f64, sin_squared: f64) -> f64 {
        let (sin, n) = ((1.0 - cos * cos).sqrt(), 2000);
        let height = 1.0 - (1.0 - sin_squared).sqrt();
        let mut sum = 0.0;
        for i in 0..n {
            let z = 1.0 - height * (f64::from(i) + 0.5) / f64::from(n);
            let radius = (1.0 - z * z).sqrt();
            for k in 0..n {
                let turn = PI * (f64::from(k) + 0.5) / f64::from(n);
                sum += (z * cos + radius * turn.cos() * sin).max(0.0);
            }
        }
        sum * 2.0 * PI * height / f64::from(n) / f64::from(n)
    }

    #[test]
    fn cones_are_clipped_at_the_horizon() {
        for sin_squared in [0.98, 0.5, 0.01] {
            for cos in [0.999, 0.6, 0.2, 0.05, 0.0, -0.05, -0.2, -0.6] {
                let (form, sum) = (unit_irradiance(cos, sin_squared), by_quadrature(cos, sin_squared));
                assert!((form - sum).abs() < 2e-6 * sin_squared, "{sin_squared} {cos}: {form} {sum}");
            }
        }
    }

    #[test]
    fn narrow_cones_keep_their_digits() {
        for sin_squared in [2e-5, 1e-9, 1e-14] {
            for cos in [1.0, 0.7, 0.1] {
                let expected = PI * sin_squared * cos;
                assert!((unit_irradiance(cos, sin_squared) / expected - 1.0).abs() < 1e-9, "{sin_squared}");
            }
            assert_eq!(unit_irradiance(-0.1, sin_squared), 0.0);
            let half = unit_irradiance(0.0, sin_squared);
            let expected = sin_squared.powf(1.5) * 2.0 / 3.0;
            assert!((half / expected - 1.0).abs() < 2e-2, "{half:e} {expected:e}");
        }
        assert_eq!(unit_irradiance(-1.0, 0.5), 0.0);
    }

    /// The integrals of all channels over the part of a cone above the horizon, by the midpoint rule.
    fn moments_by_quadrature(axis: DVec3, sin_squared: f64, normal: DVec3) -> [f64; 1 + HARMONICS] {
        let (u, v) = axis.any_orthonormal_pair();
        let n = 500;
        let height = 1.0 - (1.0 - sin_squared).sqrt();
        let mut sums = [0.0; 1 + HARMONICS];
        for i in 0..n {
            let z = 1.0 - height * (f64::from(i) + 0.5) / f64::from(n);
            let radius = (1.0 - z * z).sqrt();
            for k in 0..n {
                let (sin, cos) = (2.0 * PI * (f64::from(k) + 0.5) / f64::from(n)).sin_cos();
                let direction = z * axis + radius * (cos * u + sin * v);
                let above = direction.dot(normal);
                if above > 0.0 {
                    sums[0] += above;
                    let harmonics = spherical_harmonics(direction.as_vec3());
                    sums[1..].iter_mut().zip(harmonics).for_each(|(sum, y)| *sum += f64::from(y));
                }
            }
        }
        sums.map(|sum| sum * 2.0 * PI * height / f64::from(n) / f64::from(n))
    }

    #[test]
    fn moments_of_cones_are_the_integrals_over_them() {
        let axis = DVec3::new(0.36, -0.48, 0.8);
        let (u, _) = axis.any_orthonormal_pair();
        for sin_squared in [0.98, 0.5, 0.01] {
            for height in [0.999, 0.6, 0.2, 0.05, 0.0, -0.05, -0.2, -0.6] {
                let normal = height * axis + (1.0f64 - height * height).sqrt() * u;
                let forms = unit_moments(axis, sin_squared, normal);
                let sums = moments_by_quadrature(axis, sin_squared, normal);
                for (k, (form, sum)) in forms.into_iter().zip(sums).enumerate() {
                    let error = (form - sum).abs();
                    assert!(error < 6e-4 * sin_squared, "{sin_squared} {height} {k}: {form} {sum}");
                }
            }
        }
    }

    #[test]
    fn moments_change_smoothly_where_a_cone_touches_the_horizon() {
        let axis = DVec3::Z;
        for sin_squared in [0.5, 1e-3, 2e-5] {
            let sin = f64::sqrt(sin_squared);
            let at = |height: f64| {
                let normal = DVec3::new((1.0 - height * height).sqrt(), 0.0, height);
                unit_moments(axis, sin_squared, normal)
            };
            let [above, below] = [1.0 + 1e-9, 1.0 - 1e-9].map(|share| at(share * sin));
            for (a, b) in above.into_iter().zip(below) {
                assert!((a - b).abs() < 1e-6 * sin_squared, "{sin_squared}: {a} {b}");
            }
            assert_eq!(at(-sin - 1e-9), [0.0; 1 + HARMONICS]);
        }
    }
}
