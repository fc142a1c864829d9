//! Light in 32 bits.

use glam::Vec3;

/// Values by what the brightest, `white`, stands for: three channels of 9 bits that share an exponent of 5, little-endian. It
/// is the format that OpenGL names `RGB9_E5` and Vulkan `E5B9G9R9`, for textures that are read linearly.
///
/// The error of a channel is at most a 512th of the largest one of its lumel, or 2⁻²⁵ of white where that is more.
pub(crate) fn shared_exponent(values: &[Vec3], white: f32) -> Vec<u8> {
    let scale = if white > 0.0 { white } else { 1.0 };
    values.iter().flat_map(|value| word((*value / scale).max(Vec3::ZERO)).to_le_bytes()).collect()
}

/// The largest mantissa, in steps of the exponent.
const MAX_STEPS: f32 = 511.0;

/// A step is two to the power of the exponent less this.
const BIAS: i32 = 24;

fn word(value: Vec3) -> u32 {
    let largest = value.max_element().min(1.0);
    // The least with which the largest channel has no more than 511 steps; it is 16 for 1.
    let fits = |exponent: &i32| (largest / step(*exponent)).round() <= MAX_STEPS;
    let exponent = (0..16).find(fits).unwrap_or(16);
    let [r, g, b] = value.to_array().map(|channel| (channel / step(exponent)).round().min(MAX_STEPS) as u32);
    r | g << 9 | b << 18 | exponent.unsigned_abs() << 27
}

fn step(exponent: i32) -> f32 {
    ((exponent - BIAS) as f32).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Vec3 {
        let word = u32::from_le_bytes(bytes.try_into().unwrap());
        Vec3::from([0, 9, 18].map(|shift| (word >> shift & 511) as f32)) * step((word >> 27) as i32)
    }

    #[test]
    fn words_are_those_of_the_specification() {
        // OpenGL ES 3.0, section 3.8.3.2: 2^(exponent - 15) times mantissas over 512.
        assert_eq!(
            shared_exponent(&[Vec3::new(0.5, 1.0, 0.0)], 1.0),
            (16_u32 << 27 | 256 << 9 | 128).to_le_bytes()
        );
        assert_eq!(shared_exponent(&[Vec3::X * 3.0, Vec3::NEG_ONE], 3.0)[4..], [0; 4]);
        assert_eq!(shared_exponent(&[Vec3::ZERO], 0.0), [0; 4]);
    }

    #[test]
    fn dark_light_is_as_exact_as_bright_light() {
        for k in 0..2000 {
            let largest = (-0.006 * k as f32).exp();
            let value = largest * Vec3::new(1.0, (k % 7) as f32 / 7.0, 0.001 * (k % 13) as f32);
            let found = read(&shared_exponent(&[value], 1.0));
            let bound = (largest / 512.0).max(step(-1));
            assert!((found - value).abs().max_element() <= bound, "{found} {value}");
        }
    }
}
