//! A space of functions on the surfaces.

use crate::{Adjacency, Field, Identity, NodeId, NodeWeights};
use lumel_scene::{Irradiance, SurfacePoint};

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

    /// How far apart the places are, metres, by which its functions are integrated well enough; infinite if a few in each triangle do.
    fn resolution(&self) -> f32 {
        f32::INFINITY
    }
}

impl Field {
    /// The irradiance at a surface point; `weights` is scratch space.
    #[inline]
    pub fn at<B: Basis + ?Sized>(
        &self,
        basis: &B,
        at: SurfacePoint,
        weights: &mut NodeWeights,
    ) -> Irradiance {
        weights.clear();
        basis.weights_at(at, weights);
        weights.iter().map(|(node, weight)| self.node(node) * weight).sum()
    }
}
