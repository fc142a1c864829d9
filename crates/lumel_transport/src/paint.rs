//! What the ends of rays reflect.

use crate::hemisphere::{self, Seen};
use crate::rows::End;
use glam::Vec4;
use lumel_basis::{Basis, Field, NodeId, NodeWeights};
use lumel_scene::{Albedo, Scene, TriId};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Albedos that are stored per ray come in steps of this.
const STEP: f32 = 1.0 / u16::MAX as f32;

// What has been multiplied already is multiplied by exactly one.
const _: () = assert!(u16::MAX as f32 * STEP == 1.0);

/// Where each triangle's light is read, and what it reflects of it.
pub(crate) struct Paint {
    /// Empty if the basis is not linear over triangles.
    triangles: Arc<[Triangle]>,
    /// Per chunk, the albedos at the ends of its rays; only where there are any that vary within a triangle.
    at_ends: Option<Vec<OnceLock<AlbedosAtEnds>>>,
}

type AlbedosAtEnds = Box<[[u16; 3]]>;

#[derive(Clone, Copy)]
struct Triangle {
    nodes: [NodeId; 3],
    /// `None` if it is not the same all over the triangle.
    albedo: Option<Albedo>,
}

impl Paint {
    pub(crate) fn new<B: Basis>(scene: &Scene, basis: &B, n_chunks: usize) -> Self {
        let triangle = |tri: u32| {
            let albedo = scene.uniform_albedo(TriId(tri));
            Some(Triangle { nodes: basis.corner_nodes(TriId(tri))?, albedo })
        };
        let triangles: Option<Vec<Triangle>> =
            (0..scene.triangle_count() as u32).into_par_iter().map(triangle).collect();
        let triangles: Arc<[Triangle]> = triangles.unwrap_or_default().into();
        let varies = triangles.iter().any(|t| t.albedo.is_none());
        let at_ends = varies.then(|| (0..n_chunks).map(|_| OnceLock::new()).collect());
        Self { triangles, at_ends }
    }

    /// The same for rays in other chunks.
    pub(crate) fn for_chunks(&self, n_chunks: usize) -> Self {
        let at_ends = self.varies().then(|| (0..n_chunks).map(|_| OnceLock::new()).collect());
        Self { triangles: Arc::clone(&self.triangles), at_ends }
    }

    /// Whether albedos have to be kept per ray.
    pub(crate) fn varies(&self) -> bool {
        self.at_ends.is_some()
    }

    /// The surfaces under a certain light.
    pub(crate) fn with<'a>(&'a self, field: &'a Field) -> Painted<'a> {
        let plane = |t: &Triangle| {
            let albedo = t.albedo.map_or(Vec4::ONE, |albedo| albedo.0.extend(0.0));
            let [a, b, c] = t.nodes.map(|node| field.node(node).0.extend(0.0) * albedo);
            [c, (a - c) * End::STEP, (b - c) * End::STEP]
        };
        Painted { paint: self, field, planes: self.triangles.par_iter().map(plane).collect() }
    }

    fn albedo_at(&self, scene: &Scene, end: End) -> [u16; 3] {
        let varies = self.triangles.get(end.tri as usize).is_some_and(|t| t.albedo.is_none());
        match end.seen() {
            Some(Seen::Surface(at)) if varies => scene
                .albedo(at)
                .0
                .to_array()
                .map(|albedo| (albedo / STEP + 0.5).clamp(0.0, u16::MAX.into()) as u16),
            _ => [u16::MAX; 3],
        }
    }
}

/// Surfaces under a certain light.
pub(crate) struct Painted<'a> {
    paint: &'a Paint,
    pub(crate) field: &'a Field,
    /// What each triangle reflects, or where its albedo varies, what reaches it: at its third corner, and how it changes
    /// with each of the two numbers that tell where a ray ends. All that a ray reads lies together.
    planes: Vec<[Vec4; 3]>,
}

impl Painted<'_> {
    /// The albedos at the ends of a chunk's rays, looked up once; one where all of the triangle has the same.
    pub(crate) fn albedos(&self, scene: &Scene, chunk: u32, ends: &[End]) -> Option<&[[u16; 3]]> {
        let slot = &self.paint.at_ends.as_ref()?[chunk as usize];
        Some(slot.get_or_init(|| ends.iter().map(|end| self.paint.albedo_at(scene, *end)).collect()))
    }

    /// Whether every basis function is linear over triangles, so that [`sent`](Self::sent) is all.
    pub(crate) fn is_linear(&self) -> bool {
        !self.planes.is_empty()
    }

    /// What a triangle sends along a ray that ends there, before the ray's albedo; zero for sky and backs.
    #[inline(always)]
    pub(crate) fn sent(&self, end: End) -> Vec4 {
        let Some([c, du, dv]) = self.planes.get(end.tri as usize) else { return Vec4::ZERO };
        *c + *du * f32::from(end.u) + *dv * f32::from(end.v)
    }

    /// The light `ρE` at the end of a ray, in W·m⁻² as a cosine sample counts it.
    #[inline(always)]
    pub(crate) fn reflected<B: Basis>(
        &self,
        scene: &Scene,
        basis: &B,
        end: End,
        albedo: Option<[u16; 3]>,
        weights: &mut NodeWeights,
    ) -> Vec4 {
        if self.is_linear() {
            let sent = self.sent(end);
            return albedo.map_or(sent, |albedo| sent * unpacked(albedo));
        }
        let seen = end.seen().unwrap_or(Seen::Back);
        hemisphere::reflected(scene, basis, self.field, &seen, weights).0.extend(0.0)
    }
}

/// An albedo as it was before it was stored per ray.
#[inline(always)]
pub(crate) fn unpacked([r, g, b]: [u16; 3]) -> Vec4 {
    Vec4::new(f32::from(r), f32::from(g), f32::from(b), 0.0) * STEP
}
