//! Functions that know neither triangles nor textures: kernels around points that are scattered over the surfaces.

mod cells;
mod clearance;
mod cloud;
mod nodes;
mod receivers;
mod scatter;

use crate::parts::for_each_weight;
use crate::{Adjacency, Basis, Field, Hierarchy, Identity, NodeId, NodeWeights};
use clearance::Open;
pub use clearance::{Clearance, DIRECTIONS, Obstacle, Obstacles};
pub use cloud::{CloudLighting, CloudPoint, PointCloud};
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint, TriId};
use nodes::{Node, NodeGrid, RADIUS};
use rayon::prelude::*;
use scatter::Scattered;
pub use scatter::SurfaceSample;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Functions are integrated over parts of triangles that are this share of the spacing long at most.
const PART: f32 = 0.5;

/// Normalised kernels around points that lie evenly on the surfaces of a scene.
///
/// Node i has the weight `wᵢ(x) = K(|x − pᵢ| / s) · max(0, nᵢ·n(x))` at a place x, zero beyond the radius s and where normals differ by
/// more than 84°, and the function `Bᵢ = wᵢ / Σwⱼ`: a partition of unity (Shepard). Constants are exact. Smooth light has an error of
/// first order in the spacing, with a small factor. [`Obstacles`] that stand between the point and the place make the weight zero, too.
///
/// Where triangles lie has no influence on points or functions, nor on what they cost: a wall of two triangles has as many nodes as one of
/// two million. The points are random, but always the same for a scene and a spacing.
#[derive(Clone, Debug)]
pub struct MeshlessBasis {
    scene: Arc<Scene>,
    /// Of the finest level, metres.
    spacing: f32,
    /// Whether somebody has looked for obstacles.
    is_gated: bool,
    /// From the coarsest to the finest.
    levels: Vec<Level>,
    /// Of all levels, one after the other.
    points: Vec<SurfaceSample>,
    areas: Vec<f32>,
    /// Made when it is first asked for: most solves know all nodes.
    adjacency: OnceLock<Adjacency>,
}

/// Points of one spacing.
#[derive(Clone, Debug)]
struct Level {
    grid: NodeGrid,
    /// The number of its first node among those of all levels.
    first: u32,
}

impl MeshlessBasis {
    /// The basis with points that are `spacing` metres from each other, or a little more. It must be above zero.
    ///
    /// Runs on the threads of the caller's rayon pool; the result does not depend on their number.
    pub fn new(scene: Arc<Scene>, spacing: f32) -> Self {
        Self::with_levels(scene, spacing, 1)
    }

    /// The same with coarser levels below it, each of twice the spacing of the next, so many in all: a
    /// [hierarchy](Basis::hierarchy) of scattered-data approximations. The points of levels have nothing to do with each other.
    ///
    /// With the levels, the error of smooth light falls faster with the spacing; they have a third more nodes.
    pub fn with_levels(scene: Arc<Scene>, spacing: f32, levels: u32) -> Self {
        Self { is_gated: false, ..Self::around_obstacles(scene, spacing, levels, &Open) }
    }

    /// The same where light does not pass what stands on the surfaces.
    pub fn around_obstacles(scene: Arc<Scene>, spacing: f32, levels: u32, obstacles: &dyn Obstacles) -> Self {
        let mut basis = Self {
            scene,
            spacing,
            is_gated: true,
            levels: Vec::new(),
            points: Vec::new(),
            areas: Vec::new(),
            adjacency: OnceLock::new(),
        };
        for halvings in (0..levels.max(1)).rev() {
            let spacing = spacing * (halvings as f32).exp2();
            let mut points = scatter::scattered(&basis.scene, spacing, obstacles);
            let origin = basis.scene.bounds().min;
            let node = |Scattered { sample, .. }: &Scattered| Node {
                position: sample.position,
                normal: sample.normal,
            };
            let grid = NodeGrid::of_radius(origin, RADIUS * spacing, &mut points, node)
                .with_clearances(points.iter().map(|point| point.clearance));
            basis.levels.push(Level { grid, first: basis.points.len() as u32 });
            basis.points.extend(points.iter().map(|point| point.sample));
        }
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

    /// The least distance between points of the finest level that face the same way, metres.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// What stands around a node.
    fn clearance(&self, node: NodeId) -> Option<Clearance> {
        let level = self.levels.iter().rfind(|level| level.first <= node.0)?;
        level.grid.clearance((node.0 - level.first) as usize)
    }

    /// The number of levels.
    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// The nodes of a level; 0 is the coarsest.
    pub fn nodes_of_level(&self, level: u32) -> Range<u32> {
        let first = |level: u32| self.levels.get(level as usize).map(|level| level.first);
        first(level).unwrap_or(self.node_count() as u32)..first(level + 1).unwrap_or(self.node_count() as u32)
    }

    /// The radius of the kernels of a level, metres; 0 is the coarsest.
    pub fn radius_of_level(&self, level: u32) -> f32 {
        self.levels.get(level as usize).map_or(0.0, |level| level.grid.radius())
    }

    /// The point of each node, level by level.
    pub fn points(&self) -> &[SurfaceSample] {
        &self.points
    }

    /// Adds the nodes of some levels at a place.
    #[inline]
    fn push_weights(&self, levels: &[Level], at: &SurfaceSample, weights: &mut NodeWeights) {
        for Level { grid, first } in levels {
            grid.weights_at(at.position, at.normal, |node, weight| {
                weights.push(NodeId(first + node), weight)
            });
        }
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
        let levels = self.level_count().to_le_bytes();
        let gates = [u8::from(self.is_gated)];
        let parts = [&geometry.as_bytes()[..], &self.spacing.to_le_bytes(), &levels, &gates];
        Identity::new("points, normalised kernels", parts)
    }

    fn node_count(&self) -> usize {
        self.points.len()
    }

    #[inline]
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        self.push_weights(&self.levels, &SurfaceSample::new(&self.scene, at), weights);
    }

    fn node_areas(&self) -> &[f32] {
        &self.areas
    }

    fn adjacency(&self) -> &Adjacency {
        self.adjacency.get_or_init(|| {
            let of_level = |level: &Level| {
                let first = level.first;
                level.grid.pairs().into_iter().map(move |pair| pair.map(|node| NodeId(first + node)))
            };
            let pairs: Vec<[NodeId; 2]> = self.levels.iter().flat_map(of_level).collect();
            Adjacency::from_cells(self.points.len(), pairs.iter().copied())
        })
    }

    fn hierarchy(&self) -> Option<&dyn Hierarchy> {
        (self.levels.len() > 1).then_some(self)
    }

    fn resolution(&self) -> f32 {
        PART * self.spacing
    }
}

impl Hierarchy for MeshlessBasis {
    /// Level by level: what a value differs by from what the coarser levels say at its point (Shepard, in several levels).
    fn analyze(&self, field: &mut Field, known: Option<&[bool]>) {
        for level in 0..self.level_count() {
            let nodes = self.nodes_of_level(level);
            let coarser = &self.levels[..level as usize];
            let is_known = |node: u32| known.is_none_or(|known| known[node as usize]);
            let coefficients = |node: u32| {
                let mut weights = NodeWeights::default();
                if is_known(node) {
                    self.push_weights(coarser, &self.points[node as usize], &mut weights);
                }
                let channel = |channel: usize| -> Vec3 {
                    let value = |node: NodeId| field.coefficients(node)[channel];
                    let said: Vec3 = weights.iter().map(|(node, weight)| value(node) * weight).sum();
                    if is_known(node) { value(NodeId(node)) - said } else { Vec3::ZERO }
                };
                (0..field.channels()).map(channel).collect::<Vec<_>>()
            };
            let found: Vec<Vec<Vec3>> = nodes.clone().into_par_iter().map(coefficients).collect();
            for (node, found) in nodes.zip(found) {
                field.coefficients_mut(NodeId(node)).copy_from_slice(&found);
            }
        }
    }

    fn level_count(&self) -> u32 {
        Self::level_count(self)
    }

    fn nodes_of_level(&self, level: u32) -> Range<u32> {
        Self::nodes_of_level(self, level)
    }

    fn finer(&self, level: u32, marked: &[bool]) -> Vec<NodeId> {
        let Some(Level { grid, first }) = self.levels.get(level as usize) else { return Vec::new() };
        let is_near = |&node: &u32| {
            let point = &self.points[node as usize];
            let mut is_near = false;
            grid.weights_at(point.position, point.normal, |coarse, _| {
                is_near |= marked[(first + coarse) as usize];
            });
            is_near
        };
        self.nodes_of_level(level + 1).into_par_iter().filter(is_near).map(NodeId).collect()
    }

    fn weights_up_to(&self, level: u32, at: SurfacePoint, weights: &mut NodeWeights) {
        let levels = &self.levels[..self.levels.len().min(level as usize + 1)];
        self.push_weights(levels, &SurfaceSample::new(&self.scene, at), weights);
    }
}
