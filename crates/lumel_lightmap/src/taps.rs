//! Which lumels are read between lumels.

use glam::DVec2;
use lumel_uv::Atlas;

/// The four lumels around a place on a page, and their weights in bilinear reading, which add up to 1.
///
/// At the border of a page, the lumels beyond are those at the border.
pub(crate) fn taps(atlas: &Atlas, page: usize, place: DVec2) -> [(usize, f64); 4] {
    let [width, height] = atlas.pages()[page];
    let last = DVec2::new(f64::from(width - 1), f64::from(height - 1));
    // The centre of lumel (x, y) is at (x + ½, y + ½).
    let from = (place - 0.5).clamp(DVec2::ZERO, last);
    let low = from.floor();
    let (high, part) = ((low + 1.0).min(last), from - low);
    let first = atlas.first_lumel(page);
    let lumel = |x: f64, y: f64| first + y as usize * width as usize + x as usize;
    let rest = 1.0 - part;
    [
        (lumel(low.x, low.y), rest.x * rest.y),
        (lumel(high.x, low.y), part.x * rest.y),
        (lumel(low.x, high.y), rest.x * part.y),
        (lumel(high.x, high.y), part.x * part.y),
    ]
}
