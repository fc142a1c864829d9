//! What the ends of rays reflect.

use crate::hemisphere;
use crate::rows::End;
use glam::{Vec3, Vec4};
use lumel_basis::{Basis, Field, NodeId, NodeWeights};
use lumel_scene::{Scene, TriId};
use std::collections::HashMap;
use std::sync::OnceLock;

/// Albedos that are stored per ray, in steps of 1/65535.
const STEPS: f32 = u16::MAX as f32;

/// Where a triangle's light is read and what it reflects of it, for all triangles of a scene.
pub(crate) struct Paint {
    /// The nodes at the corners and the number of the albedo. Empty if the basis is not linear over triangles.
    triangles: Vec<[u32; 4]>,
    /// Albedos that are the same all over a triangle.
    albedos: Vec<Vec4>,
    /// Per chunk, the albedos at the ends of its rays, where they vary within triangles.
    at_ends: Option<Vec<OnceLock<Box<[[u16; 3]]>>>>,
}

/// Stands for the number of an albedo where it varies.
const VARIES: u32 = u32::MAX;

impl Paint {
    pub(crate) fn new<B: Basis>(scene: &Scene, basis: &B, n_chunks: usize) -> Self {
        let mut albedos = Vec::new();
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        let mut triangles = Vec::with_capacity(scene.triangle_count());
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let Some([a, b, c]) = basis.corner_nodes(tri) else {
                triangles.clear();
                break;
            };
            let albedo = scene.uniform_albedo(tri).map_or(VARIES, |albedo| {
                *known.entry(albedo.0.to_array().map(f32::to_bits)).or_insert_with(|| {
                    albedos.push(albedo.0.extend(0.0));
                    albedos.len() as u32 - 1
                })
            });
            triangles.push([a.0, b.0, c.0, albedo]);
        }
        let varies = triangles.iter().any(|t| t[3] == VARIES);
        let at_ends = varies.then(|| (0..n_chunks).map(|_| OnceLock::new()).collect());
        Self { triangles, albedos, at_ends }
    }

    /// Whether albedos have to be kept per ray.
    pub(crate) fn varies(&self) -> bool {
        self.at_ends.is_some()
    }

    /// The paint under a certain light.
    pub(crate) fn with<'a>(&'a self, field: &'a Field) -> Painted<'a> {
        let values = if self.triangles.is_empty() { &[][..] } else { field.values() };
        Painted { paint: self, field, values: values.iter().map(|v| v.extend(0.0)).collect() }
    }
}

/// Surfaces under a certain light.
pub(crate) struct Painted<'a> {
    paint: &'a Paint,
    pub(crate) field: &'a Field,
    /// The field, a register to a node.
    values: Vec<Vec4>,
}

impl Painted<'_> {
    /// The albedos at the ends of a chunk's rays, looked up once; `None` where every triangle has its own.
    pub(crate) fn albedos(&self, scene: &Scene, chunk: u32, ends: &[End]) -> Option<&[[u16; 3]]> {
        let slot = &self.paint.at_ends.as_ref()?[chunk as usize];
        Some(slot.get_or_init(|| ends.iter().map(|end| albedo_at(scene, *end)).collect()))
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
        let Some(&[a, b, c, paint]) = self.paint.triangles.get(end.tri as usize) else {
            return self.reflected_anyhow(scene, basis, end, weights);
        };
        let [u, v, w] = end.weights();
        let at = |node: u32| self.values[NodeId(node).index()];
        let irradiance = at(a) * u + at(b) * v + at(c) * w;
        let albedo = match self.paint.albedos.get(paint as usize) {
            Some(albedo) => *albedo,
            None => {
                let [r, g, b] = albedo.unwrap_or_default();
                Vec4::new(f32::from(r), f32::from(g), f32::from(b), 0.0) * (1.0 / STEPS)
            }
        };
        irradiance * albedo
    }

    /// The same for sky and backs, and for a basis of which no more is known.
    #[inline(never)]
    fn reflected_anyhow<B: Basis>(
        &self,
        scene: &Scene,
        basis: &B,
        end: End,
        weights: &mut NodeWeights,
    ) -> Vec4 {
        match end.seen() {
            Some(seen) if self.paint.triangles.is_empty() => {
                hemisphere::reflected(scene, basis, self.field, &seen, weights).0.extend(0.0)
            }
            _ => Vec4::ZERO,
        }
    }
}

fn albedo_at(scene: &Scene, end: End) -> [u16; 3] {
    let Some(hemisphere::Seen::Surface(at)) = end.seen() else { return [0; 3] };
    let albedo: Vec3 = scene.albedo(at).0;
    (albedo * STEPS).round().to_array().map(|x| x.clamp(0.0, STEPS) as u16)
}
