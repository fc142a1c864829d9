//! How a solve goes, by time.

use lumel::{Baker, SolveState};

/// What was still to come at some moment of a solve, as shares of the power of all light found until then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Seconds since the solve began.
    pub seconds: f64,
    /// What had arrived and was still to be reflected.
    pub unshot: f64,
    /// What all light was estimated to lack: the power of the ambient term.
    pub missing: f64,
}

impl Moment {
    /// That of a state that has some light.
    pub(super) fn of(baker: &Baker, state: &SolveState, seconds: f64) -> Option<Self> {
        let integrals = baker.integrals();
        let unshot: f64 = integrals.unshot_powers(state.unshot()?).iter().sum();
        let found: f64 = state.found().map(|field| integrals.power(field)).sum();
        (found > 0.0).then(|| Self { seconds, unshot: unshot / found, missing: integrals.missing(state) })
    }
}
