//! The kernels: how rays go through the tree. `docs/tracer.md` explains them from the idea down.

mod beam;
mod extent;
mod leaf;
mod packet;
mod shaft;
mod single;
mod stack;

pub(crate) use packet::{Packet, PacketTrace};
pub(crate) use shaft::{SHAFT, Shaft};
pub(crate) use single::{Alone, Crossings};
pub(crate) use stack::Stack;

use crate::ray::Hit;
use crate::triangle::TriangleHit;
use lumel_scene::{FaceSide, SurfacePoint, TriId};

/// Rays of a packet.
pub(crate) const PACKET: usize = 16;

/// Boxes are entered this much earlier and left this much later, relative to the distance.
///
/// Slab distances err by 2 ulps, and a triangle that ties with the closest so far may lie in a box whose distance is
/// rounded the other way: it must still be looked at, so that the tie goes to the lowest triangle.
const EARLIER: f32 = 1.0 - 1e-5;
const LATER: f32 = 1.0 + 1e-5;

/// Components of directions are kept this far from zero, relative to the longest, so that no slab distance is 0 · ∞.
const SMALLEST_COMPONENT: f32 = 1e-18;

/// That limit for directions whose longest component is `reach`.
#[inline(always)]
fn smallest_component(reach: f32) -> f32 {
    (reach * SMALLEST_COMPONENT).max(f32::MIN_POSITIVE)
}

/// No triangle.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// The best hit of a ray so far.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    /// Its distance; of a ray that has met nothing, where it ends. Hits at this very distance may still win.
    t: f32,
    /// Twice the number of the triangle, plus one if its back was met: lower codes win ties.
    code: u32,
    /// Weights of corners 1 and 2.
    weights: [f32; 2],
}

impl Found {
    /// Nothing yet, on a ray that ends before `t_max`.
    pub(crate) fn nothing(t_max: f32) -> Self {
        Self { t: t_max.next_down(), code: NO_TRIANGLE, weights: [0.0; 2] }
    }

    /// Keeps the better one.
    #[inline(always)]
    fn offer(&mut self, other: Self) {
        if other.t < self.t || (other.t == self.t && other.code < self.code) {
            *self = other;
        }
    }

    pub(crate) fn hit(&self) -> Option<Hit> {
        if self.code == NO_TRIANGLE {
            return None;
        }
        let side = if self.code & 1 == 0 { FaceSide::Front } else { FaceSide::Back };
        let at = TriangleHit { t: self.t, weights: self.weights, side };
        Some(Hit { t: at.t, at: SurfacePoint { tri: TriId(self.code >> 1), bary: at.bary() }, side })
    }
}

/// A triangle's number and the side that is met, as in [`Found`].
#[inline(always)]
fn code(tri: u32, back: bool) -> u32 {
    tri << 1 | u32::from(back)
}

/// The bits of a mask.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lowest = mask.trailing_zeros();
            mask &= mask - 1;
            lowest as usize
        })
    })
}
