//! Light measured over the triangles around vertices.

use crate::{Basis, ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site, VertexBasis};
use glam::Vec3;
use lumel_sample::{Frame, uniform_triangle};
use lumel_scene::{Barycentrics, TriId};
use std::sync::Arc;

/// Measures the nodes of a [`VertexBasis`] over the support of each hat function B: `∫BE dA / ∫B dA`.
///
/// That is the least-squares projection with the mass matrix lumped to its row sums. It conserves power and needs
/// no vertex to be visible, but it is smoother than the light: its error falls with the edge length to the power
/// 1.5 only, because the average at a border is taken off-centre.
///
/// Samples follow the square root of a triangle's area: of all ways to spread a number of samples, the one with the least
/// noise over all surfaces, if light varies alike in all triangles.
#[derive(Clone, Debug)]
pub struct AreaReceivers {
    basis: Arc<VertexBasis>,
    /// Of each triangle, m².
    areas: Vec<f32>,
    doublings: Vec<i8>,
}

/// A triangle has at least an eighth of the samples of a mean one, and at most 32 times as many.
const DOUBLINGS: std::ops::RangeInclusive<i8> = -3..=5;

impl AreaReceivers {
    /// Measures the nodes of `basis` over areas.
    pub fn new(basis: Arc<VertexBasis>) -> Self {
        let scene = basis.scene();
        let areas: Vec<f32> = (0..scene.triangle_count() as u32).map(|tri| scene.area(TriId(tri))).collect();
        let doublings = doublings(&areas);
        Self { basis, areas, doublings }
    }
}

impl AreaReceivers {
    /// The site of a triangle at any place.
    fn site_on(&self, element: ElementId) -> impl Fn([f32; 2]) -> Site {
        let (scene, tri) = (self.basis.scene(), TriId(element.0));
        let normal = scene.geometric_normal(tri);
        let (frame, skip) = (Frame::from_normal(normal), Some(scene.traced(tri)));
        let origins = scene.ray_origins(tri);
        move |u| {
            let bary = Barycentrics::from(uniform_triangle(u));
            Site { origin: origins.at(bary.weights()), frame, skip }
        }
    }
}

/// What is closer above a triangle than this share of the edges of one of its area almost touches it.
const REACH: f32 = 0.25;

/// [`Receivers::reach`] of triangles of this area, m².
pub(crate) fn reach_over(area: f32) -> f32 {
    REACH * (2.0 * area).sqrt()
}

/// The mean number of samples may become this many times what was asked for: powers of two cannot keep it.
const MAX_MEAN: f64 = 1.15;

/// The doublings of each triangle that are nearest to the square root of its area and keep the mean number of samples.
fn doublings(areas: &[f32]) -> Vec<i8> {
    let roots: Vec<f32> = areas.iter().map(|area| 0.5 * area.max(f32::MIN_POSITIVE).log2()).collect();
    let of =
        |root: f32, offset: f32| ((root + offset).round() as i8).clamp(*DOUBLINGS.start(), *DOUBLINGS.end());
    // In samples of the smallest, so that sums are exact.
    let samples = |doublings: i8| 1u64 << (doublings - DOUBLINGS.start());
    let all = (MAX_MEAN * (samples(0) * areas.len() as u64) as f64) as u64;
    let fits = |offset: f32| roots.iter().map(|&root| samples(of(root, offset))).sum::<u64>() <= all;
    let (mut low, mut high) = (-80.0, 80.0);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    roots.iter().map(|&root| of(root, low)).collect()
}

impl Receivers for AreaReceivers {
    fn identity(&self) -> Identity {
        self.basis.identity().derived("areas of vertices")
    }

    fn node_count(&self) -> usize {
        self.basis.node_count()
    }

    /// The triangles, back sides included.
    fn element_count(&self) -> usize {
        self.basis.scene().triangle_count()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Area
    }

    fn doublings(&self, element: ElementId) -> i8 {
        self.doublings[element.index()]
    }

    /// A part of a triangle keeps its own, whatever else is split.
    fn stream(&self, element: ElementId) -> u32 {
        let refinement = self.basis.scene().refinement();
        refinement.map_or(element.0, |refinement| refinement.stream(TriId(element.0)))
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        nodes.extend(self.basis.nodes_of(TriId(element.0)));
    }

    fn site(&self, element: ElementId, u: [f32; 2]) -> Site {
        self.site_on(element)(u)
    }

    fn sites(&self, element: ElementId, places: &[[f32; 2]], sites: &mut Vec<Site>) {
        sites.extend(places.iter().copied().map(self.site_on(element)));
    }

    #[inline]
    fn towards(&self, element: ElementId, u: [f32; 2], nodes: &mut NodeWeights) {
        let area = self.areas[element.index()];
        let [a, b] = uniform_triangle(u);
        for (node, weight) in self.basis.nodes_of(TriId(element.0)).into_iter().zip([a, b, 1.0 - a - b]) {
            nodes.push(node, weight * area);
        }
    }

    fn reach(&self, element: ElementId) -> f32 {
        reach_over(self.areas[element.index()])
    }

    fn surface(&self, element: ElementId) -> Option<TriId> {
        Some(TriId(element.0))
    }

    fn beside(&self, element: ElementId, beside: &mut Vec<Vec3>) {
        let origins = self.basis.scene().ray_origins(TriId(element.0));
        beside.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|corner| origins.at(corner)));
    }

    #[inline]
    fn corners(&self, element: ElementId) -> Option<([NodeId; 3], f32)> {
        Some((self.basis.nodes_of(TriId(element.0)), self.areas[element.index()]))
    }
}
