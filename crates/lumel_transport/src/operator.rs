//! What an operator on this machine is made of.

use crate::hemisphere::HemisphereDensity;
use crate::job::{Job, Shape, Source};
use crate::lights::LightSet;
use crate::order::Order;
use crate::plan::Plan;
use crate::shots::Shooting;
use lumel_accel::RayTracer;
use lumel_basis::{Basis, ElementId, Identity, Receivers};
use lumel_sample::StreamKey;
use lumel_scene::Scene;
use std::sync::Arc;

/// Measures the elements of `R` under light that is read from the basis `B`, tracing rays for every job.
///
/// Runs on the threads of the caller's rayon pool.
pub struct CpuTransport<B, R> {
    pub(crate) scene: Arc<Scene>,
    pub(crate) tracer: Arc<dyn RayTracer>,
    /// Where light is read.
    pub(crate) basis: Arc<B>,
    /// Where it is measured.
    pub(crate) receivers: Arc<R>,
    pub(crate) lights: Arc<LightSet>,
    pub(crate) plan: Plan,
    /// How densely its hemisphere rays lie.
    pub(crate) density: HemisphereDensity,
    /// The elements that are measured, in the order of chunks.
    pub(crate) order: Order,
    /// What shots by the area form need to know, found when they first need it.
    pub(crate) shooting: Shooting,
    /// What decides those elements and their sites.
    elements: Identity,
}

impl<B: Basis, R: Receivers> CpuTransport<B, R> {
    /// The operator of a scene.
    pub fn new(
        scene: Arc<Scene>,
        tracer: Arc<dyn RayTracer>,
        basis: Arc<B>,
        receivers: Arc<R>,
        plan: Plan,
    ) -> Self {
        let order = Order::new(&*receivers);
        Self::in_order(scene, tracer, basis, (receivers, order), plan)
    }

    /// The operator of a scene, for receivers that have been ordered before.
    pub fn in_order(
        scene: Arc<Scene>,
        tracer: Arc<dyn RayTracer>,
        basis: Arc<B>,
        (receivers, order): (Arc<R>, Order),
        plan: Plan,
    ) -> Self {
        let lights = Arc::new(LightSet::new(&scene, &plan));
        let elements = receivers.identity();
        let (density, shooting) = (HemisphereDensity::default(), Shooting::default());
        Self { scene, tracer, basis, receivers, lights, plan, density, order, elements, shooting }
    }

    /// What measures other receivers under the same lights, with other samples.
    ///
    /// All else is shared, and so `plan.emitters` and `plan.light_sampling` have no effect on which lights are sampled together.
    pub fn towards<S: Receivers>(&self, receivers: Arc<S>, plan: Plan) -> CpuTransport<B, S> {
        let (order, elements) = (Order::new(&*receivers), receivers.identity());
        self.for_elements(receivers, order, elements, plan)
    }

    /// The same operator with other samples, for the elements alone that count towards one of certain nodes.
    ///
    /// All else is shared, and so `plan.emitters` has no effect. Nodes beside those asked for may be measured in part.
    pub fn with_samples(&self, plan: Plan, nodes: &[bool]) -> Self {
        let order = self.order.towards(&*self.receivers, nodes);
        let whole = order.elements().len() == self.order.elements().len();
        let elements = if whole { self.elements } else { order.identity_within(&self.elements) };
        self.for_elements(Arc::clone(&self.receivers), order, elements, plan)
    }

    /// What measures these elements, which `elements` tells from others, under the same lights.
    fn for_elements<S: Receivers>(
        &self,
        receivers: Arc<S>,
        order: Order,
        elements: Identity,
        plan: Plan,
    ) -> CpuTransport<B, S> {
        CpuTransport {
            scene: Arc::clone(&self.scene),
            tracer: Arc::clone(&self.tracer),
            basis: Arc::clone(&self.basis),
            lights: Arc::clone(&self.lights),
            shooting: Shooting::default(),
            density: self.density,
            receivers,
            order,
            elements,
            plan,
        }
    }

    /// Whether direct light is found by hemisphere rays, too: that of the sky and of emissive surfaces.
    pub fn needs_hemisphere(&self) -> bool {
        self.lights.needs_hemisphere()
    }

    /// What decides its elements and their sites.
    pub(crate) fn elements_identity(&self) -> Identity {
        self.elements
    }

    /// The elements of a chunk.
    pub(crate) fn elements(&self, chunk: u32) -> &[ElementId] {
        self.order.chunk(chunk)
    }

    /// The elements of a chunk that a job measures.
    pub(crate) fn active(&self, job: &Job<'_>, chunk: u32) -> Vec<ElementId> {
        self.elements(chunk).iter().copied().filter(|&element| job.measures(element)).collect()
    }

    /// The sample points of an element in a job.
    pub(crate) fn key(&self, job: &Job<'_>, element: ElementId) -> StreamKey {
        Self::key_in(job, StreamKey::new(self.plan.seed).element(self.receivers.stream(element)))
    }

    /// The sample points that all elements share in a job.
    pub(crate) fn shared_key(&self, job: &Job<'_>) -> StreamKey {
        Self::key_in(job, StreamKey::new(self.plan.seed))
    }

    fn key_in(job: &Job<'_>, key: StreamKey) -> StreamKey {
        // Validity is no bounce; it must not share the points of one.
        let bounce = if matches!(job.source, Source::Nothing) { u32::MAX } else { job.bounce };
        key.bounce(bounce).pass(job.pass)
    }

    /// Its sizes.
    pub(crate) fn sizes(&self) -> Shape {
        Shape {
            nodes: self.receivers.node_count(),
            channels: 1,
            elements: self.order.elements().len(),
            chunks: self.order.chunk_count(),
            sampling: self.receivers.sampling(),
        }
    }
}
