//! Levels of points that are measured where light needs them.

use crate::settings::{Adaptive, PointSpacing, Settings};
use lumel_basis::{Basis, Receivers};
use lumel_sample::SamplerKind;
use lumel_solve::{Halves, Refinement};
use lumel_transport::{CachedTransport, CpuTransport, Plan, Rows, Transport};

/// How far the settings refine levels of points; `None` if all points are measured.
pub(crate) fn refinement(settings: &Settings, textured: bool) -> Option<Refinement> {
    let error = settings.adaptive.error().filter(|_| settings.refines_points())?;
    let bytes = Rows::bytes_for(settings.indirect_samples.into(), textured).max(1);
    let in_memory = usize::try_from(settings.memory.0 / bytes).unwrap_or(usize::MAX);
    Some(Refinement { error: error.get().into(), max_nodes: in_memory.min(settings.max_vertices as usize) })
}

impl Settings {
    /// Whether the mesh follows light.
    pub fn refines_mesh(&self) -> bool {
        self.adaptive != Adaptive::Off && self.point_spacing == PointSpacing::Off
    }

    /// Whether it is points, not the mesh, that follow light.
    pub(crate) fn refines_points(&self) -> bool {
        self.adaptive != Adaptive::Off && self.point_spacing != PointSpacing::Off
    }
}

/// Operators on the stored rays of some points.
pub(crate) struct StoredHalves<B, R> {
    /// Traces nothing itself.
    pub(crate) like: CachedTransport<B, R>,
    /// The samples of both halves.
    pub(crate) plan: Plan,
    /// Measures direct light.
    pub(crate) direct: CpuTransport<B, R>,
}

impl<B: Basis + 'static, R: Receivers + 'static> Halves for StoredHalves<B, R> {
    fn operator(&self, half: u32, nodes: &[bool]) -> Box<dyn Transport> {
        let Plan { direct_samples, indirect_samples, sampler, seed, .. } = self.plan;
        // Halves of a sequence complement each other; strata have none.
        let (portion, seed) =
            if sampler == SamplerKind::Stratified { (0, seed ^ u64::from(half)) } else { (half, seed) };
        let [direct_samples, indirect_samples] = [direct_samples, indirect_samples].map(|n| n.div_ceil(2));
        let plan = Plan { direct_samples, indirect_samples, portion, seed, ..self.plan };
        Box::new(self.like.with_samples(plan, nodes))
    }

    fn direct(&self) -> Option<&dyn Transport> {
        (!self.direct.needs_hemisphere()).then_some(&self.direct)
    }
}
