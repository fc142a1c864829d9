//! Where hemisphere rays end.

use lumel_accel::Hit;
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

/// What a hemisphere ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RayEnd {
    /// The lit side of a surface.
    Surface(SurfacePoint),
    /// The back of a one-sided surface: black, and a sign that the ray starts inside something.
    BackFace,
    /// Nothing.
    Sky,
}

impl RayEnd {
    #[inline]
    pub(crate) fn new(scene: &Scene, hit: Option<Hit>) -> Self {
        match hit {
            None => Self::Sky,
            Some(hit) => scene.seen_side(hit.at, hit.side).map_or(Self::BackFace, Self::Surface),
        }
    }
}

/// The end of a ray in eight bytes: a triangle and barycentrics to 1/65535, or what else there was.
///
/// Rounding moves the point by a hundred-thousandth of its triangle. Weights still sum to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StoredEnd {
    pub(crate) tri: u32,
    pub(crate) u: u16,
    pub(crate) v: u16,
}

const STEPS: f32 = u16::MAX as f32;

impl StoredEnd {
    /// What `u` and `v` are counted in.
    pub(crate) const STEP: f32 = 1.0 / STEPS;

    /// Nothing was met.
    pub(crate) const SKY: Self = Self { tri: u32::MAX, u: 0, v: 0 };
    /// The back of a surface.
    pub(crate) const BACK_FACE: Self = Self { tri: u32::MAX - 1, u: 0, v: 0 };
    /// The ray started inside geometry and does not count.
    pub(crate) const INSIDE: Self = Self { tri: u32::MAX - 2, u: 0, v: 0 };

    pub(crate) fn new(end: &RayEnd) -> Self {
        match end {
            RayEnd::Sky => Self::SKY,
            RayEnd::BackFace => Self::BACK_FACE,
            RayEnd::Surface(at) => {
                let u = (at.bary.u * STEPS).round().clamp(0.0, STEPS) as u16;
                let v = (at.bary.v * STEPS).round().clamp(0.0, STEPS) as u16;
                Self { tri: at.tri.0, u, v: v.min(u16::MAX - u) }
            }
        }
    }

    /// The weights of the three corners.
    #[inline(always)]
    fn weights(self) -> [f32; 3] {
        let (u, v) = (f32::from(self.u) * Self::STEP, f32::from(self.v) * Self::STEP);
        [u, v, 1.0 - u - v]
    }

    /// What the ray met; `None` if it does not count.
    #[inline]
    pub(crate) fn end(self) -> Option<RayEnd> {
        match self {
            Self::INSIDE => None,
            Self::SKY => Some(RayEnd::Sky),
            Self::BACK_FACE => Some(RayEnd::BackFace),
            Self { tri, .. } => {
                let [u, v, _] = self.weights();
                Some(RayEnd::Surface(SurfacePoint { tri: TriId(tri), bary: Barycentrics { u, v } }))
            }
        }
    }
}
