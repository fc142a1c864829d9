//! The cells of a page that are taken, and where a chart fits.

use crate::mask::Mask;

/// A page in the making.
pub(crate) struct Page {
    pub(crate) width: u32,
    pub(crate) height: u32,
    words_per_row: usize,
    /// A bit for each cell that a chart has.
    taken: Vec<u64>,
    /// The row after the last one that has a chart.
    pub(crate) used: u32,
}

impl Page {
    /// An empty page, in cells.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let words_per_row = width.div_ceil(64) as usize;
        Self { width, height, words_per_row, taken: vec![0; words_per_row * height as usize], used: 0 }
    }

    /// The first place where a mask fits, row by row from `first_row` on.
    pub(crate) fn find(&self, mask: &Mask, first_row: u32) -> Option<[u32; 2]> {
        let (last_x, last_y) = (self.width.checked_sub(mask.width)?, self.height.checked_sub(mask.height)?);
        let mut row = 0;
        for y in first_row..=last_y {
            let mut x = 0;
            while x <= last_x {
                match self.conflict(mask, x, y, row) {
                    None => return Some([x, y]),
                    Some((next_x, at)) => (x, row) = (next_x, at),
                }
            }
        }
        None
    }

    /// The next column that may fit if this one does not, and the row of the mask that says so. Rows are tried from
    /// `first` on: where one had a conflict, it probably has the next.
    fn conflict(&self, mask: &Mask, x: u32, y: u32, first: u32) -> Option<(u32, u32)> {
        for row in (first..mask.height).chain(0..first) {
            for &[begin, end] in mask.row(row) {
                if let Some(last) = self.last_taken(y + row, x + begin, x + end) {
                    return Some((last + 1 - begin, row));
                }
            }
        }
        None
    }

    /// The last cell that is taken among those of a row from `begin` to before `end`.
    fn last_taken(&self, y: u32, begin: u32, end: u32) -> Option<u32> {
        let row = &self.taken[y as usize * self.words_per_row..][..self.words_per_row];
        let (first, last) = ((begin / 64) as usize, ((end - 1) / 64) as usize);
        for word in (first..=last).rev() {
            let bits = row[word] & bits_between(word, begin, end);
            if bits != 0 {
                return Some(word as u32 * 64 + 63 - bits.leading_zeros());
            }
        }
        None
    }

    /// Takes the cells of a mask.
    pub(crate) fn take(&mut self, mask: &Mask, [x, y]: [u32; 2]) {
        for row in 0..mask.height {
            let cells = &mut self.taken[(y + row) as usize * self.words_per_row..][..self.words_per_row];
            for &[begin, end] in mask.row(row) {
                let (begin, end) = (x + begin, x + end);
                let (first, last) = ((begin / 64) as usize, ((end - 1) / 64) as usize);
                (first..=last).for_each(|word| cells[word] |= bits_between(word, begin, end));
            }
        }
        self.used = self.used.max(y + mask.height);
    }
}

/// The bits of a word whose cells lie from `begin` to before `end`.
fn bits_between(word: usize, begin: u32, end: u32) -> u64 {
    let from = (begin as usize).saturating_sub(word * 64);
    let to = (end as usize).saturating_sub(word * 64).min(64);
    if from >= to { 0 } else { (u64::MAX >> (64 - (to - from))) << from }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::Chart;
    use crate::mask::{Grid, Pose};
    use glam::DVec2;
    use lumel_scene::{ObjectId, TriId};

    fn triangle(corners: [[f64; 2]; 3]) -> Chart {
        Chart::in_place(ObjectId(0), vec![TriId(0)], &[corners.map(DVec2::from)])
    }

    fn mask(chart: &Chart, scale: f64, grid: Grid) -> Mask {
        Mask::new(chart, &Pose::new(chart, scale, false, grid), grid)
    }

    #[test]
    fn two_triangles_share_a_square_and_keep_their_gutter() {
        let grid = Grid::new(2, 1);
        let mut page = Page::new(130, 200);
        let (lower, upper) =
            ([[0.0, 0.0], [100.0, 0.0], [0.0, 100.0]], [[100.0, 0.0], [100.0, 100.0], [0.0, 100.0]]);
        let mut place = |corners| {
            let mask = mask(&triangle(corners), 1.0, grid);
            let at = page.find(&mask, 0).unwrap();
            page.take(&mask, at);
            at
        };
        assert_eq!(place(lower), [0, 0]);
        let [x, y] = place(upper);
        assert!(x <= 28 && y < 20, "{x} {y}: it lies along the other one's diagonal");
        assert_eq!(page.used, y + 102);
    }

    #[test]
    fn a_full_page_has_no_place() {
        let mut page = Page::new(64, 64);
        let mask = mask(&triangle([[0.0, 0.0], [128.0, 0.0], [0.0, 128.0]]), 0.5, Grid::new(0, 1));
        assert_eq!(page.find(&mask, 0), Some([0, 0]));
        page.take(&mask, [0, 0]);
        assert_eq!(page.find(&mask, 0), None);
    }

    #[test]
    fn bits_are_those_of_their_word() {
        assert_eq!(bits_between(0, 0, 64), u64::MAX);
        assert_eq!(bits_between(1, 0, 64), 0);
        assert_eq!(bits_between(1, 60, 66), 0b11);
        assert_eq!(bits_between(0, 62, 300), 0b11 << 62);
    }
}
