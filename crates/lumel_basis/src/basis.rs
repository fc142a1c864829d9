//! A space of functions on the surfaces.

use crate::{Adjacency, Field, Identity, NodeId, NodeWeights};
use lumel_scene::{Irradiance, SurfacePoint};
use std::ops::Range;

/// A space of functions on the surfaces of a scene: what the coefficients of a [`Field`](crate::Field) mean.
///
/// It measures nothing: that is the part of [`Receivers`](crate::Receivers), which may count towards the nodes of a basis or
/// of none. Every implementation keeps these laws:
///
/// - The weights at a point sum to 1, so constants are reproduced; on each level of a [hierarchy](Self::hierarchy).
/// - `node_areas` is the integral of each basis function, so they sum to the area of the surfaces, on each level.
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

    /// What turns values at its nodes into coefficients, where these are not the same.
    fn hierarchy(&self) -> Option<&dyn Hierarchy> {
        None
    }

    /// Another basis, which holds direct light where this one would blur the edges of its shadows: surfaces reflect it from there.
    fn direct(&self) -> Option<&dyn Basis> {
        None
    }

    /// How far apart the places are, metres, by which its functions are integrated well enough; infinite if a few in each triangle do.
    fn resolution(&self) -> f32 {
        f32::INFINITY
    }
}

/// What bases of several levels know besides, of which each corrects what the coarser ones say.
///
/// A field of values at the nodes is measured; its coefficients are what its values differ from the coarser levels by. The weights of a
/// place sum to 1 on each level; a constant has coefficients at the coarsest level alone.
pub trait Hierarchy: Basis {
    /// Replaces values at the nodes by coefficients. Those that are not `known`, if they are not all, have none: zero.
    fn analyze(&self, field: &mut Field, known: Option<&[bool]>);

    /// The number of levels; 0 is the coarsest.
    fn level_count(&self) -> u32;

    /// The nodes of a level.
    fn nodes_of_level(&self, level: u32) -> Range<u32>;

    /// The nodes of the next level that what is marked of a level says something about: those that it overlaps.
    fn finer(&self, level: u32, marked: &[bool]) -> Vec<NodeId>;

    /// Adds the nodes of the coarsest levels up to one, with their weights at a surface point: what is read from afar.
    fn weights_up_to(&self, level: u32, at: SurfacePoint, weights: &mut NodeWeights);
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
