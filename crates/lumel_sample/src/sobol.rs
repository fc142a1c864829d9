//! Sobol points in four dimensions, scrambled in the way of Owen by a hash.

use crate::bits::{random_pair, unit_from_bits};

/// One randomisation of the Sobol sequence: a nested shuffle of the indices and a nested scrambling per dimension.
///
/// Every point is uniform over keys, so means are unbiased. The first 2ᵐ points, and every later block of 2ᵐ that
/// starts at a multiple of 2ᵐ, form a digital net; in the first two dimensions every elementary interval of area
/// 2⁻ᵐ holds exactly one of them, for m up to 24. For smooth integrands the RMS error falls like N^-3/2.
///
/// Owen, *Scrambled net variance for integrals of smooth functions*, 1997; Burley, *Practical hash-based Owen
/// scrambling*, JCGT 9(4), 2020.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScrambledSobol {
    index_seed: u32,
    seeds: [u32; 4],
}

impl ScrambledSobol {
    #[inline]
    pub(crate) fn new(key: u64) -> Self {
        let [index_seed, s0] = random_pair(key, 0);
        let [s1, s2] = random_pair(key, 1);
        let [s3, _] = random_pair(key, 2);
        Self { index_seed, seeds: [s0, s1, s2, s3] }
    }

    #[inline]
    pub(crate) fn point_2d(&self, index: u32) -> [f32; 2] {
        let index = self.shuffled(index);
        let reversed = [index, pascal(index)];
        std::array::from_fn(|d| scrambled_unit(reversed[d], self.seeds[d]))
    }

    #[inline]
    pub(crate) fn point_4d(&self, index: u32) -> [f32; 4] {
        let index = self.shuffled(index);
        let [r2, r3] = third_and_fourth(index);
        let reversed = [index, pascal(index), r2, r3];
        std::array::from_fn(|d| scrambled_unit(reversed[d], self.seeds[d]))
    }

    /// Permutes the indices inside of every aligned block of 2ᵐ and moves the blocks as a whole, for all m at once.
    ///
    /// Prefixes stay nets, and streams of different keys pair their points at random.
    #[inline]
    fn shuffled(&self, index: u32) -> u32 {
        permute_upwards(index.reverse_bits(), self.index_seed).reverse_bits()
    }
}

/// Scrambles a coordinate given with its bits in reverse order, most significant digit in bit 0.
#[inline]
fn scrambled_unit(reversed: u32, seed: u32) -> f32 {
    unit_from_bits(permute_upwards(reversed, seed).reverse_bits())
}

/// A random permutation in which bit i of the result depends on the bits 0..=i of `v` only.
///
/// On reversed bits this is a nested uniform scrambling: a digit is flipped according to the digits above it.
///
/// Laine, Karras, *Stratified sampling for stochastic transparency*, EGSR 2011; later constants of Nathan Vegdahl.
#[inline]
fn permute_upwards(mut v: u32, seed: u32) -> u32 {
    v ^= v.wrapping_mul(0x3d20_adea);
    v = v.wrapping_add(seed);
    v = v.wrapping_mul((seed >> 16) | 1);
    v ^= v.wrapping_mul(0x0552_6c56);
    v ^ v.wrapping_mul(0x53a2_2864)
}

/// The second Sobol coordinate of `index`, bits reversed.
///
/// Its generator matrix is Pascal's triangle modulo 2, and the binomial C(i, j) is odd exactly if the bits of j are
/// among those of i (Lucas). So bit j of the result is the parity of the bits of `index` at positions that contain j.
#[inline]
const fn pascal(index: u32) -> u32 {
    let mut v = index;
    v ^= (v & 0xaaaa_aaaa) >> 1;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^= (v & 0xff00_ff00) >> 8;
    v ^ (v >> 16)
}

/// The third and fourth Sobol coordinates of `index`, bits reversed.
#[inline]
fn third_and_fourth(index: u32) -> [u32; 2] {
    let mut both = 0;
    for (nibble, row) in NIBBLES.iter().enumerate() {
        both ^= row[(index >> (4 * nibble)) as usize & 15];
    }
    [both as u32, (both >> 32) as u32]
}

/// `NIBBLES[k][n]`: what the bits n at 4k contribute to dimensions 3 (low half) and 4 (high half), bits reversed.
static NIBBLES: [[u64; 16]; 8] = {
    // x² + x + 1 with m = 1, 3 and x³ + x + 1 with m = 1, 3, 1: dimensions 3 and 4 of Joe and Kuo, 2008.
    let third = direction_numbers(0b111, &[1, 3]);
    let fourth = direction_numbers(0b1011, &[1, 3, 1]);
    let mut table = [[0; 16]; 8];
    let mut k = 0;
    while k < 8 {
        let mut n = 1;
        while n < 16 {
            // n without its lowest bit is done already; add the column of that bit.
            let bit = 4 * k + (n as u32).trailing_zeros() as usize;
            let column = (fourth[bit].reverse_bits() as u64) << 32 | third[bit].reverse_bits() as u64;
            table[k][n] = table[k][n & (n - 1)] ^ column;
            n += 1;
        }
        k += 1;
    }
    table
};

/// The 32 direction numbers of one dimension, as binary fractions with the first digit in bit 31.
///
/// - `polynomial`: a primitive polynomial over GF(2), leading coefficient first
/// - `initial`: as many odd integers as its degree, the k-th (from 1) below 2ᵏ
///
/// Bratley, Fox, *Algorithm 659*, ACM TOMS 14(1), 1988.
const fn direction_numbers(polynomial: u32, initial: &[u32]) -> [u32; 32] {
    let degree = initial.len();
    let mut v = [0; 32];
    let mut i = 0;
    while i < 32 {
        if i < degree {
            v[i] = initial[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if polynomial >> (degree - k) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix-vector product written out.
    fn coordinate(columns: &[u32; 32], index: u32) -> u32 {
        (0..32).filter(|bit| index >> bit & 1 == 1).fold(0, |v, bit| v ^ columns[bit])
    }

    #[test]
    fn fast_coordinates_are_products_with_the_generator_matrices() {
        // x + 1 with m = 1 generates the second dimension.
        let second = direction_numbers(0b11, &[1]);
        let third = direction_numbers(0b111, &[1, 3]);
        let fourth = direction_numbers(0b1011, &[1, 3, 1]);
        for index in (0..1000).map(|i: u32| i.wrapping_mul(0x9e37_79b9)) {
            let [r2, r3] = third_and_fourth(index);
            assert_eq!(pascal(index).reverse_bits(), coordinate(&second, index));
            assert_eq!(r2.reverse_bits(), coordinate(&third, index));
            assert_eq!(r3.reverse_bits(), coordinate(&fourth, index));
        }
    }

    /// Numbers of dimension k as the odd integers mₖ = vₖ·2ᵏ, worked by hand from the recurrence.
    #[test]
    fn direction_numbers_match_the_worked_example() {
        let m = |columns: [u32; 32]| std::array::from_fn::<u32, 6, _>(|i| columns[i] >> (31 - i));
        assert_eq!(m(direction_numbers(0b11, &[1])), [1, 3, 5, 15, 17, 51]);
        assert_eq!(m(direction_numbers(0b111, &[1, 3])), [1, 3, 3, 9, 29, 23]);
        // The example of the article.
        assert_eq!(m(direction_numbers(0b1011, &[1, 3, 7])), [1, 3, 7, 5, 7, 43]);
    }

    /// With a shared seed the points stay a net, but the scramblings of two dimensions repeat each other.
    #[test]
    fn the_shuffle_and_each_dimension_have_seeds_of_their_own() {
        let ScrambledSobol { index_seed, seeds: [s0, s1, s2, s3] } = ScrambledSobol::new(99);
        let seeds = std::collections::BTreeSet::from([index_seed, s0, s1, s2, s3]);
        assert_eq!(seeds.len(), 5);
    }

    #[test]
    fn shuffling_keeps_aligned_blocks_together() {
        let sobol = ScrambledSobol::new(99);
        for m in 0..8 {
            let block = sobol.shuffled(0) >> m;
            let mut seen = vec![false; 1 << m];
            for i in 0..1_u32 << m {
                let shuffled = sobol.shuffled(i);
                assert_eq!(shuffled >> m, block);
                assert!(!std::mem::replace(&mut seen[shuffled as usize & ((1 << m) - 1)], true));
            }
        }
    }
}
