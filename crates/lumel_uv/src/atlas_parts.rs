//! An atlas as plain data, for files.

use crate::{Atlas, ChartPlace};
use glam::Vec2;

/// Everything that an atlas holds.
#[derive(Clone, Debug, PartialEq)]
pub struct AtlasParts {
    /// See [`Atlas::pages`].
    pub pages: Vec<[u32; 2]>,
    /// See [`Atlas::density`].
    pub density: f32,
    /// See [`Atlas::gutter`].
    pub gutter: u32,
    /// The corners of each triangle on its page, lumels.
    pub corners: Vec<[Vec2; 3]>,
    /// The chart of each triangle.
    pub charts: Vec<u32>,
    /// Where the charts lie.
    pub places: Vec<ChartPlace>,
}

/// More lumels than this cannot be numbered.
const MAX_LUMELS: u64 = u32::MAX as u64;

impl AtlasParts {
    /// The atlas of these parts.
    ///
    /// # Errors
    /// Says what does not fit together: charts, pages or triangles that there are not, or places outside of their pages.
    pub fn atlas(self) -> Result<Atlas, String> {
        let Self { pages, density, gutter, corners, charts, places } = self;
        let lumels = pages.iter().try_fold(0u64, |sum, [width, height]| {
            sum.checked_add(u64::from(*width) * u64::from(*height)).filter(|sum| *sum <= MAX_LUMELS)
        });
        if lumels.is_none() || pages.iter().any(|page| page.contains(&0)) {
            return Err("a page has no lumels, or all have too many".to_owned());
        }
        if charts.len() != corners.len() {
            return Err(format!("{} triangles have a place, {} a chart", corners.len(), charts.len()));
        }
        if let Some(place) = places.iter().position(|place| {
            let page = pages.get(place.page as usize);
            !page.is_some_and(|page| (0..2).all(|k| place.min[k] <= place.max[k] && place.max[k] <= page[k]))
        }) {
            return Err(format!("chart {place} lies outside of its page"));
        }
        for (tri, (corners, &chart)) in corners.iter().zip(&charts).enumerate() {
            let Some(place) = places.get(chart as usize) else {
                return Err(format!("triangle {tri} belongs to chart {chart} of {}", places.len()));
            };
            let page = Vec2::from(pages[place.page as usize].map(|side| side as f32));
            // Comparisons that a coordinate which is no number fails.
            if !corners.iter().all(|corner| corner.cmpge(Vec2::ZERO).all() && corner.cmple(page).all()) {
                return Err(format!("triangle {tri} lies outside of its page"));
            }
        }
        Ok(Atlas { pages, density, gutter, corners, charts, places })
    }
}

impl From<&Atlas> for AtlasParts {
    fn from(atlas: &Atlas) -> Self {
        let Atlas { pages, density, gutter, corners, charts, places } = atlas.clone();
        Self { pages, density, gutter, corners, charts, places }
    }
}
