//! Where hemisphere rays end: the rows of the discrete transport operator.
//!
//! Directions do not depend on the bounce, nor on lights or materials: what is stored here serves every bounce, and a
//! scene that is lit anew.

use crate::cpu::CHUNK;
use crate::hemisphere::Seen;
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use std::mem::size_of;
use std::sync::OnceLock;

/// The end of a ray in eight bytes: a triangle and barycentrics to 1/65535, or what else there was.
///
/// Rounding moves the point by a hundred-thousandth of its triangle. Weights still sum to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct End {
    pub(crate) tri: u32,
    pub(crate) u: u16,
    pub(crate) v: u16,
}

const STEPS: f32 = u16::MAX as f32;

impl End {
    /// What `u` and `v` are counted in.
    pub(crate) const STEP: f32 = 1.0 / STEPS;

    /// Nothing was met.
    pub(crate) const SKY: Self = Self { tri: u32::MAX, u: 0, v: 0 };
    /// The back of a surface.
    pub(crate) const BACK: Self = Self { tri: u32::MAX - 1, u: 0, v: 0 };
    /// The ray started inside geometry and does not count.
    pub(crate) const INSIDE: Self = Self { tri: u32::MAX - 2, u: 0, v: 0 };

    pub(crate) fn new(seen: &Seen) -> Self {
        match seen {
            Seen::Sky => Self::SKY,
            Seen::Back => Self::BACK,
            Seen::Surface(at) => {
                let u = (at.bary.u * STEPS).round().clamp(0.0, STEPS) as u16;
                let v = (at.bary.v * STEPS).round().clamp(0.0, STEPS) as u16;
                Self { tri: at.tri.0, u, v: v.min(u16::MAX - u) }
            }
        }
    }

    /// The weights of the three corners.
    #[inline(always)]
    pub(crate) fn weights(self) -> [f32; 3] {
        let (u, v) = (f32::from(self.u) * Self::STEP, f32::from(self.v) * Self::STEP);
        [u, v, 1.0 - u - v]
    }

    /// What the ray saw; `None` if it does not count.
    #[inline]
    pub(crate) fn seen(self) -> Option<Seen> {
        match self {
            Self::INSIDE => None,
            Self::SKY => Some(Seen::Sky),
            Self::BACK => Some(Seen::Back),
            Self { tri, .. } => {
                let [u, v, _] = self.weights();
                Some(Seen::Surface(SurfacePoint { tri: TriId(tri), bary: Barycentrics { u, v } }))
            }
        }
    }
}

/// The ends of all hemisphere rays of an operator, chunk by chunk, traced when they are first asked for.
#[derive(Debug)]
pub struct Rows {
    /// What they were traced for.
    pub(crate) origin: Origin,
    pub(crate) chunks: Vec<OnceLock<Box<[End]>>>,
}

/// What the ends of rays depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    pub(crate) geometry: [u8; 32],
    pub(crate) elements: usize,
    /// Whether these are all elements of the surfaces; some of them are not told from as many others.
    pub(crate) is_whole: bool,
    pub(crate) per_element: u32,
    pub(crate) sampler: lumel_sample::SamplerKind,
    pub(crate) seed: u64,
    pub(crate) second_half: bool,
    pub(crate) over_area: bool,
}

impl Rows {
    pub(crate) fn new(origin: Origin) -> Self {
        let chunks = (0..origin.elements.div_ceil(CHUNK)).map(|_| OnceLock::new()).collect();
        Self { origin, chunks }
    }

    /// Bytes of the rows of so many elements with so many rays each, once all are traced.
    ///
    /// `textured` adds the albedo at the end of each ray, which is kept where it changes within triangles.
    pub fn bytes_for(elements: usize, rays_per_element: u32, textured: bool) -> u64 {
        let per_ray = size_of::<End>() + if textured { size_of::<[u16; 3]>() } else { 0 };
        elements as u64 * u64::from(rays_per_element) * per_ray as u64
    }

    /// Whether all rays have been traced.
    pub fn is_complete(&self) -> bool {
        self.chunks.iter().all(|chunk| chunk.get().is_some())
    }

    /// Bytes of the rows that are held now, without albedos.
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().filter_map(OnceLock::get).map(|chunk| size_of_val(&**chunk) as u64).sum()
    }
}
