//! The closed form of a round patch of directions.

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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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
}
