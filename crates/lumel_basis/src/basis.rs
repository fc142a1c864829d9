//! What every basis offers.

use crate::Field;
use glam::Vec3;
use lumel_sample::Frame;
use lumel_scene::{SurfacePoint, TriId};

/// A coefficient of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The index as a `usize`, for slices.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A unit of measuring: a vertex, a triangle, a lumel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The index as a `usize`, for slices.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Nodes and their weights; kept between calls so that nothing is allocated per ray.
#[derive(Clone, Debug, Default)]
pub struct NodeWeights(Vec<(NodeId, f32)>);

impl NodeWeights {
    /// Forgets all nodes.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a node.
    pub fn push(&mut self, node: NodeId, weight: f32) {
        self.0.push((node, weight));
    }

    /// The nodes and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, f32)> + '_ {
        self.0.iter().copied()
    }
}

/// A place where light is measured.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Where rays start: on the surface, pushed off it along its geometric normal.
    pub origin: Vec3,
    /// The hemisphere that is measured, in world space.
    pub frame: Frame,
    /// The traced triangle the site lies on, which rays from here do not see.
    pub skip: Option<TriId>,
}

/// How an element's light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// At one point: all rays of an element share an origin.
    AtPoint,
    /// Over an area: every ray has an origin of its own.
    OverArea,
}

/// Where light is measured, and which nodes a measurement counts towards.
pub trait Receivers: Send + Sync {
    /// Number of coefficients.
    fn node_count(&self) -> usize;

    /// Number of elements.
    fn element_count(&self) -> usize;

    /// How elements are measured.
    fn measure(&self) -> Measure;

    /// A place of element `e`, chosen by `u` in the unit square when elements have an area.
    ///
    /// Adds the nodes that a measurement there counts towards, and how much. A node's value is the mean of all its
    /// measurements by weight, so weights need no common scale.
    fn receiver(&self, e: ElementId, u: [f32; 2], counts_towards: &mut NodeWeights) -> Site;
}

/// Where light is stored on the surfaces of a scene.
pub trait Basis: Receivers {
    /// Adds the nodes whose weighted sum rebuilds a field at a surface point. Weights sum to 1.
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights);

    /// The nodes at a triangle's corners, if every field is linear over triangles.
    fn corner_nodes(&self, tri: TriId) -> Option<[NodeId; 3]> {
        let _ = tri;
        None
    }

    /// The area each node stands for, m²: the integral of its basis function.
    fn node_areas(&self) -> Vec<f32>;

    /// Gives nodes that could not be measured the mean of their measured neighbours, ring by ring.
    ///
    /// Nodes that no measured node is connected to become zero.
    fn fill(&self, field: &mut Field, known: &[bool]);

    /// The node of every vertex of the scene, for bases that are read at vertices.
    fn node_of_vertex(&self) -> &[NodeId];
}
