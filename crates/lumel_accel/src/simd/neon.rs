//! NEON: four numbers to a register, on every 64-bit ARM processor that programs for an operating system may expect.
#![allow(unsafe_code, reason = "intrinsics; the target for which this is compiled has their instructions")]

use super::lanes::{Kernel, Lanes, Permute, Quads, Simd};
use super::pair::{Pair, lanes_of_pair};
use std::arch::aarch64::*;

/// The target has NEON: see where this module is declared.
#[derive(Clone, Copy)]
pub(crate) struct Neon;

impl Simd for Neon {
    type F4 = X4;
    type F8 = Pair<X4>;
    type F16 = Pair<Pair<X4>>;

    #[inline(never)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

/// Four lanes in a register.
#[derive(Clone, Copy)]
pub(crate) struct X4(float32x4_t);

macro_rules! op {
    ($body:expr) => {{
        // SAFETY: the module exists only for targets with NEON; loads and stores go to arrays of the register's size and
        // need no alignment.
        unsafe { $body }
    }};
}

/// The sign of each lane.
const SIGN: u32 = 1 << 31;

impl X4 {
    /// The lanes' bits of a mask that has each lane all ones or all zeros.
    #[inline(always)]
    fn mask(lanes: uint32x4_t) -> u32 {
        op!(vaddvq_u32(vandq_u32(lanes, vld1q_u32([1, 2, 4, 8].as_ptr()))))
    }

    #[inline(always)]
    fn bits(self) -> uint32x4_t {
        op!(vreinterpretq_u32_f32(self.0))
    }
}

impl Lanes for X4 {
    type Isa = Neon;
    type Array = [f32; 4];

    #[inline(always)]
    fn splat(_: Neon, value: f32) -> Self {
        Self(op!(vdupq_n_f32(value)))
    }

    #[inline(always)]
    fn load(_: Neon, from: &[f32; 4]) -> Self {
        Self(op!(vld1q_f32(from.as_ptr())))
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; 4]) {
        op!(vst1q_f32(to.as_mut_ptr(), self.0));
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(op!(vaddq_f32(self.0, other.0)))
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(op!(vsubq_f32(self.0, other.0)))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(op!(vmulq_f32(self.0, other.0)))
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(op!(vdivq_f32(self.0, other.0)))
    }

    // The instructions that take a minimum or maximum treat NaN in other ways than is promised.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(op!(vbslq_f32(vcltq_f32(self.0, other.0), self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(op!(vbslq_f32(vcgtq_f32(self.0, other.0), self.0, other.0)))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(op!(vfmaq_f32(term.0, self.0, factor.0)))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Self(op!(vfmaq_f32(vnegq_f32(term.0), self.0, factor.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(vabsq_f32(self.0)))
    }

    #[inline(always)]
    fn flip(self, by: Self) -> Self {
        let sign = op!(vandq_u32(by.bits(), vdupq_n_u32(SIGN)));
        Self(op!(vreinterpretq_f32_u32(veorq_u32(self.bits(), sign))))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        Self::mask(op!(vcltq_f32(self.0, other.0)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        Self::mask(op!(vcleq_f32(self.0, other.0)))
    }

    #[inline(always)]
    fn negative(self) -> u32 {
        Self::mask(op!(vtstq_u32(self.bits(), vdupq_n_u32(SIGN))))
    }

    #[inline(always)]
    fn replace(self, other: Self, mask: u32) -> Self {
        let set = op!(vtstq_u32(vdupq_n_u32(mask), vld1q_u32([1, 2, 4, 8].as_ptr())));
        Self(op!(vbslq_f32(set, other.0, self.0)))
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        op!(vminnmvq_f32(self.0))
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        op!(vmaxnmvq_f32(self.0))
    }
}

lanes_of_pair!(X4, Neon, 4, 8);
lanes_of_pair!(Pair<X4>, Neon, 8, 16);

impl Permute for Pair<X4> {
    #[inline(always)]
    fn permute(self, order: u32) -> Self {
        let table =
            op!(uint8x16x2_t(vreinterpretq_u8_u32(self.0.bits()), vreinterpretq_u8_u32(self.1.bits())));
        // Four bytes of each lane, in a table of eight lanes.
        let four = |shifts: [i32; 4]| {
            let lanes =
                op!(vandq_u32(vshlq_u32(vdupq_n_u32(order), vld1q_s32(shifts.as_ptr())), vdupq_n_u32(7)));
            let bytes = op!(vmlaq_u32(vdupq_n_u32(0x0302_0100), lanes, vdupq_n_u32(0x0404_0404)));
            X4(op!(vreinterpretq_f32_u8(vqtbl2q_u8(table, vreinterpretq_u8_u32(bytes)))))
        };
        Self(four([0, -3, -6, -9]), four([-12, -15, -18, -21]))
    }
}

impl Quads for Pair<Pair<X4>> {
    type F4 = X4;

    #[inline(always)]
    fn repeat(_: Neon, quad: X4) -> Self {
        Self(Pair(quad, quad), Pair(quad, quad))
    }

    #[inline(always)]
    fn spread(self, lanes: [u8; 4]) -> Self {
        let mut all = [0.0; 16];
        self.store(&mut all);
        let [a, b, c, d] = lanes.map(|lane| X4(op!(vdupq_n_f32(all[usize::from(lane) % 16]))));
        Self(Pair(a, b), Pair(c, d))
    }
}
