//! The bounding volume hierarchy and its traversal.

mod build;

use crate::ray::{Hit, Ray, RayTracer};
use crate::triangle::ShearedRay;
use glam::{Vec3, Vec4};
use lumel_scene::{Scene, SurfacePoint, TriId};

/// Children of a node: as many boxes as the vector registers of any machine test at once.
const WIDTH: usize = 4;

/// A tree of boxes in one flat array; immutable after it is built.
///
/// A node holds the boxes of its four children by coordinate, so that they are tested side by side. Built
/// as a binary tree by the surface area heuristic over binned centroids (Wald, *On fast Construction of SAH-based
/// Bounding Volume Hierarchies*, 2007) and then collapsed.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    root: Child,
    triangles: Vec<LeafTriangle>,
}

/// The boxes of four children, by axis, and the children. Missing ones have boxes that no ray meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Node {
    /// Smallest and largest coordinates on each axis.
    bounds: [[Vec4; 2]; 3],
    children: [Child; WIDTH],
}

/// The index of an inner node, or with the highest bit set that of a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }
}

/// A run of triangles.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    first: u32,
    count: u32,
}

#[derive(Clone, Copy, Debug)]
struct LeafTriangle {
    corners: [Vec3; 3],
    tri: TriId,
}

/// The far ends of boxes are pushed out by this factor, 2γ(3) of Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013:
/// three rounded operations must not lose a ray between a box and the triangles in it.
const FAR_PADDING: f32 = 1.0 + 2.0 * (3.0 * UNIT_ROUNDOFF / (1.0 - 3.0 * UNIT_ROUNDOFF));
const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Components of directions are kept this far from zero, so that no slab distance is 0 · ∞.
const SMALLEST_DIRECTION: f32 = 1e-18;

/// The most nodes that may wait to be visited. A tree that would need more is built anew, balanced: then 28 levels
/// hold 2^28 leaves, and a step down leaves three siblings behind.
const MAX_STACK: usize = 96;

impl Bvh {
    /// Builds the tree over the traced triangles of a scene, on the threads of the caller's rayon pool.
    ///
    /// The result does not depend on their number.
    pub fn build(scene: &Scene) -> Self {
        Self::from_corners(
            (0..scene.traced_count() as u32).map(|t| scene.triangle_positions(TriId(t))).collect(),
        )
    }

    /// Builds the tree over triangles given by their corners.
    pub fn from_corners(corners: Vec<[Vec3; 3]>) -> Self {
        build::build(&corners)
    }

    /// Number of inner nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Bytes of memory held.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.triangles.as_slice())
    }

    /// Visits leaves front to back until `visit` has shortened the ray to nothing.
    ///
    /// `visit` gets a leaf's triangles and the current end of the ray, and returns the new end.
    #[inline]
    fn traverse(&self, ray: &Ray, mut visit: impl FnMut(&[LeafTriangle], f32) -> f32) {
        let slabs = Slabs::new(ray);
        let mut t_max = ray.t_max;
        let mut stack = Stack { entries: [(Child::default(), 0.0); MAX_STACK], len: 0 };
        let mut current = self.root;
        loop {
            if current.0 & Child::LEAF != 0 {
                let leaf = self.leaves[(current.0 & !Child::LEAF) as usize];
                let first = leaf.first as usize;
                t_max = visit(&self.triangles[first..first + leaf.count as usize], t_max);
            } else if let Some(node) = self.nodes.get(current.0 as usize) {
                let near = slabs.enter(node, t_max);
                let bottom = stack.len;
                for (child, t) in node.children.iter().zip(near) {
                    if t < f32::INFINITY {
                        stack.push_above(bottom, *child, t);
                    }
                }
            }
            // What lies exactly at t_max is still visited: a tie may be won by a lower triangle.
            current = loop {
                match stack.pop() {
                    None => return,
                    Some((child, t)) if t <= t_max => break child,
                    Some(_) => {}
                }
            };
        }
    }
}

/// Nodes still to be visited, and where the ray enters them.
struct Stack {
    entries: [(Child, f32); MAX_STACK],
    len: usize,
}

impl Stack {
    /// Pushes a child so that those above `bottom` come off the nearest first.
    #[inline]
    fn push_above(&mut self, bottom: usize, child: Child, t: f32) {
        let mut slot = self.len;
        while slot > bottom && self.entries[slot - 1].1 < t {
            self.entries[slot] = self.entries[slot - 1];
            slot -= 1;
        }
        self.entries[slot] = (child, t);
        self.len += 1;
    }

    #[inline]
    fn pop(&mut self) -> Option<(Child, f32)> {
        self.len = self.len.checked_sub(1)?;
        Some(self.entries[self.len])
    }
}

/// A ray prepared for box tests.
struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Which of a box's two sides on each axis the ray meets first.
    first: [usize; 3],
}

impl Slabs {
    fn new(ray: &Ray) -> Self {
        let away_from_zero =
            |d: f32| if d.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION.copysign(d) } else { d };
        let inverse = ray.direction.to_array().map(|d| 1.0 / away_from_zero(d));
        Self { origin: ray.origin.to_array(), inverse, first: inverse.map(|i| usize::from(i < 0.0)) }
    }

    /// Where the ray enters each child's box; infinity where it does not before `t_max`.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> [f32; WIDTH] {
        let (mut near, mut far) = (Vec4::ZERO, Vec4::INFINITY);
        for axis in 0..3 {
            let [first, last] = [self.first[axis], 1 - self.first[axis]].map(|side| node.bounds[axis][side]);
            // Subtract first: a fused lo * inverse - o * inverse loses rays far from the origin.
            near = near.max((first - self.origin[axis]) * self.inverse[axis]);
            far = far.min((last - self.origin[axis]) * self.inverse[axis]);
        }
        let entered = near.cmple((far * FAR_PADDING).min(Vec4::splat(t_max)));
        Vec4::select(entered, near, Vec4::INFINITY).to_array()
    }
}

impl RayTracer for Bvh {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let sheared = ShearedRay::new(ray.origin, ray.direction)?;
        let mut closest: Option<Hit> = None;
        self.traverse(ray, |triangles, mut t_max| {
            for triangle in triangles {
                let Some(hit) = sheared.intersect(&triangle.corners, t_max) else { continue };
                let wins = closest.map_or(hit.t < t_max, |c| hit.t < c.t || triangle.tri < c.at.tri);
                if wins && ray.skip != Some(triangle.tri) {
                    t_max = hit.t;
                    let at = SurfacePoint { tri: triangle.tri, bary: hit.bary };
                    closest = Some(Hit { t: hit.t, at, side: hit.side });
                }
            }
            t_max
        });
        closest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let Some(sheared) = ShearedRay::new(ray.origin, ray.direction) else { return false };
        let mut blocked = false;
        self.traverse(ray, |triangles, t_max| {
            let hits = |triangle: &LeafTriangle| {
                sheared.intersect(&triangle.corners, t_max).is_some_and(|hit| hit.t < ray.t_max)
                    && ray.skip != Some(triangle.tri)
            };
            if triangles.iter().any(hits) {
                blocked = true;
                return f32::NEG_INFINITY;
            }
            t_max
        });
        blocked
    }
}
