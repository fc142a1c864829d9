//! What can be seen of a job while it runs.

use super::course::Moment;
use super::task::Solved;
use crate::lumel_light::LumelIllumination;
use crate::mesh::Mesh;
use crate::selection::Illumination;
use crate::unshot::Unshot;
use crate::wake::Wakes;
use lumel::{Baker, Control, Reading, RefinementState, Tracker};
use lumel_basis::PointCloud;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Where a job is.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Building what the solve needs.
    Preparing,
    /// Splitting edges where light needs it.
    Refining {
        /// The bounce after which light is looked at; 0 is direct light.
        bounce: u32,
        /// So far.
        vertices: usize,
    },
    /// Finding vertices that lie inside geometry.
    Probing,
    /// Measuring this bounce; 0 is direct light.
    Bounce(u32),
    /// Sending the light of the brightest vertices; 0 is the first batch of them.
    Shot(u32),
    /// Measuring all light but the direct once more.
    FinalGather,
    /// Measuring direct light at the vertices, where points carry the bounces.
    ReadDirect,
    /// Measuring where all light comes from.
    Directional,
    /// Adding samples where the error is above the target; 0 is the first round.
    Round(u32),
    /// Measuring the light of some emitters alone.
    Layer(u32),
    /// Measuring the standard error.
    StandardError,
    /// Measuring the light of lumels.
    Lumels {
        /// The round of samples, from 0.
        round: u32,
        /// How much of it is done.
        percent: u32,
    },
    /// Taking noise off them, and closing seams.
    Finishing,
    /// It is over.
    Ended(Ending),
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// All bounces that were asked for are there.
    Done,
    /// It was asked to stop.
    Stopped,
    /// It failed.
    Failed(String),
}

/// What one bounce brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceStats {
    /// Luminance of the power that arrives, W.
    pub power: f64,
    /// Root mean square over the surfaces of what it changed, relative to that of all light so far.
    pub change: f64,
    /// Share of all light that later bounces will bring, as far as it can be told.
    pub unfinished: Option<f64>,
    /// How long it took; zero for a bounce that was resumed.
    pub seconds: f64,
}

/// What can be seen of a job.
#[derive(Clone)]
pub struct Published {
    /// Where it is.
    pub phase: Phase,
    /// The mesh that the light is on, once that is known.
    pub mesh: Option<Arc<Mesh>>,
    /// The light so far.
    pub light: Illumination,
    /// What of it is still to be reflected.
    pub unshot: Option<Arc<Unshot>>,
    /// The light of lumels so far, once they are measured.
    pub lumels: Option<LumelIllumination>,
    /// One for each finished bounce.
    pub stats: Vec<BounceStats>,
    /// One for each finished bounce or shot that was computed here.
    pub course: Vec<Moment>,
    /// Changes with the light, at vertices or at lumels.
    pub generation: u64,
    /// Why the last checkpoint could not be written, if it could not.
    pub checkpoint_problem: Option<String>,
}

/// What a job shares with the thread that draws.
pub(super) struct Shared {
    pub(super) published: Mutex<Published>,
    pub(super) solved: Mutex<Option<Arc<Solved>>>,
    /// The mesh that was or is to be refined, once it was read.
    pub(super) given: Mutex<Option<Arc<Baker>>>,
    /// The scattered points of the light that was shown before, then of this job.
    pub(super) cloud: Mutex<Option<Arc<PointCloud>>>,
    /// What a refinement that was stopped goes on with.
    pub(super) refinement: Mutex<Option<RefinementState>>,
    /// How many vertices a refined mesh was allowed, where light needs more.
    pub(super) vertices_missing: Mutex<Option<usize>>,
    /// When the job began.
    pub(super) begun: Instant,
    /// Follows the solve, once there is one.
    pub(super) tracker: Mutex<Option<Tracker>>,
    pub(super) wakes: Wakes,
}

impl Shared {
    pub(super) fn new(wakes: Wakes, cloud: Option<Arc<PointCloud>>) -> Self {
        let published = Published {
            phase: Phase::Preparing,
            mesh: None,
            light: Illumination::new(),
            unshot: None,
            lumels: None,
            stats: Vec::new(),
            course: Vec::new(),
            generation: 0,
            checkpoint_problem: None,
        };
        Self {
            published: Mutex::new(published),
            solved: Mutex::default(),
            given: Mutex::default(),
            cloud: Mutex::new(cloud),
            refinement: Mutex::default(),
            vertices_missing: Mutex::default(),
            begun: Instant::now(),
            tracker: Mutex::default(),
            wakes,
        }
    }

    /// Time and counters now.
    pub(super) fn reading(&self, control: &Control) -> Reading {
        Reading::new(control, self.begun.elapsed().as_secs_f64())
    }

    pub(super) fn publish_light(&self, change: impl FnOnce(&mut Published)) {
        self.change_light(change);
        (self.wakes.event)();
    }

    pub(super) fn change_light(&self, change: impl FnOnce(&mut Published)) {
        let mut published = lock(&self.published);
        change(&mut published);
        published.generation += 1;
    }

    pub(super) fn publish_phase(&self, phase: Phase) {
        lock(&self.published).phase = phase;
        (self.wakes.event)();
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is behind these is written whole, so a panic elsewhere leaves nothing half-done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
