//! The lumels that a chart touches, for packing.

use crate::chart::Chart;
use crate::raster::touched;
use glam::{DVec2, Vec2, Vec2Swizzles as _};

/// What reaches into a lumel by less than this does not touch it: rounding does, and a reader between lumels takes no
/// more than this part from the next one.
pub(crate) const INSET: f64 = 1e-3;

/// Charts keep so much further from lumels of others than reading needs: graphics devices round places to 1/256 of a lumel.
const SPARE: f64 = 1.0 / 64.0;

/// How charts lie in the cells of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Lumels per side of a cell.
    pub(crate) cell: u32,
    /// What lies within this distance of a lumel's square is read from the lumel, which is the chart's own, lumels.
    pub(crate) reach: f64,
}

impl Grid {
    /// A cell is a lumel or a block of lumels. No two charts have a cell in common.
    pub(crate) fn new(gutter: u32, align: u32) -> Self {
        let spare = if gutter > 1 { SPARE } else { 0.0 };
        Self { cell: align, reach: reach_of(gutter) + spare }
    }

    /// The whole lumels of a box for a chart of this size.
    fn box_of(&self, size: DVec2) -> DVec2 {
        (size + 2.0 * self.reach - INSET).ceil().max(DVec2::ONE)
    }
}

/// How far from the square of a lumel a chart must lie that it does not belong to, for this gutter: the centre is then half
/// of the gutter away.
pub(crate) fn reach_of(gutter: u32) -> f64 {
    (0.5 * (f64::from(gutter) - 1.0)).max(0.0)
}

/// How a chart is put into its box on a page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    /// Lumels per metre.
    pub(crate) scale: f64,
    /// Turned by a quarter.
    pub(crate) turned: bool,
    /// Width before it is turned, lumels.
    width: f64,
    /// From the corner of the box, lumels.
    offset: DVec2,
}

impl Pose {
    /// In the middle of its box.
    pub(crate) fn new(chart: &Chart, scale: f64, turned: bool, grid: Grid) -> Self {
        let size = chart.size * scale;
        let turned_size = if turned { size.yx() } else { size };
        let offset = 0.5 * (grid.box_of(turned_size) - turned_size);
        Self { scale, turned, width: size.x, offset }
    }

    /// Where a corner of the chart lies from the corner of the box, lumels.
    pub(crate) fn apply(&self, corner: Vec2) -> DVec2 {
        let scaled = corner.as_dvec2() * self.scale;
        let turned = if self.turned { DVec2::new(scaled.y, self.width - scaled.x) } else { scaled };
        turned + self.offset
    }
}

/// Cells of a box, as runs by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mask {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// The first run of each row, and the end of all.
    first: Vec<u32>,
    /// Begin and end.
    runs: Vec<[u32; 2]>,
    /// Number of cells.
    pub(crate) count: u64,
}

impl Mask {
    pub(crate) fn new(chart: &Chart, pose: &Pose, grid: Grid) -> Self {
        let size = chart.size * pose.scale;
        let size = grid.box_of(if pose.turned { size.yx() } else { size });
        let cells = |lumels: f64| (lumels as u32).div_ceil(grid.cell);
        let (width, height) = (cells(size.x), cells(size.y));
        let mut rows: Vec<Vec<[u32; 2]>> = vec![Vec::new(); height as usize];
        let cell = i64::from(grid.cell);
        for corners in &chart.corners {
            touched(corners.map(|c| pose.apply(c)), grid.reach - 0.5 * INSET, |y, first, end| {
                let at = |lumel: i64| (lumel.max(0) / cell) as u32;
                let run = [at(first), (at(end - 1) + 1).min(width)];
                if run[0] >= run[1] || at(y) >= height {
                    return;
                }
                let row = &mut rows[at(y) as usize];
                match row.last_mut() {
                    Some(last) if last[0] <= run[1] && run[0] <= last[1] => {
                        *last = [last[0].min(run[0]), last[1].max(run[1])];
                    }
                    _ => row.push(run),
                }
            });
        }
        let mut mask = Self { width, height, first: vec![0], runs: Vec::new(), count: 0 };
        for row in &mut rows {
            row.sort_unstable();
            for &run in &*row {
                let begins = mask.first.last().copied().unwrap_or_default() as usize;
                match mask.runs[begins..].last_mut() {
                    Some(last) if run[0] <= last[1] => last[1] = last[1].max(run[1]),
                    _ => mask.runs.push(run),
                }
            }
            mask.first.push(mask.runs.len() as u32);
        }
        mask.count = mask.runs.iter().map(|[begin, end]| u64::from(end - begin)).sum();
        mask
    }

    /// The runs of a row.
    pub(crate) fn row(&self, y: u32) -> &[[u32; 2]] {
        &self.runs[self.first[y as usize] as usize..self.first[y as usize + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{ObjectId, TriId};

    fn corner(width: f64, height: f64) -> Chart {
        let corners = [[DVec2::ZERO, DVec2::new(width, 0.0), DVec2::new(0.0, height)]];
        Chart::in_place(ObjectId(0), vec![TriId(0)], &corners)
    }

    fn mask(chart: &Chart, grid: Grid) -> Mask {
        Mask::new(chart, &Pose::new(chart, 1.0, false, grid), grid)
    }

    #[test]
    fn a_triangle_touches_half_of_its_box_and_its_diagonal() {
        let mask = mask(&corner(4.0, 4.0), Grid::new(1, 1));
        assert_eq!((mask.width, mask.height, mask.count), (4, 4, 10));
        assert_eq!(mask.row(0), [[0, 4]]);
        assert_eq!(mask.row(3), [[0, 1]]);
    }

    #[test]
    fn a_chart_has_the_lumels_that_reading_between_lumels_reads() {
        // From centre to centre of lumels: ten of them hold nine and a little less.
        for (size, lumels) in [(8.9, 10), (9.1, 11), (0.0, 2), (0.9, 2), (1.1, 3)] {
            let mask = mask(&corner(size, size), Grid::new(2, 1));
            assert_eq!((mask.width, mask.height), (lumels, lumels), "{size}");
        }
        assert_eq!(mask(&corner(8.9, 8.9), Grid::new(3, 1)).width, 11, "half a lumel more on both sides");
    }

    #[test]
    fn a_turned_chart_keeps_its_orientation() {
        let chart = corner(6.0, 3.0);
        let grid = Grid::new(1, 1);
        let pose = Pose::new(&chart, 1.0, true, grid);
        let turned = chart.corners[0].map(|c| pose.apply(c));
        assert!(crate::chart::signed_area(turned) > 0.0);
        let mask = Mask::new(&chart, &pose, grid);
        assert_eq!((mask.width, mask.height), (3, 6));
    }

    #[test]
    fn blocks_hold_the_lumels_around_a_chart() {
        let mask = mask(&corner(7.0, 7.0), Grid::new(2, 4));
        assert_eq!((mask.width, mask.height), (3, 3));
        assert_eq!(mask.row(0), [[0, 3]]);
        assert_eq!(mask.row(2), [[0, 1]]);
    }
}
