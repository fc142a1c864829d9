//! A scene that light is measured in.

use lumel::{Bvh, RayTracer, Scene};
use lumel_basis::{PointReceivers, VertexBasis};
use lumel_transport::{CpuTransport, Plan};
use std::sync::Arc;

/// A scene with its ray tracer and basis.
pub(crate) struct Place {
    pub(crate) scene: Arc<Scene>,
    pub(crate) tracer: Arc<dyn RayTracer>,
    pub(crate) basis: Arc<VertexBasis>,
}

impl Place {
    pub(crate) fn new(scene: Scene) -> Self {
        let scene = Arc::new(scene);
        let basis = Arc::new(VertexBasis::new(Arc::clone(&scene)));
        Self { tracer: Arc::new(Bvh::build(&scene)), basis, scene }
    }

    /// What measures light at points, read from a field of the basis if one is the source.
    pub(crate) fn towards(
        &self,
        points: PointReceivers,
        plan: Plan,
    ) -> CpuTransport<VertexBasis, PointReceivers> {
        let (scene, tracer) = (Arc::clone(&self.scene), Arc::clone(&self.tracer));
        CpuTransport::new(scene, tracer, Arc::clone(&self.basis), Arc::new(points), plan)
    }
}
