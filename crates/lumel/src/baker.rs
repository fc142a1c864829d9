//! From a scene and settings to a solution.

use crate::method::Method;
use crate::settings::{BasisKind, Memory, Settings, SolverKind, Tail, TargetError};
use crate::target::{self, StoredReplicates};
use glam::Vec3;
use lumel_accel::{Bvh, RayTracer};
use lumel_basis::{AreaVertexBasis, Basis, Field, Measure, NodeId, VertexBasis};
use lumel_export::{Solution, SolutionError, SolutionMeta};
use lumel_scene::{Scene, luminance};
use lumel_solve::{
    Energy, Neighbours, Observer, Problem, REPLICATES, Replicates, SolveError, SolveState, Stop, Target,
    final_gather, solve, solve_to_error,
};
use lumel_transport::{CachedTransport, Control, CpuTransport, Order, Plan, Rows, Stored, Transport};
use std::sync::Arc;

/// Why a solution cannot be continued.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// It belongs to another scene.
    #[error(transparent)]
    Scene(#[from] SolutionError),
    /// The scene shines differently.
    #[error("the solution was computed with other materials or lights; bake the scene anew")]
    Lighting,
    /// The settings would give other bounces.
    #[error("the solution was computed with other settings ({differences}); use the same or bake anew")]
    Settings {
        /// Which settings differ, and how.
        differences: String,
    },
    /// Its rays are not kept.
    #[error("a solution with a target error cannot be gone on with, as its rays are not kept; bake anew")]
    TargetError,
}

/// A scene made ready for baking.
pub struct Baker {
    scene: Arc<Scene>,
    tracer: Arc<dyn RayTracer>,
    settings: Settings,
    vertex_basis: VertexBasis,
    operator: Operator,
    energy: Energy,
}

/// What solves a scene.
struct Operator {
    basis: Arc<dyn Basis>,
    /// Of the elements of that basis.
    order: Order,
    method: Method,
    /// Measures direct light and bounces.
    transport: Box<dyn Transport>,
    /// The rays that it stores.
    stored: Option<Stored>,
    rest: Rest,
}

/// What an operator's transport alone does not do.
enum Rest {
    Nothing,
    /// Gathers all light once more, where not all rays are stored.
    Gather(Box<dyn Transport>),
    /// Solves with independent samples instead, where the settings have a target error.
    Replicates(Target, Box<dyn Replicates + Send>),
}

impl Baker {
    /// Builds the ray tracer and the basis, on the threads of the caller's rayon pool.
    ///
    /// `settings` must be [valid](Settings::validate), here and wherever a baker takes settings.
    pub fn new(scene: Arc<Scene>, settings: Settings) -> Self {
        let tracer = Arc::new(Bvh::build(&scene));
        Self::with_tracer(scene, tracer, settings)
    }

    /// Builds the basis for a scene whose ray tracer there is already.
    pub fn with_tracer(scene: Arc<Scene>, tracer: Arc<dyn RayTracer>, settings: Settings) -> Self {
        let vertex_basis = VertexBasis::new(Arc::clone(&scene));
        let operator = operator_of((&scene, &tracer), &vertex_basis, &settings, Shared::default());
        let energy = Energy::new(&scene, &*operator.basis);
        Self { scene, tracer, settings, vertex_basis, operator, energy }
    }

    /// The same scene under other lights or with other settings, without making anew what only its surfaces decide:
    /// the ray tracer, and the stored rays if the settings ask for the same.
    ///
    /// `scene` must be a [relit](Scene::relit) one of this baker's; of another one, all is made anew but the tracer.
    pub fn relit(&self, scene: Arc<Scene>, settings: Settings) -> Self {
        if scene.geometry_hash() != self.scene.geometry_hash() {
            return Self::with_tracer(scene, Arc::clone(&self.tracer), settings);
        }
        let vertex_basis = self.vertex_basis.clone();
        let same_basis = settings.basis == self.settings.basis;
        let shared = Shared {
            order: same_basis.then(|| self.operator.order.clone()),
            stored: self.operator.stored.as_ref(),
        };
        let operator = operator_of((&scene, &self.tracer), &vertex_basis, &settings, shared);
        // The energy of a basis depends on its albedo too.
        let same_energy = same_basis && scene.has_surfaces_of(&self.scene);
        let energy = if same_energy { self.energy.clone() } else { Energy::new(&scene, &*operator.basis) };
        Self { scene, tracer: Arc::clone(&self.tracer), settings, vertex_basis, operator, energy }
    }

    /// The operator with so many samples, every job of which traces rays of its own.
    pub(crate) fn plain_transport(&self, direct_samples: u32, indirect_samples: u32) -> Box<dyn Transport> {
        let (solver, target_error) = (SolverKind::Neumann, TargetError::Off);
        let settings =
            Settings { direct_samples, indirect_samples, solver, target_error, ..self.settings.clone() };
        let shared = Shared { order: Some(self.operator.order.clone()), stored: None };
        operator_of((&self.scene, &self.tracer), &self.vertex_basis, &settings, shared).transport
    }

    /// Whether a solve with these settings, under any lights, needs no new hemisphere ray: all are stored.
    pub fn has_rays_of(&self, settings: &Settings) -> bool {
        let stored = matches!(self.operator.method, Method::Cached { .. })
            && self.operator.stored.as_ref().is_some_and(|stored| stored.rows().is_complete());
        stored && settings.same_rays_as(&self.settings)
    }

    /// How the bounces are solved.
    pub fn method(&self) -> Method {
        self.operator.method
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The ray tracer.
    pub fn tracer(&self) -> &Arc<dyn RayTracer> {
        &self.tracer
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The basis that light is stored in.
    pub(crate) fn basis(&self) -> &dyn Basis {
        &*self.operator.basis
    }

    /// The piecewise linear basis on the vertices that all bases here are read back by.
    pub(crate) fn vertex_basis(&self) -> &VertexBasis {
        &self.vertex_basis
    }

    /// Elements measured per bounce, for progress: see [`Control::elements`].
    pub fn elements_per_step(&self) -> u64 {
        self.operator.transport.shape().elements as u64
    }

    /// Share of all light that bounces after those of `state` would bring; `None` while it cannot be told.
    pub fn remainder(&self, state: &SolveState) -> Option<f64> {
        self.energy.remainder(&state.bounces)
    }

    /// The share that each bounce of `state` has of their sum, by luminance of the incident power.
    pub fn shares(&self, state: &SolveState) -> Vec<f64> {
        let power = |field| f64::from(luminance(self.energy.incident(field).as_vec3()));
        let powers: Vec<f64> = state.bounces.iter().map(power).collect();
        let all: f64 = powers.iter().sum();
        powers.into_iter().map(|power| if all > 0.0 { power / all } else { 0.0 }).collect()
    }

    /// Solves, going on from `state`: [`SolveState::new`] or what [`Self::resume`] returned.
    ///
    /// # Errors
    /// When it is cancelled; `state` then holds the bounces that were finished. With a target error it begins anew in any
    /// case, and `state` holds the last finished round.
    pub fn run(
        &self,
        state: &mut SolveState,
        control: &Control,
        observer: &dyn Observer,
    ) -> Result<(), SolveError> {
        if let Rest::Replicates(target, replicates) = &self.operator.rest {
            return self.run_to_error((*target, &**replicates), state, control, observer);
        }
        let stop = self.settings.stop();
        let Operator { basis, transport, rest, .. } = &self.operator;
        solve(&**transport, &**basis, &self.energy, stop, state, control, observer)?;
        if self.settings.tail == Tail::Geometric {
            state.tail = self.energy.tail(&state.bounces);
        }
        if let Rest::Gather(finisher) = rest
            && state.bounces.len() > 1
        {
            final_gather(&**finisher, &**basis, state, control, observer)?;
        }
        Ok(())
    }

    fn run_to_error(
        &self,
        (target, replicates): (Target, &dyn Replicates),
        state: &mut SolveState,
        control: &Control,
        observer: &dyn Observer,
    ) -> Result<(), SolveError> {
        let Operator { basis, transport, .. } = &self.operator;
        let problem = Problem {
            probe: &**transport,
            basis: &**basis,
            neighbours: &Neighbours::new(&**basis, self.scene.triangle_count()),
            energy: &self.energy,
            stop: self.settings.stop(),
            tail: self.settings.tail == Tail::Geometric,
        };
        solve_to_error(problem, replicates, target, state, control, observer)
    }

    /// A field's value at every vertex of the scene, W·m⁻².
    pub fn at_vertices(&self, field: &Field) -> Vec<Vec3> {
        self.operator.basis.node_of_vertex().iter().map(|&node| field.node(node).0).collect()
    }

    /// What holds for the nodes of the basis, for every vertex of the scene; true where it is not known of the node.
    pub fn flags_at_vertices(&self, nodes: &[bool]) -> Vec<bool> {
        let flag = |node: &NodeId| nodes.get(node.index()).copied().unwrap_or(true);
        self.operator.basis.node_of_vertex().iter().map(flag).collect()
    }

    /// The light at every vertex of the scene.
    pub fn solution(&self, state: &SolveState) -> Solution {
        let at_vertices = |field: &Field| self.at_vertices(field);
        let settings = serde_json::to_value(&self.settings).unwrap_or_default();
        let no_light = || vec![Vec3::ZERO; self.scene.vertex_count()];
        Solution {
            meta: SolutionMeta::new(&self.scene, settings),
            positions: self.scene.positions().to_vec(),
            normals: self.scene.normals().to_vec(),
            irradiance: if state.bounces.is_empty() { no_light() } else { at_vertices(&state.total()) },
            bounces: state.bounces.iter().map(at_vertices).collect(),
            tail: state.tail.as_ref().map(at_vertices),
            valid: self.flags_at_vertices(&state.valid),
            standard_error: state.errors.as_ref().map(|errors| at_vertices(&errors.standard_error)),
        }
    }

    /// The state from which to go on with a solution that was saved.
    ///
    /// Bounces beyond those that these settings ask for are left out, so that the result does not depend on how far
    /// the solution went.
    ///
    /// # Errors
    /// When the solution is of another scene, other lights or other settings.
    pub fn resume(&self, solution: &Solution) -> Result<SolveState, ResumeError> {
        solution.check_belongs_to(&self.scene)?;
        if !solution.has_lighting_of(&self.scene) {
            return Err(ResumeError::Lighting);
        }
        let found: Option<Settings> = serde_json::from_value(solution.meta.settings.clone()).ok();
        let Some(found) = found else {
            let differences = "they are unknown to this version".to_owned();
            return Err(ResumeError::Settings { differences });
        };
        let shape = self.operator.transport.shape();
        let as_stored = method(&self.scene, (shape.elements, shape.measure), &found) == self.operator.method;
        if !(found.same_bounces_as(&self.settings) && as_stored) {
            return Err(ResumeError::Settings { differences: self.settings.differences_of_bounces(&found) });
        }
        if matches!(self.operator.rest, Rest::Replicates(..)) {
            return Err(ResumeError::TargetError);
        }
        let first_vertices = self.first_vertices();
        let at_nodes =
            |values: &Vec<Vec3>| Field::from_values(first_vertices.iter().map(|&v| values[v]).collect());
        let mut bounces: Vec<Field> = solution.bounces.iter().map(at_nodes).collect();
        bounces.truncate(self.bounces_wanted(&bounces));
        let valid = first_vertices.iter().map(|&v| solution.valid[v]).collect();
        Ok(SolveState { valid, bounces, tail: None, gathered: None, errors: None })
    }

    /// How many of these bounces, direct light included, an uninterrupted solve computes.
    fn bounces_wanted(&self, bounces: &[Field]) -> usize {
        match self.settings.stop() {
            Stop::Bounces(n) => bounces.len().min(n as usize + 1),
            Stop::Remainder { fraction, at_most } => {
                let enough = |n: &usize| {
                    let left = self.energy.remainder(&bounces[..*n]);
                    *n > at_most as usize || left.is_some_and(|left| left < f64::from(fraction))
                };
                (1..bounces.len()).find(enough).unwrap_or(bounces.len())
            }
        }
    }

    /// A vertex of each node.
    fn first_vertices(&self) -> Vec<usize> {
        let mut first = vec![usize::MAX; self.operator.basis.node_count()];
        for (vertex, &NodeId(node)) in self.operator.basis.node_of_vertex().iter().enumerate() {
            let slot = &mut first[node as usize];
            *slot = (*slot).min(vertex);
        }
        first
    }
}

type World<'a> = (&'a Arc<Scene>, &'a Arc<dyn RayTracer>);

/// What another operator of the same surfaces has already.
#[derive(Default)]
struct Shared<'a> {
    order: Option<Order>,
    stored: Option<&'a Stored>,
}

fn operator_of(
    world: World<'_>,
    vertex_basis: &VertexBasis,
    settings: &Settings,
    shared: Shared<'_>,
) -> Operator {
    match settings.basis {
        BasisKind::Vertex => operator(world, vertex_basis.clone(), settings, shared),
        BasisKind::VertexArea => {
            operator(world, AreaVertexBasis::new(vertex_basis.clone()), settings, shared)
        }
    }
}

fn operator<B: Basis + 'static>(
    (scene, tracer): World<'_>,
    basis: B,
    settings: &Settings,
    shared: Shared<'_>,
) -> Operator {
    let basis = Arc::new(basis);
    let order = shared.order.unwrap_or_else(|| Order::new(&*basis));
    let method = method(scene, (basis.element_count(), basis.measure()), settings);
    let plain = |plan| {
        let (scene, tracer) = (Arc::clone(scene), Arc::clone(tracer));
        CpuTransport::in_order(scene, tracer, Arc::clone(&basis), (Arc::clone(&basis), order.clone()), plan)
    };
    let cached = |indirect_samples: u32| {
        let plan = Plan { indirect_samples, ..settings.plan() };
        let cached = CachedTransport::new(plain(plan), shared.stored);
        let stored = cached.stored();
        (Box::new(cached) as Box<dyn Transport>, Some(stored))
    };
    let replicates = |rays: u32| -> Box<dyn Replicates + Send> {
        let first = target::first_plan(settings, rays);
        Box::new(StoredReplicates { like: CachedTransport::new(plain(first), None), first })
    };
    let plain = || -> Box<dyn Transport> { Box::new(plain(settings.plan())) };
    let ((transport, stored), rest) = match method {
        Method::Neumann => ((plain(), None), Rest::Nothing),
        Method::Cached { .. } => (cached(settings.indirect_samples), Rest::Nothing),
        Method::FinalGather { stored, .. } => (cached(stored), Rest::Gather(plain())),
        Method::Replicates { target, rays, .. } => {
            ((plain(), None), Rest::Replicates(target, replicates(rays)))
        }
    };
    Operator { basis, order, method, transport, stored, rest }
}

/// How the settings solve a scene with so many elements.
fn method(scene: &Scene, (elements, measure): (usize, Measure), settings: &Settings) -> Method {
    let textured = scene.has_varying_albedo();
    let bytes = |rays: u32| {
        let plan = Plan { indirect_samples: rays, ..settings.plan() };
        Rows::bytes_for(elements, plan.rays_per_element(measure), textured)
    };
    if let Some(target) = target::target(settings) {
        let rays = target::first_rays(settings, bytes);
        return Method::Replicates { target, rays, memory: Memory(REPLICATES as u64 * bytes(rays)) };
    }
    Method::new(settings.solver, settings.memory, settings.indirect_samples, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BounceLimit, Light, OpenOptions, Silent};

    #[test]
    fn a_relit_baker_has_the_bits_of_a_new_one() {
        let opened = crate::open("cornell-box", &OpenOptions::default()).unwrap();
        let scene = Arc::new(opened.builder.build().unwrap().0);
        let old = Baker::new(Arc::clone(&scene), Settings::default());
        let mut lights = scene.lights().to_vec();
        for light in &mut lights {
            if let Light::Rect(rect) = light {
                rect.center += Vec3::new(0.1, -0.1, 0.0);
            }
        }
        let relit = Arc::new(scene.relit(lights).unwrap());
        let solved = |baker: &Baker| {
            let mut state = SolveState::new();
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            (baker.remainder(&state), state)
        };
        for basis in [BasisKind::Vertex, BasisKind::VertexArea] {
            let settings = Settings {
                basis,
                bounces: BounceLimit::Count(1),
                direct_samples: 4,
                indirect_samples: 8,
                ..Settings::default()
            };
            let new = Baker::new(Arc::clone(&relit), settings.clone());
            assert_eq!(solved(&old.relit(Arc::clone(&relit), settings)), solved(&new), "{basis:?}");
        }
    }

    #[test]
    fn a_baker_relit_with_other_materials_has_the_bits_of_a_new_one() {
        let opened = crate::open("cornell-box", &OpenOptions::default()).unwrap();
        let scene = opened.builder.build().unwrap().0;
        let painted =
            |albedo: f32| Arc::new(scene.repainted(&vec![Vec3::splat(albedo); scene.materials().len()]));
        let settings = Settings {
            bounces: BounceLimit::Count(2),
            direct_samples: 4,
            indirect_samples: 8,
            ..Settings::default()
        };
        let solved = |baker: &Baker| {
            let (mut state, control) = (SolveState::new(), Control::default());
            baker.run(&mut state, &control, &Silent).unwrap();
            (baker.energy.reflected(&state.bounces[0]), state, control.rays())
        };
        let old = Baker::new(painted(0.3), settings.clone());
        solved(&old);
        let paler = painted(0.6);
        let relit = old.relit(Arc::clone(&paler), settings.clone());
        let (reflected, state, rays) = solved(&relit);
        let (reflected_anew, anew, rays_anew) = solved(&Baker::new(paler, settings));
        assert_eq!(reflected, reflected_anew);
        assert_eq!(rays_anew - rays, 8 * relit.elements_per_step(), "no hemisphere ray is traced again");
        assert!(state == anew, "the bits of bounces differ");
    }

    #[test]
    fn a_baker_relit_with_another_scene_is_made_anew() {
        let built =
            |name| Arc::new(crate::open(name, &OpenOptions::default()).unwrap().builder.build().unwrap().0);
        let baker =
            Baker::new(built("sphere"), Settings::default()).relit(built("furnace"), Settings::default());
        assert_eq!(baker.vertex_basis().scene().name(), "furnace");
    }
}
