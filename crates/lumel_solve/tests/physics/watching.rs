//! Cancelling a solve and looking at it while it runs.

use crate::determinism::furnished;
use crate::energy::furnace;
use crate::{as_solved, go_on, integrals, solved_by};
use glam::Vec3;
use lumel_basis::{Basis, Field};
use lumel_scene::Light;
use lumel_solve::{Gather, Observer, Silent, Snapshot, SolveError, SolveState, Step, Stop, solve};
use lumel_testkit::scene::ceiling_light;
use lumel_testkit::{Method, Operator, Stage};
use lumel_transport::{Control, LightSampling, Plan};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

fn plan(n_rays: u32) -> Plan {
    Plan { direct_samples: n_rays, indirect_samples: n_rays, ..Plan::default() }
}

/// Cancels 50 ms after `work` has begun and returns how long it took to stop after that.
fn time_to_cancel(work: impl FnOnce(&Control) -> Result<(), SolveError> + Send) -> Duration {
    let control = Control::default();
    std::thread::scope(|threads| {
        let worker = threads.spawn(|| work(&control));
        std::thread::sleep(Duration::from_millis(50));
        let asked = Instant::now();
        control.cancel();
        let result = worker.join().expect("no panic");
        assert_eq!(result, Err(SolveError::Cancelled), "it was still at work");
        asked.elapsed()
    })
}

#[test]
fn cancelling_returns_soon_and_keeps_the_finished_bounces() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        let quick = stage.operator(method, plan(16));
        let mut state = solved_by(&quick, &stage, Stop::Bounces(1));
        let finished = state.clone();
        let slow = stage.operator(method, plan(65_536));
        let integrals = integrals(&stage, &slow);
        let delay = time_to_cancel(|control| {
            let operator = as_solved(&slow);
            solve(operator, &integrals, &Gather { stop: Stop::Bounces(9) }, &mut state, control, &Silent)
        });
        println!("{method}: stopped after {delay:?}");
        assert!(delay < Duration::from_secs(1), "{method}: {delay:?}");
        assert!(state == finished, "{method}: finished bounces stay as they were");
        go_on(&quick, &stage, Stop::Bounces(2), &mut state);
        assert!(state == solved_by(&quick, &stage, Stop::Bounces(2)), "{method}: and can be gone on from");
    }
}

#[test]
fn cancelling_direct_light_of_many_samples_and_lights_returns_soon() {
    let mut builder = furnished();
    let lamp = |i: u32| Light::Rect(ceiling_light(Vec3::new(0.1 * i as f32, 0.5, 0.9), 0.3, 0.3, 1.0));
    builder.lights = (0..8).map(lamp).collect();
    let stage = Stage::new(builder);
    for light_sampling in [LightSampling::Area, LightSampling::Analytic] {
        for method in Method::ALL {
            let operator = stage.operator(method, Plan { light_sampling, ..plan(1 << 20) });
            let integrals = integrals(&stage, &operator);
            let mut state = SolveState::new();
            let delay = time_to_cancel(|control| {
                let operator = as_solved(&operator);
                solve(operator, &integrals, &Gather { stop: Stop::Bounces(0) }, &mut state, control, &Silent)
            });
            println!("{method}, {light_sampling:?}: stopped after {delay:?}");
            // One element alone would take several seconds.
            assert!(delay < Duration::from_secs(1), "{method}, {light_sampling:?}: {delay:?}");
            assert!(state.bounces.is_empty());
        }
    }
}

/// Keeps all it is shown.
#[derive(Default)]
struct Album {
    snapshots: Mutex<Vec<Snapshot>>,
    steps: Mutex<Vec<Step>>,
}

impl Observer for Album {
    fn step_done(&self, step: Step, _state: &SolveState) {
        self.steps.lock().expect("no panic").push(step);
    }

    fn wants_snapshot(&self) -> bool {
        true
    }

    fn snapshot(&self, snapshot: Snapshot) {
        self.snapshots.lock().expect("no panic").push(snapshot);
    }
}

fn watched(operator: &Operator, stage: &Stage, bounces: u32) -> (SolveState, Album) {
    let (mut state, album) = (SolveState::new(), Album::default());
    let integrals = integrals(stage, operator);
    let control = Control::default();
    let stop = Stop::Bounces(bounces);
    solve(as_solved(operator), &integrals, &Gather { stop }, &mut state, &control, &album)
        .expect("nobody cancels");
    (state, album)
}

#[test]
fn the_last_snapshot_of_a_bounce_is_the_total_after_it() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        let (state, album) = watched(&stage.operator(method, plan(16)), &stage, 2);
        let snapshots = album.snapshots.into_inner().unwrap();
        for bounce in 0..3 {
            let last = snapshots.iter().rev().find(|s| s.step == Step::Bounce(bounce)).unwrap();
            let total = Field::sum(state.valid.len(), &state.bounces[..=bounce as usize]);
            let same = last.total.values().iter().zip(total.values()).all(|(a, b)| a == b);
            assert!(same, "{method}, bounce {bounce}");
            assert_eq!(last.current.values(), state.bounces[bounce as usize].values(), "{method}");
            let dark = |node: usize| state.bounces[0].values()[node] == Vec3::ZERO;
            assert!((0..state.valid.len()).all(|node| last.measured[node] || dark(node)), "{method}");
        }
        assert_eq!(Arc::strong_count(&snapshots[0].total), 1, "nobody else holds on to a snapshot");
    }
}

#[test]
fn snapshots_only_ever_gain_light() {
    let stage = Stage::new(furnished());
    let (_, album) = watched(&stage.operator(Method::VERTEX, plan(16)), &stage, 2);
    let snapshots = album.snapshots.into_inner().unwrap();
    assert!(snapshots.len() > 20, "one per chunk");
    let power = |s: &Snapshot| s.total.values().iter().map(|e| f64::from(e.x)).sum::<f64>();
    assert!(snapshots.windows(2).all(|pair| power(&pair[1]) >= power(&pair[0])));
}

#[test]
fn a_snapshot_tells_what_is_measured_from_what_is_still_to_come() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        let (state, album) = watched(&stage.operator(method, plan(16)), &stage, 1);
        for snapshot in album.snapshots.into_inner().unwrap() {
            let Step::Bounce(bounce) = snapshot.step else { panic!("probes have no snapshots") };
            let before = Field::sum(state.valid.len(), &state.bounces[..bounce as usize]);
            for node in 0..state.valid.len() {
                let [total, current, before] =
                    [&*snapshot.total, &*snapshot.current, &before].map(|field| field.values()[node]);
                assert!((total - before - current).abs().max_element() < 1e-5);
                // A triangle that is done may be one of several around a node, so over areas values still move.
                if snapshot.measured[node] && method == Method::VERTEX {
                    assert_eq!(current, state.bounces[bounce as usize].values()[node]);
                } else if !snapshot.measured[node] && state.valid[node] {
                    assert_eq!(current, Vec3::ZERO, "{method}");
                }
            }
        }
    }
}

#[test]
fn a_bounce_under_way_is_known_everywhere_soon() {
    let stage = Stage::new(furnished());
    let (state, album) = watched(&stage.operator(Method::VERTEX, plan(16)), &stage, 0);
    let snapshots = album.snapshots.into_inner().unwrap();
    let share = |measured: &[bool]| measured.iter().filter(|m| **m).count() as f64 / measured.len() as f64;
    let half = snapshots.iter().find(|s| share(&s.measured) > 0.5).unwrap();
    for quarter in half.measured.chunks(state.valid.len().div_ceil(4)) {
        assert!((0.2..0.85).contains(&share(quarter)), "{} of a quarter of the nodes", share(quarter));
    }
}

#[test]
fn steps_are_told_in_order() {
    let stage = Stage::new(furnished());
    let (_, album) = watched(&stage.operator(Method::VERTEX, plan(4)), &stage, 2);
    let expected = [Step::Validity, Step::Bounce(0), Step::Bounce(1), Step::Bounce(2)];
    assert_eq!(*album.steps.lock().unwrap(), expected);
}

#[test]
fn a_state_of_another_basis_is_refused() {
    let (stage, other) = (Stage::new(furnished()), furnace(0.5));
    let operator = stage.operator(Method::VERTEX, plan(4));
    let of_other = solved_by(&other.operator(Method::VERTEX, plan(4)), &other, Stop::Bounces(0));
    let of_nothing = SolveState { bounces: vec![Field::zeros(3)], ..SolveState::new() };
    for mut state in [of_other, of_nothing] {
        let (found, expected) = (state.basis, operator.basis.identity());
        let (integrals, schedule) = (integrals(&stage, &operator), Gather { stop: Stop::Bounces(1) });
        let error =
            solve(as_solved(&operator), &integrals, &schedule, &mut state, &Control::default(), &Silent);
        assert_eq!(error, Err(SolveError::WrongState { found, expected }));
    }
}
