//! The hemisphere form: light that arrives along rays.

use glam::{DVec3, Vec3};
use lumel_accel::{Bundle, Hit, Ray};
use lumel_basis::{Basis, Field, NodeWeights, Site};
use lumel_sample::cosine_hemisphere;
use lumel_scene::{Irradiance, Scene, SurfacePoint};

/// What a hemisphere ray meets.
pub(crate) enum Seen {
    /// The lit side of a surface.
    Surface(SurfacePoint),
    /// The back of a one-sided surface: black, and a sign that the ray starts inside something.
    Back,
    /// Nothing.
    Sky,
}

impl Seen {
    pub(crate) fn new(scene: &Scene, hit: Option<Hit>) -> Self {
        match hit {
            None => Self::Sky,
            Some(hit) => scene.seen_side(hit.at, hit.side).map_or(Self::Back, Self::Surface),
        }
    }
}

/// The cosine-distributed direction of a site for `u` in the unit square.
///
/// By Shirley and Chiu's concentric map and Malley's method; density cos θ/π per steradian.
#[inline]
pub fn direction(site: &Site, u: [f32; 2]) -> Vec3 {
    site.frame.to_world(cosine_hemisphere(u))
}

/// A hemisphere ray of a site.
#[inline]
pub(crate) fn ray(site: &Site, direction: Vec3) -> Ray {
    Ray { origin: site.origin, direction, t_max: f32::INFINITY, skip: site.skip }
}

/// Hemisphere rays of a site.
pub(crate) fn bundle<'a>(site: &Site, directions: &'a [Vec3]) -> Bundle<'a> {
    Bundle { origin: site.origin, directions, t_max: f32::INFINITY, skip: site.skip }
}

/// One cosine-distributed sample of the light that surfaces reflect: `ρE` at the point that was met.
///
/// One term of `∫ (ρ/π) E cos θ dω`; the density's π cancels the one of the diffuse surface. Unbiased for `field`.
#[inline]
pub(crate) fn reflected<B: Basis>(
    scene: &Scene,
    basis: &B,
    field: &Field,
    seen: &Seen,
    weights: &mut NodeWeights,
) -> Irradiance {
    let Seen::Surface(at) = *seen else { return Irradiance::ZERO };
    field.at(basis, at, weights).reflected(scene.albedo(at)).cosine_sample()
}

/// Zero for the back of a surface, else one, in all channels.
#[inline]
pub(crate) fn openness(seen: &Seen) -> DVec3 {
    DVec3::splat(if matches!(seen, Seen::Back) { 0.0 } else { 1.0 })
}

/// One cosine-distributed sample of the light that sky and emissive surfaces send.
#[inline]
pub(crate) fn emitted(scene: &Scene, emission_by_rays: bool, seen: &Seen) -> Irradiance {
    match *seen {
        Seen::Surface(at) if emission_by_rays => scene.emission(at).cosine_sample(),
        Seen::Sky => scene.sky().cosine_sample(),
        Seen::Surface(_) | Seen::Back => Irradiance::ZERO,
    }
}
