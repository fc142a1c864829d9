//! What the window decides about bounces.
//!
//! Both ask the library, as the command line's `--resume` does; nothing else in the window decides either question.

use crate::solver::Solved;
use lumel::{Settings, SolveState};

/// Whether bounces computed with `old` are the very bounces that `new` asks for: what bounces depend on.
pub(crate) fn same_bounces(old: &Settings, new: &Settings) -> bool {
    old.same_bounces_as(new)
}

/// The state to resume from with these settings: when a solve is finished.
///
/// Drops the bounces beyond those that an uninterrupted solve would compute, and what was computed after the last.
/// The scene must be the one that was solved.
pub(crate) fn wanted_bounces(solved: &Solved, settings: &Settings) -> SolveState {
    let SolveState { basis, valid, mut bounces, .. } = solved.state.clone();
    if let Some(wanted) = settings.stop().wanted(solved.baker.integrals(), &bounces) {
        bounces.truncate(wanted);
    }
    SolveState { basis, valid, bounces, ..SolveState::new() }
}
