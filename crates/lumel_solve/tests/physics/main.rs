//! Solutions for all bounces against what they must be.

mod determinism;
mod energy;
mod furnace;
mod hidden;
mod meshless;
mod metamorphic;
mod shooting;
mod spheres;
mod watching;

use lumel_basis::{Basis, Field};
use lumel_solve::{Gather, Integrals, Silent, SolveState, Stop, solve};
use lumel_testkit::{Method, Operator, Stage};
use lumel_transport::{Control, EmitterSampling, Plan};

/// Solves from scratch.
fn solved(stage: &Stage, method: Method, plan: Plan, stop: Stop) -> SolveState {
    solved_by(&stage.operator(method, plan), stage, stop)
}

/// So many rays of each kind; emitters are found by hemisphere rays.
fn plan(seed: u64, n_rays: u32) -> Plan {
    Plan {
        seed,
        indirect_samples: n_rays,
        direct_samples: n_rays,
        emitters: EmitterSampling::Rays,
        ..Plan::default()
    }
}

fn solved_by(operator: &Operator, stage: &Stage, stop: Stop) -> SolveState {
    let mut state = SolveState::new();
    go_on(operator, stage, stop, &mut state);
    state
}

/// Goes on solving.
fn go_on(operator: &Operator, stage: &Stage, stop: Stop, state: &mut SolveState) {
    let control = Control::default();
    solve(as_solved(operator), &integrals(stage, operator), &Gather { stop }, state, &control, &Silent)
        .expect("nobody cancels");
}

fn as_solved(operator: &Operator) -> lumel_solve::Operator<'_> {
    lumel_solve::Operator::new(&*operator.transport, &*operator.basis)
}

fn integrals(stage: &Stage, operator: &Operator) -> Integrals {
    Integrals::new(operator.basis.node_areas().to_vec(), stage.reflecting_areas())
}

/// The mean of the first channel by area.
fn mean(operator: &Operator, field: &Field) -> f64 {
    let areas = operator.basis.node_areas();
    let sum: f64 = field.values().iter().zip(areas).map(|(e, a)| f64::from(e.x) * f64::from(*a)).sum();
    sum / areas.iter().map(|&a| f64::from(a)).sum::<f64>()
}
