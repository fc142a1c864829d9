//! Vectors as arrays: what any processor can do, and the oracle of the others.
//!
//! Compilers turn these loops into what vectors the target has at least, such as SSE2 on x86-64.

use super::lanes::{Kernel, Lanes, Permute, Quads, Simd};

/// Needs nothing.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Simd for Portable {
    type F4 = Array<4>;
    type F8 = Array<8>;
    type F16 = Array<16>;

    #[inline(never)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Array<const N: usize>([f32; N]);

impl<const N: usize> Array<N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn test(self, f: impl Fn(usize, f32) -> bool) -> u32 {
        (0..N).fold(0, |mask, i| mask | u32::from(f(i, self.0[i])) << i)
    }
}

impl<const N: usize> Lanes for Array<N> {
    type Isa = Portable;
    type Array = [f32; N];

    #[inline(always)]
    fn splat(_: Portable, value: f32) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn load(_: Portable, from: &[f32; N]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; N]) {
        *to = self.0;
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].mul_add(factor.0[i], term.0[i])))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].mul_add(factor.0[i], -term.0[i])))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn flip(self, by: Self) -> Self {
        self.zip(by, |a, b| f32::from_bits(a.to_bits() ^ (b.to_bits() & SIGN)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.test(|i, a| a < other.0[i])
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.test(|i, a| a <= other.0[i])
    }

    #[inline(always)]
    fn negative(self) -> u32 {
        self.test(|_, a| a.is_sign_negative())
    }

    #[inline(always)]
    fn replace(self, other: Self, mask: u32) -> Self {
        Self(std::array::from_fn(|i| if mask >> i & 1 == 1 { other.0[i] } else { self.0[i] }))
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
}

const SIGN: u32 = 1 << 31;

impl Permute for Array<8> {
    #[inline(always)]
    fn permute(self, order: u32) -> Self {
        Self(std::array::from_fn(|i| self.0[(order >> (3 * i) & 7) as usize]))
    }
}

impl Quads for Array<16> {
    type F4 = Array<4>;

    #[inline(always)]
    fn repeat(_: Portable, quad: Array<4>) -> Self {
        Self(std::array::from_fn(|i| quad.0[i % 4]))
    }

    #[inline(always)]
    fn spread(self, lanes: [u8; 4]) -> Self {
        Self(std::array::from_fn(|i| self.0[usize::from(lanes[i / 4]) % 16]))
    }
}
