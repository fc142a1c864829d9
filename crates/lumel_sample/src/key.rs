//! Names of sample streams: which element, bounce and pass, and what the numbers are for.

use crate::bits::{GOLDEN, mix};

/// A stateless name for a stream of samples: a hash of seed, element, bounce and pass.
///
/// Each step of the chain has its own domain and hashes what came before, so `element(1).bounce(2)`,
/// `element(2).bounce(1)` and `bounce(2).element(1)` are three different, independent streams. For a given key,
/// one step never maps two numbers to the same key; two whole chains of equal length collide with probability
/// 2⁻⁶⁴.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamKey(u64);

impl StreamKey {
    /// The root of all streams of a bake with this `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(mix(seed.wrapping_add(GOLDEN)))
    }

    /// The stream of element `e`: a vertex, a triangle or a lumel.
    #[inline]
    #[must_use]
    pub fn element(self, e: u32) -> Self {
        self.absorb(Domain::Element, e)
    }

    /// The stream of bounce `b`; 0 is direct light.
    #[inline]
    #[must_use]
    pub fn bounce(self, b: u32) -> Self {
        self.absorb(Domain::Bounce, b)
    }

    /// The stream of pass `p`: one more set of samples.
    #[inline]
    #[must_use]
    pub fn pass(self, p: u32) -> Self {
        self.absorb(Domain::Pass, p)
    }

    /// The key of one padded set of dimensions.
    #[inline]
    #[must_use]
    pub fn purpose(self, dim: Dim) -> Self {
        let (tag, number) = match dim {
            Dim::Area => (0, 0),
            Dim::Hemisphere => (1, 0),
            Dim::Light(light) => (2, light),
            Dim::LightPilot(light) => (3, light),
            Dim::LightSelect => (4, 0),
            Dim::Validity => (5, 0),
            Dim::Pixel => (6, 0),
        };
        self.absorb(Domain::Purpose(tag), number)
    }

    /// The hash itself: 64 well-mixed bits.
    #[inline]
    pub(crate) fn bits(self) -> u64 {
        self.0
    }

    #[inline]
    fn absorb(self, domain: Domain, number: u32) -> Self {
        let domain = match domain {
            Domain::Element => 1,
            Domain::Bounce => 2,
            Domain::Pass => 3,
            Domain::Purpose(tag) => 4 + u64::from(tag),
        };
        // The payload is below 2⁴⁰ and the sum and the mixing are bijections: no two payloads collide.
        Self(mix(self.0.wrapping_add(GOLDEN) ^ (domain << 32) ^ u64::from(number)))
    }
}

/// What a set of sample dimensions is used for.
///
/// Sets of different purpose under one key are padded: independent of each other, each stratified in itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dim {
    /// Where on an element the receiver lies.
    Area,
    /// The direction of a gather ray. In 4-D: receiver and direction together.
    Hemisphere,
    /// The point on light number `.0`.
    Light(u32),
    /// The independent set that decides how light number `.0` is estimated.
    LightPilot(u32),
    /// Which of many lights is sampled.
    LightSelect,
    /// The test whether a receiver lies inside of geometry.
    Validity,
    /// The position inside of a pixel.
    Pixel,
}

/// Keeps the links of a [`StreamKey`] chain apart.
#[derive(Clone, Copy)]
enum Domain {
    Element,
    Bounce,
    Pass,
    Purpose(u8),
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn chains_depend_on_order_and_domain() {
        let root = StreamKey::new(7);
        assert_ne!(root.element(1).bounce(2), root.element(2).bounce(1));
        assert_ne!(root.element(1).bounce(2), root.bounce(2).element(1));
        assert_ne!(root.element(3), root.bounce(3));
        assert_ne!(root.bounce(3), root.pass(3));
        assert_ne!(root.element(0), root);
        assert_ne!(StreamKey::new(0), StreamKey::new(1));
    }

    #[test]
    fn purposes_are_distinct() {
        let root = StreamKey::new(7);
        let lights = (0..4).flat_map(|i| [Dim::Light(i), Dim::LightPilot(i)]);
        let others = [Dim::Area, Dim::Hemisphere, Dim::LightSelect, Dim::Validity, Dim::Pixel];
        let dims: Vec<Dim> = lights.chain(others).collect();
        let keys: BTreeSet<u64> = dims.iter().map(|&dim| root.purpose(dim).bits()).collect();
        assert_eq!(keys.len(), dims.len());
    }

    #[test]
    fn neighbouring_chains_never_collide() {
        let mut keys = BTreeSet::new();
        for seed in 0..8 {
            for e in 0..32 {
                for b in 0..8 {
                    for p in 0..8 {
                        keys.insert(StreamKey::new(seed).element(e).bounce(b).pass(p).bits());
                    }
                }
            }
        }
        assert_eq!(keys.len(), 8 * 32 * 8 * 8);
    }
}
