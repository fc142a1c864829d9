//! AVX2 with fused multiply-add.
//!
//! Every operation is one or two instructions.
#![allow(
    unsafe_code,
    reason = "instructions that a processor may lack; the token proves that this one has them"
)]

use super::lanes::{Kernel, Lanes, Permute, Quads, Simd};
use super::pair::{Pair, lanes_of_pair};
use std::arch::x86_64::*;

/// The processor has AVX2 and FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
    }

    #[inline(never)]
    #[target_feature(enable = "avx2,fma")]
    fn enter<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

impl Simd for Avx2 {
    type F4 = X4<Self>;
    type F8 = X8<Self>;
    type F16 = Pair<X8<Self>>;

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: a token exists only where `detect` found the instructions.
        unsafe { self.enter(kernel) }
    }
}

/// Tokens that prove AVX2 and FMA.
pub(crate) trait HasAvx2: Simd {}
impl HasAvx2 for Avx2 {}

/// Four lanes in an SSE register.
#[derive(Clone, Copy)]
pub(crate) struct X4<S> {
    register: __m128,
    isa: S,
}

/// Eight lanes in an AVX register.
#[derive(Clone, Copy)]
pub(crate) struct X8<S> {
    pub(super) register: __m256,
    pub(super) isa: S,
}

/// Each operation is safe because the token in the vector proves that the processor has the instructions.
macro_rules! op {
    ($body:expr) => {{
        // SAFETY: see above; the loads and stores go to arrays of the register's size and need no alignment.
        unsafe { $body }
    }};
}
pub(super) use op;

/// The lanes of a mask as a vector of all ones or zeros.
macro_rules! lanes {
    ($name:ident, $n:literal, $register:ident, $set1:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident,
     $div:ident, $min:ident, $max:ident, $fmadd:ident, $fmsub:ident, $and:ident, $andnot:ident, $xor:ident, $cmp:ident,
     $movemask:ident, $replace:expr, $smallest:expr, $largest:expr) => {
        impl<S> $name<S> {
            #[inline(always)]
            fn with(self, register: $register) -> Self {
                Self { register, isa: self.isa }
            }
        }

        impl<S: HasAvx2> Lanes for $name<S> {
            type Isa = S;
            type Array = [f32; $n];

            #[inline(always)]
            fn splat(isa: S, value: f32) -> Self {
                Self { register: op!($set1(value)), isa }
            }

            #[inline(always)]
            fn load(isa: S, from: &[f32; $n]) -> Self {
                Self { register: op!($load(from.as_ptr())), isa }
            }

            #[inline(always)]
            fn store(self, to: &mut [f32; $n]) {
                op!($store(to.as_mut_ptr(), self.register));
            }

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self.with(op!($add(self.register, other.register)))
            }

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self.with(op!($sub(self.register, other.register)))
            }

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                self.with(op!($mul(self.register, other.register)))
            }

            #[inline(always)]
            fn div(self, other: Self) -> Self {
                self.with(op!($div(self.register, other.register)))
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.with(op!($min(self.register, other.register)))
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.with(op!($max(self.register, other.register)))
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self.with(op!($fmadd(self.register, factor.register, term.register)))
            }

            #[inline(always)]
            fn mul_sub(self, factor: Self, term: Self) -> Self {
                self.with(op!($fmsub(self.register, factor.register, term.register)))
            }

            #[inline(always)]
            fn abs(self) -> Self {
                self.with(op!($andnot($set1(-0.0), self.register)))
            }

            #[inline(always)]
            fn flip(self, by: Self) -> Self {
                self.with(op!($xor(self.register, $and($set1(-0.0), by.register))))
            }

            #[inline(always)]
            fn lt(self, other: Self) -> u32 {
                op!($movemask($cmp::<_CMP_LT_OQ>(self.register, other.register))) as u32
            }

            #[inline(always)]
            fn le(self, other: Self) -> u32 {
                op!($movemask($cmp::<_CMP_LE_OQ>(self.register, other.register))) as u32
            }

            #[inline(always)]
            fn negative(self) -> u32 {
                op!($movemask(self.register)) as u32
            }

            #[inline(always)]
            fn replace(self, other: Self, mask: u32) -> Self {
                self.with(op!($replace(self.register, other.register, mask)))
            }

            #[inline(always)]
            fn smallest(self) -> f32 {
                op!($smallest(self.register))
            }

            #[inline(always)]
            fn largest(self) -> f32 {
                op!($largest(self.register))
            }
        }
    };
}

lanes!(
    X4,
    4,
    __m128,
    _mm_set1_ps,
    _mm_loadu_ps,
    _mm_storeu_ps,
    _mm_add_ps,
    _mm_sub_ps,
    _mm_mul_ps,
    _mm_div_ps,
    _mm_min_ps,
    _mm_max_ps,
    _mm_fmadd_ps,
    _mm_fmsub_ps,
    _mm_and_ps,
    _mm_andnot_ps,
    _mm_xor_ps,
    _mm_cmp_ps,
    _mm_movemask_ps,
    replace4,
    smallest4,
    largest4
);
lanes!(
    X8,
    8,
    __m256,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    _mm256_fmadd_ps,
    _mm256_fmsub_ps,
    _mm256_and_ps,
    _mm256_andnot_ps,
    _mm256_xor_ps,
    _mm256_cmp_ps,
    _mm256_movemask_ps,
    replace8,
    smallest8,
    largest8
);
lanes_of_pair!(X8<Avx2>, Avx2, 8, 16);

#[inline]
#[target_feature(enable = "avx2,fma")]
fn replace4(a: __m128, b: __m128, mask: u32) -> __m128 {
    let bits = _mm_setr_epi32(1, 2, 4, 8);
    let set = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(mask as i32), bits), bits);
    _mm_blendv_ps(a, b, _mm_castsi128_ps(set))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn replace8(a: __m256, b: __m256, mask: u32) -> __m256 {
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let set = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), bits), bits);
    _mm256_blendv_ps(a, b, _mm256_castsi256_ps(set))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn smallest4(a: __m128) -> f32 {
    let pairs = _mm_min_ps(a, _mm_movehl_ps(a, a));
    _mm_cvtss_f32(_mm_min_ss(pairs, _mm_movehdup_ps(pairs)))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn largest4(a: __m128) -> f32 {
    let pairs = _mm_max_ps(a, _mm_movehl_ps(a, a));
    _mm_cvtss_f32(_mm_max_ss(pairs, _mm_movehdup_ps(pairs)))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn smallest8(a: __m256) -> f32 {
    smallest4(_mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn largest8(a: __m256) -> f32 {
    largest4(_mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn permute8(a: __m256, order: u32) -> __m256 {
    let shifts = _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21);
    // The instruction looks at the three lowest bits of each index only.
    _mm256_permutevar8x32_ps(a, _mm256_srlv_epi32(_mm256_set1_epi32(order as i32), shifts))
}

impl<S: HasAvx2> Permute for X8<S> {
    #[inline(always)]
    fn permute(self, order: u32) -> Self {
        self.with(op!(permute8(self.register, order)))
    }
}

impl<S> X4<S> {
    #[inline(always)]
    pub(super) fn register(self) -> __m128 {
        self.register
    }
}

impl Quads for Pair<X8<Avx2>> {
    type F4 = X4<Avx2>;

    #[inline(always)]
    fn repeat(isa: Avx2, quad: X4<Avx2>) -> Self {
        let both = X8 { register: op!(_mm256_broadcast_ps(&quad.register)), isa };
        Self(both, both)
    }

    #[inline(always)]
    fn spread(self, lanes: [u8; 4]) -> Self {
        let mut all = [0.0; 16];
        self.store(&mut all);
        let two = |[a, b]: [u8; 2]| {
            let [a, b] = [a, b].map(|lane| all[usize::from(lane) % 16]);
            X8 { register: op!(_mm256_set_m128(_mm_set1_ps(b), _mm_set1_ps(a))), isa: self.0.isa }
        };
        Self(two([lanes[0], lanes[1]]), two([lanes[2], lanes[3]]))
    }
}
