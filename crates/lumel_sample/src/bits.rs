//! Hashes of integers, and the way from integers and reals to `f32` in `[0, 1)`.

/// Largest `f32` below one, `1 − 2⁻²⁴`.
pub(crate) const ONE_MINUS_EPS: f32 = 1.0 - f32::EPSILON / 2.0;

/// A bijective mixing of 64 bits: every input bit reaches every output bit.
///
/// Zero maps to zero; callers add an odd constant first where that matters.
///
/// Constants of `moremur`: Pelle Evensen, *Stronger, better, morer, Moremur*, 2019.
#[inline]
pub(crate) const fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 27)).wrapping_mul(0x3c79_ac49_2ba7_b653);
    x = (x ^ (x >> 33)).wrapping_mul(0x1c69_b3f7_4ac4_ae35);
    x ^ (x >> 27)
}

/// Odd fraction of the golden ratio of 2⁶⁴; multiples of it fill the 64-bit integers evenly.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The `counter`-th pair of 32 random bits of the stream that starts at `key`.
///
/// Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014, with the mixing above.
#[inline]
pub(crate) const fn random_pair(key: u64, counter: u64) -> [u32; 2] {
    let x = mix(key.wrapping_add(counter.wrapping_mul(GOLDEN)));
    [x as u32, (x >> 32) as u32]
}

/// The top 24 bits of `bits` as a fraction in `[0, 1 − 2⁻²⁴]`.
///
/// Truncates where a plain conversion would round: a rounded value can cross into the next elementary interval
/// of a net, or reach one. The loss is a shift of the mean by less than 2⁻²⁴.
#[inline]
pub(crate) fn unit_from_bits(bits: u32) -> f32 {
    (bits >> 8) as f32 * (f32::EPSILON / 2.0)
}

/// A number in `[0, 1)` that is the same for the same words and otherwise as good as random.
pub fn unit_hash(words: &[u32]) -> f32 {
    let absorb = |hash: u64, &word: &u32| mix(hash.wrapping_add(GOLDEN) ^ u64::from(word));
    unit_from_bits((words.iter().fold(0, absorb) >> 32) as u32)
}

/// `x` as `f32`, clamped to `[0, 1)`.
#[inline]
pub(crate) fn unit_from_f64(x: f64) -> f32 {
    (x as f32).clamp(0.0, ONE_MINUS_EPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_from_bits_stays_below_one_and_truncates() {
        assert_eq!(unit_from_bits(0), 0.0);
        assert_eq!(unit_from_bits(u32::MAX), ONE_MINUS_EPS);
        assert_eq!(unit_from_bits(0x8000_0000), 0.5);
        assert!(unit_from_bits(0x7fff_ffff) < 0.5, "rounding would give one half");
    }

    #[test]
    fn unit_from_f64_stays_below_one() {
        assert_eq!(unit_from_f64(1.0 - 1e-12), ONE_MINUS_EPS);
        assert_eq!(unit_from_f64(-1e-12), 0.0);
        assert_eq!(unit_from_f64(0.25), 0.25);
    }

    /// Flipping one input bit flips each output bit with probability 1/2. Over 4096 inputs and 64 input bits the
    /// count per output bit has σ = √(4096·64)/2 = 256; 6σ of 131072 is 1.2 %.
    #[test]
    fn mixing_flips_half_of_the_bits() {
        let mut flips = [0_u32; 64];
        for n in 0..4096_u64 {
            let x = n.wrapping_mul(GOLDEN);
            for bit in 0..64 {
                let changed = mix(x) ^ mix(x ^ (1 << bit));
                for (i, count) in flips.iter_mut().enumerate() {
                    *count += ((changed >> i) & 1) as u32;
                }
            }
        }
        for count in flips {
            assert!((f64::from(count) / 131_072.0 - 1.0).abs() < 0.012, "{count} of 262144");
        }
    }
}
