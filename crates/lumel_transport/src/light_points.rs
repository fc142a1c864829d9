//! Sample points of a light in an order that keeps neighbours together.

use lumel_sample::Stream;

/// Bits of a Morton code per axis.
const BITS: u32 = 16;

/// The first points of a stream, along a space-filling curve through the unit square.
///
/// Any run of them covers few cells, so that shadow rays through it are a narrow beam.
#[derive(Default)]
pub(crate) struct LightPoints {
    points: Vec<(u64, [f32; 2])>,
    choices: Vec<([f32; 2], f32)>,
}

impl LightPoints {
    /// The first `n` points of `stream`.
    pub(crate) fn fill(&mut self, stream: &Stream, n: u32) -> &[(u64, [f32; 2])] {
        self.points.clear();
        self.points.extend((0..n).map(|i| {
            let u = stream.sample_2d(i);
            // The number makes keys unique, so that their order is too.
            (u64::from(morton(u)) << 32 | u64::from(i), u)
        }));
        self.points.sort_unstable_by_key(|(key, _)| *key);
        &self.points
    }

    /// The first `n` points of `stream`, each with a third coordinate that chooses a light, in the order of that.
    pub(crate) fn fill_by_choice(&mut self, stream: &Stream, n: u32) -> &[([f32; 2], f32)] {
        self.choices.clear();
        self.choices.extend((0..n).map(|i| {
            let [x, y, choice, _] = stream.sample_4d(i);
            ([x, y], choice)
        }));
        // Equal in all coordinates is equal: the order of such points cannot matter.
        let key = |(u, choice): &([f32; 2], f32)| [*choice, u[0], u[1]].map(f32::to_bits);
        self.choices.sort_unstable_by_key(key);
        &self.choices
    }
}

/// Interleaves the leading bits of two coordinates in `[0, 1)`.
fn morton(u: [f32; 2]) -> u32 {
    let [x, y] = u.map(|x| {
        let mut bits = (x * (1 << BITS) as f32) as u32 & 0xffff;
        for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    });
    x | y << 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_sample::{Dim, SamplerKind, StreamKey};

    #[test]
    fn quarters_of_a_sobol_set_lie_in_quarters_of_the_square() {
        let stream = SamplerKind::Sobol.for_count(256).stream(StreamKey::new(1), Dim::Light(0));
        let mut points = LightPoints::default();
        for (i, (_, u)) in points.fill(&stream, 256).iter().enumerate() {
            let quarter = usize::from(u[0] >= 0.5) + 2 * usize::from(u[1] >= 0.5);
            assert_eq!(quarter, i / 64);
        }
    }

    #[test]
    fn every_point_of_the_stream_comes_once() {
        let stream = SamplerKind::Halton.for_count(100).stream(StreamKey::new(1), Dim::Light(0));
        let mut points = LightPoints::default();
        let mut numbers: Vec<u32> = points.fill(&stream, 100).iter().map(|(key, _)| *key as u32).collect();
        numbers.sort_unstable();
        assert_eq!(numbers, (0..100).collect::<Vec<_>>());
    }
}
