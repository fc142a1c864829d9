//! The lumels that a chart touches, for packing.

use crate::chart::Chart;
use crate::raster::touched;
use glam::{DVec2, Vec2, Vec2Swizzles as _};

/// What reaches into a lumel by less than this does not touch it: rounding does, and a reader between lumels takes no
/// more than this part from the next one.
pub(crate) const INSET: f64 = 1e-3;

/// How charts lie in the cells of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Lumels per side of a cell.
    pub(crate) cell: u32,
    /// Cells that stay free between charts.
    pub(crate) gap: u32,
    /// Cells that stay free at the border of a page.
    pub(crate) margin: u32,
    /// Lumels around a chart that belong to its cells.
    pad: u32,
}

impl Grid {
    /// Without blocks a cell is a lumel. With them a cell is a block, and half of the gutter lies in it: two charts in blocks
    /// of their own have the whole gutter between them.
    pub(crate) fn new(gutter: u32, align: u32) -> Self {
        let half = gutter.div_ceil(2);
        if align > 1 {
            Self { cell: align, gap: 0, margin: 0, pad: half }
        } else {
            Self { cell: 1, gap: gutter, margin: half, pad: 0 }
        }
    }
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
    /// In the middle of a box of at least two by two lumels.
    pub(crate) fn new(chart: &Chart, scale: f64, turned: bool) -> Self {
        let size = chart.size * scale;
        let turned_size = if turned { size.yx() } else { size };
        let offset = 0.5 * (box_of(turned_size) - turned_size);
        Self { scale, turned, width: size.x, offset }
    }

    /// Where a corner of the chart lies from the corner of the box, lumels.
    pub(crate) fn apply(&self, corner: Vec2) -> DVec2 {
        let scaled = corner.as_dvec2() * self.scale;
        let turned = if self.turned { DVec2::new(scaled.y, self.width - scaled.x) } else { scaled };
        turned + self.offset
    }
}

/// The whole lumels that a chart of this size needs.
fn box_of(size: DVec2) -> DVec2 {
    (size - INSET).ceil().max(DVec2::splat(2.0))
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
    /// From the corner of the mask to that of the box, lumels.
    pub(crate) pad: u32,
}

impl Mask {
    pub(crate) fn new(chart: &Chart, pose: &Pose, grid: Grid) -> Self {
        let Grid { cell, pad, .. } = grid;
        let size = chart.size * pose.scale;
        let size = box_of(if pose.turned { size.yx() } else { size });
        let cells = |lumels: f64| (lumels as u32 + 2 * pad).div_ceil(cell);
        let (width, height) = (cells(size.x), cells(size.y));
        let mut rows: Vec<Vec<[u32; 2]>> = vec![Vec::new(); height as usize];
        // A chart that is narrower than its box is in all of it.
        if chart.size.min_element() * pose.scale < 2.0 {
            rows.iter_mut().for_each(|row| row.push([0, width]));
        }
        let (pad, cell) = (i64::from(pad), i64::from(cell));
        for corners in &chart.corners {
            touched(corners.map(|c| pose.apply(c)), 0.0, |y, first, end| {
                let at = |lumel: i64| (lumel.max(0) / cell) as u32;
                let run = [at(first), (at(end + 2 * pad - 1) + 1).min(width)];
                if run[0] >= run[1] {
                    return;
                }
                for row in at(y)..=at(y + 2 * pad).min(height - 1) {
                    let row = &mut rows[row as usize];
                    match row.last_mut() {
                        Some(last) if last[0] <= run[1] && run[0] <= last[1] => {
                            *last = [last[0].min(run[0]), last[1].max(run[1])];
                        }
                        _ => row.push(run),
                    }
                }
            });
        }
        let mut mask = Self { width, height, first: vec![0], runs: Vec::new(), count: 0, pad: pad as u32 };
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

    #[test]
    fn a_triangle_touches_half_of_its_box_and_its_diagonal() {
        let chart = corner(4.0, 4.0);
        let mask = Mask::new(&chart, &Pose::new(&chart, 1.0, false), Grid::new(2, 1));
        assert_eq!((mask.width, mask.height, mask.count), (4, 4, 10));
        assert_eq!(mask.row(0), [[0, 4]]);
        assert_eq!(mask.row(3), [[0, 1]]);
    }

    #[test]
    fn a_turned_chart_keeps_its_orientation() {
        let chart = corner(6.0, 3.0);
        let pose = Pose::new(&chart, 1.0, true);
        let turned = chart.corners[0].map(|c| pose.apply(c));
        assert!(crate::chart::signed_area(turned) > 0.0);
        let mask = Mask::new(&chart, &pose, Grid::new(2, 1));
        assert_eq!((mask.width, mask.height), (3, 6));
    }

    #[test]
    fn the_smallest_charts_have_two_by_two_lumels() {
        let chart = corner(0.001, 0.0001);
        let mask = Mask::new(&chart, &Pose::new(&chart, 1.0, false), Grid::new(2, 1));
        assert_eq!((mask.width, mask.height, mask.count), (2, 2, 4));
    }

    #[test]
    fn blocks_hold_the_lumels_around_a_chart() {
        let chart = corner(7.0, 7.0);
        let mask = Mask::new(&chart, &Pose::new(&chart, 1.0, false), Grid::new(2, 4));
        assert_eq!((mask.width, mask.height), (3, 3));
        assert_eq!(mask.row(0), [[0, 3]]);
        assert_eq!(mask.row(2), [[0, 1]], "columns 0 to 2 of lumels with the gutter");
    }
}
