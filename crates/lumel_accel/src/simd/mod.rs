//! Vectors of numbers, written once and compiled for several instruction sets.
//!
//! A kernel is generic over [`Simd`], a token whose existence proves that the processor has the instructions; all
//! vectors start from it. [`Simd::call`] enters a kernel with those instructions switched on, and everything that the
//! kernel calls is inlined into it. Kernels are chosen once per call of the tracer, never per ray.
//!
//! Every operation rounds as IEEE 754 says, and `mul_add` rounds once, on all instruction sets: the same kernel gives
//! the same hits everywhere. Without fused instructions it is slow but the same.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
mod neon;
mod pair;
mod portable;

use std::fmt;

/// A set of instructions that the tracer has kernels for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Whatever the program was compiled for: the reference.
    Portable,
    /// NEON, on 64-bit ARM: four registers of four numbers to a packet.
    Neon,
    /// AVX2 with fused multiply-add: two registers of eight numbers to a packet.
    Avx2,
    /// AVX-512 (F, VL, DQ and BW): a packet to a register.
    Avx512,
}

impl InstructionSet {
    /// All that this machine has, the fastest last.
    pub fn available() -> Vec<Self> {
        [Self::Portable, Self::Neon, Self::Avx2, Self::Avx512]
            .into_iter()
            .filter(|set| set.is_available())
            .collect()
    }

    /// The fastest that this machine has.
    pub fn best() -> Self {
        Self::available().last().copied().unwrap_or(Self::Portable)
    }

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Neon => {
                cfg!(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => avx2::Avx2::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => avx512::Avx512::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Runs a kernel with these instructions; with portable ones where the machine lacks them.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        {
            if self == Self::Avx512
                && let Some(isa) = avx512::Avx512::detect()
            {
                return isa.call(kernel);
            }
            if self == Self::Avx2
                && let Some(isa) = avx2::Avx2::detect()
            {
                return isa.call(kernel);
            }
        }
        #[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
        if self == Self::Neon {
            return neon::Neon.call(kernel);
        }
        portable::Portable.call(kernel)
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Portable => "portable",
            Self::Neon => "NEON",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        })
    }
}

/// A computation that is compiled for every instruction set.
pub(crate) trait Kernel {
    /// What it finds.
    type Output;

    /// Computes; must be marked `#[inline(always)]`, as must all that it calls.
    fn run<S: Simd>(self, isa: S) -> Self::Output;
}

/// A proof that the processor has certain instructions, and their vectors.
pub(crate) trait Simd: Copy {
    /// Four numbers: the triangles of a block.
    type F4: Lanes<Isa = Self, Array = [f32; 4]>;
    /// Eight numbers: the children of a node.
    type F8: Lanes<Isa = Self, Array = [f32; 8]> + Permute;
    /// Sixteen numbers: the rays of a packet.
    type F16: Lanes<Isa = Self, Array = [f32; 16]> + Quads<F4 = Self::F4>;

    /// Runs a kernel with the instructions switched on.
    fn call<K: Kernel>(self, kernel: K) -> K::Output;
}

/// A few numbers side by side. Comparisons return a bit per lane, the first lane in bit 0.
pub(crate) trait Lanes: Copy {
    /// The instructions it needs.
    type Isa: Simd;
    /// The numbers in memory.
    type Array: Copy;

    fn splat(isa: Self::Isa, value: f32) -> Self;
    fn load(isa: Self::Isa, from: &Self::Array) -> Self;
    fn store(self, to: &mut Self::Array);
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// The smaller one; `other` if either is NaN, and any of two zeros.
    fn min(self, other: Self) -> Self;
    /// The larger one; `other` if either is NaN, and any of two zeros.
    fn max(self, other: Self) -> Self;
    /// `self * factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `self * factor - term`, rounded once.
    fn mul_sub(self, factor: Self, term: Self) -> Self;
    fn abs(self) -> Self;
    /// Changes the sign where `by` is negative.
    fn flip(self, by: Self) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;
    /// Where the sign is set, that of -0 too.
    fn negative(self) -> u32;
    /// `other` where the mask is set; any bits, NaN too, are kept.
    fn replace(self, other: Self, mask: u32) -> Self;
    /// The smallest lane; the sign of a zero is not prescribed.
    fn smallest(self) -> f32;
    /// The largest lane; the sign of a zero is not prescribed.
    fn largest(self) -> f32;
}

/// Eight lanes in another order.
pub(crate) trait Permute {
    /// Lane `i` of the result is lane `order >> 3 i & 7`.
    fn permute(self, order: u32) -> Self;
}

/// Sixteen lanes as four times four.
pub(crate) trait Quads: Lanes {
    /// Four of them.
    type F4;

    /// The same four numbers, four times.
    fn repeat(isa: Self::Isa, quad: Self::F4) -> Self;

    /// Each of four lanes, four times.
    fn spread(self, lanes: [u8; 4]) -> Self;
}

#[cfg(test)]
mod tests;
