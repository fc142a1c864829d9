//! Solving until the error is known to be small enough.
//!
//! Eight replicates solve the whole problem with samples of their own: direct light, and rays that carry the bounces. So
//! their spread holds every error of sampling, what bounces carry on included. Samples are added where it is too large.

use crate::accuracy::{Accuracy, Ended, Errors, REPLICATES, Spread, Target};
use crate::observer::{Observer, Snapshot, Step};
use crate::solver::{self, SolveError, Stop};
use crate::{Energy, Neighbours, SolveState};
use glam::DVec3;
use lumel_basis::{Basis, Field, Measure};
use lumel_transport::{Cancelled, Control, Job, Source, Transport, accumulate};
use std::sync::Arc;

/// Makes operators with independent samples.
pub trait Replicates: Sync {
    /// The operator with the samples that a replicate gets in a round, for what counts towards certain nodes.
    ///
    /// It has `times` the samples of the first round, and keeps its rays.
    fn operator(&self, replicate: u32, round: u32, times: u32, nodes: &[bool]) -> Box<dyn Transport>;

    /// Bytes of the rays that operators of one replicate keep with so many samples for those nodes.
    fn bytes(&self, times: u32, nodes: &[bool]) -> u64;
}

/// What is solved.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The operator that finds nodes inside geometry.
    pub probe: &'a dyn Transport,
    /// The basis.
    pub basis: &'a dyn Basis,
    /// Which of its nodes lie beside each other.
    pub neighbours: &'a Neighbours,
    /// Its integrals.
    pub energy: &'a Energy,
    /// Which bounces.
    pub stop: Stop,
    /// Whether a geometric series stands for those that are left out.
    pub tail: bool,
}

/// Solves anew until enough values have an error below the target, or a limit is reached.
///
/// Every value is the mean of all replicates, every bounce too. In each round the nodes above the target get as many
/// samples as they have in the largest case so far, and all replicates are solved on all rays that are stored. Whether a
/// node is above is decided by the mean variance of it and its neighbours: decided by its own, nodes would stop that are
/// good by luck, and their intervals would be too narrow.
///
/// When the solve is cancelled, `state` holds the last finished round.
///
/// # Errors
/// When it is cancelled, or memory does not even do for the first round.
pub fn solve_to_error(
    problem: Problem<'_>,
    replicates: &dyn Replicates,
    target: Target,
    state: &mut SolveState,
    control: &Control,
    observer: &dyn Observer,
) -> Result<(), SolveError> {
    *state = SolveState::new();
    let valid = solver::probe(problem.probe, control, observer, state)?;
    let mut solve = Solve { problem, control, valid, replicates: Default::default() };
    let mut active = solve.valid.clone();
    let mut bytes = REPLICATES as u64 * replicates.bytes(1, &active);
    if bytes > target.memory {
        return Err(SolveError::Memory { needed: bytes, allowed: target.memory });
    }
    for round in 0.. {
        observer.step_started(Step::Round(round));
        solve.add(replicates, round, &active, observer)?;
        let solved = solve.all_bounces()?;
        let mean_light = |mean: &Field| problem.energy.mean(mean);
        let spread = Spread::new(&solved.totals, &solve.valid, problem.neighbours, mean_light, target);
        active = spread.above;
        let next = REPLICATES as u64 * replicates.bytes(times(round + 1), &active);
        let ended = if spread.accuracy.share >= target.share {
            Some(Ended::Reached)
        } else if round + 1 >= target.rounds {
            Some(Ended::Samples)
        } else {
            (bytes + next > target.memory).then_some(Ended::Memory)
        };
        bytes += next;
        let accuracy = Accuracy { rounds: round + 1, ended, ..spread.accuracy };
        state.valid.clone_from(&solve.valid);
        (state.bounces, state.tail) = (solved.bounces, solved.tail);
        state.errors = Some(Errors { standard_error: spread.standard_error, accuracy });
        observer.step_done(Step::Round(round), state);
        if observer.wants_snapshot() {
            observer.snapshot(snapshot(spread.mean, round));
        }
        if ended.is_some() {
            break;
        }
    }
    Ok(())
}

/// All that is known in a round.
fn snapshot(mean: Field, round: u32) -> Snapshot {
    let measured = Arc::new(vec![true; mean.len()]);
    let total = Arc::new(mean);
    Snapshot { current: Arc::clone(&total), total, measured, step: Step::Round(round) }
}

/// The samples of a round as a multiple of those of the first: with all before, they double.
fn times(round: u32) -> u32 {
    if round == 0 { 1 } else { 1 << (round - 1) }
}

struct Solve<'a> {
    problem: Problem<'a>,
    control: &'a Control,
    valid: Vec<bool>,
    replicates: [Vec<Pass>; REPLICATES],
}

/// The samples that a replicate got in one round.
struct Pass {
    operator: Box<dyn Transport>,
    nodes: Arc<[bool]>,
    samples: f64,
    direct: Measured,
}

/// The light of all nodes that a pass knows.
struct Measured {
    field: Field,
    known: Vec<bool>,
}

struct Solved {
    bounces: Vec<Field>,
    tail: Option<Field>,
    /// Of each replicate, the sum of all bounces and the tail.
    totals: Vec<Vec<DVec3>>,
}

impl Solve<'_> {
    /// Adds the samples of a round to all replicates.
    ///
    /// In the first round there is direct light to be seen after each.
    fn add(
        &mut self,
        replicates: &dyn Replicates,
        round: u32,
        active: &[bool],
        observer: &dyn Observer,
    ) -> Result<(), Cancelled> {
        let nodes: Arc<[bool]> = active.into();
        for replicate in 0..REPLICATES {
            let operator = replicates.operator(replicate as u32, round, times(round), &nodes);
            let direct = measure(&*operator, Source::Emitters, &nodes, self.control)?;
            if round == 0 && self.problem.probe.shape().measure == Measure::OverArea {
                // Over areas, it is the first measurement that shows which nodes cannot be measured.
                self.valid.iter_mut().zip(&direct.known).for_each(|(valid, known)| *valid &= known);
            }
            let samples = f64::from(times(round));
            self.replicates[replicate].push(Pass { operator, nodes: Arc::clone(&nodes), samples, direct });
            if round == 0 && observer.wants_snapshot() {
                let so_far = self.replicates[..=replicate].iter().map(|passes| self.direct(passes));
                observer.snapshot(snapshot(mean(&so_far.collect::<Vec<_>>()), round));
            }
        }
        Ok(())
    }

    /// Solves all replicates, bounce by bounce together, so that all end with the same.
    fn all_bounces(&self) -> Result<Solved, Cancelled> {
        let Problem { energy, stop, tail, .. } = self.problem;
        let mut last: Vec<Field> = self.replicates.iter().map(|passes| self.direct(passes)).collect();
        let mut before = Vec::new();
        let mut totals: Vec<Vec<DVec3>> = last.iter().map(|field| vec![DVec3::ZERO; field.len()]).collect();
        add_to(&mut totals, &last);
        let mut bounces = vec![mean(&last)];
        while !stop.reached(energy, &bounces) {
            let next: Result<Vec<Field>, Cancelled> = self
                .replicates
                .iter()
                .zip(&last)
                .map(|(passes, field)| self.bounced(passes, field))
                .collect();
            before = std::mem::replace(&mut last, next?);
            add_to(&mut totals, &last);
            bounces.push(mean(&last));
        }
        let tails: Option<Vec<Field>> = (tail && !before.is_empty()).then(|| {
            let of = |(before, last): (&Field, &Field)| {
                energy.tail(&[before.clone(), last.clone()]).unwrap_or_else(|| Field::zeros(last.len()))
            };
            before.iter().zip(&last).map(of).collect()
        });
        tails.iter().for_each(|tails| add_to(&mut totals, tails));
        Ok(Solved { bounces, tail: tails.map(|tails| mean(&tails)), totals })
    }

    fn direct(&self, passes: &[Pass]) -> Field {
        self.merged(passes.iter().map(|pass| (&pass.direct, pass.samples)))
    }

    fn bounced(&self, passes: &[Pass], field: &Field) -> Result<Field, Cancelled> {
        let measured: Result<Vec<Measured>, Cancelled> = passes
            .iter()
            .map(|pass| measure(&*pass.operator, Source::Field(field), &pass.nodes, self.control))
            .collect();
        Ok(self.merged(measured?.iter().zip(passes.iter().map(|pass| pass.samples))))
    }

    /// The mean of passes by their samples.
    fn merged<'a>(&self, passes: impl Iterator<Item = (&'a Measured, f64)>) -> Field {
        let mut sums = vec![(0.0, DVec3::ZERO); self.valid.len()];
        for (Measured { field, known }, samples) in passes {
            for ((sum, value), _) in
                sums.iter_mut().zip(field.values()).zip(known).filter(|(_, known)| **known)
            {
                sum.0 += samples;
                sum.1 += value.as_dvec3() * samples;
            }
        }
        let known: Vec<bool> =
            sums.iter().zip(&self.valid).map(|(sum, valid)| *valid && sum.0 > 0.0).collect();
        let value = |&(samples, sum): &(f64, DVec3)| {
            if samples > 0.0 { (sum / samples).as_vec3() } else { glam::Vec3::ZERO }
        };
        let mut field = Field::from_values(sums.iter().map(value).collect());
        self.problem.basis.fill(&mut field, &known);
        field
    }
}

/// What a pass says of its nodes; others may have been measured in part.
fn measure(
    operator: &dyn Transport,
    source: Source<'_>,
    nodes: &[bool],
    control: &Control,
) -> Result<Measured, Cancelled> {
    let bounce = if matches!(source, Source::Emitters) { 0 } else { 1 };
    let job = Job { source, bounce, pass: 0, active: None };
    let measured = accumulate(operator, &job, control, None)?;
    let known = measured.known.iter().zip(nodes).map(|(known, wanted)| *known && *wanted).collect();
    Ok(Measured { field: measured.field, known })
}

fn add_to(totals: &mut [Vec<DVec3>], fields: &[Field]) {
    for (total, field) in totals.iter_mut().zip(fields) {
        total.iter_mut().zip(field.values()).for_each(|(sum, value)| *sum += value.as_dvec3());
    }
}

/// The mean over replicates, rounded once.
fn mean(fields: &[Field]) -> Field {
    let sum = |node: usize| fields.iter().map(|field| field.values()[node].as_dvec3()).sum::<DVec3>();
    let n_nodes = fields.first().map_or(0, Field::len);
    Field::from_values((0..n_nodes).map(|node| (sum(node) / fields.len() as f64).as_vec3()).collect())
}
