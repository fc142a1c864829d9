//! Solving, step by step.

use crate::observer::{Observer, Snapshot, Step};
use crate::schedule::{Schedule, Shot};
use crate::state::ShotLight;
use crate::{Integrals, PowerLog, SolveState};
use glam::Vec3;
use lumel_basis::{Basis, Field, Identity, NodeId, Sampling};
use lumel_transport::{Control, Job, Measured, PartialField, Source, Transport, TransportError, accumulate};
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

/// The discrete operator of a solve: what measures, and the basis whose nodes it measures.
#[derive(Clone, Copy)]
pub struct Operator<'a> {
    /// What measures.
    pub transport: &'a dyn Transport,
    /// The basis of what is read and of what is measured.
    pub basis: &'a dyn Basis,
    /// The nodes of a hierarchy that may have coefficients, unless all may; the others have none where they are not measured.
    pub active: Option<&'a [bool]>,
}

impl Operator<'_> {
    /// The elements of a job, where elements are nodes and some of them cannot be measured.
    pub(crate) fn active<'a>(&self, valid: &'a [bool]) -> Option<&'a [bool]> {
        (self.transport.shape().sampling == Sampling::Point).then_some(valid)
    }

    /// Gives nodes that cannot be measured the light of their neighbours.
    pub(crate) fn extrapolate(&self, field: &mut Field, known: &[bool]) {
        let is_active = |node: usize| self.active.is_none_or(|active| active[node]);
        if (0..known.len()).any(|node| is_active(node) && !known[node]) {
            self.basis.adjacency().complete(field, known);
        }
    }

    /// Makes what was measured at some nodes the light of all: the others follow their neighbours, and values become coefficients.
    pub(crate) fn complete(&self, field: &mut Field, known: &[bool]) {
        self.extrapolate(field, known);
        if let Some(hierarchy) = self.basis.hierarchy() {
            let counts = self.active.map(|active| {
                active.iter().zip(known).map(|(active, known)| active | known).collect::<Vec<bool>>()
            });
            hierarchy.analyze(field, counts.as_deref());
        }
    }
}

/// Continues from `state` until the schedule is finished.
///
/// Each step transports light that no step before it has, never the running sum, and what it brings is kept by itself.
/// Each has sample points of its own. When the solve is cancelled, `state` holds the steps that were finished.
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
    while let Some(shot) = schedule.next(state, &powers) {
        if let Shot::Nodes(nodes) = shot {
            shoot(operator, state, &nodes, control, observer)?;
            continue;
        }
        let bounce = state.bounces.len() as u32;
        let step = Step::Bounce(bounce);
        observer.step_started(step);
        let measured = {
            let source = match (shot, state.unshot()) {
                (Shot::All, Some(unshot)) => Source::Field(unshot),
                _ => Source::Emitters(None),
            };
            let job = Job { source, bounce, pass: 0, active: operator.active(&state.valid) };
            let live = Live { operator, step, state, observer };
            measured_step(operator, &job, control, Some(&live))?
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

/// The step itself, which nobody watches. All shots are measured by the same samples.
pub(crate) fn transport_shot(
    operator: Operator<'_>,
    state: &mut SolveState,
    nodes: &[NodeId],
    control: &Control,
) -> Result<(), TransportError> {
    let Some(direct) = state.bounces.first() else { return Ok(()) };
    let mut shot = state.shot.take().unwrap_or_else(|| ShotLight::new(direct));
    let sent = shot.sent(nodes);
    let source = Source::Shot(&sent, nodes);
    let job = Job { source, bounce: 1, pass: 0, active: operator.active(&state.valid) };
    let arrived = measured_step(operator, &job, control, None);
    if let Ok(arrived) = &arrived {
        shot.receive(nodes, &arrived.field);
    }
    state.shot = Some(shot);
    arrived.map(|_| ())
}

/// Refuses a state of another basis.
pub(crate) fn check_basis(state: &SolveState, expected: Identity) -> Result<(), SolveError> {
    let found = state.basis;
    let is_new = state.valid.is_empty() && state.bounces.is_empty();
    if is_new || found == Some(expected) { Ok(()) } else { Err(SolveError::WrongState { found, expected }) }
}

/// One application of the operator, with the nodes that were not measured extrapolated: coefficients of its basis.
pub(crate) fn measured_step(
    operator: Operator<'_>,
    job: &Job<'_>,
    control: &Control,
    progress: Option<&dyn PartialField>,
) -> Result<Measured, TransportError> {
    let mut measured = accumulate(operator.transport, job, control, progress)?;
    operator.complete(&mut measured.field, &measured.known);
    Ok(measured)
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
    let source = state.gatherable();
    // Rays apart from those of the bounces.
    let job =
        Job { source: Source::Field(&source), bounce: 1, pass: 1, active: operator.active(&state.valid) };
    Ok(measured_step(operator, &job, control, None)?.field)
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

/// Which nodes that are measured at points lie outside geometry.
pub(crate) fn visible_points(
    transport: &dyn Transport,
    control: &Control,
) -> Result<Vec<bool>, TransportError> {
    let job = Job { source: Source::Nothing, bounce: 0, pass: 0, active: None };
    Ok(accumulate(transport, &job, control, None)?.visible().collect())
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
