//! Jittered samples on a square grid.

use crate::bits::{mix, random_pair, unit_from_f64};

/// Layers of `side²` points, one in each cell of a square grid, placed at random inside of the cell.
///
/// Over one layer each point is uniform within its own cell: means over whole layers are unbiased, means over a part
/// of a layer are not. For f = x + y and one layer of N points the RMS error is 1/(√6 N).
///
/// Cook, *Stochastic sampling in computer graphics*, ACM TOG 5(1), 1986.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JitteredGrid {
    key: u64,
    side: u32,
}

impl JitteredGrid {
    #[inline]
    pub(crate) fn new(key: u64, side: u16) -> Self {
        Self { key, side: u32::from(side).max(1) }
    }

    /// Visits the cells in plain order, row by row.
    #[inline]
    pub(crate) fn point_2d(&self, index: u32) -> [f32; 2] {
        let cell = index % self.cells();
        self.jittered(cell, random_pair(self.key, u64::from(index)))
    }

    /// Pads two grids, each visited in a random order of its own.
    #[inline]
    pub(crate) fn point_4d(&self, index: u32) -> [f32; 4] {
        let cells = self.cells();
        let (layer, cell) = (index / cells, index % cells);
        let [order_a, order_b] = random_pair(mix(!self.key), u64::from(layer));
        let [x, y] =
            self.jittered(permuted(cell, cells, order_a), random_pair(self.key, 2 * u64::from(index)));
        let [z, w] =
            self.jittered(permuted(cell, cells, order_b), random_pair(self.key, 2 * u64::from(index) + 1));
        [x, y, z, w]
    }

    /// Number of cells; at most 65535², which fits.
    #[inline]
    fn cells(&self) -> u32 {
        self.side * self.side
    }

    #[inline]
    fn jittered(&self, cell: u32, random: [u32; 2]) -> [f32; 2] {
        let corner = [cell % self.side, cell / self.side];
        std::array::from_fn(|d| {
            let offset = f64::from(random[d]) / 4_294_967_296.0;
            unit_from_f64((f64::from(corner[d]) + offset) / f64::from(self.side))
        })
    }
}

/// Where a random permutation of `0..n` puts `i`; `order` selects the permutation.
///
/// A bijection of the next power of two, applied again until the result falls below `n` (cycle walking): fewer than
/// two rounds on average. `i` must be below `n`.
///
/// Black, Rogaway, *Ciphers with arbitrary finite domains*, 2002.
fn permuted(i: u32, n: u32, order: u32) -> u32 {
    if n <= 1 {
        return 0;
    }
    let bits = u32::BITS - (n - 1).leading_zeros();
    let mask = u32::MAX >> (u32::BITS - bits);
    let shift = bits.div_ceil(2);
    let keys = [random_pair(u64::from(order), 0), random_pair(u64::from(order), 1)];
    let mut x = i;
    loop {
        // Each line is a bijection of the masked bits: adding, multiplying by an odd number, folding down.
        for [add, multiply] in keys {
            x = x.wrapping_add(add) & mask;
            x ^= x >> shift;
            x = x.wrapping_mul(multiply | 1) & mask;
            x ^= x >> shift;
            x = x.wrapping_mul(0x9e37_79b1) & mask;
        }
        x ^= x >> shift;
        if x < n {
            return x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_hit_every_cell_once() {
        for n in [1, 2, 3, 4, 7, 16, 25, 64, 100, 1024, 1025] {
            for order in 0..20 {
                let mut seen = vec![false; n as usize];
                for i in 0..n {
                    assert!(!std::mem::replace(&mut seen[permuted(i, n, order) as usize], true));
                }
            }
        }
    }

    /// Over 16000 orders each of the 256 pairs (i, place) of 16 cells is expected 1000 times, σ = 31; 5σ covers all.
    #[test]
    fn every_cell_reaches_every_place() {
        let mut counts = [[0_i32; 16]; 16];
        for order in 0..16_000 {
            for i in 0..16 {
                counts[i as usize][permuted(i, 16, order) as usize] += 1;
            }
        }
        for count in counts.as_flattened() {
            assert!((count - 1000).abs() < 155, "{count}");
        }
    }

    #[test]
    fn the_largest_grid_does_not_overflow() {
        let grid = JitteredGrid::new(3, u16::MAX);
        for index in [0, u32::MAX - 1, u32::MAX] {
            assert!(grid.point_4d(index).iter().chain(&grid.point_2d(index)).all(|x| (0.0..1.0).contains(x)));
        }
    }
}
