//! The reference tracer: tries every triangle.

use crate::ray::{Hit, Ray, RayTracer};
use crate::triangle::ShearedRay;
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint, TriId};

/// Tries every triangle with the same test as [`Bvh`](crate::Bvh): slow, and simple enough to be right.
#[derive(Clone, Debug)]
pub struct BruteForce {
    corners: Vec<[Vec3; 3]>,
}

impl BruteForce {
    /// A tracer over the traced triangles of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self::from_corners(
            (0..scene.traced_count() as u32).map(|t| scene.triangle_positions(TriId(t))).collect(),
        )
    }

    /// A tracer over triangles given by their corners.
    pub fn from_corners(corners: Vec<[Vec3; 3]>) -> Self {
        Self { corners }
    }
}

impl RayTracer for BruteForce {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let sheared = ShearedRay::new(ray.origin, ray.direction)?;
        let mut closest: Option<Hit> = None;
        for (i, corners) in self.corners.iter().enumerate() {
            let tri = TriId(i as u32);
            let t_max = closest.map_or(ray.t_max, |hit| hit.t);
            if ray.skip == Some(tri) {
                continue;
            }
            // Going up in number, a hit must be strictly closer to replace one.
            if let Some(hit) = sheared.intersect(corners, t_max).filter(|hit| hit.t < t_max) {
                closest = Some(Hit { t: hit.t, at: SurfacePoint { tri, bary: hit.bary }, side: hit.side });
            }
        }
        closest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.closest_hit(ray).is_some()
    }
}
