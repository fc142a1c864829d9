//! Watching a solve.

use crate::SolveState;
use lumel_basis::Field;
use std::sync::Arc;

/// What a solve is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Finding the nodes that lie inside geometry.
    Validity,
    /// Measuring this bounce; 0 is direct light.
    Bounce(u32),
    /// Transporting the unshot light of the batch of nodes with this number.
    Shot(u32),
    /// Measuring all light but the direct once more.
    FinalGather,
    /// Measuring direct light in the basis in which it is read, where that is another than carries bounces.
    ReadDirect,
    /// Measuring where all light comes from.
    Directional,
    /// Adding samples where the error is above a target, and solving all replicates with them.
    Round(u32),
    /// Finding the part of this layer of emitters.
    Layer(u32),
}

/// All light found so far, at some moment of a solve.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The sum of finished bounces and what is known of the current one.
    pub total: Arc<Field>,
    /// What is known of the bounce being measured, zero at nodes that are not measured yet; where light is shot, all light but
    /// the direct.
    pub current: Arc<Field>,
    /// Which nodes have been measured in this bounce. Hidden ones count once all neighbours that they follow do.
    pub measured: Arc<Vec<bool>>,
    /// What is being measured.
    pub step: Step,
}

impl Snapshot {
    /// One of light that is known everywhere.
    pub(crate) fn of_all(total: Field, step: Step) -> Self {
        let measured = Arc::new(vec![true; total.node_count()]);
        let total = Arc::new(total);
        Self { current: Arc::clone(&total), total, measured, step }
    }
}

/// Follows a solve; called from the threads that solve, so everything here must be quick.
pub trait Observer: Sync {
    /// A step begins.
    fn step_started(&self, step: Step) {
        let _ = step;
    }

    /// A step is done; `state` holds its result. The place to write a checkpoint.
    fn step_done(&self, step: Step, state: &SolveState) {
        let _ = (step, state);
    }

    /// Whether a snapshot is wanted now; a yes is followed by one [`snapshot`](Self::snapshot).
    ///
    /// Asked often and by many threads: the observer has the clock, and should set it when it says yes.
    fn wants_snapshot(&self) -> bool {
        false
    }

    /// Takes a snapshot that was wanted. Those of one bounce come in order, each with all that was in the last.
    fn snapshot(&self, snapshot: Snapshot) {
        let _ = snapshot;
    }
}

/// An observer that does not look.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}
