//! Direct light where it is read.

use crate::SolveState;
use crate::observer::{Observer, Step};
use crate::solver::{Operator, SolveError, measured_step};
use lumel_basis::Sampling;
use lumel_transport::{Control, Job, Measured, Source, accumulate};

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
    let job = |source| Job { source, bounce: 0, pass: 0, active: None };
    let Measured { field, .. } = match operator.transport.shape().sampling {
        // Over areas, what is hidden is left out as it is measured.
        Sampling::Area => measured_step(operator, &job(Source::Emitters(None)), control, None)?,
        Sampling::Point => {
            let hidden = accumulate(operator.transport, &job(Source::Nothing), control, None)?;
            let visible: Vec<bool> = hidden.visible().collect();
            let active = Some(visible.as_slice());
            measured_step(operator, &Job { active, ..job(Source::Emitters(None)) }, control, None)?
        }
    };
    state.read_direct = Some(field);
    observer.step_done(Step::ReadDirect, state);
    Ok(())
}
