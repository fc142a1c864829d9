//! Which lumels are read between lumels.

use glam::DVec2;
use lumel_uv::Atlas;
use smallvec::SmallVec;

/// How light is read between lumels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Filter {
    /// Each lumel is a square of one light.
    Nearest,
    /// Linear in both directions between the four around.
    #[default]
    Bilinear,
    /// A cubic B-spline over the sixteen around: without kinks, never brighter or darker than all of them, but softer, as it
    /// passes lumels by. Charts need a gutter of 3.
    Bicubic,
}

/// The four lumels around a place on a page, and their weights in bilinear reading, which add up to 1.
///
/// At the border of a page, the lumels beyond are those at the border.
pub(crate) fn taps(atlas: &Atlas, page: usize, place: DVec2) -> [(usize, f64); 4] {
    let (low, part) = around(place);
    let rest = 1.0 - part;
    let lumel = |x: f64, y: f64| lumel(atlas, page, low + DVec2::new(x, y));
    [
        (lumel(0.0, 0.0), rest.x * rest.y),
        (lumel(1.0, 0.0), part.x * rest.y),
        (lumel(0.0, 1.0), rest.x * part.y),
        (lumel(1.0, 1.0), part.x * part.y),
    ]
}

/// The lumels that a filter reads at a place, and their weights, which add up to 1.
pub(crate) fn taps_of(
    filter: Filter,
    atlas: &Atlas,
    page: usize,
    place: DVec2,
) -> SmallVec<[(usize, f64); 16]> {
    match filter {
        Filter::Nearest => SmallVec::from_iter([(lumel(atlas, page, place.floor()), 1.0)]),
        Filter::Bilinear => SmallVec::from_iter(taps(atlas, page, place)),
        Filter::Bicubic => {
            let (low, part) = around(place);
            let (across, down) = (spline(part.x), spline(part.y));
            let row = |(y, down): (usize, f64)| {
                let tap = move |(x, across): (usize, f64)| {
                    let from_low = DVec2::new(x as f64, y as f64) - 1.0;
                    (lumel(atlas, page, low + from_low), across * down)
                };
                across.into_iter().enumerate().map(tap)
            };
            down.into_iter().enumerate().flat_map(row).collect()
        }
    }
}

/// Column and row of the lumel up and left of a place, and how far on the place is.
fn around(place: DVec2) -> (DVec2, DVec2) {
    // The centre of lumel (x, y) is at (x + ½, y + ½).
    let from = place - 0.5;
    let low = from.floor();
    (low, from - low)
}

/// The lumel of this column and row, or the nearest on the page.
fn lumel(atlas: &Atlas, page: usize, at: DVec2) -> usize {
    let [width, height] = atlas.pages()[page];
    let last = DVec2::new(f64::from(width - 1), f64::from(height - 1));
    let at = at.clamp(DVec2::ZERO, last);
    atlas.first_lumel(page) + at.y as usize * width as usize + at.x as usize
}

/// The weights of the two lumels before and the two after a place between the middle ones.
fn spline(t: f64) -> [f64; 4] {
    let rest = 1.0 - t;
    let middle = |t: f64| (t * t * (3.0 * t - 6.0) + 4.0) / 6.0;
    [rest.powi(3) / 6.0, middle(t), middle(rest), t.powi(3) / 6.0]
}

#[cfg(test)]
mod tests {
    use super::spline;

    #[test]
    fn a_spline_keeps_constants_and_slopes() {
        for t in [0.0, 0.2, 0.5, 0.93] {
            let weights = spline(t);
            let mean: f64 = weights.iter().zip([-1.0, 0.0, 1.0, 2.0]).map(|(w, x)| w * x).sum();
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15 && (mean - t).abs() < 1e-15, "{t}");
            assert!(weights.iter().all(|w| *w >= 0.0));
        }
    }
}
