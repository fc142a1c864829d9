//! How densely and by which estimators light is measured.

use lumel_basis::Sampling;
use lumel_sample::{Dim, SamplerKind, Stream, StreamKey};
use serde::{Deserialize, Serialize};

/// How the light of a rectangle or an emissive triangle is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightSampling {
    /// Points uniform over the light's area; the textbook estimator. Unbiased, but noisy close to the light.
    Area,
    /// The closed form of the unblocked light minus a sampled estimate of what is blocked, sampled uniformly in
    /// solid angle. Unbiased, and free of noise wherever the light is seen whole or not at all.
    #[default]
    Analytic,
}

/// How light from emissive surfaces reaches the receivers. Each is counted once, whichever way is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EmitterSampling {
    /// Shadow rays go to triangles and texels by the light that they send. Where that has no closed form, hemisphere rays
    /// find it too, and both are weighted so that neither is noisy. By hemisphere rays alone if nearly all surfaces emit the
    /// same.
    #[default]
    Auto,
    /// By shadow rays alone.
    Lights,
    /// Hemisphere rays find them. Free of noise when all surfaces emit, very noisy when few do.
    Rays,
    /// Not at all: only lights and sky shine.
    Off,
}

/// The settings of one measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Where sample points come from.
    pub sampler: SamplerKind,
    /// Shadow rays per receiver and light.
    pub direct_samples: u32,
    /// Hemisphere rays per receiver.
    pub indirect_samples: u32,
    /// Changes all random choices.
    pub seed: u64,
    /// The estimator for lights with an area.
    pub light_sampling: LightSampling,
    /// What to do with emissive surfaces.
    pub emitters: EmitterSampling,
    /// Which portion of their sequence the samples are: `N` samples are those from number `portion * N` on, so that portions
    /// of equal size are spread evenly with each other.
    ///
    /// Not for stratified samples, whose number is that of their cells.
    pub portion: u32,
}

/// Of this many samples that a vertex would get, an element with an area gets one: as there are about twice as many
/// triangles as vertices, both are measured by the same number of rays.
const AREA_SHARE: u32 = 2;

/// At least this many samples of an area, so that each corner of a triangle gets something.
const MIN_AREA_SAMPLES: u32 = 4;

impl Plan {
    /// The stream of an element's `samples` points for one purpose.
    pub(crate) fn stream(&self, samples: u32, key: StreamKey, dim: Dim) -> Stream {
        let stream = self.sampler.for_count(samples).stream(key, dim);
        stream.without_first(samples.wrapping_mul(self.portion))
    }

    /// The number of samples taken of an element when `requested` are asked for, with so many
    /// [doublings](lumel_basis::Receivers::doublings).
    pub(crate) fn samples(&self, requested: u32, sampling: Sampling, doublings: i8) -> u32 {
        let doubled = |n: u32| match doublings {
            0.. => n.saturating_mul(1 << doublings.min(30)),
            _ => n >> doublings.unsigned_abs().min(31),
        };
        self.sampler.sample_count(match sampling {
            Sampling::Point => doubled(requested),
            Sampling::Area => doubled(requested / AREA_SHARE).max(MIN_AREA_SAMPLES),
        })
    }
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            sampler: SamplerKind::Sobol,
            direct_samples: 64,
            indirect_samples: 256,
            seed: 0,
            light_sampling: LightSampling::default(),
            emitters: EmitterSampling::default(),
            portion: 0,
        }
    }
}
