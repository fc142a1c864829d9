//! Many rays as one: intervals that hold all their origins and directions.
//!
//! A box that the interval misses is missed by every ray of it, so that one test of eight boxes serves a whole packet.
//!
//! Boulos, Wald, Shirley, *Geometric and arithmetic culling methods for entire ray packets*, 2006.

use super::extent::{Interval, Origins};
use super::{EARLIER, LATER, smallest_component};
use crate::bvh::Node;
use crate::simd::{Lanes, Simd};

/// Bounds of where rays enter and leave boxes.
pub(super) struct Beam<S: Simd> {
    axes: [Axis<S>; 3],
    /// The signs of most directions.
    pub(super) octant: usize,
    /// No direction changes its sign within the beam, on any axis.
    pub(super) one_octant: bool,
    /// What separates components of its directions from zero.
    pub(super) smallest: f32,
    pub(super) from: Origins,
    pub(super) directions: Interval,
}

struct Axis<S: Simd> {
    origin_min: S::F8,
    origin_max: S::F8,
    /// Distance along rays that go up per distance along the axis, at least; zero if there are none.
    up: S::F8,
    /// The same for rays that go down.
    down: S::F8,
    /// At most; zero where some rays stand still along the axis.
    out: S::F8,
    /// Where all leave at the latest if `out` says nothing.
    never: S::F8,
    reversed: bool,
}

impl<S: Simd> Axis<S> {
    #[inline(always)]
    fn new(isa: S, origin: (f32, f32), (min, max): (f32, f32), smallest: f32) -> Self {
        let reversed = max < -smallest;
        let up = if max > smallest { EARLIER / max } else { 0.0 };
        let down = if min < -smallest { EARLIER / min } else { 0.0 };
        let (out, never) = if min > smallest {
            (LATER / min, 0.0)
        } else if reversed {
            (LATER / max, 0.0)
        } else {
            (0.0, NEVER)
        };
        Self {
            origin_min: S::F8::splat(isa, origin.0),
            origin_max: S::F8::splat(isa, origin.1),
            up: S::F8::splat(isa, up),
            down: S::F8::splat(isa, down),
            out: S::F8::splat(isa, out),
            never: S::F8::splat(isa, never),
            reversed,
        }
    }
}

/// A number beyond any distance, and finite so that zero times it is zero.
const NEVER: f32 = 1e30;

impl<S: Simd> Beam<S> {
    /// A beam around rays.
    #[inline(always)]
    pub(super) fn new(isa: S, origins: Interval, directions: Interval) -> Self {
        let reach = (0..3).fold(0.0, |r: f32, a| r.max(directions.max[a]).max(-directions.min[a]));
        let smallest = smallest_component(reach);
        let axis = |axis: usize| {
            let origin = (origins.min[axis], origins.max[axis]);
            Axis::new(isa, origin, (directions.min[axis], directions.max[axis]), smallest)
        };
        let axes = [axis(0), axis(1), axis(2)];
        let (mut octant, mut one_octant) = (0, true);
        for axis in 0..3 {
            let (min, max) = (directions.min[axis], directions.max[axis]);
            octant |= usize::from(min + max < 0.0) << axis;
            one_octant &= min > smallest || max < -smallest;
        }
        let center: [f32; 3] = std::array::from_fn(|a| 0.5 * origins.min[a] + 0.5 * origins.max[a]);
        let from = Origins {
            center,
            spread: (0..3).fold(0.0, |s: f32, a| s.max(origins.max[a] - origins.min[a])),
            reach,
        };
        Self { axes, octant, one_octant, smallest, from, directions }
    }

    /// Bounds of where rays enter and leave the boxes of a node, and the boxes relative to the origins.
    ///
    /// `ONE` promises that there is one octant.
    #[inline(always)]
    pub(super) fn enter<const ONE: bool>(&self, isa: S, node: &Node, limit: f32) -> Entered<S> {
        let mut near = S::F8::splat(isa, 0.0);
        let mut far = S::F8::splat(isa, limit);
        let (mut lowers, mut uppers) = ([[0.0; 8]; 3], [[0.0; 8]; 3]);
        for (i, axis) in self.axes.iter().enumerate() {
            let lower = S::F8::load(isa, &node.lower[i]).sub(axis.origin_max);
            let upper = S::F8::load(isa, &node.upper[i]).sub(axis.origin_min);
            lower.store(&mut lowers[i]);
            upper.store(&mut uppers[i]);
            let last = if axis.reversed { lower } else { upper };
            if ONE {
                near = near.max(if axis.reversed { upper.mul(axis.down) } else { lower.mul(axis.up) });
                far = far.min(last.mul(axis.out));
            } else {
                near = near.max(lower.mul(axis.up).max(upper.mul(axis.down)));
                far = far.min(last.mul_add(axis.out, axis.never));
            }
        }
        Entered { near, far, lower: lowers, upper: uppers }
    }
}

/// How a beam meets the boxes of a node.
pub(super) struct Entered<S: Simd> {
    pub(super) near: S::F8,
    pub(super) far: S::F8,
    /// Sides of the boxes as seen from the nearest origins; exact if there is one origin only.
    pub(super) lower: [[f32; 8]; 3],
    pub(super) upper: [[f32; 8]; 3],
}
