//! The bounding volume hierarchy.

mod aabb;
mod build;
mod collapse;
mod item;
mod node;

pub(crate) use build::MAX_STACK;
pub(crate) use node::{Block, Child, Node};

use crate::simd::InstructionSet;
use glam::Vec3;
use lumel_scene::{Scene, TriId};

/// A tree of boxes in one flat array; immutable after it is built.
///
/// A node holds the boxes of its eight children by coordinate, so that they are tested side by side; a leaf's
/// triangles are tested four at a time. Built as a binary tree by the surface area heuristic over binned centroids
/// (Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007), then collapsed to the wide tree that
/// costs a ray least, by dynamic programming over all ways to do so.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
    /// `None` for an empty scene.
    pub(crate) root: Option<Child>,
    pub(crate) instructions: InstructionSet,
}

impl Bvh {
    /// Builds the tree over the traced triangles of a scene, on the threads of the caller's rayon pool.
    ///
    /// The result does not depend on their number.
    pub fn build(scene: &Scene) -> Self {
        Self::from_corners(scene.traced_corners())
    }

    /// Builds the tree over those of the traced triangles that are `wanted`.
    pub(crate) fn over(scene: &Scene, wanted: impl Fn(TriId) -> bool) -> Self {
        let mut corners = scene.traced_corners();
        for (_, corners) in (0..).map(TriId).zip(&mut corners).filter(|(tri, _)| !wanted(*tri)) {
            *corners = Scene::UNTRACED;
        }
        Self::from_corners(corners)
    }

    /// Builds the tree over triangles given by their corners.
    pub fn from_corners(corners: Vec<[Vec3; 3]>) -> Self {
        let instructions = InstructionSet::best();
        match build::build(&corners) {
            Some(tree) => {
                Self { nodes: tree.nodes, blocks: tree.blocks, root: Some(tree.root), instructions }
            }
            None => Self { nodes: Vec::new(), blocks: Vec::new(), root: None, instructions },
        }
    }

    /// The same tree, traced with other instructions; `None` if this machine lacks them.
    ///
    /// A tree is built for the fastest that there are. All find the same hits, to the bit.
    pub fn with_instructions(self, instructions: InstructionSet) -> Option<Self> {
        instructions.is_available().then_some(Self { instructions, ..self })
    }

    /// The instructions it is traced with.
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// Number of inner nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Bytes of memory held.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }
}
