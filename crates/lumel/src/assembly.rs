//! The operators that settings ask for.

use crate::BounceBasis;
use crate::direct_at_vertices::{AtVertices, DirectAtVertices};
use crate::method::Method;
use crate::point_levels::StoredHalves;
use crate::settings::{Memory, ScheduleKind, Settings, SolverKind, TargetError};
use crate::surfaces::{Ordered, Surfaces};
use crate::target::{self, StoredReplicates};
use lumel_basis::{Directional, Receivers, Sampling};
use lumel_scene::Scene;
use lumel_solve::{Halves, REPLICATES, Replicates, Schedule, Target};
use lumel_transport::{
    CachedTransport, CpuTransport, DirectionalTransport, Order, Plan, Rows, Stored, Transport,
};
use std::sync::Arc;

/// What solves a scene with certain settings.
pub(crate) struct Assembly {
    pub(crate) method: Method,
    pub(crate) schedule: Box<dyn Schedule>,
    /// Measures direct light and bounces.
    pub(crate) transport: Box<dyn Transport>,
    pub(crate) stored: StoredRays,
    pub(crate) rest: Rest,
    /// Measures direct light at the vertices, where points carry the bounces.
    pub(crate) direct: Option<AtVertices>,
    /// Measures some of the points, where these follow light.
    pub(crate) halves: Option<Box<dyn Halves + Send>>,
    /// Measures all light by direction in the end, where the settings want it.
    pub(crate) directional: Option<Box<dyn Transport>>,
}

/// The rays that operators store, and others of the same surfaces may share.
#[derive(Clone, Default)]
pub(crate) struct StoredRays {
    /// Those that bounces are measured by.
    pub(crate) bounces: Option<Stored>,
    /// Those of light by direction.
    pub(crate) directional: Option<Stored>,
}

/// What an operator's transport alone does not do.
pub(crate) enum Rest {
    Nothing,
    /// Gathers all light once more, where not all rays are stored.
    Gather(Box<dyn Transport>),
    /// Solves with independent samples instead, where the settings have a target error.
    Replicates(Target, Box<dyn Replicates + Send>),
}

impl Assembly {
    /// The operators of a scene; `stored` rays of the same surfaces are used again where they are the same.
    pub(crate) fn new(
        scene: &Arc<Scene>,
        surfaces: &Surfaces,
        settings: &Settings,
        stored: &StoredRays,
    ) -> Self {
        match settings.sampling() {
            Sampling::Point => {
                Parts { scene, surfaces, measured: surfaces.at_nodes(), settings }.assembly(stored)
            }
            Sampling::Area => {
                Parts { scene, surfaces, measured: surfaces.over_areas(), settings }.assembly(stored)
            }
        }
    }

    /// The operator with so many samples, every job of which traces rays of its own.
    pub(crate) fn traced(
        scene: &Arc<Scene>,
        surfaces: &Surfaces,
        settings: &Settings,
        [direct_samples, indirect_samples]: [u32; 2],
    ) -> Box<dyn Transport> {
        let (solver, target_error, directional) = (SolverKind::Neumann, TargetError::Off, Directional::Off);
        let settings = Settings {
            direct_samples,
            indirect_samples,
            solver,
            target_error,
            directional,
            ..settings.clone()
        };
        Self::new(scene, surfaces, &settings, &StoredRays::default()).transport
    }
}

/// How settings solve a scene with these elements.
pub(crate) fn method(scene: &Scene, order: &Order, settings: &Settings) -> Method {
    let textured = scene.has_varying_albedo();
    let bytes = |rays: u32| {
        let plan = Plan { indirect_samples: rays, ..settings.plan() };
        let rays = order.rays(&plan);
        Rows::bytes_for(rays, textured) + column_bytes(settings, rays)
    };
    if let Some(target) = target::target(settings) {
        let rays = target::first_rays(settings, bytes);
        return Method::Replicates { target, rays, memory: Memory(REPLICATES as u64 * bytes(rays)) };
    }
    if settings.refines_points() {
        // Of all points; there are as many as fit.
        let memory = bytes(settings.indirect_samples).min(settings.memory.0);
        return Method::Cached { memory: Memory(memory) };
    }
    Method::new(settings.solver, settings.memory, settings.indirect_samples, bytes)
}

/// What shooting takes besides so many stored rays.
pub(crate) fn column_bytes(settings: &Settings, rays: u64) -> u64 {
    if settings.schedule == ScheduleKind::Shoot { Rows::column_bytes_for(rays) } else { 0 }
}

/// Light by direction is measured by this part of the samples of a solve. With half of them it took nearly as long as the solve.
const DIRECTIONAL_PART: u32 = 4;

/// The samples of what measures light by direction.
pub(crate) fn directional_plan(plan: Plan) -> Plan {
    let part = |samples: u32| samples.div_ceil(DIRECTIONAL_PART);
    Plan { direct_samples: part(plan.direct_samples), indirect_samples: part(plan.indirect_samples), ..plan }
}

/// The memory that the rays of light by direction take; `None` where they are not stored.
pub(crate) fn directional_memory(
    scene: &Scene,
    order: &Order,
    settings: &Settings,
    method: Method,
) -> Option<Memory> {
    let Method::Cached { memory } = method else { return None };
    let rays = order.rays(&directional_plan(settings.plan()));
    let own = Rows::bytes_for(rays, scene.has_varying_albedo());
    let is_kept = settings.directional != Directional::Off && memory.0 + own <= settings.memory.0;
    is_kept.then_some(Memory(own))
}

/// What operators are made of.
struct Parts<'a, R> {
    scene: &'a Arc<Scene>,
    surfaces: &'a Surfaces,
    measured: &'a Ordered<R>,
    settings: &'a Settings,
}

impl<R: Receivers + 'static> Parts<'_, R> {
    fn assembly(self, shared: &StoredRays) -> Assembly {
        let method = method(self.scene, &self.measured.order, self.settings);
        let traced = || -> Box<dyn Transport> { Box::new(self.traced(self.settings.plan())) };
        let cached = |indirect_samples| {
            let plan = Plan { indirect_samples, ..self.settings.plan() };
            let cached = CachedTransport::new(self.traced(plan), shared.bounces.as_ref());
            let stored = cached.stored();
            (Box::new(cached) as Box<dyn Transport>, Some(stored))
        };
        let directional = self.directional(method, shared.directional.as_ref());
        let at_vertices = DirectAtVertices::new(self.scene, self.surfaces, self.settings);
        let direct = at_vertices.as_ref().map(|direct| direct.operator(self.settings.plan()));
        let ((transport, bounces), rest) = match method {
            Method::Neumann => ((traced(), None), Rest::Nothing),
            Method::Cached { .. } => (cached(self.settings.indirect_samples), Rest::Nothing),
            Method::FinalGather { stored, .. } => (cached(stored), Rest::Gather(traced())),
            Method::Replicates { target, rays, .. } => {
                let first = target::first_plan(self.settings, rays);
                let like = CachedTransport::new(self.traced(first), None);
                let shoots = self.settings.schedule == ScheduleKind::Shoot;
                let replicates = StoredReplicates { like, first, shoots, direct: at_vertices };
                ((traced(), None), Rest::Replicates(target, Box::new(replicates)))
            }
        };
        let stored = |directional: &DirectionalTransport<_, _>| directional.stored();
        let stored = StoredRays { bounces, directional: directional.as_ref().and_then(stored) };
        let directional = directional.map(|operator| Box::new(operator) as Box<dyn Transport>);
        let halves = self.settings.refines_points().then(|| self.halves());
        let schedule = self.settings.schedule();
        Assembly { method, schedule, transport, stored, rest, direct, halves, directional }
    }

    fn halves(&self) -> Box<dyn Halves + Send> {
        let plan = self.settings.plan();
        let like = CachedTransport::new(self.traced(plan), None);
        Box::new(StoredHalves { like, plan, direct: self.traced(plan) })
    }

    /// Its rays are stored where those of bounces are, and both fit into memory.
    fn directional(
        &self,
        method: Method,
        shared: Option<&Stored>,
    ) -> Option<DirectionalTransport<BounceBasis, R>> {
        let kind = self.settings.directional;
        let inner = || self.traced(directional_plan(self.settings.plan()));
        (kind != Directional::Off).then(|| {
            match directional_memory(self.scene, &self.measured.order, self.settings, method) {
                Some(_) => DirectionalTransport::storing(inner(), kind, shared),
                None => DirectionalTransport::new(inner(), kind),
            }
        })
    }

    fn traced(&self, plan: Plan) -> CpuTransport<BounceBasis, R> {
        self.surfaces.traced(self.scene, self.measured, plan)
    }
}
