//! Places by the cell of a grid that they lie in.

use glam::{IVec3, Vec3};

/// A grid of cubes over space, anchored at a corner of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    origin: Vec3,
    cells_per_metre: f32,
}

/// Bits of a cell's number per axis. Cells so far from each other that they share a number are told apart by distance.
const BITS: u32 = 21;

impl Grid {
    /// Cells twice as wide as `reach`, metres: what is within reach of a place lies in [eight](Self::around) of them.
    pub(crate) fn new(origin: Vec3, reach: f32) -> Self {
        Self { origin, cells_per_metre: 0.5 / reach }
    }

    /// The cell of a place.
    pub(crate) fn cell(&self, position: Vec3) -> u64 {
        number(((position - self.origin) * self.cells_per_metre).floor().as_ivec3())
    }

    /// The cells in which everything lies that is within reach of a place.
    pub(crate) fn around(&self, position: Vec3) -> [u64; 8] {
        let first = ((position - self.origin) * self.cells_per_metre - 0.5).floor().as_ivec3();
        [0, 1, 2, 3, 4, 5, 6, 7].map(|i| number(first + IVec3::new(i & 1, (i >> 1) & 1, i >> 2)))
    }
}

fn number(cell: IVec3) -> u64 {
    let [x, y, z] = cell.to_array().map(|k| u64::from(k as u32) & ((1 << BITS) - 1));
    x | y << BITS | z << (2 * BITS)
}

/// A small number for each of some cells: open addressing, as it is asked for cells of which many are empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellTable {
    /// Cell and value; a power of two of them, less than half of which are taken.
    slots: Vec<(u64, u32)>,
    len: usize,
}

/// No cell has this number.
const EMPTY: u64 = u64::MAX;

/// Bytes of a cell in a [`CellTable`], at most.
pub(crate) const BYTES_PER_CELL: u64 = 4 * size_of::<(u64, u32)>() as u64;

impl CellTable {
    /// The value of a cell.
    #[inline]
    pub(crate) fn get(&self, cell: u64) -> Option<u32> {
        if self.slots.is_empty() {
            return None;
        }
        let (found, value) = self.slots[self.slot(cell)];
        (found == cell).then_some(value)
    }

    /// Gives a cell a value and returns the one that it had.
    pub(crate) fn insert(&mut self, cell: u64, value: u32) -> Option<u32> {
        if 2 * (self.len + 1) > self.slots.len() {
            self.grow();
        }
        let slot = self.slot(cell);
        let (found, before) = std::mem::replace(&mut self.slots[slot], (cell, value));
        if found == cell {
            return Some(before);
        }
        self.len += 1;
        None
    }

    /// Where a cell is, or would be.
    #[inline]
    fn slot(&self, cell: u64) -> usize {
        let mask = self.slots.len() - 1;
        // Fibonacci hashing; the upper bits are mixed best.
        let mut slot = (cell.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[slot].0 != cell && self.slots[slot].0 != EMPTY {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let len = (2 * self.slots.len()).max(16);
        let old = std::mem::replace(&mut self.slots, vec![(EMPTY, 0); len]);
        for (cell, value) in old.into_iter().filter(|(cell, _)| *cell != EMPTY) {
            let slot = self.slot(cell);
            self.slots[slot] = (cell, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_reach_lies_in_the_cells_around() {
        let (grid, reach) = (Grid::new(Vec3::splat(-3.0), 0.7), 0.7);
        for i in 0..400 {
            let spread = |k: i32| (i as f32 * 0.37 * k as f32).sin() * 5.0;
            let at = Vec3::new(spread(1), spread(2), spread(3));
            for toward in [Vec3::X, Vec3::NEG_Y, Vec3::ONE.normalize(), Vec3::new(-0.6, 0.0, 0.8)] {
                assert!(grid.around(at).contains(&grid.cell(at + toward * (0.999 * reach))));
            }
        }
    }

    #[test]
    fn a_table_has_the_last_value_of_each_cell() {
        let mut table = CellTable::default();
        assert_eq!(table.get(3), None);
        for round in 0..2 {
            for cell in 0..1000 {
                let before = table.insert(cell << 40 | cell, cell as u32 + round);
                assert_eq!(before, (round > 0).then_some(cell as u32));
            }
        }
        assert!((0..1000).all(|cell| table.get(cell << 40 | cell) == Some(cell as u32 + 1)));
        assert_eq!(table.get(1 << 40), None);
    }
}
