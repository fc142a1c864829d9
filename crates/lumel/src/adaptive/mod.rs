//! Tessellation that follows light.

mod criterion;
mod kinks;
mod probes;
mod refiner;

use crate::assembly::StoredRays;
use crate::settings::{BounceLimit, Layers, ScheduleKind, Settings, TargetError};
use crate::{Baker, Tail};
use glam::Vec3;
use lumel_accel::Refined;
use lumel_basis::{Directional, Field};
use lumel_export::{NextRefinement, RefinementState};
use lumel_scene::{Bisection, SceneError, SurfacePoint};
use lumel_solve::{Silent, SolveError, SolveState};
use lumel_transport::{Control, TransportError};
use probes::Probes;
use refiner::Refiner;
use std::sync::Arc;

pub use refiner::RefinementEnd;

/// Light that was reflected may differ by this many times as much from a linear function.
const AFTER_BOUNCES: f64 = 2.0;

/// To see where the mesh is too coarse after a bounce, direct light needs this part of its samples.
const DIRECT_PART: u32 = 4;

/// A refinement that is under way.
#[derive(Clone, Copy)]
pub struct Refining<'a> {
    /// The bounce after which light is looked at; 0 is direct light.
    pub bounce: u32,
    /// What the refinement can be continued with, where a step of it is done.
    next: Option<NextRefinement>,
    refiner: &'a Refiner,
}

impl Refining<'_> {
    /// The mesh so far.
    pub fn mesh(&self) -> &Bisection {
        &self.refiner.mesh
    }

    /// Irradiance at the vertices of the mesh, W·m⁻², to look at: as it was measured last, and spread over what was not.
    pub fn irradiance(&self) -> Vec<Vec3> {
        self.refiner.irradiance()
    }

    /// What decides which edges are split: by how much light differs from a linear function along the edges around each vertex, over
    /// what it may, at most. 0 where no edge was looked at.
    pub fn indicator(&self) -> Vec<f32> {
        self.refiner.indicator()
    }

    /// All that is needed to [go on](Baker::adapted_from) from here; `None` in the middle of a step. A step is a round that
    /// measures direct light, or a bounce.
    pub fn state(&self) -> Option<RefinementState> {
        self.next.map(|next| self.refiner.state(next))
    }
}

/// A scene whose mesh was refined where light needs it, ready for baking.
pub struct Adapted {
    /// Bakes the refined scene.
    pub baker: Baker,
    /// Why it was refined no further.
    pub ended: RefinementEnd,
}

impl Baker {
    /// Splits edges where light differs from a linear function by more than the settings say; `None` if they say
    /// [nothing](crate::Adaptive::Off), or it is points that follow light, which a [solve](Self::run) sees to.
    ///
    /// Light is measured in the middle of edges: first direct light, and then, after each bounce, all light so far, whose
    /// tolerance is twice as large. Nothing is split for what may be noise. Rays that are stored of triangles which stay whole
    /// serve the new mesh. The result is a baker like any other, of a scene that was [refined](lumel_scene::Scene::refined) from that of
    /// this one; `watch` is told after every round.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn adapted(
        &self,
        control: &Control,
        watch: &mut dyn FnMut(&Refining<'_>),
    ) -> Result<Option<Adapted>, SolveError> {
        self.adapted_from(None, control, watch)
    }

    /// The same from where an earlier refinement with these settings under these lights was: the result has the bits of
    /// one that was not interrupted.
    ///
    /// # Errors
    /// When it is cancelled, tracing fails, or `state` is of another scene.
    pub fn adapted_from(
        &self,
        state: Option<&RefinementState>,
        control: &Control,
        watch: &mut dyn FnMut(&Refining<'_>),
    ) -> Result<Option<Adapted>, SolveError> {
        let Some(error) = self.settings().adaptive.error().filter(|_| self.settings().refines_mesh()) else {
            return Ok(None);
        };
        let error = f64::from(error.get());
        let original = self.scene().original();
        let original = original.map(|scene| Self::new(Arc::new(scene), self.settings().clone()));
        let start = original.as_ref().unwrap_or(self);
        let max_vertices = self.settings().max_vertices as usize;
        let (mut refiner, mut next) = match state {
            None => {
                let mesh = Bisection::new(Arc::clone(start.scene()));
                (Refiner::new(mesh, error, max_vertices), NextRefinement::Direct)
            }
            Some(state) => {
                let refiner = Refiner::from_state(start.scene(), state, error, max_vertices);
                (refiner.map_err(|error| failed(&error))?, state.next)
            }
        };
        let most = match self.settings().bounces {
            BounceLimit::Count(n) => n,
            BounceLimit::All => u32::MAX,
        };
        let mut coarser: Option<Self> = None;
        let ended = loop {
            next = match next {
                NextRefinement::Direct => {
                    let probes = start.probes(None);
                    let ended = refiner.refine(|points| probes.measure(points, control), &mut |refiner| {
                        watch(&Refining { bounce: 0, next: Some(next), refiner })
                    })?;
                    after(0, ended)
                }
                NextRefinement::Bounce(bounce) if bounce > most => break RefinementEnd::Reached,
                NextRefinement::Bounce(bounce) => {
                    let before = refiner.mesh.splits().len();
                    let fine =
                        start.on_mesh(coarser.as_ref(), &refiner.mesh, self.settings().quick(bounce))?;
                    let (ended, is_dim) = fine.refine_after(bounce, error, &mut refiner, control, watch)?;
                    coarser = Some(fine);
                    // Later bounces are smoother.
                    let is_last = is_dim || refiner.mesh.splits().len() == before;
                    if is_last && ended == RefinementEnd::Reached {
                        NextRefinement::Reached
                    } else {
                        after(bounce, ended)
                    }
                }
                NextRefinement::Reached => break RefinementEnd::Reached,
                NextRefinement::Vertices => break RefinementEnd::Vertices,
            };
            let bounce = if let NextRefinement::Bounce(bounce) = next { bounce - 1 } else { 0 };
            watch(&Refining { bounce, next: Some(next), refiner: &refiner });
        };
        let baker = start.on_mesh(coarser.as_ref(), &refiner.mesh, self.settings().clone())?;
        Ok(Some(Adapted { baker, ended }))
    }

    /// Solves so many bounces on the mesh of this baker and refines it further. Returns why no further, and whether the last
    /// bounce is so dim that later ones need not be looked at.
    fn refine_after(
        &self,
        bounce: u32,
        error: f64,
        refiner: &mut Refiner,
        control: &Control,
        watch: &mut dyn FnMut(&Refining<'_>),
    ) -> Result<(RefinementEnd, bool), SolveError> {
        let mut state = SolveState::new();
        self.run(&mut state, control, &Silent)?;
        let all = Field::sum(state.node_count(), &state.bounces);
        let light = self.light_reader(&state).at_vertices(&all);
        let reflecting = Field::sum(state.node_count(), &state.bounces[..bounce as usize]);
        let probes = self.probes(Some(&reflecting));
        let probe = |points: &[SurfacePoint]| {
            let refined: Vec<_> = points.iter().map(|&at| self.scene().refined_point(at)).collect();
            probes.measure(&refined, control)
        };
        let ended = refiner.refine_after_bounce(AFTER_BOUNCES * error, &light, probe, &mut |refiner| {
            watch(&Refining { bounce, next: None, refiner });
        })?;
        Ok((ended, self.shares(&state).last().is_none_or(|&share| share < error)))
    }

    /// A baker of this one's scene with its edges split, and with the rays that `coarser` has stored.
    fn on_mesh(
        &self,
        coarser: Option<&Self>,
        mesh: &Bisection,
        settings: Settings,
    ) -> Result<Self, SolveError> {
        let scene = self.scene().refined(mesh.splits()).map_err(|error| failed(&error))?;
        let tracer = Refined::new(Arc::clone(self.tracer()), scene.clone());
        let none = StoredRays::default();
        let stored = coarser.map_or(&none, Self::stored);
        Ok(Self::with_stored(Arc::new(scene), Arc::new(tracer), settings, stored))
    }

    fn probes<'a>(&'a self, reflecting: Option<&'a Field>) -> Probes<'a> {
        let (scene, surfaces, settings) = (self.scene(), self.surfaces(), self.settings());
        Probes { scene, surfaces, settings, reflecting }
    }
}

/// What comes after a bounce.
fn after(bounce: u32, ended: RefinementEnd) -> NextRefinement {
    match ended {
        RefinementEnd::Vertices => NextRefinement::Vertices,
        RefinementEnd::Reached => NextRefinement::Bounce(bounce + 1),
    }
}

fn failed(error: &SceneError) -> SolveError {
    TransportError::Failed { worker: "refinement".to_owned(), cause: error.to_string() }.into()
}

impl Settings {
    /// What is solved to see where the mesh is too coarse.
    fn quick(&self, bounces: u32) -> Self {
        let (bounces, target_error) = (BounceLimit::Count(bounces), TargetError::Off);
        let (layers, directional) = (Layers::Off, Directional::Off);
        let direct_samples = self.direct_samples.div_ceil(DIRECT_PART);
        let (schedule, tail) = (ScheduleKind::Gather, Tail::Off);
        Self { schedule, bounces, target_error, layers, directional, direct_samples, tail, ..self.clone() }
    }
}
