//! The Neumann series, bounce by bounce.

use crate::observer::{Observer, Snapshot, Step};
use crate::{Energy, SolveState};
use glam::Vec3;
use lumel_basis::{Basis, Field, Measure};
use lumel_transport::{Cancelled, Control, Job, Measured, PartialField, Source, Transport, accumulate};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Nodes that meet the backs of surfaces with more than a quarter of their rays lie inside geometry.
const MIN_OPENNESS: f32 = 0.75;

/// When enough bounces have been computed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// After this many; 0 is direct light only.
    Bounces(u32),
    /// When the bounces to come would bring less than this share of all light, but after `at_most` in any case.
    Remainder {
        /// The share.
        fraction: f32,
        /// The limit.
        at_most: u32,
    },
}

/// Why a solve ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolveError {
    /// It was asked to.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The state to resume has another number of nodes than the operator.
    #[error("the state to resume has {found} nodes, the scene has {expected}")]
    WrongState {
        /// Nodes of the state.
        found: usize,
        /// Nodes of the operator.
        expected: usize,
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

/// Goes on from `state` until `stop` is reached.
///
/// Each bounce gathers the bounce before it, never the running sum, and is kept by itself. Each has sample points
/// of its own. When the solve is cancelled, `state` holds the bounces that were finished.
///
/// # Errors
/// See [`SolveError`].
pub fn solve(
    transport: &dyn Transport,
    basis: &dyn Basis,
    energy: &Energy,
    stop: Stop,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    let expected = transport.shape().nodes;
    let sizes =
        state.bounces.iter().map(Field::len).chain((!state.valid.is_empty()).then_some(state.valid.len()));
    if let Some(found) = sizes.into_iter().find(|&n| n != expected) {
        return Err(SolveError::WrongState { found, expected });
    }
    (state.tail, state.gathered, state.errors) = (None, None, None);
    if state.valid.is_empty() {
        state.valid = probe(transport, control, observer, state)?;
    }
    while !stop.reached(energy, &state.bounces) {
        let bounce = state.bounces.len() as u32;
        let step = Step::Bounce(bounce);
        observer.step_started(step);
        let measured = {
            let source = state.unshot().map_or(Source::Emitters, Source::Field);
            let active = (transport.shape().measure == Measure::AtPoint).then_some(state.valid.as_slice());
            let job = Job { source, bounce, pass: 0, active };
            let live = Live { basis, step, state, observer };
            accumulate(transport, &job, control, Some(&live))?
        };
        if bounce == 0 {
            // Over areas, it is the first measurement that shows which nodes cannot be measured.
            state.valid.iter_mut().zip(&measured.known).for_each(|(valid, known)| *valid &= known);
        }
        let mut field = measured.field;
        basis.fill(&mut field, &measured.known);
        state.bounces.push(field);
        observer.step_done(step, state);
    }
    Ok(())
}

/// Measures all light of a finished solve but the direct once more, by another operator with more rays.
///
/// What few rays have carried from bounce to bounce is smoothed by many at the end: the error of the result is that of
/// the many, and a part of that of the few. The bounces of `state` stay as they are.
///
/// # Errors
/// When it is asked to stop; `state` is as before then.
pub fn final_gather(
    transport: &dyn Transport,
    basis: &dyn Basis,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    observer.step_started(Step::FinalGather);
    let source = state.gatherable();
    let active = (transport.shape().measure == Measure::AtPoint).then_some(state.valid.as_slice());
    // Rays apart from those of the bounces.
    let job = Job { source: Source::Field(&source), bounce: 1, pass: 1, active };
    let measured = accumulate(transport, &job, control, None)?;
    let mut field = measured.field;
    basis.fill(&mut field, &measured.known);
    state.gathered = Some(field);
    observer.step_done(Step::FinalGather, state);
    Ok(())
}

impl Stop {
    pub(crate) fn reached(self, energy: &Energy, bounces: &[Field]) -> bool {
        match self {
            Self::Bounces(n) => bounces.len() > n as usize,
            Self::Remainder { fraction, at_most } => {
                bounces.len() > at_most as usize
                    || energy.remainder(bounces).is_some_and(|left| left < f64::from(fraction))
            }
        }
    }
}

/// Finds the nodes that lie inside geometry.
pub(crate) fn probe(
    transport: &dyn Transport,
    control: &Control,
    observer: &dyn Observer,
    state: &SolveState,
) -> Result<Vec<bool>, Cancelled> {
    let shape = transport.shape();
    if shape.measure == Measure::OverArea {
        return Ok(vec![true; shape.nodes]);
    }
    observer.step_started(Step::Probe);
    let job = Job { source: Source::Openness, bounce: 0, pass: 0, active: None };
    let measured = accumulate(transport, &job, control, None)?;
    observer.step_done(Step::Probe, state);
    Ok(measured.field.values().iter().map(|openness| openness.x >= MIN_OPENNESS).collect())
}

/// Makes snapshots of a bounce under way.
struct Live<'a> {
    basis: &'a dyn Basis,
    step: Step,
    state: &'a SolveState,
    observer: &'a dyn Observer,
}

impl PartialField for Live<'_> {
    fn wants_look(&self) -> bool {
        self.observer.wants_snapshot()
    }

    fn look(&self, Measured { field: mut current, known }: Measured) {
        let valid = &self.state.valid;
        // Hidden nodes follow their neighbours; what is not measured yet stays dark.
        let open: Vec<bool> = known.iter().zip(valid).map(|(known, valid)| known | valid).collect();
        self.basis.fill(&mut current, &open);
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
        self.basis.fill(&mut share, open);
        share.values().iter().map(|share| share.x == 1.0).collect()
    }
}
