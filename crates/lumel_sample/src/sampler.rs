//! The choice of a sample sequence, and points from it.

use std::{error::Error, fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::{
    bits::{random_pair, unit_from_bits},
    halton::ShiftedHalton,
    key::{Dim, StreamKey},
    sobol::ScrambledSobol,
    stratified::JitteredGrid,
};

/// A stateless source of sample points: (key, index, dim) → point.
///
/// Each point alone is uniform over keys, so every mean over a stream is unbiased; the samplers differ in how
/// evenly the points of one stream lie. Coordinates lie in `[0, 1)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Independent points. RMS error ∝ N^-½ for any integrand.
    Random,
    /// One point in each cell of a `side × side` grid; indices from `side²` on begin another such layer.
    ///
    /// A `side` of zero counts as one. Cells are visited in plain order, so only whole layers are even. In 4-D the
    /// gain over random is small.
    Stratified {
        /// Number of cells along one axis.
        side: u16,
    },
    /// Halton points in bases 2, 3, 5 and 7 with a random toroidal shift: even for any count.
    Halton,
    /// Sobol points with nested (Owen) scrambling: the best choice for counts that are powers of two.
    Sobol,
}

impl Sampler {
    /// Prepares the points of one key and purpose; cheaper than [`sample_2d`](Self::sample_2d) in a loop.
    #[inline]
    #[must_use]
    pub fn stream(self, key: StreamKey, dim: Dim) -> Stream {
        let key = key.purpose(dim);
        let points = match self {
            Self::Random => Points::Random(key.bits()),
            Self::Stratified { side } => Points::Stratified(JitteredGrid::new(key.bits(), side)),
            Self::Halton => Points::Halton(ShiftedHalton::new(key.bits())),
            Self::Sobol => Points::Sobol(ScrambledSobol::new(key.bits())),
        };
        Stream { points, first: 0 }
    }

    /// Point number `index` of the unit square.
    #[inline]
    #[must_use]
    pub fn sample_2d(self, key: StreamKey, index: u32, dim: Dim) -> [f32; 2] {
        self.stream(key, dim).sample_2d(index)
    }

    /// Point number `index` of the 4-D unit cube.
    #[inline]
    #[must_use]
    pub fn sample_4d(self, key: StreamKey, index: u32, dim: Dim) -> [f32; 4] {
        self.stream(key, dim).sample_4d(index)
    }
}

/// The points of one [`Sampler`] for one key and purpose. Use either the 2-D or the 4-D points, not both.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    points: Points,
    /// The number of the point that is called 0.
    first: u32,
}

#[derive(Clone, Copy, Debug)]
enum Points {
    Random(u64),
    Stratified(JitteredGrid),
    Halton(ShiftedHalton),
    Sobol(ScrambledSobol),
}

impl Stream {
    /// The stream without its first `n` points, which go together with them: of a power of two of Sobol points, twice as
    /// many are spread as evenly.
    ///
    /// A stratified stream ends with its count, and so is to be replaced by one of another key.
    #[must_use]
    pub fn without_first(self, n: u32) -> Self {
        Self { first: self.first.wrapping_add(n), ..self }
    }

    /// Point number `index` of the unit square.
    #[inline]
    #[must_use]
    pub fn sample_2d(&self, index: u32) -> [f32; 2] {
        let index = self.first.wrapping_add(index);
        match &self.points {
            &Points::Random(key) => random_pair(key, u64::from(index)).map(unit_from_bits),
            Points::Stratified(grid) => grid.point_2d(index),
            Points::Halton(halton) => halton.point_2d(index),
            Points::Sobol(sobol) => sobol.point_2d(index),
        }
    }

    /// Point number `index` of the 4-D unit cube.
    #[inline]
    #[must_use]
    pub fn sample_4d(&self, index: u32) -> [f32; 4] {
        let index = self.first.wrapping_add(index);
        match &self.points {
            &Points::Random(key) => {
                let [a, b] = random_pair(key, 2 * u64::from(index));
                let [c, d] = random_pair(key, 2 * u64::from(index) + 1);
                [a, b, c, d].map(unit_from_bits)
            }
            Points::Stratified(grid) => grid.point_4d(index),
            Points::Halton(halton) => halton.point_4d(index),
            Points::Sobol(sobol) => sobol.point_4d(index),
        }
    }
}

/// The family of a [`Sampler`], as chosen in settings and on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SamplerKind {
    /// See [`Sampler::Random`].
    Random,
    /// See [`Sampler::Stratified`].
    Stratified,
    /// See [`Sampler::Halton`].
    Halton,
    /// See [`Sampler::Sobol`].
    #[default]
    Sobol,
}

impl SamplerKind {
    /// Every kind, from the noisiest to the best.
    pub const ALL: [Self; 4] = [Self::Random, Self::Stratified, Self::Halton, Self::Sobol];

    /// The number of samples that really are taken when `requested` are asked for.
    ///
    /// `Stratified` rounds up to the next square (at most 65535²), the others keep the number. At least one.
    #[must_use]
    pub fn sample_count(self, requested: u32) -> u32 {
        match self {
            Self::Stratified => u32::from(side_for(requested)).pow(2),
            Self::Random | Self::Halton | Self::Sobol => requested.max(1),
        }
    }

    /// The sampler for streams of `count` points.
    #[must_use]
    pub fn for_count(self, count: u32) -> Sampler {
        match self {
            Self::Random => Sampler::Random,
            Self::Stratified => Sampler::Stratified { side: side_for(count) },
            Self::Halton => Sampler::Halton,
            Self::Sobol => Sampler::Sobol,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Stratified => "stratified",
            Self::Halton => "halton",
            Self::Sobol => "sobol",
        }
    }
}

/// Side of the smallest square grid with at least `count` cells, as far as `u16` reaches.
fn side_for(count: u32) -> u16 {
    let floor = count.isqrt();
    let side = if floor * floor < count { floor + 1 } else { floor };
    u16::try_from(side).unwrap_or(u16::MAX).max(1)
}

impl fmt::Display for SamplerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for SamplerKind {
    type Err = UnknownSampler;

    fn from_str(name: &str) -> Result<Self, UnknownSampler> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| UnknownSampler(name.to_owned()))
    }
}

/// The text is not the name of a [`SamplerKind`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownSampler(String);

impl fmt::Display for UnknownSampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown sampler \"{}\": expected one of", self.0)?;
        for (i, kind) in SamplerKind::ALL.into_iter().enumerate() {
            write!(f, "{} {kind}", if i == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

impl Error for UnknownSampler {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_without_its_first_points_goes_on_where_they_end() {
        for sampler in [Sampler::Random, Sampler::Halton, Sampler::Sobol] {
            let stream = sampler.stream(StreamKey::new(1), Dim::Hemisphere);
            let rest = stream.without_first(5).without_first(3);
            for i in 0..20 {
                assert_eq!(rest.sample_2d(i), stream.sample_2d(i + 8));
                assert_eq!(rest.sample_4d(i), stream.sample_4d(i + 8));
            }
        }
    }

    #[test]
    fn stratified_counts_round_up_to_squares() {
        let counts = [(0, 1), (1, 1), (2, 4), (4, 4), (5, 9), (64, 64), (65, 81), (u32::MAX, 65535 * 65535)];
        for (requested, taken) in counts {
            assert_eq!(SamplerKind::Stratified.sample_count(requested), taken);
        }
        assert_eq!(SamplerKind::Stratified.for_count(65), Sampler::Stratified { side: 9 });
    }

    #[test]
    fn other_counts_are_kept_but_never_zero() {
        for kind in [SamplerKind::Random, SamplerKind::Halton, SamplerKind::Sobol] {
            assert_eq!([0, 1, 77].map(|n| kind.sample_count(n)), [1, 1, 77]);
        }
    }

    #[test]
    fn names_round_trip() {
        for kind in SamplerKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        assert_eq!(SamplerKind::default(), SamplerKind::Sobol);
        let error = "poisson".parse::<SamplerKind>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown sampler \"poisson\": expected one of random, stratified, halton, sobol"
        );
    }
}
