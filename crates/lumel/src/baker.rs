//! From a scene and settings to a solution.

use crate::BounceBasis;
use crate::assembly::{Assembly, Rest, StoredRays, directional_memory};
use crate::direct_at_vertices::AtVertices;
use crate::layers;
use crate::method::Method;
use crate::point_levels;
use crate::settings::{Layers, Memory, Projection, Settings};
use crate::surfaces::Surfaces;
use glam::Vec3;
use lumel_accel::{RayTracer, tracer_of};
use lumel_basis::{Basis, Field, LeastSquares, NodeId, Readout, Receivers, Sampling, reflecting_areas};
use lumel_scene::Scene;
use lumel_solve::{
    DirectOperator, Integrals, Observer, Operator, PowerLog, Problem, RefinedLevels, SolveError, SolveState,
    brightest, final_gather, solve, solve_directional, solve_layers, solve_to_error,
};
use lumel_transport::{Control, Order, Transport};
use std::sync::Arc;

/// A scene made ready for baking.
pub struct Baker {
    scene: Arc<Scene>,
    surfaces: Surfaces,
    settings: Settings,
    assembly: Assembly,
    integrals: Arc<Integrals>,
}

impl Baker {
    /// Builds the ray tracer and the basis, on the threads of the caller's rayon pool.
    ///
    /// `settings` must be [valid](Settings::validate), here and wherever a baker takes settings.
    pub fn new(scene: Arc<Scene>, settings: Settings) -> Self {
        let tracer = tracer_of(&scene);
        Self::with_tracer(scene, tracer, settings)
    }

    /// Builds the basis for a scene that already has a ray tracer.
    pub fn with_tracer(scene: Arc<Scene>, tracer: Arc<dyn RayTracer>, settings: Settings) -> Self {
        Self::with_stored(scene, tracer, settings, &StoredRays::default())
    }

    /// The same, with what another baker has stored of the same triangles.
    pub(crate) fn with_stored(
        scene: Arc<Scene>,
        tracer: Arc<dyn RayTracer>,
        settings: Settings,
        stored: &StoredRays,
    ) -> Self {
        let surfaces = Surfaces::new(&scene, tracer, &settings);
        let assembly = Assembly::new(&scene, &surfaces, &settings, stored);
        let integrals = Arc::new(integrals(&scene, &surfaces.basis));
        Self { scene, surfaces, settings, assembly, integrals }
    }

    /// The same scene under other lights or with other settings, without rebuilding what only its surfaces decide:
    /// the ray tracer, the basis, and the stored rays if the settings ask for the same.
    ///
    /// `scene` must be a [relit](Scene::relit) or [repainted](Scene::repainted) one of this baker's; for a different
    /// scene everything but the tracer is rebuilt.
    pub fn relit(&self, scene: Arc<Scene>, settings: Settings) -> Self {
        if scene.geometry_hash() != self.scene.geometry_hash() {
            return Self::with_tracer(scene, Arc::clone(self.tracer()), settings);
        }
        let surfaces = self.surfaces.carrying(&settings);
        let assembly = Assembly::new(&scene, &surfaces, &settings, &self.assembly.stored);
        // The integrals of a basis depend on albedo too.
        let same_integrals =
            scene.has_surfaces_of(&self.scene) && Arc::ptr_eq(&surfaces.basis, &self.surfaces.basis);
        let new = || Arc::new(integrals(&scene, &surfaces.basis));
        let integrals = if same_integrals { Arc::clone(&self.integrals) } else { new() };
        Self { scene, surfaces, settings, assembly, integrals }
    }

    /// The operator with so many direct and hemisphere samples, every job of which traces rays of its own.
    pub(crate) fn traced_transport(&self, samples: [u32; 2]) -> Box<dyn Transport> {
        Assembly::traced(&self.scene, &self.surfaces, &self.settings, samples)
    }

    /// Whether a solve with these settings, under any lights, needs no new hemisphere ray: all are stored.
    pub fn has_rays_of(&self, settings: &Settings) -> bool {
        let stored = matches!(self.assembly.method, Method::Cached { .. })
            && self.assembly.stored.bounces.as_ref().is_some_and(|stored| stored.rows().is_complete());
        stored && settings.same_rays_as(&self.settings)
    }

    /// How the bounces are solved.
    pub fn method(&self) -> Method {
        self.assembly.method
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The ray tracer.
    pub fn tracer(&self) -> &Arc<dyn RayTracer> {
        &self.surfaces.tracer
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The basis that bounces are carried on: that of all fields of a [`SolveState`].
    pub fn basis(&self) -> &Arc<BounceBasis> {
        &self.surfaces.basis
    }

    /// Where light is measured.
    pub(crate) fn receivers(&self) -> &dyn Receivers {
        match self.settings.sampling() {
            Sampling::Point => &*self.surfaces.at_nodes().receivers,
            Sampling::Area => &*self.surfaces.over_areas().receivers,
        }
    }

    /// The order in which light is measured.
    pub(crate) fn order(&self) -> &Order {
        match self.settings.sampling() {
            Sampling::Point => &self.surfaces.at_nodes().order,
            Sampling::Area => &self.surfaces.over_areas().order,
        }
    }

    /// The rays that are stored.
    pub(crate) fn stored(&self) -> &StoredRays {
        &self.assembly.stored
    }

    /// The memory that the rays of light by direction take.
    pub(crate) fn directional_memory(&self) -> Memory {
        let memory = directional_memory(&self.scene, self.order(), &self.settings, self.method());
        memory.unwrap_or(Memory(0))
    }

    /// The surfaces, for what looks at them besides solving.
    pub(crate) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// The integrals of the basis: see [`PowerLog`].
    pub fn integrals(&self) -> &Integrals {
        &self.integrals
    }

    /// The sizes of the operator.
    pub(crate) fn shape(&self) -> lumel_transport::Shape {
        self.assembly.transport.shape()
    }

    /// Elements measured per bounce, for progress: see [`Control::elements`].
    pub fn elements_per_step(&self) -> u64 {
        self.shape().elements as u64
    }

    /// Share of all light that bounces after those of `state` would bring, or what is unshot; `None` while it cannot be told.
    pub fn remainder(&self, state: &SolveState) -> Option<f64> {
        match state.shot {
            Some(_) => Some(self.integrals.missing(state)),
            None => self.integrals.remainder(&state.bounces),
        }
    }

    /// The ambient term: what light that is not computed yet would bring everywhere, for looking at. See
    /// [`Integrals::ambient`].
    pub fn ambient(&self, state: &SolveState) -> Vec3 {
        self.integrals.ambient(state)
    }

    /// The nodes with the most unshot power, as few as have this share of all of it.
    pub fn brightest(&self, state: &SolveState, share: f64) -> Vec<NodeId> {
        let powers = state.unshot().map(|unshot| self.integrals.unshot_powers(unshot));
        brightest(&powers.unwrap_or_default(), share)
    }

    /// Where a node lies.
    pub fn position_of(&self, node: NodeId) -> Vec3 {
        match &**self.basis() {
            BounceBasis::Vertices(basis) => {
                self.scene().positions()[basis.first_vertices()[node.index()] as usize]
            }
            BounceBasis::Points { points, .. } => points.points()[node.index()].position,
        }
    }

    /// Power that arrives in a field, W by luminance.
    pub fn power(&self, field: &Field) -> f64 {
        self.integrals.power(field)
    }

    /// The root of the mean over all surfaces of a field's squared irradiance, W·m⁻² by luminance.
    pub fn root_mean_square(&self, field: &Field) -> f64 {
        self.integrals.mean_square(field).sqrt()
    }

    /// The share that each bounce of `state` has of all light that was found, by luminance of the incident power.
    pub fn shares(&self, state: &SolveState) -> Vec<f64> {
        let log = PowerLog::of(&self.integrals, &state.bounces);
        let shot = state.shot.as_ref().map_or(0.0, |shot| self.power(&shot.reflected));
        let all: f64 = log.powers().iter().sum::<f64>() + shot;
        log.powers().iter().map(|power| if all > 0.0 { power / all } else { 0.0 }).collect()
    }

    /// Solves, continuing from `state`: [`SolveState::new`] or what [`Self::resume`] returned.
    ///
    /// # Errors
    /// When it is cancelled or fails; `state` then holds the bounces that were finished, or with a target error the last
    /// finished round.
    pub fn run(
        &self,
        state: &mut SolveState,
        control: &Control,
        observer: &dyn Observer,
    ) -> Result<(), SolveError> {
        let refined = self.refined_levels(state, control, observer)?;
        let mut problem = self.problem();
        if let Some(refined) = &refined {
            refined.prepare(&*self.surfaces.basis, state);
            problem.operator = refined.operator(problem.operator);
        }
        let directional = self.assembly.directional.as_ref().map(|transport| self.operator(&**transport));
        let finish = |state: &mut SolveState| match directional {
            Some(operator) => solve_directional(operator, state, control, observer),
            None => Ok(()),
        };
        if let Rest::Replicates(target, replicates) = &self.assembly.rest {
            solve_to_error(problem, &**replicates, *target, state, control, observer)?;
            return finish(state);
        }
        let Problem { operator, schedule, .. } = problem;
        solve(operator, &self.integrals, schedule, state, control, observer)?;
        if problem.tail {
            state.tail = self.integrals.tail_of(state);
        }
        let finisher = match &self.assembly.rest {
            Rest::Gather(finisher) => Some(self.operator(&**finisher)),
            Rest::Nothing | Rest::Replicates(..) => None,
        };
        if let Some(finisher) = finisher
            && (state.bounces.len() > 1 || state.shot.is_some())
        {
            final_gather(finisher, state, control, observer)?;
        }
        finish(state)?;
        if self.settings.layers == Layers::Lights {
            let masks = layers::masks(&self.scene, &self.settings);
            let finishers = [finisher, directional];
            solve_layers(problem, finishers, &masks, state, control, observer)?;
        }
        Ok(())
    }

    /// The points that are measured, where these follow light and the solve is not finished.
    fn refined_levels(
        &self,
        state: &mut SolveState,
        control: &Control,
        observer: &dyn Observer,
    ) -> Result<Option<RefinedLevels<'_>>, SolveError> {
        let refinement = point_levels::refinement(&self.settings, self.scene.has_varying_albedo());
        let powers = PowerLog::of(&self.integrals, &state.bounces);
        let is_finished = !state.valid.is_empty() && self.assembly.schedule.next(state, &powers).is_none();
        let operator = self.problem().operator;
        match (refinement, self.surfaces.basis.hierarchy(), &self.assembly.halves) {
            (Some(refinement), Some(hierarchy), Some(halves)) if !is_finished => {
                RefinedLevels::new(operator, hierarchy, &**halves, refinement, state, control, observer)
                    .map(Some)
            }
            _ => Ok(None),
        }
    }

    /// What is solved.
    pub(crate) fn problem(&self) -> Problem<'_> {
        Problem {
            operator: Operator { direct: self.direct(), ..self.operator(&*self.assembly.transport) },
            integrals: &self.integrals,
            readout: self.readout(),
            schedule: &*self.assembly.schedule,
            tail: self.settings.tail.is_added(self.settings.bounces),
        }
    }

    fn operator<'a>(&'a self, transport: &'a dyn Transport) -> Operator<'a> {
        Operator::new(transport, &*self.surfaces.basis)
    }

    /// What measures direct light at the vertices, where points carry the bounces.
    pub(crate) fn at_vertices(&self) -> Option<&AtVertices> {
        self.assembly.direct.as_ref()
    }

    fn direct(&self) -> Option<DirectOperator<'_>> {
        let AtVertices { transport, .. } = self.at_vertices()?;
        Some(DirectOperator { transport: &**transport, basis: &*self.surfaces.vertices })
    }

    /// How carried light is read, where that is a function of its own.
    pub(crate) fn readout(&self) -> Option<&dyn Readout> {
        self.least_squares().map(|solver| solver as &dyn Readout)
    }

    /// What reads carried light, where its projection is the one by least squares.
    pub(crate) fn least_squares(&self) -> Option<&LeastSquares> {
        let is_read = self.settings.projection == Projection::LeastSquares && self.basis().points().is_none();
        is_read.then(|| self.surfaces.least_squares())
    }
}

fn integrals(scene: &Scene, basis: &BounceBasis) -> Integrals {
    let levels = basis.points().map_or(1, |points| points.level_count());
    Integrals::new(basis.node_areas().to_vec(), reflecting_areas(scene, basis)).of_levels(levels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{PointSpacing, ScheduleKind};
    use crate::{BounceLimit, Light, OpenOptions, Projection, Silent};
    use glam::Vec3;

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
        for projection in [Projection::Point, Projection::Area, Projection::LeastSquares] {
            let settings = Settings {
                projection,
                bounces: BounceLimit::Count(1),
                direct_samples: 4,
                indirect_samples: 8,
                ..Settings::default()
            };
            let new = Baker::new(Arc::clone(&relit), settings.clone());
            assert_eq!(solved(&old.relit(Arc::clone(&relit), settings)), solved(&new), "{projection:?}");
        }
    }

    #[test]
    fn a_baker_relit_with_other_materials_has_the_bits_of_a_new_one() {
        let opened = crate::open("cornell-box", &OpenOptions::default()).unwrap();
        let scene = opened.builder.build().unwrap().0;
        let painted =
            |albedo: f32| Arc::new(scene.repainted(&vec![Vec3::splat(albedo); scene.materials().len()]));
        let settings = Settings {
            projection: Projection::Point,
            bounces: BounceLimit::Count(2),
            direct_samples: 4,
            indirect_samples: 8,
            ..Settings::default()
        };
        let solved = |baker: &Baker| {
            let (mut state, control) = (SolveState::new(), Control::default());
            baker.run(&mut state, &control, &Silent).unwrap();
            (baker.integrals.reflected(&state.bounces[0]), state, control.rays())
        };
        let old = Baker::new(painted(0.3), settings.clone());
        solved(&old);
        let paler = painted(0.6);
        let relit = old.relit(Arc::clone(&paler), settings.clone());
        let (reflected, state, rays) = solved(&relit);
        let (reflected_by_new, new, rays_of_new) = solved(&Baker::new(paler, settings));
        assert_eq!(reflected, reflected_by_new);
        assert_eq!(rays_of_new - rays, 8 * relit.elements_per_step(), "no hemisphere ray is traced again");
        assert!(state == new, "the bits of bounces differ");
    }

    #[test]
    fn each_layer_of_points_reflects_its_own_direct_light_of_the_vertices() {
        let opened = crate::open("cornell-box", &OpenOptions::default()).unwrap();
        let scene = opened.builder.build().unwrap().0;
        let mut lights = scene.lights().to_vec();
        lights.extend(scene.lights().to_vec().into_iter().map(|light| match light {
            Light::Rect(mut rect) => {
                rect.center.x += 0.3;
                Light::Rect(rect)
            }
            light => light,
        }));
        let scene = Arc::new(scene.relit(lights).unwrap());
        for schedule in [ScheduleKind::Gather, ScheduleKind::Shoot] {
            // Settings of users cannot have both, as readers know layers at vertices alone.
            let settings = Settings {
                point_spacing: PointSpacing::Points(200),
                layers: Layers::Lights,
                bounces: if schedule == ScheduleKind::Gather {
                    BounceLimit::Count(2)
                } else {
                    BounceLimit::All
                },
                schedule,
                direct_samples: 4,
                indirect_samples: 16,
                ..Settings::default()
            };
            let (baker, mut state) = (Baker::new(Arc::clone(&scene), settings), SolveState::new());
            baker.run(&mut state, &Control::default(), &Silent).unwrap();
            assert!(baker.basis().direct().is_some() && state.layers.len() == 2);
            let sum = Field::sum(state.node_count(), &state.layers);
            let off = |(a, b): (&Vec3, &Vec3)| (*a - *b).length() / (1e-3 + b.length());
            let worst = sum.values().iter().zip(state.total().values()).map(off).fold(0.0, f32::max);
            assert!(worst < 1e-4, "{schedule:?}: {worst}");
        }
    }

    #[test]
    fn a_baker_relit_with_another_scene_is_made_anew() {
        let built =
            |name| Arc::new(crate::open(name, &OpenOptions::default()).unwrap().builder.build().unwrap().0);
        let baker =
            Baker::new(built("sphere"), Settings::default()).relit(built("furnace"), Settings::default());
        assert_eq!(baker.scene().name(), "furnace");
    }
}
