//! Light for lumels that were not measured.

use crate::charts::charts;
use crate::nearest::{NONE, nearest};
use glam::Vec3;
use lumel_uv::{Atlas, Coverage};
use rayon::prelude::*;

/// Which lumel each lumel has its light from.
///
/// A valid one has its own. One of a chart that is not valid, because it lies inside geometry, has that of the nearest
/// valid one of the chart. All others, between charts and in charts without a valid lumel, have the light of what is nearest
/// on their page, so that a smaller picture of the page is not darker.
#[derive(Clone, Debug)]
pub struct Dilation {
    /// By lumel; `NONE` on a page without valid lumels.
    sources: Vec<u32>,
    /// By lumel: the chart that reads it; `NONE` between charts.
    charts: Vec<u32>,
}

impl Dilation {
    /// `valid` tells by lumel of all pages whether it has light of its own.
    pub fn new(atlas: &Atlas, coverage: &Coverage, valid: &[bool]) -> Self {
        let charts = charts(atlas, coverage);
        let mut sources: Vec<u32> =
            (0..valid.len()).map(|lumel| if valid[lumel] { lumel as u32 } else { NONE }).collect();
        let mut incomplete: Vec<u32> = (charts.iter().zip(valid))
            .filter(|(chart, valid)| **chart != NONE && !**valid)
            .map(|(&chart, _)| chart)
            .collect();
        incomplete.sort_unstable();
        incomplete.dedup();
        let completed: Vec<Vec<(u32, u32)>> =
            incomplete.par_iter().map(|&chart| within_chart(atlas, &charts, valid, chart)).collect();
        for (lumel, source) in completed.into_iter().flatten() {
            sources[lumel as usize] = source;
        }
        for (page, &[width, height]) in atlas.pages().iter().enumerate() {
            let first = atlas.first_lumel(page);
            let page = &mut sources[first..first + width as usize * height as usize];
            let has_light: Vec<bool> = page.iter().map(|&source| source != NONE).collect();
            for (lumel, &near) in nearest(width as usize, &has_light).iter().enumerate() {
                if near != NONE {
                    page[lumel] = page[near as usize];
                }
            }
        }
        Self { sources, charts }
    }

    /// Gives light to the lumels that have none of their own: black if nothing on their page has any.
    pub fn fill(&self, values: &mut [Vec3]) {
        // Sources are their own, so that the order does not matter.
        for (lumel, &source) in self.sources.iter().enumerate().filter(|(lumel, s)| **s as usize != *lumel) {
            values[lumel] = if source == NONE { Vec3::ZERO } else { values[source as usize] };
        }
    }

    /// The lumel whose light is read at a lumel, if it is one of this chart.
    pub(crate) fn source(&self, lumel: usize, chart: usize) -> Option<u32> {
        let source = self.sources[lumel];
        (source != NONE && self.charts[source as usize] as usize == chart).then_some(source)
    }
}

/// The lumels of a chart that are not valid, each with the nearest valid one of the chart, if there is any.
fn within_chart(atlas: &Atlas, charts: &[u32], valid: &[bool], chart: u32) -> Vec<(u32, u32)> {
    let place = &atlas.charts()[chart as usize];
    let [page_width, page_height] = atlas.pages()[place.page as usize];
    let first = atlas.first_lumel(place.page as usize);
    // Reading between lumels reaches one further than the chart.
    let [left, top] = place.min.map(|from| from.saturating_sub(1));
    let [right, bottom] = [(place.max[0] + 1).min(page_width), (place.max[1] + 1).min(page_height)];
    let lumels: Vec<usize> = (top..bottom)
        .flat_map(|y| (left..right).map(move |x| first + y as usize * page_width as usize + x as usize))
        .collect();
    let is_source: Vec<bool> = lumels.iter().map(|&lumel| valid[lumel] && charts[lumel] == chart).collect();
    let found = nearest((right - left) as usize, &is_source);
    (lumels.iter().zip(found))
        .filter(|(lumel, near)| charts[**lumel] == chart && !valid[**lumel] && *near != NONE)
        .map(|(&lumel, near)| (lumel as u32, lumels[near as usize] as u32))
        .collect()
}
