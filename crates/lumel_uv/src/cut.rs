//! Charts that are larger than a page.

use crate::chart::Chart;
use glam::DVec2;
use std::collections::BTreeMap;

/// Cuts a chart along a grid into parts of whole triangles, if its larger side would exceed `most`, metres.
///
/// Each part gets the triangles whose centres are in its cell. A part may still be larger by its largest triangle.
pub(crate) fn cut(chart: Chart, most: f64) -> Vec<Chart> {
    if chart.size.max_element() <= most || chart.triangles.len() == 1 || chart.is_given() {
        return vec![chart];
    }
    // Room for triangles that reach out of their cell.
    let cells = (chart.size / (0.9 * most)).ceil().max(DVec2::ONE);
    let mut parts: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (i, &[a, b, c]) in chart.corners.iter().enumerate() {
        let center = (a.as_dvec2() + b.as_dvec2() + c.as_dvec2()) / 3.0;
        let cell = (center / chart.size.max(DVec2::splat(f64::MIN_POSITIVE)) * cells).min(cells - 1.0);
        parts.entry([cell.x as u32, cell.y as u32]).or_default().push(i);
    }
    let part = |of: Vec<usize>| {
        let triangles = of.iter().map(|&i| chart.triangles[i]).collect();
        let corners: Vec<_> = of.iter().map(|&i| chart.corners[i].map(|c| c.as_dvec2())).collect();
        Chart::in_place(chart.object, triangles, &corners)
    };
    parts.into_values().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{ObjectId, TriId};

    /// A strip of squares of one metre.
    fn strip(length: u32) -> Chart {
        let at = |x: u32, y: u32| DVec2::new(f64::from(x), f64::from(y));
        let corners: Vec<_> = (0..length)
            .flat_map(|x| [[at(x, 0), at(x + 1, 0), at(x + 1, 1)], [at(x, 0), at(x + 1, 1), at(x, 1)]])
            .collect();
        Chart::in_place(ObjectId(0), (0..2 * length).map(TriId).collect(), &corners)
    }

    #[test]
    fn a_long_strip_becomes_parts_that_fit_and_hold_all_of_it() {
        let parts = cut(strip(100), 12.0);
        assert!(parts.len() >= 9 && parts.iter().all(|part| part.size.max_element() <= 12.0));
        let mut all: Vec<TriId> = parts.into_iter().flat_map(|part| part.triangles).collect();
        all.sort();
        assert_eq!(all, (0..200).map(TriId).collect::<Vec<_>>());
    }

    #[test]
    fn what_fits_stays_whole() {
        assert_eq!(cut(strip(10), 12.0).len(), 1);
        assert_eq!(cut(strip(1), 0.1).len(), 2, "a square has two triangles, however large it is");
    }
}
