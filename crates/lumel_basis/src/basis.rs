//! A space of functions on the surfaces.

use crate::{Adjacency, Identity};
use lumel_scene::SurfacePoint;

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

/// Nodes and their weights; kept between calls so that nothing is allocated per ray.
#[derive(Clone, Debug, Default)]
pub struct NodeWeights(Vec<(NodeId, f32)>);

impl NodeWeights {
    /// Removes all nodes.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a node.
    pub fn push(&mut self, node: NodeId, weight: f32) {
        self.0.push((node, weight));
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The nodes and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, f32)> + '_ {
        self.0.iter().copied()
    }
}

/// A space of functions on the surfaces of a scene: what the coefficients of a [`Field`](crate::Field) mean.
///
/// It measures nothing: that is the part of [`Receivers`](crate::Receivers), which may count towards the nodes of a basis or
/// of none. Every implementation keeps these laws:
///
/// - The weights at a point sum to 1, so constants are reproduced.
/// - `node_areas` is the integral of each basis function, so they sum to the area of the surfaces.
/// - `corner_nodes`, if there are any, agree with `weights_at` everywhere.
/// - `adjacency` is symmetric and has `node_count` nodes; the nodes of a triangle in `corner_nodes` are adjacent.
/// - `identity` is the same for the same geometry and construction and another one for any other.
///
/// `lumel_testkit::laws` checks them.
pub trait Basis: Send + Sync {
    /// What decides its nodes.
    fn identity(&self) -> Identity;

    /// Number of coefficients.
    fn node_count(&self) -> usize;

    /// Adds the nodes whose weighted sum is the value of a field at a surface point.
    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights);

    /// The nodes at the corners of each triangle, for bases that are linear over the triangles of the scene.
    ///
    /// A fast path: readers of many points use it in place of `weights_at`.
    fn corner_nodes(&self) -> Option<&[[NodeId; 3]]> {
        None
    }

    /// The integral of each basis function over the surfaces, m².
    fn node_areas(&self) -> &[f32];

    /// Which nodes are next to each other.
    fn adjacency(&self) -> &Adjacency;
}
