//! From the triangles of a scene to those of its refined one, and back.

use super::parts::Part;
use crate::face_list::FaceList;
use crate::{Barycentrics, Scene, SurfacePoint, TriId};
use std::sync::Arc;

/// Points between the corners of a triangle are told apart to so many steps: as finely as stored rays are, so that rays that
/// were stored before a refinement lead to the same points after it as those that are stored then.
const STEPS: f32 = u16::MAX as f32;

/// How the triangles of a [refined](Scene::refined) scene lie in those of the scene that it was made from.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// The faces of that scene.
    pub(super) given: Arc<FaceList>,
    pub(super) splits: Vec<[u32; 2]>,
    /// The node of each triangle that rays meet.
    pub(super) roots: Vec<u32>,
    pub(super) nodes: Vec<Node>,
    /// Where each new triangle lies, and its path among the parts of its triangle.
    pub(super) parts: Vec<(Part, u64)>,
    /// The first part of each original triangle.
    pub(super) first_of: Vec<u32>,
}

/// A triangle and what became of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// The edge that is split, by the corner that it begins at; or [`LEAF`](Self::LEAF), plus how far a triangle is turned.
    kind: u8,
    turns: u8,
    /// The first of its halves, or the triangle.
    index: u32,
}

impl Node {
    const LEAF: u8 = 3;
    /// Of triangles that rays do not meet.
    pub(super) const NONE: Self = Self::leaf(u32::MAX);

    pub(super) const fn leaf(index: u32) -> Self {
        Self { kind: Self::LEAF, turns: 0, index }
    }

    pub(super) fn split(edge: usize, halves: u32) -> Self {
        Self { kind: edge as u8, turns: 0, index: halves }
    }

    /// How a leaf is turned and which one it is.
    pub(super) fn leaf_mut(&mut self) -> Option<(&mut u8, &mut u32)> {
        (self.kind == Self::LEAF && self.index != u32::MAX).then_some((&mut self.turns, &mut self.index))
    }
}

impl Refinement {
    /// The vertices at the ends of each split edge, in the order of the vertices in their middle.
    pub fn splits(&self) -> &[[u32; 2]] {
        &self.splits
    }

    /// The triangle of the original scene that a triangle is a part of, and where its corners lie on that.
    pub fn part(&self, tri: TriId) -> &Part {
        &self.parts[tri.index()].0
    }

    /// A number for the sample points of a triangle: its own as long as it is whole, and one of its parts' own for each of
    /// those. It does not depend on what else is split.
    pub fn stream(&self, tri: TriId) -> u32 {
        let (part, path) = &self.parts[tri.index()];
        if *path == 1 {
            return part.tri.0;
        }
        // The finalizer of SplitMix64 (Steele, Lea, Flood 2014): two triangles may share a number, but hardly any two
        // neighbours do.
        let mut x = path.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(part.tri.0);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 32) as u32
    }

    pub(crate) fn given(&self) -> &Arc<FaceList> {
        &self.given
    }

    /// The new triangle that an original one is, if it was not split.
    pub(crate) fn unsplit(&self, tri: TriId) -> Option<TriId> {
        let other = self.given.other_side[tri.index()];
        let node = self.nodes[self.roots[tri.min(other).index()] as usize];
        (node.kind == Node::LEAF).then_some(TriId(self.first_of[tri.index()]))
    }

    /// The point on the original triangle.
    #[inline]
    pub fn original(&self, at: SurfacePoint) -> SurfacePoint {
        self.part(at.tri).at(at.bary.weights())
    }

    /// The new triangle at a point of an original one that rays meet, rounded to a 65535th of that triangle.
    #[inline]
    pub fn traced_point(&self, at: SurfacePoint) -> SurfacePoint {
        let step = |weight: f32| (weight * STEPS).round().clamp(0.0, STEPS) as i32;
        let u = step(at.bary.u);
        let v = step(at.bary.v).min(i32::from(u16::MAX) - u);
        let mut weights = [u, v, i32::from(u16::MAX) - u - v];
        let mut node = self.nodes[self.roots[at.tri.index()] as usize];
        while node.kind != Node::LEAF {
            let (a, b) = (node.kind as usize, (node.kind as usize + 1) % 3);
            // The point is nearer to one end of the edge: what both ends share is that of the middle.
            let is_last = weights[a] > weights[b];
            let (end, shared) = if is_last { (a, b) } else { (b, a) };
            weights[end] -= weights[shared];
            weights[shared] *= 2;
            node = self.nodes[node.index as usize + usize::from(is_last)];
        }
        weights.rotate_left(node.turns.into());
        let bary = Barycentrics { u: weights[0] as f32 / STEPS, v: weights[1] as f32 / STEPS };
        SurfacePoint { tri: TriId(node.index), bary }
    }

    fn new_point(&self, at: SurfacePoint, refined: &FaceList) -> SurfacePoint {
        let other = self.given.other_side[at.tri.index()];
        if other >= at.tri {
            return self.traced_point(at);
        }
        let swapped = |at: SurfacePoint| Barycentrics { u: at.bary.v, v: at.bary.u };
        let front = self.traced_point(SurfacePoint { tri: other, bary: swapped(at) });
        SurfacePoint { tri: refined.other_side[front.tri.index()], bary: swapped(front) }
    }
}

impl Scene {
    /// The point of this scene at a point of the scene that it was [refined](Self::refined) from; the same point if it was
    /// not.
    pub fn refined_point(&self, original: SurfacePoint) -> SurfacePoint {
        self.refinement().map_or(original, |refinement| refinement.new_point(original, self.faces()))
    }
}
