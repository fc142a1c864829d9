//! The tracer of refined scenes.

use crate::ray::{Bundle, Hit, Layer, Ray, RayTracer};
use glam::Vec3;
use lumel_scene::{Refinement, Scene, TriId};
use std::sync::Arc;

/// Rays that are handed on at once.
const BLOCK: usize = 64;

/// Traces the triangles that a scene was [refined](Scene::refined) from, and finds the parts of them that rays meet.
///
/// Whatever the refinement, the tree stays as it is. Points are rounded to a 65535th of the original triangle.
#[derive(Clone)]
pub struct Refined {
    original: Arc<dyn RayTracer>,
    scene: Scene,
}

impl Refined {
    /// The tracer of a refined scene, from that of the original.
    pub fn new(original: Arc<dyn RayTracer>, scene: Scene) -> Self {
        Self { original, scene }
    }

    /// The tracer of the original scene.
    pub fn original(&self) -> &Arc<dyn RayTracer> {
        &self.original
    }

    /// The original triangle of one that a ray does not see. As it is flat, no part of it is seen from there.
    fn skip(&self, skip: Option<TriId>) -> Option<TriId> {
        let Some(refinement) = self.scene.refinement() else { return skip };
        skip.map(|tri| refinement.part(tri).tri)
    }

    fn ray(&self, ray: &Ray) -> Ray {
        Ray { skip: self.skip(ray.skip), ..*ray }
    }

    fn bundle<'a>(&self, bundle: &Bundle<'a>) -> Bundle<'a> {
        Bundle { skip: self.skip(bundle.skip), ..*bundle }
    }

    /// Finds the parts that rays have met.
    fn refine<'a>(&self, hits: impl IntoIterator<Item = &'a mut Hit>) {
        let Some(refinement) = self.scene.refinement() else { return };
        let refine = |hit: &mut Hit| hit.at = Refinement::traced_point(refinement, hit.at);
        hits.into_iter().for_each(refine);
    }

    /// Hands on rays in blocks, as rays of the original.
    fn each_block<T>(&self, rays: &[Ray], results: &mut [T], mut trace: impl FnMut(&[Ray], &mut [T])) {
        let mut block = [Ray::new(Vec3::ZERO, Vec3::ZERO); BLOCK];
        for (rays, results) in rays.chunks(BLOCK).zip(results.chunks_mut(BLOCK)) {
            block.iter_mut().zip(rays).for_each(|(original, ray)| *original = self.ray(ray));
            trace(&block[..rays.len()], results);
        }
    }
}

impl RayTracer for Refined {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = self.original.closest_hit(&self.ray(ray));
        self.refine(&mut hit);
        hit
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.original.occluded(&self.ray(ray))
    }

    fn is_see_through(&self) -> bool {
        self.original.is_see_through()
    }

    fn transmittance(&self, ray: &Ray) -> Vec3 {
        self.original.transmittance(&self.ray(ray))
    }

    fn layers(&self, ray: &Ray, layers: &mut Vec<Layer>) {
        self.original.layers(&self.ray(ray), layers);
        self.refine(layers.iter_mut().map(|layer| &mut layer.hit));
    }

    fn closest_hits(&self, bundle: &Bundle<'_>, hits: &mut [Option<Hit>]) {
        self.original.closest_hits(&self.bundle(bundle), hits);
        self.refine(hits.iter_mut().flatten());
    }

    fn closest_hits_of(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.each_block(rays, hits, |rays, hits| self.original.closest_hits_of(rays, hits));
        self.refine(hits.iter_mut().flatten());
    }

    fn occlusions_of(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.each_block(rays, occluded, |rays, occluded| self.original.occlusions_of(rays, occluded));
    }

    fn transmittances_of(&self, rays: &[Ray], passed: &mut [Vec3]) {
        self.each_block(rays, passed, |rays, passed| self.original.transmittances_of(rays, passed));
    }

    fn transmittances(&self, bundle: &Bundle<'_>, passed: &mut [Vec3]) {
        self.original.transmittances(&self.bundle(bundle), passed);
    }

    fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
        self.original.occlusions(&self.bundle(bundle), occluded);
    }
}
