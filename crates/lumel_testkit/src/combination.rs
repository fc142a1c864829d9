//! The independent choices of a measurement, to run one test body over all of them.

use lumel_sample::SamplerKind;
use lumel_transport::{LightSampling, Plan};
use std::fmt;

/// Where the nodes of the vertex basis are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// At vertices: [`PointReceivers`](lumel_basis::PointReceivers).
    Vertex,
    /// Over the triangles around vertices: [`AreaReceivers`](lumel_basis::AreaReceivers).
    VertexArea,
}

/// What happens to hemisphere rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// They are stored and serve every bounce: the default of bakes.
    Stored,
    /// Every application of the operator traces its own.
    Traced,
}

impl Solver {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Stored, Self::Traced];
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?} rays")
    }
}

/// How an operator measures: all that is not an estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Where.
    pub storage: Storage,
    /// With which rays.
    pub solver: Solver,
}

impl Method {
    /// Every storage with every solver.
    pub const ALL: [Self; 4] = [Self::VERTEX, Self::AREA, Self::VERTEX.traced(), Self::AREA.traced()];

    /// At vertices, with every solver.
    pub const AT_VERTICES: [Self; 2] = [Self::VERTEX, Self::VERTEX.traced()];

    /// Over areas, with every solver.
    pub const OVER_AREAS: [Self; 2] = [Self::AREA, Self::AREA.traced()];

    /// At vertices, on stored rays.
    pub const VERTEX: Self = Self { storage: Storage::Vertex, solver: Solver::Stored };

    /// Over areas, on stored rays.
    pub const AREA: Self = Self { storage: Storage::VertexArea, solver: Solver::Stored };

    /// The same with rays of its own for each application.
    #[must_use]
    pub const fn traced(self) -> Self {
        Self { storage: self.storage, solver: Solver::Traced }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} storage, {}", self.storage, self.solver)
    }
}

/// A sampler and an estimator of lights.
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

/// How light is measured at points, which have no storage of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtPoints {
    /// With which rays.
    pub solver: Solver,
    /// How light is estimated.
    pub estimator: Estimator,
}

impl AtPoints {
    /// Every solver with every sampler and every estimator.
    pub fn all() -> impl Iterator<Item = Self> {
        let with = |solver| Estimator::all().map(move |estimator| Self { solver, estimator });
        Solver::ALL.into_iter().flat_map(with)
    }
}

impl fmt::Display for AtPoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "points, {}, {}", self.solver, self.estimator)
    }
}

/// A method with an estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Combination {
    /// How the operator measures.
    pub method: Method,
    /// How light is estimated.
    pub estimator: Estimator,
}

impl Combination {
    /// Every method with every sampler and every estimator.
    pub fn all() -> impl Iterator<Item = Self> {
        let with = |method| Estimator::all().map(move |estimator| Self { method, estimator });
        Method::ALL.into_iter().flat_map(with)
    }
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.method, self.estimator)
    }
}
