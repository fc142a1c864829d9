//! What the window decides about bounces.
//!
//! Each is a copy of a rule that the command line's `--resume` follows too; nothing else here decides either question.

use lumel::{BounceLimit, Settings, SolveState};

/// Whether bounces computed with `old` are the very bounces that `new` asks for: what bounces depend on.
pub(crate) fn same_bounces(old: &Settings, new: &Settings) -> bool {
    old.same_bounces_as(new)
}

/// The state to resume from with these settings: when a solve is finished.
///
/// Drops the bounces beyond a number of bounces, but not those beyond a remainder.
pub(crate) fn wanted_bounces(state: &SolveState, settings: &Settings) -> SolveState {
    let mut state = SolveState { tail: None, ..state.clone() };
    if let BounceLimit::Count(n) = settings.bounces {
        state.bounces.truncate(n as usize + 1);
    }
    state
}
