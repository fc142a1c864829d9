//! A vector of two halves, for instruction sets whose registers are narrower than a packet.

#[derive(Clone, Copy)]
pub(crate) struct Pair<L>(pub(super) L, pub(super) L);

/// Implements [`Lanes`] for a pair of vectors of `$half` lanes.
///
/// Not generic over the length: arrays of twice an associated length cannot be named.
macro_rules! lanes_of_pair {
    ($lanes:ty, $isa:ty, $half:literal, $whole:literal) => {
        impl $crate::simd::lanes::Lanes for $crate::simd::pair::Pair<$lanes> {
            type Isa = $isa;
            type Array = [f32; $whole];

            #[inline(always)]
            fn splat(isa: $isa, value: f32) -> Self {
                Self(<$lanes>::splat(isa, value), <$lanes>::splat(isa, value))
            }

            #[inline(always)]
            fn load(isa: $isa, from: &[f32; $whole]) -> Self {
                let ([low, high], _) = from.as_chunks::<$half>() else { unreachable!() };
                Self(<$lanes>::load(isa, low), <$lanes>::load(isa, high))
            }

            #[inline(always)]
            fn store(self, to: &mut [f32; $whole]) {
                let ([low, high], _) = to.as_chunks_mut::<$half>() else { unreachable!() };
                self.0.store(low);
                self.1.store(high);
            }

            #[inline(always)]
            fn negative(self) -> u32 {
                self.0.negative() | self.1.negative() << $half
            }

            #[inline(always)]
            fn lt(self, other: Self) -> u32 {
                self.0.lt(other.0) | self.1.lt(other.1) << $half
            }

            #[inline(always)]
            fn le(self, other: Self) -> u32 {
                self.0.le(other.0) | self.1.le(other.1) << $half
            }

            #[inline(always)]
            fn replace(self, other: Self, mask: u32) -> Self {
                Self(self.0.replace(other.0, mask), self.1.replace(other.1, mask >> $half))
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                Self(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
            }

            #[inline(always)]
            fn mul_sub(self, factor: Self, term: Self) -> Self {
                Self(self.0.mul_sub(factor.0, term.0), self.1.mul_sub(factor.1, term.1))
            }

            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs(), self.1.abs())
            }

            #[inline(always)]
            fn smallest(self) -> f32 {
                self.0.min(self.1).smallest()
            }

            #[inline(always)]
            fn largest(self) -> f32 {
                self.0.max(self.1).largest()
            }

            $crate::simd::pair::halves!(add, sub, mul, div, min, max, flip);
        }
    };
}

/// Operations of two vectors that go half by half.
macro_rules! halves {
    ($($name:ident),*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Self {
            Self(self.0.$name(other.0), self.1.$name(other.1))
        }
    )*};
}

pub(super) use {halves, lanes_of_pair};
