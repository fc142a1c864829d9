//! What a solve leaves behind on its way.

use lumel::{Baker, Observer, Saved, SolveState, Step};
use std::sync::Mutex;

/// Keeps the checkpoint after every bounce and every shot.
pub(crate) struct Keep<'a>(pub(crate) &'a Baker, pub(crate) Mutex<Vec<Saved>>);

impl Observer for Keep<'_> {
    fn step_done(&self, step: Step, state: &SolveState) {
        if matches!(step, Step::Bounce(_) | Step::Shot(_)) {
            self.1.lock().unwrap().push(Saved::Checkpoint(Box::new(self.0.checkpoint(state))));
        }
    }
}
