//! Rays and the triangles of a block.
//!
//! For an origin, three planes of each triangle decide: the ray's direction has the same sign in all of them exactly if
//! it passes through. They are shared by all rays of one origin, which then cost three dot products each.

use super::extent::{Interval, Origins};
use crate::bvh::Block;
use crate::simd::{Lanes, Quads};
use crate::triangle::{EDGE_ERROR, passes};
use glam::Vec3;

/// A vector per lane.
pub(super) type V3<L> = [L; 3];

/// See the rule about the order of operations in `triangle.rs`.
#[inline(always)]
fn cross<L: Lanes>(a: V3<L>, b: V3<L>) -> V3<L> {
    [
        a[1].mul_sub(b[2], a[2].mul(b[1])),
        a[2].mul_sub(b[0], a[0].mul(b[2])),
        a[0].mul_sub(b[1], a[1].mul(b[0])),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(a: V3<L>, b: V3<L>) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

#[inline(always)]
fn sub<L: Lanes>(a: V3<L>, b: V3<L>) -> V3<L> {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

/// `v.map(f)`, but surely inlined: what is not would be compiled without the kernel's instructions.
#[inline(always)]
pub(super) fn each<A: Copy, B>(v: [A; 3], f: impl Fn(A) -> B) -> [B; 3] {
    [f(v[0]), f(v[1]), f(v[2])]
}

#[inline(always)]
pub(super) fn splat<L: Lanes>(isa: L::Isa, v: [f32; 3]) -> V3<L> {
    [L::splat(isa, v[0]), L::splat(isa, v[1]), L::splat(isa, v[2])]
}

#[inline(always)]
pub(super) fn load<L: Lanes>(isa: L::Isa, v: &[L::Array; 3]) -> V3<L> {
    [L::load(isa, &v[0]), L::load(isa, &v[1]), L::load(isa, &v[2])]
}

/// Triangles as one corner and two edges: what no ray changes.
#[derive(Clone, Copy)]
pub(super) struct Edges<L> {
    corner: V3<L>,
    e1: V3<L>,
    e2: V3<L>,
    normal: V3<L>,
    /// Bound of the error of edge functions.
    slack: L,
}

impl<L: Lanes> Edges<L> {
    /// The triangles of a block, for rays that start within `spread` of `center` (per axis) and whose directions have
    /// components up to `reach`.
    #[inline(always)]
    pub(super) fn new(isa: L::Isa, block: &Block, from: &Origins) -> Self
    where
        L: Lanes<Array = [f32; 4]>,
    {
        let [corner, b, c] = &block.corners;
        let (corner, b, c): (V3<L>, V3<L>, V3<L>) = (load(isa, corner), load(isa, b), load(isa, c));
        let (e1, e2) = (sub(b, corner), sub(c, corner));
        let extent = L::load(isa, &block.extent);
        let away = sub(corner, splat(isa, from.center));
        let away =
            away[0].abs().max(away[1].abs()).max(away[2].abs()).add(extent).add(L::splat(isa, from.spread));
        let slack = away.mul(extent).mul(L::splat(isa, EDGE_ERROR * from.reach));
        Self { corner, e1, e2, normal: cross(e1, e2), slack }
    }

    /// As [`Planes`] for an origin, or for one per lane.
    #[inline(always)]
    pub(super) fn planes(self, origin: V3<L>) -> Planes<L> {
        let to_corner = sub(self.corner, origin);
        let height = dot(self.normal, to_corner);
        Planes {
            second: cross(self.e2, to_corner),
            third: cross(to_corner, self.e1),
            normal: self.normal,
            height,
            slack: self.slack,
        }
    }

    /// The four triangles again and again, for four rays.
    #[inline(always)]
    pub(super) fn repeated<M: Quads<F4 = L, Isa = L::Isa>>(self, isa: L::Isa) -> Edges<M> {
        Edges {
            corner: repeated(isa, self.corner),
            e1: repeated(isa, self.e1),
            e2: repeated(isa, self.e2),
            normal: repeated(isa, self.normal),
            slack: M::repeat(isa, self.slack),
        }
    }
}

#[inline(always)]
fn repeated<M: Quads>(isa: M::Isa, v: V3<M::F4>) -> V3<M>
where
    M::F4: Copy,
{
    [M::repeat(isa, v[0]), M::repeat(isa, v[1]), M::repeat(isa, v[2])]
}

/// Triangles seen from an origin.
#[derive(Clone, Copy)]
pub(super) struct Planes<L> {
    /// Through the origin and the edges at corner 0; dot products with a direction weigh corners 1 and 2.
    second: V3<L>,
    third: V3<L>,
    normal: V3<L>,
    /// Of the triangle's plane above the origin, along the normal: positive if its back is seen.
    height: L,
    slack: L,
}

impl<L: Lanes> Planes<L> {
    /// The four triangles again and again, for four rays.
    #[inline(always)]
    pub(super) fn repeated<M: Quads<F4 = L, Isa = L::Isa>>(self, isa: L::Isa) -> Planes<M> {
        Planes {
            second: repeated(isa, self.second),
            third: repeated(isa, self.third),
            normal: repeated(isa, self.normal),
            height: M::repeat(isa, self.height),
            slack: M::repeat(isa, self.slack),
        }
    }

    /// Tests directions: those that may pass through at `0 < t <= limit`.
    ///
    /// The mask is wrong at most for lanes that are not `certain`.
    #[inline(always)]
    pub(super) fn test(&self, isa: L::Isa, direction: V3<L>, limit: L) -> Met<L> {
        // With the sign of the height taken out, all three must be positive, and so must the determinant.
        let det = dot(self.normal, direction).flip(self.height);
        let second = dot(self.second, direction).flip(self.height);
        let third = dot(self.third, direction).flip(self.height);
        let first = det.sub(second).sub(third);
        let least = first.min(second).min(third);
        let zero = L::splat(isa, 0.0);
        let inside = zero.sub(self.slack).le(least);
        if inside == 0 {
            return Met { lanes: 0, certain: 0, t: zero, weights: [zero; 2] };
        }
        let inverse = L::splat(isa, 1.0).div(det);
        let t = self.height.abs().mul(inverse);
        let lanes = inside & zero.lt(t) & t.le(limit);
        Met { lanes, certain: self.slack.le(least), t, weights: [second.mul(inverse), third.mul(inverse)] }
    }

    /// The lanes whose triangle any direction of an interval may pass through.
    ///
    /// For each edge, the interval's best corner decides. Both it and a direction's own test err by up to the slack, and
    /// so does taking the first plane from the others: what is left out here would not pass the test of any direction.
    #[inline(always)]
    pub(super) fn within_reach(&self, isa: L::Isa, directions: &Interval) -> u32 {
        let Self { second, third, normal, height, slack } = *self;
        let (min, max) = (splat(isa, directions.min), splat(isa, directions.max));
        let first = sub(sub(normal, second), third);
        let least = highest(first, height, min, max)
            .min(highest(second, height, min, max))
            .min(highest(third, height, min, max));
        // What overflows stays in.
        !slack.mul_add(L::splat(isa, 4.0), least).lt(L::splat(isa, 0.0))
    }

    /// The lanes in which the back is seen.
    #[inline(always)]
    pub(super) fn back(&self) -> u32 {
        !self.height.negative()
    }
}

/// The largest dot product of a plane, with the sign of `height` taken out, and a direction between two corners.
#[inline(always)]
fn highest<L: Lanes>(plane: V3<L>, height: L, min: V3<L>, max: V3<L>) -> L {
    let [x, y, z] = [plane[0].flip(height), plane[1].flip(height), plane[2].flip(height)];
    let (x, y, z) = (
        x.mul(min[0]).max(x.mul(max[0])),
        y.mul(min[1]).max(y.mul(max[1])),
        z.mul(min[2]).max(z.mul(max[2])),
    );
    x.add(y).add(z)
}

/// What a test found.
pub(super) struct Met<L> {
    pub(super) lanes: u32,
    pub(super) certain: u32,
    pub(super) t: L,
    /// Weights of corners 1 and 2.
    pub(super) weights: [L; 2],
}

impl<L: Lanes> Met<L> {
    /// Leaves the lanes that do meet the triangle, given the triangle, origin and direction of each.
    #[inline(always)]
    pub(super) fn decided(&self, among: u32, ray: impl Fn(usize) -> ([Vec3; 3], Vec3, Vec3)) -> u32 {
        let mut lanes = self.lanes & among;
        let uncertain = lanes & !self.certain;
        if uncertain != 0 {
            for lane in super::bits(uncertain) {
                let (corners, origin, direction) = ray(lane);
                if !passes(&corners, origin, direction) {
                    lanes &= !(1 << lane);
                }
            }
        }
        lanes
    }
}

/// The planes of a block's triangles in memory, to be taken out one by one.
#[derive(Clone, Copy)]
pub(super) struct PlanesOfBlock([[f32; 4]; 11]);

impl PlanesOfBlock {
    #[inline(always)]
    pub(super) fn new<L: Lanes<Array = [f32; 4]>>(planes: Planes<L>) -> Self {
        let mut rows = [[0.0; 4]; 11];
        let Planes { second, third, normal, height, slack } = planes;
        for axis in 0..3 {
            second[axis].store(&mut rows[axis]);
            third[axis].store(&mut rows[3 + axis]);
            normal[axis].store(&mut rows[6 + axis]);
        }
        height.store(&mut rows[9]);
        slack.store(&mut rows[10]);
        Self(rows)
    }

    /// Triangle `i` in all lanes.
    #[inline(always)]
    pub(super) fn triangle<M: Lanes>(&self, isa: M::Isa, i: usize) -> Planes<M> {
        let at = |row: usize| M::splat(isa, self.0[row][i & 3]);
        Planes {
            second: [at(0), at(1), at(2)],
            third: [at(3), at(4), at(5)],
            normal: [at(6), at(7), at(8)],
            height: at(9),
            slack: at(10),
        }
    }

    /// Whether triangle `i` shows its back.
    #[inline(always)]
    pub(super) fn shows_back(&self, i: usize) -> bool {
        !self.0[9][i & 3].is_sign_negative()
    }
}

/// The edges of a block's triangles in memory, to be taken out one by one.
#[derive(Clone, Copy)]
pub(super) struct EdgesOfBlock([[f32; 4]; 13]);

impl EdgesOfBlock {
    #[inline(always)]
    pub(super) fn new<L: Lanes<Array = [f32; 4]>>(edges: Edges<L>) -> Self {
        let mut rows = [[0.0; 4]; 13];
        let Edges { corner, e1, e2, normal, slack } = edges;
        for axis in 0..3 {
            corner[axis].store(&mut rows[axis]);
            e1[axis].store(&mut rows[3 + axis]);
            e2[axis].store(&mut rows[6 + axis]);
            normal[axis].store(&mut rows[9 + axis]);
        }
        slack.store(&mut rows[12]);
        Self(rows)
    }

    /// Triangle `i` in all lanes.
    #[inline(always)]
    pub(super) fn triangle<M: Lanes>(&self, isa: M::Isa, i: usize) -> Edges<M> {
        let at = |row: usize| M::splat(isa, self.0[row][i & 3]);
        Edges {
            corner: [at(0), at(1), at(2)],
            e1: [at(3), at(4), at(5)],
            e2: [at(6), at(7), at(8)],
            normal: [at(9), at(10), at(11)],
            slack: at(12),
        }
    }
}
