//! Which chart a lumel belongs to.

use crate::nearest::NONE;
use lumel_uv::{Atlas, Coverage};

/// By lumel of all pages: the chart whose light is read there; `NONE` between charts.
pub(crate) fn charts(atlas: &Atlas, coverage: &Coverage) -> Vec<u32> {
    let mut charts = vec![NONE; atlas.lumel_count()];
    for (place, &lumel) in coverage.lumels().iter().enumerate() {
        charts[lumel as usize] = atlas.chart(coverage.shares(place)[0].tri) as u32;
    }
    charts
}
