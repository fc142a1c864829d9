//! The hemisphere form: light that arrives along rays.

use crate::emitters::{Emitter, EmitterMask};
use crate::ends::RayEnd;
use crate::lights::LightSet;
use glam::Vec3;
use lumel_accel::{Bundle, Ray};
use lumel_basis::{Basis, Field, NodeWeights, Site};
use lumel_sample::{cosine_hemisphere, cosine_hemisphere_pdf, mixed_hemisphere, mixed_hemisphere_pdf};
use lumel_scene::{Irradiance, Scene};

/// The cosine-distributed direction of a site for `u` in the unit square.
///
/// By Shirley and Chiu's concentric map and Malley's method; density cos θ/π per steradian.
#[inline]
pub fn direction(site: &Site, u: [f32; 2]) -> Vec3 {
    site.frame.to_world(cosine_hemisphere(u))
}

/// How densely hemisphere rays lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum HemisphereDensity {
    /// By the cosine to the normal: best for irradiance.
    #[default]
    Cosine,
    /// Half by the cosine and half evenly: for moments, which do not vanish at the horizon.
    Mixed,
}

impl HemisphereDensity {
    /// The direction of a site for `u` in the unit square.
    #[inline]
    pub(crate) fn direction(self, site: &Site, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Cosine => direction(site, u),
            Self::Mixed => site.frame.to_world(mixed_hemisphere(u)),
        }
    }

    /// The density in a direction at this cosine to the normal, sr⁻¹.
    #[inline]
    pub(crate) fn pdf(self, cos: f32) -> f32 {
        match self {
            Self::Cosine => cosine_hemisphere_pdf(cos),
            Self::Mixed => mixed_hemisphere_pdf(cos),
        }
    }

    /// What a ray in such a direction adds to the irradiance of a surface that faces it, per what a cosine-distributed one
    /// adds to that of the receiver: 1 / πp.
    #[inline]
    pub(crate) fn per_cosine_sample(self, cos: f32) -> f32 {
        cosine_hemisphere_pdf(1.0) / self.pdf(cos)
    }
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
pub(crate) fn reflected<B: Basis + ?Sized>(
    scene: &Scene,
    basis: &B,
    field: &Field,
    end: &RayEnd,
    weights: &mut NodeWeights,
) -> Irradiance {
    let RayEnd::Surface(at) = *end else { return Irradiance::ZERO };
    field.at(basis, at, weights).reflected(scene.albedo(at)).cosine_sample()
}

/// One cosine-distributed sample of the light that emissive surfaces send, and the sky if it is the same all around: any
/// other needs [directions](crate::sky_rays).
#[inline]
pub(crate) fn emitted(
    scene: &Scene,
    lights: &LightSet,
    mask: Option<&EmitterMask>,
    end: &RayEnd,
) -> Irradiance {
    let shines = |emitter| mask.is_none_or(|mask| mask.shines(emitter));
    match *end {
        RayEnd::Surface(at)
            if lights.emission_by_rays && shines(Emitter::Surfaces(scene.material_id(at.tri))) =>
        {
            scene.emission(at).cosine_sample()
        }
        RayEnd::Sky if shines(Emitter::Sky) => scene.sky().uniform().unwrap_or_default().cosine_sample(),
        RayEnd::Surface(_) | RayEnd::BackFace | RayEnd::Sky => Irradiance::ZERO,
    }
}
