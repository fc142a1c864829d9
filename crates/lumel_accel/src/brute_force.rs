//! The reference tracer: tries every triangle.

use crate::ray::{Hit, Ray, RayTracer};
use crate::triangle::{intersect, is_traceable};
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint, TriId};

/// Tries every triangle with the same test as [`Bvh`](crate::Bvh): slow, and simple enough to be right.
///
/// It decides every case exactly, where `Bvh` does so only near the edges.
#[derive(Clone, Debug)]
pub struct BruteForce {
    corners: Vec<[Vec3; 3]>,
}

impl BruteForce {
    /// A tracer over the traced triangles of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self::from_corners(scene.traced_corners())
    }

    /// A tracer over triangles given by their corners.
    pub fn from_corners(corners: Vec<[Vec3; 3]>) -> Self {
        Self { corners }
    }
}

impl RayTracer for BruteForce {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        if !is_traceable(ray.origin, ray.direction) {
            return None;
        }
        let mut closest: Option<Hit> = None;
        for (i, corners) in self.corners.iter().enumerate() {
            let tri = TriId(i as u32);
            // Going up in number, a hit must be strictly closer to replace one.
            let limit = closest.map_or(ray.t_max, |hit| hit.t).next_down();
            if ray.skip == Some(tri) {
                continue;
            }
            if let Some(hit) = intersect(corners, ray.origin, ray.direction, limit) {
                closest = Some(Hit { t: hit.t, at: SurfacePoint { tri, bary: hit.bary() }, side: hit.side });
            }
        }
        closest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.closest_hit(ray).is_some()
    }
}
