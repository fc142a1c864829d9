//! What surfaces reflect where stored rays end.

use crate::ends::{RayEnd, StoredEnd};
use crate::hemisphere;
use crate::job::Source;
use glam::Vec4;
use lumel_basis::{Basis, Field, Identity, NodeId, NodeWeights};
use lumel_scene::{Albedo, Scene, TriId};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Albedos that are stored per ray come in steps of this.
const STEP: f32 = 1.0 / u16::MAX as f32;

// What has been multiplied already is multiplied by exactly one.
const _: () = assert!(u16::MAX as f32 * STEP == 1.0);

/// The albedos of a scene, as the rows of an operator need them.
pub(crate) struct Reflectance {
    basis: Identity,
    /// That of each triangle, `None` where it is not the same all over it. Empty if the basis is not linear over
    /// triangles.
    triangles: Arc<[Option<Albedo>]>,
    /// Per chunk, the albedos at the ends of its rays; only where there are any that vary within a triangle.
    at_ends: Option<Vec<OnceLock<AlbedosAtEnds>>>,
    /// The same for the basis that holds direct light, if that is another.
    direct: Option<Box<Reflectance>>,
}

type AlbedosAtEnds = Box<[[u16; 3]]>;

impl Reflectance {
    pub(crate) fn new<B: Basis + ?Sized>(scene: &Scene, basis: &B, n_chunks: usize) -> Self {
        let n_triangles = if basis.corner_nodes().is_some() { scene.triangle_count() as u32 } else { 0 };
        let albedo = |tri: u32| scene.uniform_albedo(TriId(tri));
        let triangles: Vec<Option<Albedo>> = (0..n_triangles).into_par_iter().map(albedo).collect();
        let varies = triangles.contains(&None);
        Self {
            basis: basis.identity(),
            triangles: triangles.into(),
            at_ends: Self::slots(varies, n_chunks),
            direct: basis.direct().map(|direct| Box::new(Self::new(scene, direct, n_chunks))),
        }
    }

    /// The same for rays in other chunks.
    pub(crate) fn for_chunks(&self, n_chunks: usize) -> Self {
        Self {
            basis: self.basis,
            triangles: Arc::clone(&self.triangles),
            at_ends: Self::slots(self.at_ends.is_some(), n_chunks),
            direct: self.direct.as_ref().map(|direct| Box::new(direct.for_chunks(n_chunks))),
        }
    }

    fn slots(varies: bool, n_chunks: usize) -> Option<Vec<OnceLock<AlbedosAtEnds>>> {
        varies.then(|| (0..n_chunks).map(|_| OnceLock::new()).collect())
    }

    /// The basis it is for.
    pub(crate) fn basis(&self) -> Identity {
        self.basis
    }

    /// Whether albedos have to be kept per ray.
    pub(crate) fn varies(&self) -> bool {
        self.at_ends.is_some() || self.direct.as_ref().is_some_and(|direct| direct.varies())
    }

    /// The radiosity that surfaces reflect of a source, basis by basis; none of what is no light on surfaces.
    pub(crate) fn of_source<'a, B: Basis>(&'a self, basis: &'a B, source: Source<'a>) -> Vec<Reflected<'a>> {
        let of = |field| self.of(basis, field);
        match source {
            Source::Field(field) | Source::Shot(field, _) => vec![of(field)],
            Source::Reflecting { direct, carried } => {
                let direct = match (&self.direct, basis.direct()) {
                    (Some(reflectance), Some(basis)) => {
                        Reflected { direct: Some(basis), ..reflectance.of(basis, direct) }
                    }
                    _ => of(direct),
                };
                [direct].into_iter().chain(carried.map(of)).collect()
            }
            Source::Emitters(_) | Source::Ambient(_) | Source::Nothing => Vec::new(),
        }
    }

    fn of<'a, B: Basis + ?Sized>(&'a self, basis: &B, field: &'a Field) -> Reflected<'a> {
        let corner_nodes = basis.corner_nodes().unwrap_or_default();
        let triangles = corner_nodes.par_iter().zip(&self.triangles[..]);
        let planes = triangles.map(|(nodes, albedo)| plane(field, nodes, *albedo)).collect();
        Reflected { reflectance: self, field, planes, direct: None }
    }

    /// The triangles that reflect anything of a field that is zero at all nodes but some, in their order.
    pub(crate) fn of_shot<B: Basis>(&self, basis: &B, field: &Field, nodes: &[NodeId]) -> Vec<ShotTriangle> {
        let mut shoots = vec![false; basis.node_count()];
        nodes.iter().for_each(|node| shoots[node.index()] = true);
        let corner_nodes = basis.corner_nodes().unwrap_or_default();
        let triangles = (0..).zip(corner_nodes).zip(&self.triangles[..]);
        let shot = triangles.filter(|((_, nodes), _)| nodes.iter().any(|node| shoots[node.index()]));
        shot.map(|((tri, nodes), albedo)| ShotTriangle {
            tri,
            plane: plane(field, nodes, *albedo),
            varies: albedo.is_none(),
        })
        .collect()
    }

    /// How many triangles it knows; none if the basis is not linear over triangles.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The albedos at the ends of a chunk's rays, looked up once; one where all of the triangle has the same.
    pub(crate) fn albedos(&self, scene: &Scene, chunk: u32, ends: &[StoredEnd]) -> Option<&[[u16; 3]]> {
        let slot = &self.at_ends.as_ref()?[chunk as usize];
        Some(slot.get_or_init(|| ends.iter().map(|end| self.albedo_at(scene, *end)).collect()))
    }

    fn albedo_at(&self, scene: &Scene, end: StoredEnd) -> [u16; 3] {
        let varies = self.triangles.get(end.tri as usize).is_some_and(Option::is_none);
        match end.end() {
            Some(RayEnd::Surface(at)) if varies => scene
                .albedo(at)
                .0
                .to_array()
                .map(|albedo| (albedo / STEP + 0.5).clamp(0.0, u16::MAX.into()) as u16),
            _ => [u16::MAX; 3],
        }
    }
}

/// What a triangle reflects of a field, or if its albedo varies, what reaches it: at its third corner, and how it changes with
/// each of the two numbers that tell where a ray ends. All that a ray reads lies together.
type Plane = [Vec4; 3];

fn plane(field: &Field, nodes: &[NodeId; 3], albedo: Option<Albedo>) -> Plane {
    let albedo = albedo.map_or(Vec4::ONE, |albedo| albedo.0.extend(0.0));
    let [a, b, c] = nodes.map(|node| field.node(node).0.extend(0.0) * albedo);
    [c, (a - c) * StoredEnd::STEP, (b - c) * StoredEnd::STEP]
}

#[inline(always)]
fn at([c, du, dv]: &Plane, end: StoredEnd) -> Vec4 {
    *c + *du * f32::from(end.u) + *dv * f32::from(end.v)
}

/// A triangle that shoots.
pub(crate) struct ShotTriangle {
    pub(crate) tri: u32,
    plane: Plane,
    /// Whether its albedo varies, so that each ray has its own.
    pub(crate) varies: bool,
}

impl ShotTriangle {
    /// The radiosity where a ray ends, before the albedo of the ray.
    #[inline(always)]
    pub(crate) fn at(&self, end: StoredEnd) -> Vec4 {
        at(&self.plane, end)
    }
}

/// The radiosity that surfaces reflect, as stored rays read it.
pub(crate) struct Reflected<'a> {
    reflectance: &'a Reflectance,
    field: &'a Field,
    planes: Vec<Plane>,
    /// The basis of direct light, if it is this that is reflected and has one of its own.
    direct: Option<&'a dyn Basis>,
}

impl Reflected<'_> {
    /// [`Reflectance::albedos`].
    pub(crate) fn albedos(&self, scene: &Scene, chunk: u32, ends: &[StoredEnd]) -> Option<&[[u16; 3]]> {
        self.reflectance.albedos(scene, chunk, ends)
    }

    /// Whether every basis function is linear over triangles, so that [`plane_at`](Self::plane_at) is all.
    pub(crate) fn is_linear(&self) -> bool {
        !self.planes.is_empty()
    }

    /// The radiosity of a triangle where a ray ends, before the albedo of the ray; zero for sky and back faces.
    #[inline(always)]
    pub(crate) fn plane_at(&self, end: StoredEnd) -> Vec4 {
        self.planes.get(end.tri as usize).map_or(Vec4::ZERO, |plane| at(plane, end))
    }

    /// The light `ρE` at the end of a ray, in W·m⁻² as a cosine sample counts it.
    #[inline(always)]
    pub(crate) fn at<B: Basis>(
        &self,
        scene: &Scene,
        basis: &B,
        end: StoredEnd,
        albedo: Option<[u16; 3]>,
        weights: &mut NodeWeights,
    ) -> Vec4 {
        if self.is_linear() {
            let radiosity = self.plane_at(end);
            return albedo.map_or(radiosity, |albedo| radiosity * unpacked(albedo));
        }
        let end = end.end().unwrap_or(RayEnd::BackFace);
        let reflected = match self.direct {
            Some(direct) => hemisphere::reflected(scene, direct, self.field, &end, weights),
            None => hemisphere::reflected(scene, basis, self.field, &end, weights),
        };
        reflected.0.extend(0.0)
    }
}

/// An albedo as it was before it was stored per ray.
#[inline(always)]
pub(crate) fn unpacked([r, g, b]: [u16; 3]) -> Vec4 {
    Vec4::new(f32::from(r), f32::from(g), f32::from(b), 0.0) * STEP
}
