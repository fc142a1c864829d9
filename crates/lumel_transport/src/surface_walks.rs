//! What stands in the way of walks over surfaces.

use glam::Vec3;
use lumel_accel::{Ray, RayTracer};
use lumel_basis::{Obstacle, Obstacles, SurfaceSample};
use lumel_scene::{Scene, SurfacePoint};

/// Surfaces that a walk goes on over, before what is left of it counts as free: bumps, and facets of what is hollow.
const STEPS: usize = 4;

/// A walk goes on over what it meets if the cosine between its normal and that of the start is more than this (60°): steeper surfaces
/// stand in the way.
const CONTINUES: f32 = 0.5;

/// Walks over the surfaces of a scene, as its rays find them.
pub struct SurfaceWalks<'a> {
    /// The surfaces.
    pub scene: &'a Scene,
    /// Finds what stands on them.
    pub tracer: &'a dyn RayTracer,
}

impl SurfaceWalks<'_> {
    /// The place of a surface that is within a distance of a position and faces the same way, metres.
    pub fn surface_at(&self, position: Vec3, normal: Vec3, within: f32) -> Option<SurfacePoint> {
        let down = Ray { t_max: 2.0 * within, ..Ray::new(position + within * normal, -normal) };
        let hit = self.tracer.closest_hit(&down)?;
        self.scene.seen_side(hit.at, hit.side)
    }
}

impl Obstacles for SurfaceWalks<'_> {
    fn first(&self, from: &SurfaceSample, toward: Vec3, lift: f32, reach: f32) -> Option<Obstacle> {
        let start = self.scene.geometric_normal(from.at.tri);
        let (mut at, mut normal, mut walked) = (from.at, start, 0.0);
        for _ in 0..STEPS {
            let direction = toward.reject_from_normalized(normal).try_normalize()?;
            let low = self.scene.ray_origin(at);
            let skip = Some(self.scene.traced(at.tri));
            let up = Ray { t_max: lift, skip, ..Ray::new(low, normal) };
            // Under something that lies flat on the surface.
            let height = self.tracer.closest_hit(&up).map_or(lift, |hit| 0.5 * hit.t);
            let along = Ray { t_max: reach - walked, skip, ..Ray::new(low + normal * height, direction) };
            let hit = self.tracer.closest_hit(&along)?;
            walked += hit.t;
            let seen = self.scene.seen_side(hit.at, hit.side);
            let Some(next) = seen.filter(|seen| self.scene.geometric_normal(seen.tri).dot(start) > CONTINUES)
            else {
                return Some(Obstacle { distance: walked, normal: self.scene.geometric_normal(hit.at.tri) });
            };
            (at, normal) = (next, self.scene.geometric_normal(next.tri));
        }
        None
    }
}
