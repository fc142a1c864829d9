//! Charts on pages.

use crate::chart::Chart;
use crate::mask::{Grid, Mask, Pose};
use crate::page::Page;
use crate::{UnwrapSettings, UvError};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Lumels of charts on all pages together: with what is left free between them, they can be numbered.
const MOST_LUMELS: u64 = 1 << 30;

/// How full a page is thought to get; decides the width of pages that are smaller than they may be.
const FILL: f64 = 0.85;

/// Widths of the page that are tried, in parts of that of a square page, where one page is enough for up to so many charts:
/// with few charts, much depends on it.
const WIDTHS: [f64; 7] = [1.0, 0.7, 0.8, 0.9, 1.1, 1.25, 1.4];
const MOST_FOR_WIDTHS: usize = 500;

/// Charts larger than this, in cells, are tried as they are and turned; smaller ones lie as they are.
const TURNED_FROM: u32 = 3;

/// Where a chart was put.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) page: u32,
    /// The corner of its box, lumels.
    pub(crate) min: [u32; 2],
    pub(crate) pose: Pose,
}

/// Charts on pages.
pub(crate) struct Packed {
    /// Lumels.
    pub(crate) pages: Vec<[u32; 2]>,
    /// By chart.
    pub(crate) placed: Vec<Placed>,
}

impl Packed {
    pub(crate) fn lumel_count(&self) -> u64 {
        self.pages.iter().map(|[width, height]| u64::from(*width) * u64::from(*height)).sum()
    }
}

/// The largest side of a chart that fits on a page, lumels.
pub(crate) fn longest(settings: &UnwrapSettings) -> u32 {
    // A gutter and the rest of a block: more than any grid needs.
    settings.page_size - 2 * settings.gutter - 2 * settings.align
}

/// The lumels that a chart takes up with its gutter, about. `scale`: lumels per metre.
pub(crate) fn footprint(chart: &Chart, scale: f64, settings: &UnwrapSettings) -> f64 {
    // Half a lumel is lost on average by whole lumels.
    let reach = 2.0 * Grid::new(settings.gutter, settings.align).reach;
    let around = reach + 0.5 * f64::from(settings.align);
    let size = chart.size * scale;
    let (area, border) = (chart.area * scale * scale, chart.border * scale);
    let full = ((size.x + around) * (size.y + around)).max(reach.ceil().powi(2));
    (area + 0.5 * border * around + around * around).min(full)
}

/// Puts charts on pages, the highest first, each at the first place where it fits (bottom left, by their shapes).
///
/// `scales`: lumels per metre by chart. None may be longer than [`longest`].
pub(crate) fn pack(charts: &[Chart], scales: &[f64], settings: &UnwrapSettings) -> Result<Packed, UvError> {
    let lumels: f64 = charts.iter().zip(scales).map(|(c, &scale)| footprint(c, scale, settings)).sum();
    if lumels > MOST_LUMELS as f64 {
        return Err(UvError::TooLarge { lumels: lumels as u64, limit: MOST_LUMELS });
    }
    let grid = Grid::new(settings.gutter, settings.align);
    let shapes: Vec<Vec<(Pose, Mask)>> = charts
        .par_iter()
        .zip(scales)
        .map(|(chart, &scale)| {
            let shape = |turned| {
                let pose = Pose::new(chart, scale, turned, grid);
                (pose, Mask::new(chart, &pose, grid))
            };
            let lying = shape(false);
            let is_long = lying.1.width > TURNED_FROM && lying.1.width != lying.1.height;
            let turns = is_long && !chart.is_given();
            if turns { vec![lying, shape(true)] } else { vec![lying] }
        })
        .collect();
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by_key(|&i| {
        let mask = &shapes[i][0].1;
        (std::cmp::Reverse((mask.width.max(mask.height), mask.count)), i)
    });
    let [width, height] = page_cells(&shapes, grid, settings);
    let most = settings.page_size / grid.cell;
    let tried = if charts.len() <= MOST_FOR_WIDTHS && width < most { WIDTHS.len() } else { 1 };
    let widest = shapes.iter().map(|shape| shape[0].1.width).max().unwrap_or(1);
    let all: Vec<Packed> = WIDTHS[..tried]
        .par_iter()
        .map(|part| {
            let width = ((f64::from(width) * part) as u32).max(widest).next_multiple_of(4).min(most);
            place_all(&shapes, &order, [width, height], grid, settings)
        })
        .collect();
    // The first of those with the fewest lumels.
    all.into_iter().min_by_key(Packed::lumel_count).ok_or(UvError::Stopped)
}

/// Puts charts on pages of a size in cells, in an order.
fn place_all(
    shapes: &[Vec<(Pose, Mask)>],
    order: &[usize],
    [width, height]: [u32; 2],
    grid: Grid,
    settings: &UnwrapSettings,
) -> Packed {
    let mut pages: Vec<Page> = Vec::new();
    let mut placed = vec![None; shapes.len()];
    let mut begins: BTreeMap<[u32; 2], (usize, u32)> = BTreeMap::new();
    for &i in order {
        let at = loop {
            if let Some(found) = place(&pages, &shapes[i], &mut begins) {
                break found;
            }
            pages.push(Page::new(width, height));
        };
        let (pose, mask) = &shapes[i][at.shape];
        pages[at.page].take(mask, at.cell);
        let min = at.cell.map(|cell| cell * grid.cell);
        placed[i] = Some(Placed { page: at.page as u32, min, pose: *pose });
    }
    let cropped = |page: &Page| {
        let used = page.used * grid.cell;
        [(page.width * grid.cell), used.next_multiple_of(4).min(settings.page_size)]
    };
    Packed { pages: pages.iter().map(cropped).collect(), placed: placed.into_iter().flatten().collect() }
}

/// A place for a chart.
struct Place {
    shape: usize,
    page: usize,
    cell: [u32; 2],
}

/// The lowest place for any shape of a chart. `begins`: where charts of about the same size did not fit before.
fn place(
    pages: &[Page],
    shapes: &[(Pose, Mask)],
    begins: &mut BTreeMap<[u32; 2], (usize, u32)>,
) -> Option<Place> {
    let mut best: Option<(usize, u32, Place)> = None;
    for (shape, (_, mask)) in shapes.iter().enumerate() {
        let begin = begins.entry([mask.width, mask.height].map(size_class)).or_default();
        let mut first_row = begin.1;
        for (page, on) in pages.iter().enumerate().skip(begin.0) {
            if let Some(cell) = on.find(mask, first_row) {
                *begin = (page, cell[1]);
                let ends = cell[1] + mask.height;
                if best.as_ref().is_none_or(|(p, e, _)| (page, ends) < (*p, *e)) {
                    best = Some((page, ends, Place { shape, page, cell }));
                }
                break;
            }
            (*begin, first_row) = ((page + 1, 0), 0);
        }
    }
    best.map(|(_, _, place)| place)
}

/// Sizes of which one is taken for the other: all of a class are within a quarter of each other.
fn size_class(cells: u32) -> u32 {
    if cells < 16 { cells } else { 16 + (4.0 * (f64::from(cells) / 16.0).log2()) as u32 }
}

/// Width and height of pages, in cells: as wide as they may be, or about square if one is enough.
fn page_cells(shapes: &[Vec<(Pose, Mask)>], grid: Grid, settings: &UnwrapSettings) -> [u32; 2] {
    let most = settings.page_size / grid.cell;
    let total: f64 = shapes.iter().map(|shape| shape[0].1.count as f64).sum();
    let widest = shapes.iter().map(|shape| shape[0].1.width).max().unwrap_or(1);
    let side = (total / FILL).sqrt() as u32;
    let width = side.max(widest).next_multiple_of(if grid.cell == 1 { 4 } else { 1 });
    [width.min(most), most]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use lumel_scene::{ObjectId, TriId};

    fn rectangle(width: f64, height: f64) -> Chart {
        let [a, b, c, d] = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(DVec2::from);
        Chart::in_place(ObjectId(0), vec![TriId(0), TriId(1)], &[[a, b, c], [a, c, d]])
    }

    #[test]
    fn many_rectangles_fill_most_of_their_page() {
        let charts: Vec<Chart> =
            (0..400).map(|i| rectangle(f64::from(10 + i * 7 % 23), f64::from(8 + i * 5 % 17))).collect();
        let packed = pack(&charts, &vec![1.0; 400], &UnwrapSettings::default()).unwrap();
        let with_gutter: f64 = charts.iter().map(|c| (c.size.x + 2.0) * (c.size.y + 2.0)).sum();
        assert_eq!(packed.pages.len(), 1);
        let fill = with_gutter / packed.lumel_count() as f64;
        assert!(fill > 0.9, "{fill} {:?}", packed.pages);
    }

    #[test]
    fn what_does_not_fit_on_a_page_is_on_the_next() {
        let settings = UnwrapSettings { page_size: 64, ..UnwrapSettings::default() };
        let charts: Vec<Chart> = (0..10).map(|_| rectangle(40.0, 40.0)).collect();
        let packed = pack(&charts, &[1.0; 10], &settings).unwrap();
        assert_eq!(packed.pages.len(), 10);
        let pages: Vec<u32> = packed.placed.iter().map(|placed| placed.page).collect();
        assert_eq!(pages, (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn blocks_are_not_shared() {
        let settings = UnwrapSettings { align: 4, ..UnwrapSettings::default() };
        let charts: Vec<Chart> = (0..50).map(|i| rectangle(f64::from(3 + i % 9), 5.0)).collect();
        let packed = pack(&charts, &[1.0; 50], &settings).unwrap();
        assert!(packed.placed.iter().all(|placed| placed.min.iter().all(|x| x % 4 == 0)));
        assert!(packed.pages.iter().flatten().all(|side| side % 4 == 0));
    }
}
