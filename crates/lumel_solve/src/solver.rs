//! Solving, step by step.

use crate::observer::{Observer, Snapshot, Step};
use crate::operator::{Operator, visible_points};
use crate::schedule::{Schedule, Shot};
use crate::state::ShotLight;
use crate::{Integrals, PowerLog, SolveState};
use glam::Vec3;
use lumel_basis::{Field, Identity, NodeId, Sampling};
use lumel_transport::{Control, Job, Measured, PartialField, Source, Transport, TransportError};
use std::sync::Arc;

/// Why a solve ended early.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// It was asked to.
    #[error("cancelled")]
    Cancelled,
    /// What measures light has failed.
    #[error(transparent)]
    Transport(TransportError),
    /// The state to resume is that of another basis.
    #[error("the state to resume does not belong to the basis of this solve, {expected}")]
    WrongState {
        /// The basis of the state.
        found: Option<Identity>,
        /// The basis of the operator.
        expected: Identity,
    },
    /// The stored rays of all replicates do not fit.
    #[error("replicates need {needed} bytes for stored rays, {allowed} are allowed")]
    Memory {
        /// The bytes they need at least.
        needed: u64,
        /// The limit.
        allowed: u64,
    },
}

impl From<TransportError> for SolveError {
    fn from(error: TransportError) -> Self {
        match error {
            TransportError::Cancelled => Self::Cancelled,
            error => Self::Transport(error),
        }
    }
}

/// Continues from `state` until the schedule is finished.
///
/// Each step transports light that no step before it has, never the running sum, and what it brings is kept by itself.
/// Each has sample points of its own. When the solve is cancelled, `state` holds the steps that were finished.
/// Where direct light is read in another basis, it is measured there before the first bounce.
///
/// # Errors
/// See [`SolveError`].
pub fn solve(
    operator: Operator<'_>,
    integrals: &Integrals,
    schedule: &dyn Schedule,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    let expected = operator.basis.identity();
    check_basis(state, expected)?;
    state.reopen();
    if state.valid.is_empty() {
        state.valid = find_valid(operator.transport, control, observer, state)?;
        state.basis = Some(expected);
    }
    let mut powers = PowerLog::of(integrals, &state.bounces);
    loop {
        if !state.bounces.is_empty() {
            measure_direct(operator, state, control, observer)?;
        }
        let Some(shot) = schedule.next(state, &powers) else { break };
        if let Shot::Nodes(nodes) = shot {
            shoot(operator, state, &nodes, control, observer)?;
            continue;
        }
        let bounce = state.bounces.len() as u32;
        let step = Step::Bounce(bounce);
        observer.step_started(step);
        let measured = {
            let source = match shot {
                Shot::All => state.unshot_source(operator.basis),
                Shot::Emitters | Shot::Nodes(_) => Source::Emitters(None),
            };
            let job = Job { source, bounce, pass: 0, active: operator.active(&state.valid) };
            let live = Live { operator, step, state, observer };
            operator.apply(&job, control, Some(&live))?
        };
        if bounce == 0 {
            // Over areas, it is the first measurement that shows which nodes cannot be measured.
            state.valid.iter_mut().zip(&measured.known).for_each(|(valid, known)| *valid &= known);
        }
        powers.add(&measured.field);
        state.bounces.push(measured.field);
        observer.step_done(step, state);
    }
    Ok(())
}

/// Measures direct light where it is read, if that is another basis and `state` does not have it.
pub(crate) fn measure_direct(
    operator: Operator<'_>,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), TransportError> {
    let Some(direct) = operator.direct.filter(|_| state.read_direct.is_none()) else { return Ok(()) };
    observer.step_started(Step::ReadDirect);
    let visible = direct.visible(control)?;
    state.read_direct = Some(direct.measure(None, visible.as_deref(), control)?);
    observer.step_done(Step::ReadDirect, state);
    Ok(())
}

/// One step of shooting: what these nodes have unshot is transported and counted where it arrives.
fn shoot(
    operator: Operator<'_>,
    state: &mut SolveState,
    nodes: &[NodeId],
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), TransportError> {
    let step = Step::Shot(state.shot.as_ref().map_or(0, |shot| shot.shots));
    observer.step_started(step);
    transport_shot(operator, state, nodes, control)?;
    observer.step_done(step, state);
    if observer.wants_snapshot() {
        observer.snapshot(Snapshot {
            current: Arc::new(state.reflected()),
            ..Snapshot::of_all(state.total(), step)
        });
    }
    Ok(())
}

/// The step itself, which nobody watches. All shots are measured by the same samples. Where another basis holds direct light, the
/// first shot is all of that, whatever nodes of this one are the brightest.
pub(crate) fn transport_shot(
    operator: Operator<'_>,
    state: &mut SolveState,
    nodes: &[NodeId],
    control: &Control,
) -> Result<(), TransportError> {
    let Some(direct) = state.bounces.first() else { return Ok(()) };
    let arrived = |source| {
        let job = Job { source, bounce: 1, pass: 0, active: operator.active(&state.valid) };
        operator.apply(&job, control, None)
    };
    if let (None, Some(direct)) = (&state.shot, state.direct_in(operator.basis)) {
        let arrived = arrived(Source::Reflecting { direct, carried: None })?;
        state.shot = Some(ShotLight::of_direct(arrived.field));
        return Ok(());
    }
    let sent = match &state.shot {
        Some(shot) => shot.sent(nodes),
        None => ShotLight::new(direct).sent(nodes),
    };
    let arrived = arrived(Source::Shot(&sent, nodes))?;
    let shot = state.shot.take().unwrap_or_else(|| ShotLight::new(direct));
    state.shot.insert(shot).receive(nodes, &arrived.field);
    Ok(())
}

/// Refuses a state of another basis.
pub(crate) fn check_basis(state: &SolveState, expected: Identity) -> Result<(), SolveError> {
    let found = state.basis;
    let is_new = state.valid.is_empty() && state.bounces.is_empty();
    if is_new || found == Some(expected) { Ok(()) } else { Err(SolveError::WrongState { found, expected }) }
}

/// Measures all light of a finished solve but the direct once more, by another operator with more rays.
///
/// What few rays have carried from bounce to bounce is smoothed by many at the end: the error of the result is that of
/// the many, and a part of that of the few. The bounces of `state` stay as they are.
///
/// # Errors
/// When it is cancelled or the transport fails; `state` is as before then.
pub fn final_gather(
    operator: Operator<'_>,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    observer.step_started(Step::FinalGather);
    state.gathered = Some(gathered(operator, state, control)?);
    observer.step_done(Step::FinalGather, state);
    Ok(())
}

/// All light of a state but the direct, measured once more.
pub(crate) fn gathered(
    operator: Operator<'_>,
    state: &SolveState,
    control: &Control,
) -> Result<Field, TransportError> {
    let gatherable = state.gatherable(operator.basis);
    // Rays apart from those of the bounces.
    let job = Job { source: gatherable.source(), bounce: 1, pass: 1, active: operator.active(&state.valid) };
    Ok(operator.apply(&job, control, None)?.field)
}

/// Finds the nodes that lie outside geometry.
pub(crate) fn find_valid(
    transport: &dyn Transport,
    control: &Control,
    observer: &dyn Observer,
    state: &SolveState,
) -> Result<Vec<bool>, TransportError> {
    let shape = transport.shape();
    if shape.sampling == Sampling::Area {
        return Ok(vec![true; shape.nodes]);
    }
    observer.step_started(Step::Validity);
    let visible = visible_points(transport, control)?;
    observer.step_done(Step::Validity, state);
    Ok(visible)
}

/// Makes snapshots of a bounce under way.
struct Live<'a> {
    operator: Operator<'a>,
    step: Step,
    state: &'a SolveState,
    observer: &'a dyn Observer,
}

impl PartialField for Live<'_> {
    fn wants_look(&self) -> bool {
        self.observer.wants_snapshot()
    }

    fn look(&self, measured: Measured) {
        let (mut current, known) = (measured.field, measured.known);
        let valid = &self.state.valid;
        // Hidden nodes follow their neighbours; what is not measured yet stays dark.
        let open: Vec<bool> = known.iter().zip(valid).map(|(known, valid)| known | valid).collect();
        self.operator.complete(&mut current, &open);
        let total = Field::sum(valid.len(), self.state.bounces.iter().chain([&current]));
        self.observer.snapshot(Snapshot {
            total: Arc::new(total),
            current: Arc::new(current),
            measured: Arc::new(self.followed(known, &open)),
            step: self.step,
        });
    }
}

impl Live<'_> {
    /// Which nodes are known, or hidden and follow only nodes that are.
    fn followed(&self, known: Vec<bool>, open: &[bool]) -> Vec<bool> {
        if !open.contains(&false) {
            return known;
        }
        let one_where_known = known.iter().map(|&known| Vec3::splat(f32::from(u8::from(known)))).collect();
        let mut share = Field::from_values(one_where_known);
        self.operator.basis.adjacency().complete(&mut share, open);
        share.values().iter().map(|share| share.x == 1.0).collect()
    }
}
