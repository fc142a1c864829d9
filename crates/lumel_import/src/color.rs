//! Colours stored with the sRGB transfer curve.

use glam::Vec3;

/// sRGB to linear, 0..=1 each, by IEC 61966-2-1.
pub(crate) fn linear_from_srgb(srgb: Vec3) -> Vec3 {
    let decode = |c: f32| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    Vec3::new(decode(srgb.x), decode(srgb.y), decode(srgb.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_stay_and_middle_grey_is_darker_than_half() {
        assert_eq!(linear_from_srgb(Vec3::ZERO), Vec3::ZERO);
        assert!((linear_from_srgb(Vec3::ONE) - 1.0).length() < 1e-6);
        assert!((linear_from_srgb(Vec3::splat(0.5)).x - 0.214_041).abs() < 1e-6);
    }
}
