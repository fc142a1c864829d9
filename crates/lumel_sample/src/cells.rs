//! Sample points in the order of the cells that they lie in.

use crate::Stream;

/// The points of a stream, sorted so that neighbours in the list are neighbours in the square.
///
/// The square is cut into about as many cells as there are points, 2ᵃ × 2ᵇ of them, and these are visited along
/// Morton's curve: any run of 4ᵏ cells that starts at a multiple of its length is a square. Of a power of two of Sobol
/// points each cell holds exactly one. The points are those of the stream, so means over all of them are the same.
///
/// Keeps its memory from one stream to the next.
#[derive(Clone, Debug, Default)]
pub struct CellOrder {
    plain: Vec<[f32; 2]>,
    cells: Vec<u32>,
    /// Where the next point of each cell goes.
    next: Vec<u32>,
    sorted: Vec<[f32; 2]>,
}

impl CellOrder {
    /// The first `n` points of a stream; those of one cell stay in their order.
    pub fn points(&mut self, stream: &Stream, n: u32) -> &[[f32; 2]] {
        let grid = Grid::new(n);
        self.plain.clear();
        self.plain.extend((0..n).map(|i| stream.sample_2d(i)));
        self.cells.clear();
        self.cells.extend(self.plain.iter().map(|&point| grid.cell(point)));
        self.next.clear();
        self.next.resize(grid.cells() + 1, 0);
        for &cell in &self.cells {
            self.next[cell as usize + 1] += 1;
        }
        for cell in 1..self.next.len() {
            self.next[cell] += self.next[cell - 1];
        }
        self.sorted.resize(n as usize, [0.0; 2]);
        for (&point, &cell) in self.plain.iter().zip(&self.cells) {
            let place = &mut self.next[cell as usize];
            self.sorted[*place as usize] = point;
            *place += 1;
        }
        &self.sorted
    }
}

/// The numbers of points in the order of the cells that [`CellOrder`] sorts by; those of one cell stay in their order.
#[must_use]
pub fn numbers_by_cell(points: &[[f32; 2]]) -> Vec<u32> {
    let grid = Grid::new(points.len() as u32);
    let mut numbers: Vec<u32> = (0..points.len() as u32).collect();
    numbers.sort_by_key(|&number| grid.cell(points[number as usize]));
    numbers
}

/// Cells of the unit square.
#[derive(Clone, Copy)]
struct Grid {
    /// Bits of the coordinates of a cell; x has as many as y or one more.
    bits: [u32; 2],
}

impl Grid {
    /// At most `n` cells, more than half of it.
    fn new(n: u32) -> Self {
        let bits = n.max(1).ilog2();
        Self { bits: [bits.div_ceil(2), bits / 2] }
    }

    fn cells(self) -> usize {
        1 << (self.bits[0] + self.bits[1])
    }

    /// The number of a point's cell along the curve.
    fn cell(self, point: [f32; 2]) -> u32 {
        let [x, y] = [0, 1].map(|d| {
            let side = 1u32 << self.bits[d];
            every_other_bit(((point[d] * side as f32) as u32).min(side - 1))
        });
        x | y << 1
    }
}

/// Moves bit i to bit 2i, for numbers of 16 bits.
fn every_other_bit(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dim, SamplerKind, StreamKey};

    fn stream(kind: SamplerKind, n: u32) -> Stream {
        kind.for_count(n).stream(StreamKey::new(3).element(n), Dim::Hemisphere)
    }

    #[test]
    fn the_points_are_those_of_the_stream() {
        let mut order = CellOrder::default();
        for kind in SamplerKind::ALL {
            // A longer list before a shorter one: nothing of it may stay.
            for n in [1000, 256, 64, 100, 2, 1] {
                let stream = stream(kind, n);
                let bits = |p: [f32; 2]| p.map(f32::to_bits);
                let mut plain: Vec<_> = (0..n).map(|i| bits(stream.sample_2d(i))).collect();
                let mut sorted: Vec<_> = order.points(&stream, n).iter().copied().map(bits).collect();
                plain.sort_unstable();
                sorted.sort_unstable();
                assert_eq!(sorted, plain, "{kind} {n}");
            }
        }
    }

    #[test]
    fn every_cell_holds_one_of_a_power_of_two_of_sobol_points() {
        for n in [2, 8, 64, 128, 1024] {
            let mut order = CellOrder::default();
            let points = order.points(&stream(SamplerKind::Sobol, n), n);
            let grid = Grid::new(n);
            assert_eq!(grid.cells(), n as usize);
            assert!(points.iter().enumerate().all(|(i, &p)| grid.cell(p) == i as u32), "{n}");
        }
    }

    #[test]
    fn numbers_by_cell_sort_as_the_order_does() {
        for n in [1, 36, 64, 100] {
            let stream = stream(SamplerKind::Halton, n);
            let plain: Vec<_> = (0..n).map(|i| stream.sample_2d(i)).collect();
            let by_number: Vec<_> = numbers_by_cell(&plain).into_iter().map(|i| plain[i as usize]).collect();
            assert_eq!(by_number, CellOrder::default().points(&stream, n), "{n}");
        }
    }

    #[test]
    fn sixteen_in_a_row_lie_in_a_small_square() {
        let mut order = CellOrder::default();
        let points = order.points(&stream(SamplerKind::Sobol, 256), 256);
        for row in points.chunks(16) {
            for d in 0..2 {
                let min = row.iter().fold(1.0, |m: f32, p| m.min(p[d]));
                let max = row.iter().fold(0.0, |m: f32, p| m.max(p[d]));
                assert!(max - min < 0.25, "{row:?}");
            }
        }
    }
}
