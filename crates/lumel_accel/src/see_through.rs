//! The tracer of scenes in which light passes through surfaces.
//!
//! Two trees: opaque triangles are traced as in any scene, in bundles; then the others are looked for in front of what
//! was found, ray by ray where there are any.

use crate::bvh::Bvh;
use crate::ray::{Bundle, Hit, Layer, Ray, RayTracer};
use crate::refined::Refined;
use crate::simd::InstructionSet;
use crate::triangle::owns;
use glam::Vec3;
use lumel_sample::unit_hash;
use lumel_scene::Scene;
use std::sync::Arc;

/// Rays that are handed to the kernels at once.
const BLOCK: usize = 64;

/// Weights of corners below this may be those of an edge: rounding errs by much less.
const NEAR_EDGE: f32 = 1e-3;

/// The tracer for a scene: [`SeeThrough`] if light passes through any of its surfaces, a [`Bvh`] if not, and [`Refined`] over
/// either if the scene was refined.
pub fn tracer_of(scene: &Scene) -> Arc<dyn RayTracer> {
    if let Some(original) = scene.original() {
        return Arc::new(Refined::new(tracer_of(&original), scene.clone()));
    }
    if scene.has_transparent() { Arc::new(SeeThrough::build(scene)) } else { Arc::new(Bvh::build(scene)) }
}

/// Traces a scene in which light passes through some triangles.
#[derive(Clone, Debug)]
pub struct SeeThrough {
    opaque: Bvh,
    /// Over the transparent triangles alone.
    transparent: Bvh,
    /// Says what passes where.
    scene: Scene,
}

impl SeeThrough {
    /// Builds the trees over the traced triangles of a scene, on the threads of the caller's rayon pool.
    pub fn build(scene: &Scene) -> Self {
        Self {
            opaque: Bvh::over(scene, |tri| !scene.is_transparent(tri)),
            transparent: Bvh::over(scene, |tri| scene.is_transparent(tri)),
            scene: scene.clone(),
        }
    }

    /// The same, traced with other instructions; `None` if this machine lacks them.
    pub fn with_instructions(self, instructions: InstructionSet) -> Option<Self> {
        let opaque = self.opaque.with_instructions(instructions)?;
        Some(Self { opaque, transparent: self.transparent.with_instructions(instructions)?, ..self })
    }

    /// What passes through a surface that a ray meets. All, if the ray is on an edge that belongs to a neighbour.
    fn passes(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        let transmittance = self.scene.transmittance(hit.at);
        let [u, v, w] = hit.at.bary.weights();
        let counts = transmittance == Vec3::ZERO
            || u.min(v).min(w) > NEAR_EDGE
            || owns(&self.scene.triangle_positions(hit.at.tri), ray.origin, ray.direction);
        if counts { transmittance } else { Vec3::ONE }
    }

    /// Whether a ray ends where it meets a surface.
    fn ends(&self, ray: &Ray, hit: &Hit) -> bool {
        let opacity = 1.0 - self.passes(ray, hit).element_sum() / 3.0;
        let chance = || {
            let [a, b, c] = ray.origin.to_array().map(f32::to_bits);
            let [d, e, f] = ray.direction.to_array().map(f32::to_bits);
            unit_hash(&[a, b, c, d, e, f, hit.at.tri.0])
        };
        opacity >= 1.0 || (opacity > 0.0 && chance() < opacity)
    }

    /// Where a ray ends of which an opaque surface is met at `closest`.
    fn nearer(&self, ray: &Ray, mut closest: Option<Hit>) -> Option<Hit> {
        let ray = before(ray, closest.as_ref());
        let first =
            |closest: &Option<Hit>| closest.map_or((f32::INFINITY, u32::MAX), |hit| (hit.t, hit.at.tri.0));
        let mut limit = ray.t_max.next_down();
        self.transparent.cross(&ray, &mut |hit| {
            if (hit.t, hit.at.tri.0) < first(&closest) && self.ends(&ray, &hit) {
                closest = Some(hit);
                limit = hit.t;
            }
            limit
        });
        closest
    }

    /// The share of light that transparent surfaces let through.
    fn filtered(&self, ray: &Ray) -> Vec3 {
        let (mut passed, mut limit) = (Vec3::ONE, ray.t_max.next_down());
        self.transparent.cross(ray, &mut |hit| {
            passed *= self.passes(ray, &hit);
            if passed == Vec3::ZERO {
                limit = f32::NEG_INFINITY;
            }
            limit
        });
        passed
    }

    /// Goes on with those of up to [`BLOCK`] rays that meet a transparent surface.
    fn each_crossing(&self, rays: &[Ray], mut each: impl FnMut(usize)) {
        let mut crosses = [false; BLOCK];
        self.transparent.occlusions_of(rays, &mut crosses[..rays.len()]);
        crosses.iter().enumerate().filter(|(_, crosses)| **crosses).for_each(|(i, _)| each(i));
    }

    fn refine(&self, count: usize, ray: impl Fn(usize) -> Ray, hits: &mut [Option<Hit>]) {
        for first in (0..count).step_by(BLOCK) {
            let block = first..count.min(first + BLOCK);
            let mut rays = [ray(first); BLOCK];
            for (before_hit, i) in rays.iter_mut().zip(block.clone()) {
                *before_hit = before(&ray(i), hits[i].as_ref());
            }
            self.each_crossing(&rays[..block.len()], |k| {
                let i = first + k;
                hits[i] = self.nearer(&ray(i), hits[i]);
            });
        }
    }

    fn filter(&self, rays: &[Ray], occluded: &[bool], passed: &mut [Vec3]) {
        for (passed, &occluded) in passed.iter_mut().zip(occluded) {
            *passed = if occluded { Vec3::ZERO } else { Vec3::ONE };
        }
        self.each_crossing(rays, |i| {
            if !occluded[i] {
                passed[i] = self.filtered(&rays[i]);
            }
        });
    }
}

/// The part of a ray up to a hit and with it, so that a tie can go to the lower triangle.
fn before(ray: &Ray, hit: Option<&Hit>) -> Ray {
    Ray { t_max: hit.map_or(ray.t_max, |hit| hit.t.next_up()), ..*ray }
}

impl RayTracer for SeeThrough {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.nearer(ray, self.opaque.closest_hit(ray))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.transmittance(ray) == Vec3::ZERO
    }

    fn is_see_through(&self) -> bool {
        true
    }

    fn transmittance(&self, ray: &Ray) -> Vec3 {
        if self.opaque.occluded(ray) { Vec3::ZERO } else { self.filtered(ray) }
    }

    fn layers(&self, ray: &Ray, layers: &mut Vec<Layer>) {
        layers.clear();
        let opaque = self.opaque.closest_hit(ray);
        layers.extend(opaque.map(|hit| Layer { hit, transmittance: Vec3::ZERO }));
        let ray = before(ray, opaque.as_ref());
        let mut limit = ray.t_max.next_down();
        self.transparent.cross(&ray, &mut |hit| {
            let transmittance = self.passes(&ray, &hit);
            if transmittance != Vec3::ONE {
                layers.push(Layer { hit, transmittance });
            }
            if transmittance == Vec3::ZERO {
                limit = hit.t;
            }
            limit
        });
        layers.sort_by(|a, b| (a.hit.t.total_cmp(&b.hit.t)).then(a.hit.at.tri.cmp(&b.hit.at.tri)));
        let n_seen =
            layers.iter().position(|layer| layer.transmittance == Vec3::ZERO).map_or(layers.len(), |i| i + 1);
        layers.truncate(n_seen);
    }

    fn closest_hits(&self, bundle: &Bundle<'_>, hits: &mut [Option<Hit>]) {
        self.opaque.closest_hits(bundle, hits);
        self.refine(hits.len(), |i| bundle.ray(i), hits);
    }

    fn closest_hits_of(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.opaque.closest_hits_of(rays, hits);
        self.refine(hits.len(), |i| rays[i], hits);
    }

    fn occlusions_of(&self, rays: &[Ray], occluded: &mut [bool]) {
        let mut passed = [Vec3::ZERO; BLOCK];
        for (rays, occluded) in rays.chunks(BLOCK).zip(occluded.chunks_mut(BLOCK)) {
            self.transmittances_of(rays, &mut passed[..rays.len()]);
            occluded.iter_mut().zip(passed).for_each(|(occluded, passed)| *occluded = passed == Vec3::ZERO);
        }
    }

    fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
        let mut passed = [Vec3::ZERO; BLOCK];
        for (directions, occluded) in bundle.directions.chunks(BLOCK).zip(occluded.chunks_mut(BLOCK)) {
            self.transmittances(&Bundle { directions, ..*bundle }, &mut passed[..directions.len()]);
            occluded.iter_mut().zip(passed).for_each(|(occluded, passed)| *occluded = passed == Vec3::ZERO);
        }
    }

    fn transmittances_of(&self, rays: &[Ray], passed: &mut [Vec3]) {
        let mut occluded = [false; BLOCK];
        for (rays, passed) in rays.chunks(BLOCK).zip(passed.chunks_mut(BLOCK)) {
            let occluded = &mut occluded[..rays.len()];
            self.opaque.occlusions_of(rays, occluded);
            self.filter(rays, occluded, passed);
        }
    }

    fn transmittances(&self, bundle: &Bundle<'_>, passed: &mut [Vec3]) {
        let mut occluded = [false; BLOCK];
        for (directions, passed) in bundle.directions.chunks(BLOCK).zip(passed.chunks_mut(BLOCK)) {
            let (part, occluded) = (Bundle { directions, ..*bundle }, &mut occluded[..directions.len()]);
            self.opaque.occlusions(&part, occluded);
            let mut rays = [part.ray(0); BLOCK];
            rays.iter_mut().enumerate().take(directions.len()).for_each(|(i, ray)| *ray = part.ray(i));
            self.filter(&rays[..directions.len()], occluded, passed);
        }
    }
}
