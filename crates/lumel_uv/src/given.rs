//! Layouts that files give: one place on a square for each vertex of an object.

use crate::chart::{Chart, signed_area};
use crate::overlap::overlapping;
use crate::slight::SLIGHT;
use crate::topology::Topology;
use glam::{DVec2, Vec2};
use lumel_scene::{Edges, Forest, Scene, TriId, Weld};
use std::collections::BTreeMap;

/// Coordinates may lie so far outside the square: files round them.
const OUTSIDE: f64 = 1e-4;

/// A triangle has no area on the square if it has less than this part of what triangles of its size have there.
const COLLAPSED: f64 = 1e-3;

/// How far triangles may lie on each other, as part of the side of a mean triangle: files round coordinates.
const TOLERANCE: f64 = 0.02;

/// A square is not meant to be a little wider than high, or the other way round: what changes by less than this factor is due
/// to how charts are stretched.
const SQUARE: f64 = 1.05;

/// The layout of an object.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// By triangle, in the square from 0 to 1, `v` down.
    pub(crate) corners: Vec<[DVec2; 3]>,
    /// By triangle: the part of the layout that it belongs to, within which triangles continue each other's surface.
    pub(crate) islands: Vec<u32>,
    /// How the square is stretched.
    pub(crate) metric: Metric,
}

/// How surfaces lie on a square, in sums that add up over objects.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Metric {
    /// m².
    area: f64,
    /// In parts of the square.
    flat_area: f64,
    /// How much of the area is due to metres along the square, and to those down it.
    along: DVec2,
}

impl Layout {
    /// The layout that the vertices of an object have; `None` if none has any.
    ///
    /// # Errors
    /// Why it cannot be used, whatever the density.
    pub(crate) fn new(scene: &Scene, topology: &Topology) -> Result<Option<Self>, String> {
        let tris = || (0..topology.len() as u32).map(|face| topology.tri(face));
        let given = scene.lightmap_uvs();
        let uvs = |tri: TriId| scene.triangle(tri).map(|vertex| given[vertex as usize]);
        if given.is_empty() || !tris().any(|tri| uvs(tri).iter().all(|uv| uv.is_finite())) {
            return Ok(None);
        }
        if let Some(tri) = tris().find(|&tri| !uvs(tri).iter().all(|uv| uv.is_finite())) {
            return Err(format!("triangle {} has none", tri.0));
        }
        let corners: Vec<[DVec2; 3]> = tris().map(|tri| uvs(tri).map(|uv| uv.as_dvec2())).collect();
        let is_outside = |c: &DVec2| c.min_element() < -OUTSIDE || c.max_element() > 1.0 + OUTSIDE;
        if let Some((tri, _)) = tris().zip(&corners).find(|(_, corners)| corners.iter().any(is_outside)) {
            return Err(format!("triangle {} reaches out of the square from 0 to 1", tri.0));
        }
        let corners: Vec<[DVec2; 3]> =
            corners.iter().map(|t| t.map(|c| c.clamp(DVec2::ZERO, DVec2::ONE))).collect();
        let mut metric = Metric::default();
        tris().zip(&corners).for_each(|(tri, corners)| metric.add(scene, tri, *corners));
        let scale = metric.area / metric.flat_area;
        let is_flat = |(tri, corners): &(TriId, &[DVec2; 3])| {
            signed_area(**corners).abs() * scale < COLLAPSED * f64::from(scene.area(*tri))
        };
        let collapsed: f64 =
            tris().zip(&corners).filter(is_flat).map(|(tri, _)| f64::from(scene.area(tri))).sum();
        if !(scale.is_finite() && collapsed <= SLIGHT * metric.area) {
            let found = tris().zip(&corners).find(is_flat).map_or(topology.triangles.start, |(tri, _)| tri.0);
            return Err(format!("triangle {found} has no area there"));
        }
        let mean_side = (metric.flat_area / corners.len() as f64).sqrt();
        let scaled: Vec<[DVec2; 3]> = corners.iter().map(|t| t.map(|c| c / mean_side)).collect();
        let pairs: Vec<[TriId; 2]> = overlapping(&scaled, TOLERANCE)
            .into_iter()
            .map(|pair| pair.map(|face| topology.tri(face as u32)))
            .collect();
        let lost: f64 =
            pairs.iter().map(|pair| f64::from(scene.area(pair[0]).min(scene.area(pair[1])))).sum();
        if lost > SLIGHT * metric.area {
            let share = 100.0 * lost / metric.area;
            let [a, b] = pairs.first().map_or([0; 2], |pair| pair.map(|tri| tri.0));
            return Err(format!("triangles {a} and {b} and others overlap, {share:.1} % of its area"));
        }
        let islands = islands(scene, topology, uvs);
        Ok(Some(Self { corners, islands, metric }))
    }

    /// The layout as one chart, in metres.
    pub(crate) fn chart(&self, topology: &Topology) -> Chart {
        let metres = self.metric.size();
        let corners: Vec<[DVec2; 3]> = self.corners.iter().map(|t| t.map(|c| c * metres)).collect();
        let triangles = (0..topology.len() as u32).map(|face| topology.tri(face)).collect();
        let chart = Chart::in_place(topology.object, triangles, &corners);
        Chart { islands: self.islands.clone(), ..chart }
    }
}

impl Metric {
    fn add(&mut self, scene: &Scene, tri: TriId, corners: [DVec2; 3]) {
        let [p, q, r] = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let [a, b, c] = corners;
        let (q, r, b, c) = (q - p, r - p, b - a, c - a);
        let twice = b.perp_dot(c);
        self.area += 0.5 * q.cross(r).length();
        self.flat_area += 0.5 * twice.abs();
        if twice != 0.0 {
            // The edges as one goes along the axes of the square.
            let along = [(q * c.y - r * b.y) / twice, (r * b.x - q * c.x) / twice];
            // In parts of their sum: slivers that are nearly collapsed would decide alone.
            let squared = DVec2::from(along.map(|along| along.length_squared()));
            self.along += squared / squared.element_sum() * (0.5 * q.cross(r).length());
        }
    }

    pub(crate) fn plus(self, other: &Self) -> Self {
        Self {
            area: self.area + other.area,
            flat_area: self.flat_area + other.flat_area,
            along: self.along + other.along,
        }
    }

    /// Width and height of the square, metres: areas are true on average, and lengths along it and down as far as they can be.
    pub(crate) fn size(&self) -> DVec2 {
        let aspect = (self.along.x / self.along.y).sqrt();
        let is_square = !aspect.is_finite() || (1.0 / SQUARE..SQUARE).contains(&aspect);
        let root = if is_square { 1.0 } else { aspect.sqrt() };
        DVec2::new(root, 1.0 / root) * (self.area / self.flat_area).sqrt()
    }
}

/// Numbers the parts of a layout: triangles that have an edge in common on the surface and on the square.
fn islands(scene: &Scene, topology: &Topology, uvs: impl Fn(TriId) -> [Vec2; 3]) -> Vec<u32> {
    let (mut weld, mut numbers) = (Weld::default(), BTreeMap::new());
    let places = (0..topology.len() as u32).map(|face| {
        let tri = topology.tri(face);
        let (points, uvs) = (scene.triangle_positions(tri), uvs(tri));
        [0, 1, 2].map(|k| {
            let next = numbers.len() as u32;
            // Adding zero turns -0 into 0.
            let uv = (uvs[k] + Vec2::ZERO).to_array().map(f32::to_bits);
            *numbers.entry((weld.number(points[k]), uv)).or_insert(next)
        })
    });
    let edges = Edges::new(places);
    let mut forest = Forest::new(topology.len());
    for edge in edges.each() {
        edge.windows(2).for_each(|pair| forest.join(pair[0].tri, pair[1].tri));
    }
    (0..topology.len() as u32).map(|face| forest.of(face)).collect()
}
