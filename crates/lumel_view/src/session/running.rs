//! A job that runs, and what it was started for.

use crate::inputs::Inputs;
use crate::solver::SolveJob;
use lumel::Settings;

/// A job and what it was started for.
pub(super) struct Running {
    pub(super) job: SolveJob,
    /// What it computes light from.
    pub(super) inputs: Inputs,
    /// The generation of its light that was taken in last.
    pub(super) seen: u64,
    pub(super) then: Then,
    pub(super) errand: Errand,
}

/// What a job was started for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Errand {
    /// A solve that was asked for.
    Solve,
    /// A solve after a change of lights or materials, by itself: shown when it is done.
    Follow,
    /// The standard error of a finished solve.
    StandardError,
    /// The light of lumels, by itself, after a solve.
    Lumels,
    /// What a solve has found, read as the settings ask now: shown when it is done.
    Read {
        /// Whether the solve had finished.
        complete: bool,
        /// How long it took.
        seconds: Option<f64>,
    },
}

/// What to do when a job that was asked to stop has stopped.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Then {
    Rest,
    Restart,
    GoOn,
}

impl Running {
    pub(super) fn settings(&self) -> &Settings {
        self.job.settings()
    }

    pub(super) fn is_under_way(&self) -> bool {
        self.job.ending().is_none()
    }

    /// Whether it follows the hand: nobody has asked for it.
    pub(super) fn follows(&self) -> bool {
        matches!(self.errand, Errand::Follow | Errand::Read { .. })
    }
}
