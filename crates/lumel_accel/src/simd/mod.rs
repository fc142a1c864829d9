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
mod lanes;
#[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
mod neon;
mod pair;
mod portable;

pub(crate) use lanes::{Kernel, Lanes, Permute, Quads, Simd};

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

#[cfg(test)]
mod tests;
