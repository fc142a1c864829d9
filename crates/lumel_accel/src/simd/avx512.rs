//! AVX-512: sixteen lanes to a register, masks as bits.
#![allow(
    unsafe_code,
    reason = "instructions that a processor may lack; the token proves that this one has them"
)]

use super::avx2::{HasAvx2, X4, X8, op};
use super::lanes::{Kernel, Lanes, Quads, Simd};
use std::arch::x86_64::*;

/// The processor has AVX-512 F, VL, DQ and BW, and with them AVX2 and FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    pub(super) fn detect() -> Option<Self> {
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma");
        has.then_some(Self(()))
    }

    #[inline(never)]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma")]
    fn enter<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

impl HasAvx2 for Avx512 {}

impl Simd for Avx512 {
    type F4 = X4<Self>;
    type F8 = X8<Self>;
    type F16 = X16;

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: a token exists only where `detect` found the instructions.
        unsafe { self.enter(kernel) }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct X16 {
    register: __m512,
    isa: Avx512,
}

impl X16 {
    #[inline(always)]
    fn with(self, register: __m512) -> Self {
        Self { register, isa: self.isa }
    }
}

/// Operations of two registers that are one instruction.
macro_rules! two {
    ($($name:ident = $intrinsic:ident),*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Self {
            self.with(op!($intrinsic(self.register, other.register)))
        }
    )*};
}

impl Lanes for X16 {
    type Isa = Avx512;
    type Array = [f32; 16];

    two!(
        add = _mm512_add_ps,
        sub = _mm512_sub_ps,
        mul = _mm512_mul_ps,
        div = _mm512_div_ps,
        min = _mm512_min_ps,
        max = _mm512_max_ps
    );

    #[inline(always)]
    fn splat(isa: Avx512, value: f32) -> Self {
        Self { register: op!(_mm512_set1_ps(value)), isa }
    }

    #[inline(always)]
    fn load(isa: Avx512, from: &[f32; 16]) -> Self {
        Self { register: op!(_mm512_loadu_ps(from.as_ptr())), isa }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; 16]) {
        op!(_mm512_storeu_ps(to.as_mut_ptr(), self.register));
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.with(op!(_mm512_fmadd_ps(self.register, factor.register, term.register)))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        self.with(op!(_mm512_fmsub_ps(self.register, factor.register, term.register)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.with(op!(_mm512_abs_ps(self.register)))
    }

    #[inline(always)]
    fn flip(self, by: Self) -> Self {
        self.with(op!(_mm512_xor_ps(self.register, _mm512_and_ps(_mm512_set1_ps(-0.0), by.register))))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        u32::from(op!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.register, other.register)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        u32::from(op!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.register, other.register)))
    }

    #[inline(always)]
    fn negative(self) -> u32 {
        u32::from(op!(_mm512_movepi32_mask(_mm512_castps_si512(self.register))))
    }

    #[inline(always)]
    fn replace(self, other: Self, mask: u32) -> Self {
        self.with(op!(_mm512_mask_mov_ps(self.register, mask as u16, other.register)))
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        op!(_mm512_reduce_min_ps(self.register))
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        op!(_mm512_reduce_max_ps(self.register))
    }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn spread16(a: __m512, lanes: [u8; 4]) -> __m512 {
    let quads = _mm_cvtepu8_epi32(_mm_cvtsi32_si128(i32::from_le_bytes(lanes)));
    let places = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    let lanes = _mm512_permutexvar_epi32(places, _mm512_castsi128_si512(quads));
    _mm512_permutexvar_ps(lanes, a)
}

impl Quads for X16 {
    type F4 = X4<Avx512>;

    #[inline(always)]
    fn repeat(isa: Avx512, quad: X4<Avx512>) -> Self {
        Self { register: op!(_mm512_broadcast_f32x4(quad.register())), isa }
    }

    #[inline(always)]
    fn spread(self, lanes: [u8; 4]) -> Self {
        self.with(op!(spread16(self.register, lanes)))
    }
}
