//! 16-bit floats, IEEE 754 binary16.

use crate::shaders::MAX_F16;

/// The bits of the nearest 16-bit float; ties to even. Numbers out of 0..=65504 become the nearest of these.
pub(crate) fn f16_bits(value: f32) -> u16 {
    /// The smallest number with all 11 bits.
    const SMALLEST_NORMAL: f32 = 1.0 / 16_384.0;
    /// One over the smallest number there is.
    const SUBNORMAL_STEPS: f32 = 16_777_216.0;
    let value = if value > 0.0 { value.min(MAX_F16) } else { 0.0 };
    if value < SMALLEST_NORMAL {
        return (value * SUBNORMAL_STEPS).round_ties_even() as u16;
    }
    // The exponent's bias shrinks from 127 to 15, and 13 bits of the fraction go.
    let bits = value.to_bits() - ((127 - 15) << 23);
    let to_even = 0xfff + ((bits >> 13) & 1);
    ((bits + to_even) >> 13) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(bits: u16) -> f32 {
        let (exponent, fraction) = (i32::from(bits >> 10), f32::from(bits & 0x3ff));
        let normal = || (1.0 + fraction / 1024.0) * 2f32.powi(exponent - 15);
        if exponent == 0 { fraction / 16_777_216.0 } else { normal() }
    }

    #[test]
    fn every_16_bit_float_is_its_own_nearest() {
        // 0x7bff is 65504; what follows is infinity.
        for bits in 0..=0x7bff {
            assert_eq!(f16_bits(back(bits)), bits);
        }
    }

    #[test]
    fn numbers_between_go_to_the_nearer_and_ties_to_even() {
        for bits in [0u16, 1, 7, 0x3ff, 0x400, 0x3c00, 0x3c01, 0x7bfd] {
            let (low, high) = (back(bits), back(bits + 1));
            assert_eq!(f16_bits(low + 0.4 * (high - low)), bits, "{low}");
            assert_eq!(f16_bits(low + 0.6 * (high - low)), bits + 1, "{low}");
            assert_eq!(f16_bits(0.5 * (low + high)), bits + (bits & 1), "{low}");
        }
    }

    #[test]
    fn numbers_out_of_range_become_its_ends() {
        assert_eq!([-1.0, f32::NAN, 1e9, f32::INFINITY].map(f16_bits), [0, 0, 0x7bff, 0x7bff]);
    }
}
