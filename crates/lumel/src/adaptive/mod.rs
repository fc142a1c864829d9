//! Tessellation that follows light.

mod criterion;
mod kinks;
mod probes;
mod refiner;

use crate::assembly::StoredRays;
use crate::settings::{BounceLimit, Layers, Settings, TargetError};
use crate::{Baker, Tail};
use lumel_accel::Refined;
use lumel_basis::{Directional, Field};
use lumel_scene::{Bisection, SurfacePoint, luminance};
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
#[derive(Clone, Copy, Debug)]
pub struct Refining<'a> {
    /// The bounce after which light is looked at; 0 is direct light.
    pub bounce: u32,
    /// The mesh so far.
    pub mesh: &'a Bisection,
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
    /// [nothing](crate::Adaptive::Off).
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
        let Some(error) = self.settings().adaptive.error() else { return Ok(None) };
        let error = f64::from(error.get());
        let original = self.scene().original();
        let original = original.map(|scene| Self::new(Arc::new(scene), self.settings().clone()));
        let start = original.as_ref().unwrap_or(self);
        let mesh = Bisection::new(Arc::clone(start.scene()));
        let mut refiner = Refiner::new(mesh, error, self.settings().max_vertices as usize);
        let probes = start.probes(None);
        let mut ended = refiner.refine(|points| probes.measure(points, control), &mut |mesh| {
            watch(&Refining { bounce: 0, mesh });
        })?;
        let most = match self.settings().bounces {
            BounceLimit::Count(n) => n,
            BounceLimit::All => u32::MAX,
        };
        let mut coarser: Option<Self> = None;
        for bounce in 1..=most {
            if ended == RefinementEnd::Vertices {
                break;
            }
            let settings = self.settings().quick(bounce);
            let fine = start.on_mesh(coarser.as_ref(), &refiner.mesh, settings)?;
            let mut state = SolveState::new();
            fine.run(&mut state, control, &Silent)?;
            let all = Field::sum(state.node_count(), &state.bounces);
            let light: Vec<f64> =
                fine.light_reader(&state).at_vertices(&all).iter().map(|e| luminance(*e).into()).collect();
            let reflecting = Field::sum(state.node_count(), &state.bounces[..bounce as usize]);
            let probes = fine.probes(Some(&reflecting));
            let before = refiner.mesh.splits().len();
            let probe = |points: &[SurfacePoint]| {
                let refined: Vec<_> = points.iter().map(|&at| fine.scene().refined_point(at)).collect();
                probes.measure(&refined, control)
            };
            ended = refiner.refine_after_bounce(AFTER_BOUNCES * error, &light, probe, &mut |mesh| {
                watch(&Refining { bounce, mesh });
            })?;
            let is_dim = fine.shares(&state).last().is_none_or(|&share| share < error);
            coarser = Some(fine);
            // Later bounces are smoother.
            if is_dim || refiner.mesh.splits().len() == before {
                break;
            }
        }
        let baker = start.on_mesh(coarser.as_ref(), &refiner.mesh, self.settings().clone())?;
        Ok(Some(Adapted { baker, ended }))
    }

    /// A baker of this one's scene with its edges split, and with the rays that `coarser` has stored.
    fn on_mesh(
        &self,
        coarser: Option<&Self>,
        mesh: &Bisection,
        settings: Settings,
    ) -> Result<Self, SolveError> {
        let scene = self.scene().refined(mesh.splits()).map_err(|error| {
            let worker = "refinement".to_owned();
            TransportError::Failed { worker, cause: error.to_string() }
        })?;
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

impl Settings {
    /// What is solved to see where the mesh is too coarse.
    fn quick(&self, bounces: u32) -> Self {
        let (bounces, target_error) = (BounceLimit::Count(bounces), TargetError::Off);
        let (layers, directional) = (Layers::Off, Directional::Off);
        let direct_samples = self.direct_samples.div_ceil(DIRECT_PART);
        Self { bounces, target_error, layers, directional, direct_samples, tail: Tail::Off, ..self.clone() }
    }
}
