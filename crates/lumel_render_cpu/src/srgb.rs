//! The sRGB transfer curve, IEC 61966-2-1.

/// Linear light to the sRGB code, both 0..=1: `12.92 x` up to 0.0031308, then `1.055 x^(1/2.4) - 0.055`.
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The sRGB code to linear light, both 0..=1: the inverse of [`srgb_encode`].
pub fn srgb_decode(code: f32) -> f32 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// Linear light to the byte of a picture: clamped to 0..=1, encoded, times 255, rounded to nearest.
///
/// NaN is black.
pub fn srgb_byte(linear: f32) -> u8 {
    unit_byte(srgb_encode(linear.clamp(0.0, 1.0)))
}

/// The byte of a picture to linear light.
pub fn srgb_from_byte(byte: u8) -> f32 {
    srgb_decode(f32::from(byte) / 255.0)
}

/// A number in 0..=1 as a byte, without a curve; NaN is zero.
pub(crate) fn unit_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        for byte in 0..=255 {
            assert_eq!(srgb_byte(srgb_from_byte(byte)), byte);
        }
    }

    #[test]
    fn known_values_of_the_standard() {
        // Middle grey, one half and the joint of the two pieces.
        for (linear, code) in [(0.18, 0.461_356), (0.5, 0.735_357), (0.003_130_8, 0.040_45), (1.0, 1.0)] {
            assert!((srgb_encode(linear) - code).abs() < 1e-5, "{linear}");
            assert!((srgb_decode(code) - linear).abs() < 1e-5, "{code}");
        }
        assert_eq!([0.18, 0.5].map(srgb_byte), [118, 188]);
    }

    #[test]
    fn values_out_of_range_are_clamped_and_nan_is_black() {
        let values = [-1.0, 0.0, 1.0, 7.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        assert_eq!(values.map(srgb_byte), [0, 0, 255, 255, 255, 0, 0]);
    }
}
