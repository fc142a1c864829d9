//! Stored rows whose replicates are independent.

use lumel_accel::RayTracer;
use lumel_basis::{Basis, Receivers};
use lumel_scene::Scene;
use lumel_transport::{
    CachedTransport, ChunkSink, Control, CpuTransport, Job, Plan, Shape, Stored, Transport, TransportError,
};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// An operator on stored rows that stores rows of their own for every pass, with a seed of its own.
///
/// A [`CachedTransport`] traces for all passes but the first. Tests want replicates of stored rows instead.
pub(crate) struct StoredPasses<B, R> {
    pub(crate) scene: Arc<Scene>,
    pub(crate) tracer: Arc<dyn RayTracer>,
    pub(crate) basis: Arc<B>,
    pub(crate) receivers: Arc<R>,
    pub(crate) plan: Plan,
    pub(crate) stored: Mutex<BTreeMap<u32, Stored>>,
}

impl<B: Basis, R: Receivers + 'static> StoredPasses<B, R> {
    fn pass(&self, pass: u32) -> CachedTransport<B, R> {
        // The golden ratio in 64 bits: seeds of different passes have nothing in common.
        let seed = self.plan.seed ^ u64::from(pass).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let (scene, tracer) = (Arc::clone(&self.scene), Arc::clone(&self.tracer));
        let (basis, receivers) = (Arc::clone(&self.basis), Arc::clone(&self.receivers));
        let inner = CpuTransport::new(scene, tracer, basis, receivers, Plan { seed, ..self.plan });
        let mut stored = self.stored.lock().expect("no test panics while it stores");
        let cached = CachedTransport::new(inner, stored.get(&pass));
        stored.insert(pass, cached.stored());
        cached
    }
}

impl<B: Basis, R: Receivers + 'static> Transport for StoredPasses<B, R> {
    fn shape(&self) -> Shape {
        self.pass(0).shape()
    }

    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        self.pass(job.pass).measure(&Job { pass: 0, ..*job }, chunks, control, sink)
    }
}
