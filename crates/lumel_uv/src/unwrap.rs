//! From a scene to its atlas.

use crate::atlas::{Atlas, ChartPlace};
use crate::chart::Chart;
use crate::cut::cut;
use crate::object::{ObjectCharts, charts_of};
use crate::pack::{Packed, footprint, longest, pack};
use crate::topology::{Topology, objects};
use crate::{Density, Finding, Method, Pace, Report, UnwrapSettings, UvError, check};
use glam::Vec2;
use lumel_scene::{ObjectId, Scene};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Packings that are tried to come near a budget from below, and how near is near enough.
const MOST_TRIALS: usize = 5;
const NEAR_BUDGET: f64 = 0.94;

/// A budget never makes lumels coarser than if no lumel were lost between charts, by more than this factor.
const COARSEST: f64 = 1000.0;

/// Charts cannot get fewer lumels than the smallest of them have. A budget below this many times that is exceeded: what is
/// larger would get next to nothing.
const ABOVE_LEAST: f64 = 1.25;

/// How full pages are thought to get when a budget is first divided by areas.
const USUAL_FILL: f64 = 0.85;

/// Times that objects with faults get simpler charts: once for each method that has a simpler one.
const MOST_REPAIRS: usize = 2;

/// An atlas, and what to know about it.
#[derive(Clone, Debug)]
pub struct Unwrapped {
    /// Where light is stored.
    pub atlas: Atlas,
    /// How it went.
    pub report: Report,
}

/// Lays out the light of all triangles of a scene.
///
/// Each object's surface is cut where it creases, flattened and packed. The result is [checked](check()): an object with a
/// fault gets simpler charts, down to single triangles. The same scene and settings give the same atlas on any number of
/// threads and any processor, unless `pace` says that time is up: `pace` is asked now and then, from all threads.
///
/// # Errors
/// Settings outside their bounds, an atlas with more lumels than can be numbered, and [`Pace::Stop`].
pub fn unwrap(
    scene: &Scene,
    settings: &UnwrapSettings,
    pace: &(dyn Fn() -> Pace + Sync),
) -> Result<Unwrapped, UvError> {
    settings.check()?;
    let mut parts: Vec<(Topology, ObjectCharts)> = objects(scene)
        .into_par_iter()
        .map(|triangles| {
            let topology = Topology::new(scene, triangles);
            let charts = charts_of(scene, &topology, Method::Conformal, pace)?;
            Ok((topology, charts))
        })
        .collect::<Result<_, UvError>>()?;
    let mut repairs = 0;
    loop {
        let (atlas, mut findings) = lay_out(scene, settings, &parts)?;
        let faults = check(&atlas, scene);
        let faulty: BTreeSet<ObjectId> = faults.iter().filter_map(|fault| fault.object(scene)).collect();
        if faulty.is_empty() || repairs == MOST_REPAIRS {
            let name = |object: ObjectId| scene.object_names()[object.index()].clone();
            for (topology, charts) in &parts {
                let Some(reason) = &charts.reason else { continue };
                let message = format!("it has {} charts: {reason}", charts.method.name());
                findings.push(Finding { object: Some(name(topology.object)), message });
            }
            for fault in &faults {
                let object = fault.object(scene).map(name);
                findings.push(Finding { object, message: fault.to_string() });
            }
            let methods: Vec<_> = parts.iter().map(|(t, charts)| (t.object, charts.method)).collect();
            return Ok(Unwrapped { report: Report::new(scene, &atlas, &methods, findings), atlas });
        }
        repairs += 1;
        for (topology, charts) in parts.iter_mut().filter(|(t, _)| faulty.contains(&t.object)) {
            let fault = faults.iter().find(|fault| fault.object(scene) == Some(topology.object));
            let reason = fault.map(ToString::to_string);
            *charts = ObjectCharts { reason, ..charts_of(scene, topology, charts.method.simpler(), pace)? };
        }
    }
}

/// Cuts, turns round and packs the charts of all objects.
fn lay_out(
    scene: &Scene,
    settings: &UnwrapSettings,
    parts: &[(Topology, ObjectCharts)],
) -> Result<(Atlas, Vec<Finding>), UvError> {
    let factor = |chart: &Chart| settings.factor(chart.object);
    let whole = || parts.iter().flat_map(|(_, charts)| &charts.charts);
    // No page is more than full, so that no density is above this one.
    let weighted: f64 = (0..scene.triangle_count() as u32)
        .map(lumel_scene::TriId)
        .map(|tri| f64::from(scene.area(tri)) * settings.factor(scene.object_id(tri)).powi(2))
        .sum();
    let most = match settings.density {
        Density::PerMetre(density) => f64::from(density),
        Density::Budget(lumels) => (f64::from(lumels) / weighted.max(f64::MIN_POSITIVE)).sqrt(),
    };
    let longest = f64::from(longest(settings));
    let charts: Vec<Chart> = whole()
        .flat_map(|chart| cut(chart.clone(), longest / (most * factor(chart))))
        .flat_map(|chart| [chart.back(scene), Some(chart)].into_iter().rev().flatten())
        .collect();
    let scales = |density: f64| -> Vec<f64> {
        let scale = |chart: &Chart| {
            let largest = longest / chart.size.max_element().max(f64::MIN_POSITIVE);
            (density * factor(chart)).min(largest)
        };
        charts.iter().map(scale).collect()
    };
    let (density, packed) = match settings.density {
        Density::PerMetre(_) => (most, pack(&charts, &scales(most), settings)?),
        Density::Budget(lumels) => within_budget(&charts, f64::from(lumels), most, &scales, settings)?,
    };
    let scales = scales(density);
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
            let message = format!(
                "a triangle is longer than a page of {} lumels and has {scale:.3} lumels per metre; use larger pages, or split it with a maximum edge length",
                settings.page_size
            );
            findings
                .push(Finding { object: Some(scene.object_names()[chart.object.index()].clone()), message });
        }
    }
    Ok((assemble(scene, settings, density, &charts, &packed), findings))
}

/// The finest packing found that has no more lumels than `budget`, or than a little more than the smallest charts take up.
fn within_budget(
    charts: &[Chart],
    budget: f64,
    most: f64,
    scales: &dyn Fn(f64) -> Vec<f64>,
    settings: &UnwrapSettings,
) -> Result<(f64, Packed), UvError> {
    let estimate = |density: f64| -> f64 {
        charts.iter().zip(scales(density)).map(|(c, s)| footprint(c, s, settings)).sum::<f64>() / USUAL_FILL
    };
    let least = most / COARSEST;
    let budget = budget.max(ABOVE_LEAST * estimate(least));
    let bisect = |target: f64| {
        let (mut low, mut high) = (least, most);
        for _ in 0..30 {
            let middle = (low * high).sqrt();
            if estimate(middle) > target { high = middle } else { low = middle }
        }
        low
    };
    let mut target = budget;
    let mut best: Option<(f64, Packed)> = None;
    for _ in 0..MOST_TRIALS {
        let density = bisect(target);
        let packed = pack(charts, &scales(density), settings)?;
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
    best.ok_or(UvError::Stopped)
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
    for (i, (chart, placed)) in charts.iter().zip(&packed.placed).enumerate() {
        let origin = placed.min.map(f64::from);
        let (mut min, mut max) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for (&tri, corners) in chart.triangles.iter().zip(&chart.corners) {
            let corners = corners.map(|c| (placed.pose.apply(c) + glam::DVec2::from(origin)).as_vec2());
            corners.iter().for_each(|&c| (min, max) = (min.min(c), max.max(c)));
            atlas.corners[tri.index()] = corners;
            atlas.charts[tri.index()] = i as u32;
        }
        atlas.places.push(ChartPlace {
            object: chart.object,
            page: placed.page,
            min: min.floor().to_array().map(|x| x as u32),
            max: max.ceil().to_array().map(|x| x as u32),
            density: placed.pose.scale as f32,
        });
    }
    atlas
}
