//! The bounding volume hierarchy and its traversal.

mod build;

use crate::ray::{Hit, Ray, RayTracer};
use crate::triangle::ShearedRay;
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint, TriId};

/// A binary tree of boxes in one flat array; immutable after it is built.
///
/// A node holds the boxes of both children, so that a step down the tree touches one cache line. Built by the
/// surface area heuristic over binned centroids: Wald, *On fast Construction of SAH-based Bounding Volume
/// Hierarchies*, 2007.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    root: Child,
    triangles: Vec<LeafTriangle>,
}

/// The two children of an inner node.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Node {
    bounds: [Aabb; 2],
    children: [Child; 2],
}

#[derive(Clone, Copy, Debug)]
struct Aabb {
    min: Vec3,
    max: Vec3,
}

/// An inner node (`count == 0`) or a run of leaf triangles.
#[derive(Clone, Copy, Debug)]
struct Child {
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
        size_of_val(self.nodes.as_slice()) + size_of_val(self.triangles.as_slice())
    }

    /// Visits leaves front to back until `visit` has shortened the ray to nothing.
    ///
    /// `visit` gets a leaf's triangles and the current end of the ray, and returns the new end.
    #[inline]
    fn traverse(&self, ray: &Ray, mut visit: impl FnMut(&[LeafTriangle], f32) -> f32) {
        let slabs = Slabs::new(ray);
        let mut t_max = ray.t_max;
        let mut stack = [(Child { first: 0, count: 0 }, 0.0f32); build::MAX_DEPTH];
        let mut depth = 0;
        let mut current = self.root;
        loop {
            if current.count > 0 {
                let first = current.first as usize;
                t_max = visit(&self.triangles[first..first + current.count as usize], t_max);
            } else if let Some(node) = self.nodes.get(current.first as usize) {
                let near = [slabs.enter(&node.bounds[0], t_max), slabs.enter(&node.bounds[1], t_max)];
                match near {
                    [Some(a), Some(b)] => {
                        let (first, second, t) = if a <= b { (0, 1, b) } else { (1, 0, a) };
                        stack[depth] = (node.children[second], t);
                        depth += 1;
                        current = node.children[first];
                        continue;
                    }
                    [Some(_), None] => {
                        current = node.children[0];
                        continue;
                    }
                    [None, Some(_)] => {
                        current = node.children[1];
                        continue;
                    }
                    [None, None] => {}
                }
            }
            // What lies exactly at t_max is still visited: a tie may be won by a lower triangle.
            loop {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                let (child, t) = stack[depth];
                if t <= t_max {
                    current = child;
                    break;
                }
            }
        }
    }
}

/// A ray prepared for box tests.
struct Slabs {
    origin: Vec3,
    inverse: Vec3,
}

impl Slabs {
    fn new(ray: &Ray) -> Self {
        let away_from_zero =
            |d: f32| if d.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION.copysign(d) } else { d };
        let d = ray.direction;
        let clamped = Vec3::new(away_from_zero(d.x), away_from_zero(d.y), away_from_zero(d.z));
        Self { origin: ray.origin, inverse: clamped.recip() }
    }

    /// Where the ray enters a box, if it does before `t_max`.
    #[inline]
    fn enter(&self, bounds: &Aabb, t_max: f32) -> Option<f32> {
        // Subtract first: a fused lo * inverse - o * inverse loses rays far from the origin.
        let a = (bounds.min - self.origin) * self.inverse;
        let b = (bounds.max - self.origin) * self.inverse;
        let near = a.min(b).max_element().max(0.0);
        let far = (a.max(b).min_element() * FAR_PADDING).min(t_max);
        (near <= far).then_some(near)
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
