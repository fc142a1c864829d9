//! All charts on pages, at a density or within a budget.

use crate::atlas::{Atlas, ChartPlace};
use crate::chart::{Chart, signed_area};
use crate::cut::cut;
use crate::merge::merged;
use crate::object::ObjectCharts;
use crate::pack::{Packed, footprint, longest, pack};
use crate::topology::Topology;
use crate::{Density, Finding, UnwrapSettings, UvError};
use glam::Vec2;
use lumel_scene::{ObjectId, Scene, TriId};
use std::collections::{BTreeMap, BTreeSet};

/// Packings that are tried to come near a budget from below, and how near is near enough.
const MOST_TRIALS: usize = 5;
const NEAR_BUDGET: f64 = 0.94;

/// A budget never makes lumels coarser than if no lumel were lost between charts, by more than this factor.
const COARSEST: f64 = 1000.0;

/// Charts cannot get fewer lumels than the smallest of them have. A budget below this many times that is exceeded: what is
/// larger would get next to nothing.
const ABOVE_LEAST: f64 = 1.25;

/// Times that charts are merged for a budget, each time for the density that the last one allows.
const MERGINGS: usize = 2;

/// How full pages are thought to get when a budget is first divided by areas.
const USUAL_FILL: f64 = 0.85;

/// Cuts, turns round and packs the charts of all objects.
pub(crate) fn lay_out(
    scene: &Scene,
    settings: &UnwrapSettings,
    parts: &[(Topology, ObjectCharts)],
) -> Result<(Atlas, Vec<Finding>), UvError> {
    let factor = |chart: &Chart| settings.factor(scene, chart.object);
    let whole = || parts.iter().flat_map(|(_, charts)| &charts.charts);
    let most = most_dense(scene, settings);
    let longest = f64::from(longest(settings));
    // At a density, charts that are smaller than its lumels are merged.
    let charts_at = |density: Option<f64>| -> Vec<Chart> {
        let charts: Vec<Chart> = whole().cloned().collect();
        let charts = match density {
            Some(density) => merged(scene, charts, |chart| density * factor(chart)),
            None => charts,
        };
        let pieces = charts.into_iter().flat_map(|chart| {
            let most = longest / (most * factor(&chart));
            cut(chart, most)
        });
        pieces.flat_map(|chart| [chart.back(scene), Some(chart)].into_iter().rev().flatten()).collect()
    };
    let scales = |charts: &[Chart], density: f64| -> Vec<f64> {
        let scale = |chart: &Chart| {
            let largest = longest / chart.size.max_element().max(f64::MIN_POSITIVE);
            (density * factor(chart)).min(largest)
        };
        charts.iter().map(scale).collect()
    };
    let (density, charts, packed) = match settings.density {
        Density::PerMetre(_) => {
            let charts = charts_at(Some(most));
            let packed = pack(&charts, &scales(&charts, most), settings)?;
            (most, charts, packed)
        }
        Density::Budget(lumels) => within_budget(&charts_at, f64::from(lumels), most, &scales, settings)?,
    };
    let scales = scales(&charts, density);
    let mut findings = Vec::new();
    if let Density::Budget(lumels) = settings.density
        && packed.lumel_count() > u64::from(lumels)
    {
        let message = format!(
            "{} charts have {} lumels, above the budget of {lumels}: each needs some of its own",
            charts.len(),
            packed.lumel_count()
        );
        findings.push(Finding { object: None, message });
    }
    let reduced = |(chart, scale): &(&Chart, &f64)| **scale < density * factor(chart) * (1.0 - 1e-6);
    let mut told = BTreeSet::new();
    for (chart, scale) in charts.iter().zip(&scales).filter(reduced) {
        if told.insert(chart.object) {
            let message = too_long(chart, *scale, settings);
            findings
                .push(Finding { object: Some(scene.object_names()[chart.object.index()].clone()), message });
        }
    }
    Ok((assemble(scene, settings, density, &charts, &packed), findings))
}

/// Lumels per metre that are asked for, or that a budget allows at most: no page is more than full.
pub(crate) fn most_dense(scene: &Scene, settings: &UnwrapSettings) -> f64 {
    let lumels = match settings.density {
        Density::PerMetre(density) => return f64::from(density),
        Density::Budget(lumels) => f64::from(lumels),
    };
    let weighted = |tri| f64::from(scene.area(tri)) * settings.factor(scene, scene.object_id(tri)).powi(2);
    let weighted: f64 = (0..scene.triangle_count() as u32).map(TriId).map(weighted).sum();
    (lumels / weighted.max(f64::MIN_POSITIVE)).sqrt()
}

fn too_long(chart: &Chart, scale: f64, settings: &UnwrapSettings) -> String {
    let page = settings.page_size;
    if chart.is_given() {
        return format!(
            "its lightmap coordinates need more than a page of {page} lumels: it has {scale:.3} lumels per metre; use larger pages"
        );
    }
    format!(
        "a triangle is longer than a page of {page} lumels and has {scale:.3} lumels per metre; use larger pages, or split it with a maximum edge length"
    )
}

/// Charts, and the finest packing found of them that has no more lumels than `budget`, or than a little more than the smallest
/// charts take up.
fn within_budget(
    charts_at: &dyn Fn(Option<f64>) -> Vec<Chart>,
    budget: f64,
    most: f64,
    scales: &dyn Fn(&[Chart], f64) -> Vec<f64>,
    settings: &UnwrapSettings,
) -> Result<(f64, Vec<Chart>, Packed), UvError> {
    let estimate = |charts: &[Chart], density: f64| -> f64 {
        let scales = scales(charts, density);
        charts.iter().zip(scales).map(|(c, s)| footprint(c, s, settings)).sum::<f64>() / USUAL_FILL
    };
    let least = most / COARSEST;
    let bisect = |charts: &[Chart], target: f64| {
        let (mut low, mut high) = (least, most);
        for _ in 0..30 {
            let middle = (low * high).sqrt();
            if estimate(charts, middle) > target { high = middle } else { low = middle }
        }
        low
    };
    // What is merged at a density leaves room for a higher one.
    let mut charts = charts_at(None);
    for _ in 0..MERGINGS {
        charts = charts_at(Some(bisect(&charts, budget)));
    }
    let budget = budget.max(ABOVE_LEAST * estimate(&charts, least));
    let mut target = budget;
    let mut best: Option<(f64, Packed)> = None;
    for _ in 0..MOST_TRIALS {
        let density = bisect(&charts, target);
        let packed = pack(&charts, &scales(&charts, density), settings)?;
        let used = packed.lumel_count() as f64 / budget;
        let better = best.as_ref().is_none_or(|(_, old)| {
            let old = old.lumel_count() as f64 / budget;
            if used > 1.0 { used < old } else { old > 1.0 || used > old }
        });
        if better {
            best = Some((density, packed));
        }
        if (NEAR_BUDGET..=1.0).contains(&used) || density <= least * 1.0001 {
            break;
        }
        target *= 0.98 / used;
    }
    best.map(|(density, packed)| (density, charts, packed)).ok_or(UvError::Stopped)
}

fn assemble(
    scene: &Scene,
    settings: &UnwrapSettings,
    density: f64,
    charts: &[Chart],
    packed: &Packed,
) -> Atlas {
    let mut atlas = Atlas {
        pages: packed.pages.clone(),
        density: density as f32,
        gutter: settings.gutter,
        corners: vec![[Vec2::ZERO; 3]; scene.triangle_count()],
        charts: vec![0; scene.triangle_count()],
        places: Vec::with_capacity(charts.len()),
    };
    for (chart, placed) in charts.iter().zip(&packed.placed) {
        let origin = placed.min.map(f64::from);
        let mut islands = BTreeMap::new();
        for (i, (&tri, corners)) in chart.triangles.iter().zip(&chart.corners).enumerate() {
            let island = chart.islands.get(i).copied().unwrap_or(0);
            let corners = corners.map(|c| (placed.pose.apply(c) + glam::DVec2::from(origin)).as_vec2());
            islands.entry(island).or_insert_with(Vec::new).push((tri, corners));
        }
        for triangles in islands.into_values() {
            let given = chart.is_given().then_some(scene);
            atlas.add((chart.object, placed.page), &triangles, given, placed.pose.scale);
        }
    }
    atlas
}

/// A triangle with its corners on a page.
pub(crate) type PlacedTriangle = (TriId, [Vec2; 3]);

impl Atlas {
    /// Adds a chart of an object on a page: triangles with their corners there.
    ///
    /// Its density is the scale, or measured on the scene where a file gives the layout.
    pub(crate) fn add(
        &mut self,
        (object, page): (ObjectId, u32),
        triangles: &[PlacedTriangle],
        given: Option<&Scene>,
        scale: f64,
    ) {
        let (mut min, mut max) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (mut lumels, mut area) = (0.0, 0.0);
        for &(tri, corners) in triangles {
            corners.iter().for_each(|&c| (min, max) = (min.min(c), max.max(c)));
            self.corners[tri.index()] = corners;
            self.charts[tri.index()] = self.places.len() as u32;
            lumels += signed_area(corners.map(|c| c.as_dvec2())).abs();
            area += given.map_or(0.0, |scene| f64::from(scene.area(tri)));
        }
        let density = if given.is_some() { (lumels / area).sqrt() } else { scale };
        self.places.push(ChartPlace {
            object,
            page,
            min: min.floor().to_array().map(|x| x as u32),
            max: max.ceil().to_array().map(|x| x as u32),
            density: density as f32,
        });
    }
}
