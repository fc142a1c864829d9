//! The independent choices of a measurement, to run one test body over all of them.

use lumel_sample::SamplerKind;
use lumel_transport::{LightSampling, Plan};
use std::fmt;

/// How light is stored and measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// At vertices: [`VertexBasis`](lumel_basis::VertexBasis).
    Vertex,
    /// Over the triangles around vertices: [`AreaVertexBasis`](lumel_basis::AreaVertexBasis).
    VertexArea,
}

impl Storage {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Vertex, Self::VertexArea];
}

/// A sampler and an estimator of lights: all that matters for point receivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Estimator {
    /// Where sample points come from.
    pub sampler: SamplerKind,
    /// How lights with an area are estimated.
    pub light: LightSampling,
}

impl Estimator {
    /// Every sampler with every estimator.
    pub fn all() -> impl Iterator<Item = Self> {
        let lights = [LightSampling::Area, LightSampling::Analytic];
        SamplerKind::ALL
            .into_iter()
            .flat_map(move |sampler| lights.into_iter().map(move |light| Self { sampler, light }))
    }

    /// Settings with this estimator.
    pub fn plan(self, direct_samples: u32, indirect_samples: u32) -> Plan {
        Plan {
            sampler: self.sampler,
            light_sampling: self.light,
            direct_samples,
            indirect_samples,
            ..Plan::default()
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} sampler, {:?} light", self.sampler, self.light)
    }
}

/// A basis, a sampler and an estimator of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Combination {
    /// How light is stored.
    pub storage: Storage,
    /// How it is estimated.
    pub estimator: Estimator,
}

impl Combination {
    /// Every basis with every sampler and every estimator.
    pub fn all() -> impl Iterator<Item = Self> {
        Storage::ALL
            .into_iter()
            .flat_map(|storage| Estimator::all().map(move |estimator| Self { storage, estimator }))
    }
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} basis, {}", self.storage, self.estimator)
    }
}
