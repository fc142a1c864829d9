//! Halton points in bases 2, 3, 5 and 7 with a random toroidal shift.

use crate::bits::{random_pair, unit_from_f64};

/// One randomisation of the Halton sequence: the same points, shifted on the torus.
///
/// Unbiased, since each shifted point is uniform. Coordinate d is computed in f64 and exact to its rounding.
///
/// Halton, 1960; Cranley, Patterson, *Randomization of number theoretic methods for multiple integration*, 1976.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShiftedHalton {
    /// In units of 2⁻³².
    shift: [u32; 4],
}

impl ShiftedHalton {
    #[inline]
    pub(crate) fn new(key: u64) -> Self {
        let [a, b] = random_pair(key, 0);
        let [c, d] = random_pair(key, 1);
        Self { shift: [a, b, c, d] }
    }

    #[inline]
    pub(crate) fn point_2d(&self, index: u32) -> [f32; 2] {
        [self.shifted(0, radical_inverse::<2>(index)), self.shifted(1, radical_inverse::<3>(index))]
    }

    #[inline]
    pub(crate) fn point_4d(&self, index: u32) -> [f32; 4] {
        let [x, y] = self.point_2d(index);
        let z = self.shifted(2, radical_inverse::<5>(index));
        [x, y, z, self.shifted(3, radical_inverse::<7>(index))]
    }

    #[inline]
    fn shifted(&self, d: usize, x: f64) -> f32 {
        let x = x + f64::from(self.shift[d]) / 4_294_967_296.0;
        unit_from_f64(if x < 1.0 { x } else { x - 1.0 })
    }
}

/// The digits of `index` in `BASE`, mirrored at the radix point: a number in `[0, 1)`.
///
/// Digits are collected as an integer, exactly; the one division rounds.
#[inline]
fn radical_inverse<const BASE: u32>(index: u32) -> f64 {
    let mut rest = index;
    let mut mirrored = 0_u64;
    let mut power = 1_u64;
    while rest > 0 {
        mirrored = mirrored * u64::from(BASE) + u64::from(rest % BASE);
        power *= u64::from(BASE);
        rest /= BASE;
    }
    mirrored as f64 / power as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radical_inverses_mirror_the_digits() {
        assert_eq!(radical_inverse::<2>(0), 0.0);
        assert_eq!(radical_inverse::<2>(6), 0.375); // 110 -> 0.011
        assert_eq!(radical_inverse::<3>(5), 7.0 / 9.0); // 12 -> 0.21
        assert_eq!(radical_inverse::<5>(7), 11.0 / 25.0); // 12 -> 0.21
        assert_eq!(radical_inverse::<7>(50), 50.0 / 343.0); // 101 -> 0.101
        assert_eq!(radical_inverse::<2>(u32::MAX), 1.0 - 0.5_f64.powi(32));
        assert!(radical_inverse::<7>(u32::MAX) < 1.0);
    }
}
