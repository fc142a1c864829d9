//! All light of a finished solve by direction.

use crate::SolveState;
use crate::observer::{Observer, Step};
use crate::operator::Operator;
use crate::solver::SolveError;
use lumel_basis::Field;
use lumel_transport::{Control, DIRECTIONAL_PASS, EmitterMask, Job, Source, TransportError};

/// Measures the moments of all light of a finished solve, by an operator with more channels.
///
/// Bounces are carried as irradiance alone: what arrives by direction is measured once in the end, from lights and from all
/// that surfaces reflect. Channel 0 of the result is the irradiance that the solve has found, bit by bit.
///
/// # Errors
/// When it is cancelled or the transport fails; `state` is as before then.
pub fn solve_directional(
    operator: Operator<'_>,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    observer.step_started(Step::Directional);
    state.directional = Some(by_direction(operator, None, state, control)?);
    observer.step_done(Step::Directional, state);
    Ok(())
}

/// The light of some emitters by direction, of which `state` has the bounces.
pub(crate) fn by_direction(
    operator: Operator<'_>,
    mask: Option<&EmitterMask>,
    state: &SolveState,
    control: &Control,
) -> Result<Field, TransportError> {
    let measured = |source, bounce| {
        let job = Job { source, bounce, pass: DIRECTIONAL_PASS, active: operator.active(&state.valid) };
        Ok(operator.apply(&job, control, None)?.field)
    };
    let mut parts = vec![measured(Source::Emitters(mask), 0)?];
    if state.bounces.len() > 1 || state.shot.is_some() {
        parts.push(measured(state.gatherable(operator.basis).source(), 1)?);
    }
    let mut sum = Field::sum(state.node_count(), &parts);
    sum.set_irradiance(&state.total());
    Ok(sum)
}
