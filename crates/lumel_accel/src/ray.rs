//! Rays, hits and the tracer's interface.

use glam::Vec3;
use lumel_scene::{FaceSide, SurfacePoint, TriId};

/// Where a shadow ray to a point stops, as a share of the way.
///
/// The last ten-thousandth is left out because the point lies on a surface that may be geometry itself, and neither
/// it nor a neighbour in the same plane must shadow it.
pub const SHADOW_END: f32 = 1.0 - 1e-4;

/// A ray from `origin` along `direction`, up to and without `t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts, in world space; pushed off its surface as [`RayOrigins`](lumel_scene::RayOrigins) are.
    pub origin: Vec3,
    /// Where it goes; of any length, in whose units `t` is measured.
    pub direction: Vec3,
    /// Where it ends.
    pub t_max: f32,
    /// A triangle that it does not see: the one it starts on.
    pub skip: Option<TriId>,
}

impl Ray {
    /// A ray without end.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY, skip: None }
    }

    /// The segment from `origin` to just before `target`, for asking whether one sees the other.
    pub fn between(origin: Vec3, target: Vec3) -> Self {
        Self { origin, direction: target - origin, t_max: SHADOW_END, skip: None }
    }

    /// The same ray, blind to a triangle.
    #[must_use]
    pub fn skipping(self, tri: TriId) -> Self {
        Self { skip: Some(tri), ..self }
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// The point, on a traced triangle.
    pub at: SurfacePoint,
    /// The side of that triangle which the ray sees.
    pub side: FaceSide,
}

/// A surface that a ray meets, and what passes through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Where.
    pub hit: Hit,
    /// The share of light that passes, 0..=1.
    pub transmittance: Vec3,
}

/// Many rays from one origin.
///
/// Traced fast when directions that follow each other are close to each other: in the order of the cells of their
/// sample points.
#[derive(Clone, Copy, Debug)]
pub struct Bundle<'a> {
    /// Where all rays start.
    pub origin: Vec3,
    /// Where each goes.
    pub directions: &'a [Vec3],
    /// Where they end, in lengths of their directions.
    pub t_max: f32,
    /// A triangle that none of them sees.
    pub skip: Option<TriId>,
}

impl Bundle<'_> {
    /// Ray number `i`.
    pub fn ray(&self, i: usize) -> Ray {
        Ray { origin: self.origin, direction: self.directions[i], t_max: self.t_max, skip: self.skip }
    }
}

/// Answers where rays meet the triangles of a scene.
///
/// Rays whose origin or direction is zero or not finite meet nothing.
///
/// Where light passes through surfaces, a ray ends at each of them with a probability, its
/// [opacity](lumel_scene::Scene::opacity): what is read where rays end is right in the mean. The ray itself decides, so
/// that it always ends in the same place, however it is traced. Segments to lights are not decided but multiplied:
/// [`transmittance`](Self::transmittance).
pub trait RayTracer: Send + Sync {
    /// The closest hit with `0 < t < t_max`; among equals the one of the lowest triangle.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether no light passes `0 < t < t_max`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// Whether light passes through any surface. If not, segments are occluded or free.
    fn is_see_through(&self) -> bool {
        false
    }

    /// The share of light that passes `0 < t < t_max`, 0..=1: the product over all surfaces there.
    fn transmittance(&self, ray: &Ray) -> Vec3 {
        if self.occluded(ray) { Vec3::ZERO } else { Vec3::ONE }
    }

    /// What a ray meets at `0 < t < t_max`, the nearest first, up to the first surface that lets nothing through.
    fn layers(&self, ray: &Ray, layers: &mut Vec<Layer>) {
        layers.clear();
        layers.extend(self.closest_hit(ray).map(|hit| Layer { hit, transmittance: Vec3::ZERO }));
    }

    /// The closest hits of a bundle; `hits` is as long as `bundle.directions`.
    fn closest_hits(&self, bundle: &Bundle<'_>, hits: &mut [Option<Hit>]) {
        for (i, hit) in hits.iter_mut().enumerate() {
            *hit = self.closest_hit(&bundle.ray(i));
        }
    }

    /// The closest hits of rays with origins of their own; `hits` is as long as `rays`.
    ///
    /// Fast when rays that follow each other start close together and go similar ways, such as one direction of many
    /// neighbours.
    fn closest_hits_of(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray);
        }
    }

    /// The occlusion of rays with origins of their own; `occluded` is as long as `rays`.
    ///
    /// Fast when rays that follow each other start close together and go similar ways.
    fn occlusions_of(&self, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(occluded) {
            *blocked = self.occluded(ray);
        }
    }

    /// The transmittance of rays with origins of their own; `passed` is as long as `rays`.
    fn transmittances_of(&self, rays: &[Ray], passed: &mut [Vec3]) {
        for (ray, passed) in rays.iter().zip(passed) {
            *passed = self.transmittance(ray);
        }
    }

    /// The transmittance of a bundle; `passed` is as long as `bundle.directions`.
    fn transmittances(&self, bundle: &Bundle<'_>, passed: &mut [Vec3]) {
        for (i, passed) in passed.iter_mut().enumerate() {
            *passed = self.transmittance(&bundle.ray(i));
        }
    }

    /// The occlusion of a bundle; `occluded` is as long as `bundle.directions`.
    fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
        for (i, blocked) in occluded.iter_mut().enumerate() {
            *blocked = self.occluded(&bundle.ray(i));
        }
    }
}
