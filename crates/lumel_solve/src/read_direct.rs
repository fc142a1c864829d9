//! Direct light where it is read.

use crate::SolveState;
use crate::observer::{Observer, Step};
use crate::solver::{Operator, SolveError, measured_step, visible_points};
use lumel_basis::Sampling;
use lumel_transport::{Control, Job, Source};

/// Measures the direct light of a finished solve once more, by an operator towards the basis in which light is read.
///
/// Bounces are smooth and may be carried by few functions that are read anywhere; direct light has edges, which these blur. The
/// result stands beside the bounces of `state`, which stay as they are.
///
/// # Errors
/// When it is cancelled or the transport fails; `state` is as before then.
pub fn read_direct(
    operator: Operator<'_>,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    observer.step_started(Step::ReadDirect);
    let visible = match operator.transport.shape().sampling {
        // What is hidden is left out as it is measured.
        Sampling::Area => None,
        Sampling::Point => Some(visible_points(operator.transport, control)?),
    };
    let job = Job { source: Source::Emitters(None), bounce: 0, pass: 0, active: visible.as_deref() };
    state.read_direct = Some(measured_step(operator, &job, control, None)?.field);
    observer.step_done(Step::ReadDirect, state);
    Ok(())
}
