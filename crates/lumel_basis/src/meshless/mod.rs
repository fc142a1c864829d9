//! Functions that know neither triangles nor textures: kernels around points that are scattered over the surfaces.

mod cells;
mod nodes;
mod receivers;
mod scatter;

use crate::parts::for_each_weight;
use crate::{Adjacency, Basis, Identity, NodeId, NodeWeights};
use lumel_scene::{Scene, SurfacePoint, TriId};
use nodes::NodeGrid;
pub use scatter::SurfaceSample;
use std::sync::{Arc, OnceLock};

/// Functions are integrated over parts of triangles that are this share of the spacing long at most.
const PART: f32 = 0.5;

/// Normalised kernels around points that lie evenly on the surfaces of a scene.
///
/// Node i has the weight `wᵢ(x) = K(|x − pᵢ| / s) · max(0, nᵢ·n(x))` at a place x, zero beyond the radius s and where normals differ by
/// more than 84°, and the function `Bᵢ = wᵢ / Σwⱼ`: a partition of unity (Shepard). Constants are exact. Smooth light has an error of
/// first order in the spacing, with a small factor.
///
/// Where triangles lie has no influence on points or functions, nor on what they cost: a wall of two triangles has as many nodes as one of
/// two million. The points are random, but always the same for a scene and a spacing.
#[derive(Clone, Debug)]
pub struct MeshlessBasis {
    scene: Arc<Scene>,
    spacing: f32,
    points: Vec<SurfaceSample>,
    grid: NodeGrid,
    areas: Vec<f32>,
    /// Made when it is first asked for: most solves know all nodes.
    adjacency: OnceLock<Adjacency>,
}

impl MeshlessBasis {
    /// The basis with points that are `spacing` metres from each other, or a little more. It must be above zero.
    ///
    /// Runs on the threads of the caller's rayon pool; the result does not depend on their number.
    pub fn new(scene: Arc<Scene>, spacing: f32) -> Self {
        let mut points = scatter::scattered(&scene, spacing);
        let grid = NodeGrid::new(scene.bounds().min, spacing, &mut points);
        let mut basis = Self { scene, spacing, areas: Vec::new(), points, grid, adjacency: OnceLock::new() };
        basis.areas = basis.integrated();
        basis
    }

    /// The spacing at which a scene has about so many points, metres.
    pub fn spacing_for(scene: &Scene, points: u64) -> f32 {
        scatter::spacing_for(points, area(scene))
    }

    /// About how many points a scene has at a spacing. Surfaces of many small pieces have up to one more for each.
    pub fn count_for(scene: &Scene, spacing: f32) -> u64 {
        scatter::count_for(spacing, area(scene))
    }

    /// About how much memory it takes to make a basis of so many points, and what of it the basis keeps, bytes.
    pub fn bytes_for(scene: &Scene, points: u64) -> [u64; 2] {
        let kept = points * (size_of::<SurfaceSample>() as u64 + nodes::BYTES_PER_NODE + 4);
        [kept + scatter::bytes_to_scatter(points, scene.triangle_count() as u64), kept]
    }

    /// The scene it lies on.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The least distance between points that face the same way, metres.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// The radius of kernels, metres.
    pub fn radius(&self) -> f32 {
        self.grid.radius()
    }

    /// The point of each node.
    pub fn points(&self) -> &[SurfaceSample] {
        &self.points
    }

    /// The integral of each function, m², by the middles of small parts.
    fn integrated(&self) -> Vec<f32> {
        let mut areas = vec![0.0f64; self.points.len()];
        for_each_weight(&self.scene, self, |part, node, weight| {
            areas[node.index()] += part.area * f64::from(weight);
        });
        areas.into_iter().map(|area| area as f32).collect()
    }
}

/// The area of all surfaces, m².
fn area(scene: &Scene) -> f64 {
    (0..scene.triangle_count() as u32).map(|tri| f64::from(scene.area(TriId(tri)))).sum()
}

impl Basis for MeshlessBasis {
    fn identity(&self) -> Identity {
        let geometry = self.scene.geometry_hash();
        Identity::new("points, normalised kernels", [&geometry.as_bytes()[..], &self.spacing.to_le_bytes()])
    }

    fn node_count(&self) -> usize {
        self.points.len()
    }

    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        let SurfaceSample { position, normal, .. } = SurfaceSample::new(&self.scene, at);
        self.grid.weights_at(position, normal, |node, weight| weights.push(NodeId(node), weight));
    }

    fn node_areas(&self) -> &[f32] {
        &self.areas
    }

    fn adjacency(&self) -> &Adjacency {
        self.adjacency.get_or_init(|| {
            let pairs = self.grid.pairs();
            Adjacency::from_cells(self.points.len(), pairs.iter().map(|pair| pair.map(NodeId)))
        })
    }

    fn resolution(&self) -> f32 {
        PART * self.spacing
    }
}
