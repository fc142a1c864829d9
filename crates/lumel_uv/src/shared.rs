//! One square on which a file lays out all objects.

use crate::atlas::Atlas;
use crate::chart::generated_back;
use crate::given::{Layout, Metric};
use crate::lay_out::{PlacedTriangle, most_dense};
use crate::object::ObjectCharts;
use crate::slight::serious;
use crate::topology::Topology;
use crate::{Density, Finding, UnwrapSettings, check};
use glam::{DVec2, Vec2};
use lumel_scene::Scene;
use std::collections::BTreeMap;

/// A square that is shared is filled at least to this part of its width and height.
const FILLED: f64 = 0.5;

/// The smallest page, lumels.
const SMALLEST: f64 = 4.0;

/// The square that all objects share as the page of an atlas, if there is one: no object overlaps another one, and none is to
/// have another density than the file gives it. The backs of two-sided surfaces lie on a second page, mirrored.
pub(crate) fn share(
    scene: &Scene,
    settings: &UnwrapSettings,
    parts: &[(Topology, ObjectCharts)],
) -> Option<(Atlas, Vec<Finding>)> {
    let layouts: Vec<(&Topology, &Layout)> =
        parts.iter().map(|(t, charts)| Some((t, charts.layout.as_ref()?))).collect::<Option<_>>()?;
    let corners = layouts.iter().flat_map(|(_, layout)| layout.corners.as_flattened()).copied();
    let (min, max) = corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
    let differ = layouts.iter().any(|(t, _)| settings.factor(scene, t.object) != 1.0);
    if layouts.is_empty() || differ || (max - min).min_element() < FILLED {
        return None;
    }
    let metric = layouts.iter().fold(Metric::default(), |sum, (_, layout)| sum.plus(&layout.metric));
    let has_backs = scene.triangle_count() > scene.traced_count();
    let n_pages = if has_backs { 2.0 } else { 1.0 };
    let asked = metric.size() * most_dense(scene, settings);
    // A density is met as nearly as pages allow, a budget never exceeded.
    let (most, whole): (f64, fn(DVec2) -> DVec2) = match settings.density {
        Density::PerMetre(_) => (f64::INFINITY, DVec2::round),
        Density::Budget(lumels) => (f64::from(lumels) / n_pages, DVec2::floor),
    };
    // No more lumels than the budget has, however much of the square is empty.
    let within = asked * (most / (asked.x * asked.y)).sqrt().min(1.0);
    let size = within * (f64::from(settings.page_size) / within.max_element()).min(1.0);
    let size = whole(size / 4.0) * 4.0;
    let size = size.max(DVec2::splat(SMALLEST)).min(DVec2::splat(f64::from(settings.page_size)));
    let mut findings = Vec::new();
    let density = (size.x * size.y / (metric.size().x * metric.size().y)).sqrt();
    if let Density::PerMetre(asked) = settings.density
        && within.max_element() > f64::from(settings.page_size)
    {
        let message = format!(
            "the lightmap coordinates of all objects need more than a page of {} lumels at {asked} lumels per metre: they have {density:.3}; use larger pages",
            settings.page_size
        );
        findings.push(Finding { object: None, message });
    }
    let page = size.to_array().map(|side| side as u32);
    let mut atlas = Atlas {
        pages: vec![page; n_pages as usize],
        density: density as f32,
        gutter: settings.gutter,
        corners: vec![[Vec2::ZERO; 3]; scene.triangle_count()],
        charts: vec![0; scene.triangle_count()],
        places: Vec::new(),
    };
    for (topology, layout) in layouts {
        let mut islands: BTreeMap<(u32, u32), Vec<PlacedTriangle>> = BTreeMap::new();
        for (face, (&corners, &island)) in (0..).zip(layout.corners.iter().zip(&layout.islands)) {
            let tri = topology.tri(face);
            let [a, b, c] = corners.map(|c| (c * size).as_vec2());
            islands.entry((0, island)).or_default().push((tri, [a, b, c]));
            if let Some(back) = generated_back(scene, tri) {
                let corners = [b, a, c].map(|p| Vec2::new(page[0] as f32 - p.x, p.y));
                islands.entry((1, island)).or_default().push((back, corners));
            }
        }
        for ((page, _), triangles) in islands {
            atlas.add((topology.object, page), &triangles, Some(scene), density);
        }
    }
    let (faults, slight) = serious(check(&atlas, scene), &atlas, scene, |_| true);
    findings.extend(slight);
    faults.is_empty().then_some((atlas, findings))
}
