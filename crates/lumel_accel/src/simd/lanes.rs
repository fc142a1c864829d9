//! What an instruction set must offer.

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
