//! What there is to compute, and what was computed.

use crate::layout::Layout;
use crate::mesh::Given;
use lumel::{Baker, Checkpoint, RefinementState, Saved, Scene, Settings, SolveState};
use lumel_basis::PointCloud;
use std::sync::Arc;

/// What a solve works with.
#[derive(Clone)]
pub struct Task {
    /// The scene with the lights to solve for.
    pub scene: Arc<Scene>,
    /// What computed light on these surfaces before.
    pub baker: Arc<Baker>,
    /// The settings.
    pub settings: Settings,
    /// What is refined, where that is to be done.
    pub given: Given,
    /// The scattered points of the light that is shown, if there are any.
    pub cloud: Option<Arc<PointCloud>>,
    /// Whether all light is wanted at a first look before there is any.
    pub first_look: bool,
}

/// What to compute.
pub enum Work {
    /// All bounces, from the beginning or from what a stopped solve or a file has.
    Solve(SolveStart),
    /// The standard error of a finished solve.
    StandardError(Arc<Solved>),
    /// The bounces of a solve, read as other settings ask.
    Read(Arc<Solved>),
    /// The light of a solve at lumels.
    Lumels {
        /// The solve.
        solved: Arc<Solved>,
        /// Where the lumels lie.
        layout: Arc<Layout>,
        /// Whether noise is taken off.
        denoises: bool,
    },
}

/// Where a solve begins.
pub enum SolveStart {
    /// With direct light.
    Anew,
    /// With refining the given mesh, or with what a refinement with these settings has.
    Refine(Option<Box<RefinementState>>),
    /// With what a solve with these settings continues of this state.
    From(Box<SolveState>),
    /// With what was saved; an error if it does not fit.
    FromFile(Saved),
}

/// A solve that ended, well or because it was stopped.
#[derive(Clone)]
pub struct Solved {
    /// What computed it.
    pub baker: Arc<Baker>,
    /// All bounces that were finished.
    pub state: SolveState,
}

/// Keeps a solve somewhere after each bounce, and after each step of a refinement; `None` to keep nothing.
pub type Keep = Option<Box<dyn Fn(&Checkpoint) -> Result<(), String> + Send + Sync>>;
