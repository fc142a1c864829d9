//! Solving until the error is known to be small enough.
//!
//! Eight replicates solve the whole problem with samples of their own: direct light, and rays that carry the bounces. So
//! their spread holds every error of sampling, what bounces carry on included. Samples are added where it is too large.

use crate::accuracy::{Accuracy, Ended, Errors, REPLICATES, Spread, Target};
use crate::integrals::ambient_field;
use crate::observer::{Observer, Snapshot, Step};
use crate::operator::{DirectOperator, Operator};
use crate::schedule::{Schedule, Shot};
use crate::solver::{self, SolveError};
use crate::state::ShotLight;
use crate::{Integrals, PowerLog, SolveState};
use glam::DVec3;
use lumel_basis::{Field, NodeId, Readout, Sampling};
use lumel_transport::{
    Control, Job, Measured, Pass, Passes, Source, Sums, Transport, TransportError, accumulate,
};
use std::sync::Arc;

/// One set of samples of one replicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    /// Which replicate, from 0.
    pub replicate: u32,
    /// Number of the round, from 0.
    pub number: u32,
    /// Its samples as a multiple of those of the first round: with all before, they double.
    pub times: u32,
}

impl Round {
    fn new(replicate: usize, number: u32) -> Self {
        let times = if number == 0 { 1 } else { 1 << (number - 1) };
        Self { replicate: replicate as u32, number, times }
    }
}

/// Makes operators with independent samples.
pub trait Replicates: Sync {
    /// The operator of a round, for what counts towards certain nodes. It keeps its rays.
    fn operator(&self, round: Round, nodes: &[bool]) -> Box<dyn Transport>;

    /// What measures direct light in the basis that [holds it](lumel_basis::Basis::direct), with the samples of a round; `None` if there is
    /// no such basis.
    fn direct(&self, round: Round) -> Option<Box<dyn Transport>> {
        let _ = round;
        None
    }

    /// Bytes of the rays that the operator of a round keeps for those nodes.
    fn bytes(&self, round: Round, nodes: &[bool]) -> u64;
}

/// What is solved.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The operator that finds nodes inside geometry, and the basis.
    pub operator: Operator<'a>,
    /// The integrals of the basis.
    pub integrals: &'a Integrals,
    /// How users read the light, if not as it is carried: errors are those of what they read.
    pub readout: Option<&'a dyn Readout>,
    /// In which order, and which bounces.
    pub schedule: &'a dyn Schedule,
    /// Whether an estimate stands for what is left out.
    pub tail: bool,
}

impl Problem<'_> {
    /// Removes from a state of finished rounds what depends on which bounces are summed, if these are not those of the
    /// problem: errors, the tail, and the choice of the next round.
    ///
    /// The rounds that were measured stay. They are the samples of the nodes that the old sum asked for, so that the
    /// solve continues with as many as there were, and adds more where the errors of the new sum ask for it.
    pub fn reopen(&self, state: &mut SolveState) {
        let Some(errors) = &state.errors else { return };
        let wanted = self.schedule.wanted(state, &PowerLog::of(self.integrals, &state.bounces));
        let has_tail = self.tail && (state.bounces.len() > 1 || state.shot.is_some());
        if wanted == Some(state.bounces.len()) && state.tail.is_some() == has_tail {
            return;
        }
        state.rounds.truncate(errors.accuracy.rounds as usize);
        (state.errors, state.tail, state.shot, state.directional) = (None, None, None, None);
        // The same rays bring the same bounces, however many there are.
        state.bounces.truncate(wanted.unwrap_or(usize::MAX));
    }
}

/// Solves again and again until enough values have an error below the target, or a limit is reached.
///
/// Every value is the mean of all replicates, every bounce too. In each round the nodes above the target get as many
/// samples as they have in the largest case so far, and all replicates are solved on all rays that are stored. Whether a
/// node is above is decided by the mean variance of it and its neighbours: decided by its own, nodes would stop that are
/// good by luck, and their intervals would be too narrow.
///
/// Where another basis holds direct light, each replicate has measured it there in the first round: bounces average its noise away.
///
/// When the solve is cancelled, `state` holds the last finished round. Given such a state, it measures the samples of its
/// rounds once more and continues with the next; the result has the same bits as if it had not been stopped. A state of
/// other bounces, or with another tail, is [reopened](Problem::reopen) before.
///
/// # Errors
/// When it is cancelled, the transport fails, or memory does not even suffice for the first round.
pub fn solve_to_error(
    problem: Problem<'_>,
    replicates: &dyn Replicates,
    target: Target,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    let Operator { transport, basis, .. } = problem.operator;
    let direct = problem.operator.reflected_direct();
    let expected = basis.identity();
    solver::check_basis(state, expected)?;
    problem.reopen(state);
    if state.errors.as_ref().is_some_and(|errors| errors.accuracy.ended.is_some()) {
        return Ok(());
    }
    if state.rounds.is_empty() {
        let valid = solver::find_valid(transport, control, observer, state)?;
        *state =
            SolveState { basis: Some(expected), rounds: vec![valid.clone()], valid, ..SolveState::new() };
    }
    let mut bytes = 0;
    let visible = direct.map(|direct| direct.visible(control)).transpose()?.flatten();
    let (valid, replicated) = (state.valid.clone(), Default::default());
    let mut solve = Solve { problem, control, valid, visible, replicates: replicated };
    for number in 0.. {
        let active = state.rounds[number as usize].clone();
        let needed =
            |number, active: &[bool]| REPLICATES as u64 * replicates.bytes(Round::new(0, number), active);
        bytes += needed(number, &active);
        if number == 0 && bytes > target.memory {
            return Err(SolveError::Memory { needed: bytes, allowed: target.memory });
        }
        observer.step_started(Step::Round(number));
        solve.add(replicates, number, &active, observer)?;
        if (number as usize) + 1 < state.rounds.len() {
            // A resumed round: what it led to is known.
            continue;
        }
        let solved = solve.all_bounces()?;
        let mean_light = |mean: &Field| problem.integrals.mean(mean);
        let spread = Spread::new(&solved.totals, &solve.valid, basis.adjacency(), mean_light, target);
        let ended = if spread.accuracy.share >= target.share {
            Some(Ended::Reached)
        } else if number + 1 >= target.rounds {
            Some(Ended::Samples)
        } else {
            (bytes + needed(number + 1, &spread.above) > target.memory).then_some(Ended::Memory)
        };
        let accuracy = Accuracy { rounds: number + 1, ended, ..spread.accuracy };
        state.valid.clone_from(&solve.valid);
        state.read_direct = solve.read_direct();
        (state.bounces, state.shot, state.tail) = (solved.bounces, solved.shot, solved.tail);
        state.errors = Some(Errors { standard_error: spread.standard_error, accuracy });
        state.rounds.push(spread.above);
        observer.step_done(Step::Round(number), state);
        if observer.wants_snapshot() {
            observer.snapshot(Snapshot::of_all(solved.total, Step::Round(number)));
        }
        if ended.is_some() {
            break;
        }
    }
    Ok(())
}

struct Solve<'a> {
    problem: Problem<'a>,
    control: &'a Control,
    valid: Vec<bool>,
    /// Which nodes of the basis that holds direct light lie outside geometry, where that is another and they are points.
    visible: Option<Vec<bool>>,
    replicates: [Replicate; REPLICATES],
}

/// All samples that a replicate has.
#[derive(Default)]
struct Replicate {
    passes: Passes,
    /// The direct light of each pass: measured once, as its rays are not stored.
    direct: Vec<Sums>,
    /// The same in the basis that holds direct light, if that is another.
    read_direct: Option<Field>,
}

struct Solved {
    bounces: Vec<Field>,
    shot: Option<ShotLight>,
    tail: Option<Field>,
    /// The mean over replicates of all light.
    total: Field,
    /// Of each replicate, the sum of all bounces and the tail, as users read it.
    totals: Vec<Vec<DVec3>>,
}

impl Replicate {
    /// Direct light as surfaces reflect it, if it is held in another basis.
    fn reflected_direct(&self) -> Option<Source<'_>> {
        self.read_direct.as_ref().map(|direct| Source::Reflecting { direct, carried: None })
    }
}

impl Solve<'_> {
    /// Adds the samples of a round to all replicates.
    ///
    /// In the first round there is direct light to be seen after each.
    fn add(
        &mut self,
        replicates: &dyn Replicates,
        number: u32,
        active: &[bool],
        observer: &dyn Observer,
    ) -> Result<(), TransportError> {
        let nodes: Arc<[bool]> = active.into();
        for replicate in 0..REPLICATES {
            let round = Round::new(replicate, number);
            let operator = replicates.operator(round, &nodes);
            let pass = Pass::new(operator, Arc::clone(&nodes), f64::from(round.times));
            let job = Job { source: Source::Emitters(None), bounce: 0, pass: 0, active: None };
            let direct = pass.measure(&job, self.control)?;
            if number == 0 && self.problem.operator.transport.shape().sampling == Sampling::Area {
                // Over areas, it is the first measurement that shows which nodes cannot be measured.
                let mut known = vec![false; self.valid.len()];
                direct.nodes.iter().for_each(|node| known[node.index()] = true);
                self.valid.iter_mut().zip(&known).for_each(|(valid, known)| *valid &= known);
            }
            if number == 0 {
                self.replicates[replicate].read_direct = self.measured_direct(replicates, round)?;
            }
            self.replicates[replicate].passes.push(pass);
            self.replicates[replicate].direct.push(direct);
            if number == 0 && observer.wants_snapshot() {
                let so_far: Vec<Field> =
                    self.replicates[..=replicate].iter().map(|replicate| self.direct(replicate)).collect();
                observer.snapshot(Snapshot::of_all(mean(&so_far), Step::Round(number)));
            }
        }
        Ok(())
    }

    /// The direct light of a replicate in the basis that holds it, if that is another.
    fn measured_direct(
        &self,
        replicates: &dyn Replicates,
        round: Round,
    ) -> Result<Option<Field>, TransportError> {
        let direct = self.problem.operator.reflected_direct();
        let Some((direct, transport)) = direct.zip(replicates.direct(round)) else { return Ok(None) };
        let direct = DirectOperator { transport: &*transport, ..direct };
        direct.measure(None, self.visible.as_deref(), self.control).map(Some)
    }

    /// The mean of it.
    fn read_direct(&self) -> Option<Field> {
        let all = self.replicates.iter().map(|replicate| replicate.read_direct.clone());
        all.collect::<Option<Vec<Field>>>().map(|all| mean(&all))
    }

    /// Solves all replicates, step by step together, so that all end with the same. Their mean decides about steps.
    fn all_bounces(&self) -> Result<Solved, TransportError> {
        let Problem { integrals, schedule, tail, readout, .. } = self.problem;
        let mut last: Vec<Field> = self.replicates.iter().map(|replicate| self.direct(replicate)).collect();
        let mut before = Vec::new();
        let mut totals: Vec<Vec<DVec3>> =
            last.iter().map(|field| vec![DVec3::ZERO; field.values().len()]).collect();
        add_to(&mut totals, &last);
        let mut light = SolveState { bounces: vec![mean(&last)], ..SolveState::new() };
        let mut powers = PowerLog::of(integrals, &light.bounces);
        let mut shots = Vec::new();
        while let Some(shot) = schedule.next(&light, &powers) {
            if let Shot::Nodes(nodes) = shot {
                if shots.is_empty() && self.replicates.iter().all(|replicate| replicate.read_direct.is_some())
                {
                    shots = self.shots_of_direct()?;
                } else {
                    if shots.is_empty() {
                        shots = last.iter().map(ShotLight::new).collect();
                    }
                    self.shoot(&mut shots, &nodes)?;
                }
                light.shot = Some(mean_of_shots(&shots));
                continue;
            }
            let is_first = light.bounces.len() == 1;
            let bounced = |(replicate, field): (&Replicate, _)| {
                let direct = replicate.reflected_direct().filter(|_| is_first);
                self.measured(replicate, direct.unwrap_or(Source::Field(field)))
            };
            let both = self.replicates.iter().zip(&last);
            let next: Result<Vec<Field>, TransportError> = both.map(bounced).collect();
            before = std::mem::replace(&mut last, next?);
            add_to(&mut totals, &last);
            let bounce = mean(&last);
            powers.add(&bounce);
            light.bounces.push(bounce);
        }
        let reflected: Vec<Field> = shots.iter().map(|shot: &ShotLight| shot.reflected.clone()).collect();
        add_to(&mut totals, &reflected);
        let tails: Option<Vec<Field>> = if !tail {
            None
        } else if shots.is_empty() {
            let of = |(before, last): (&Field, &Field)| {
                let tail = integrals.tail(&[before.clone(), last.clone()]);
                tail.unwrap_or_else(|| Field::zeros(last.node_count()))
            };
            (!before.is_empty()).then(|| before.iter().zip(&last).map(of).collect())
        } else {
            let of = |(shot, direct): (&ShotLight, &Field)| {
                let (bounces, shot) = (vec![direct.clone()], Some(shot.clone()));
                let light = SolveState { bounces, shot, ..SolveState::new() };
                ambient_field(integrals, &light, &light)
            };
            Some(shots.iter().zip(&last).map(of).collect())
        };
        tails.iter().for_each(|tails| add_to(&mut totals, tails));
        let total = mean_by(totals[0].len(), |i| totals.iter().map(move |total| total[i]));
        if let Some(readout) = readout {
            totals.iter_mut().for_each(|total| read(readout, total));
        }
        let SolveState { bounces, shot, .. } = light;
        Ok(Solved { bounces, shot, tail: tails.map(|tails| mean(&tails)), total, totals })
    }

    /// Lets the same nodes of all replicates shoot.
    fn shoot(&self, shots: &mut [ShotLight], nodes: &[NodeId]) -> Result<(), TransportError> {
        for (replicate, shot) in self.replicates.iter().zip(shots) {
            let sent = shot.sent(nodes);
            let arrived = self.measured(replicate, Source::Shot(&sent, nodes))?;
            shot.receive(nodes, &arrived);
        }
        Ok(())
    }

    /// A first shot of all direct light, from the basis that holds it.
    fn shots_of_direct(&self) -> Result<Vec<ShotLight>, TransportError> {
        let sources =
            self.replicates.iter().filter_map(|replicate| Some((replicate, replicate.reflected_direct()?)));
        sources
            .map(|(replicate, source)| self.measured(replicate, source).map(ShotLight::of_direct))
            .collect()
    }

    fn direct(&self, replicate: &Replicate) -> Field {
        let shape = replicate.passes.shape();
        self.completed(Measured::merge(shape.nodes, shape.channels, &replicate.direct))
    }

    fn measured(&self, replicate: &Replicate, source: Source<'_>) -> Result<Field, TransportError> {
        let job = Job { source, bounce: 1, pass: 0, active: None };
        Ok(self.completed(accumulate(&replicate.passes, &job, self.control, None)?))
    }

    /// The light of all nodes.
    fn completed(&self, measured: Measured) -> Field {
        let Measured { mut field, known, .. } = measured;
        let known: Vec<bool> = known.iter().zip(&self.valid).map(|(known, valid)| *known && *valid).collect();
        self.problem.operator.complete(&mut field, &known);
        field
    }
}

fn read(readout: &dyn Readout, total: &mut [DVec3]) {
    let mut field = Field::from_values(total.iter().map(|value| value.as_vec3()).collect());
    readout.read(&mut field);
    total.iter_mut().zip(field.values()).for_each(|(total, value)| *total = value.as_dvec3());
}

fn add_to(totals: &mut [Vec<DVec3>], fields: &[Field]) {
    for (total, field) in totals.iter_mut().zip(fields) {
        total.iter_mut().zip(field.values()).for_each(|(sum, value)| *sum += value.as_dvec3());
    }
}

/// The mean over replicates of what was shot.
fn mean_of_shots(shots: &[ShotLight]) -> ShotLight {
    let of = |field: fn(&ShotLight) -> &Field| {
        let n_values = shots.first().map_or(0, |shot| field(shot).values().len());
        mean_by(n_values, |i| shots.iter().map(move |shot| field(shot).values()[i].as_dvec3()))
    };
    let shots_so_far = shots.first().map_or(0, |shot| shot.shots);
    ShotLight { reflected: of(|shot| &shot.reflected), unshot: of(|shot| &shot.unshot), shots: shots_so_far }
}

/// The mean over replicates, rounded once.
fn mean(fields: &[Field]) -> Field {
    let n_values = fields.first().map_or(0, |field| field.values().len());
    mean_by(n_values, |i| fields.iter().map(move |field| field.values()[i].as_dvec3()))
}

/// The mean over replicates of `values(i)`, which has one of each.
fn mean_by<I: ExactSizeIterator<Item = DVec3>>(n_values: usize, values: impl Fn(usize) -> I) -> Field {
    let mean = |i: usize| {
        let values = values(i);
        let n = values.len() as f64;
        (values.sum::<DVec3>() / n).as_vec3()
    };
    Field::from_values((0..n_values).map(mean).collect())
}
