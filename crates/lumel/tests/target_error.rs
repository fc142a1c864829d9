//! Stopping at an error: what the stated intervals are worth, on scenes whose light is known.
//!
//! An interval of 95 % that holds the truth 93 to 97 % of the time is what was promised. Values of one solve are
//! correlated, those of different seeds are not: the share of each seed is one observation, and the spread of these shares
//! tells how well their mean is known.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::Vec3;
use lumel::{
    Baker, BounceLimit, CONFIDENCE_95, Control, EmitterSampling, Ended, Light, Memory, Method, Observer,
    Projection, Saved, Scene, SceneBuilder, Settings, Silent, Snapshot, SolveError, SolveState, Step, Tail,
    TargetError,
};
use lumel_basis::{Field, LeastSquares};
use lumel_solve::PowerLog;
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{ceiling_light, grey, scene, two_sided, varying_sphere};
use lumel_testkit::{Estimate, rms, screen};
use std::sync::Arc;

/// What has no noise may be off by this, relative: origins of rays lie a little above their surface.
const ROUNDING: f64 = 5e-5;

fn built(builder: SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.build().unwrap().0)
}

fn settings(target: &str, bounces: u32) -> Settings {
    Settings {
        projection: Projection::Point,
        bounces: BounceLimit::Count(bounces),
        target_error: target.parse().unwrap(),
        direct_samples: 64,
        indirect_samples: 256,
        ..Settings::default()
    }
}

fn solved(scene: &Arc<Scene>, settings: Settings) -> SolveState {
    let mut state = SolveState::new();
    Baker::new(Arc::clone(scene), settings).run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

/// Light as users read it.
fn read(scene: &Arc<Scene>, settings: &Settings, carried: &Field) -> Field {
    let mut field = carried.clone();
    if settings.projection == Projection::LeastSquares {
        let basis = lumel_basis::VertexBasis::new(Arc::clone(scene));
        LeastSquares::new(&basis, LeastSquares::ALPHA).project(&mut field);
    }
    field
}

/// What many solves say about their own errors.
struct Honesty {
    /// Per seed, the share of values whose interval holds the truth.
    covered: Estimate,
    /// Root mean square of the relative errors.
    rms: f64,
    /// Share of values that are within the target.
    within: f64,
}

impl Honesty {
    /// Solves with each of `seeds`. Values that have no noise, and rightly so, do not count.
    fn of(scene: &Arc<Scene>, truth: &Field, settings: &Settings, seeds: std::ops::Range<u64>) -> Self {
        let TargetError::At(target) = settings.target_error else { panic!("there is no target") };
        let known = || truth.values().iter().map(|v| f64::from(v.y)).filter(|v| !v.is_nan());
        let floor = 0.1 * known().sum::<f64>() / known().count() as f64;
        let (mut shares, mut errors) = (Vec::new(), Vec::new());
        for seed in seeds {
            let state = solved(scene, Settings { seed, ..settings.clone() });
            let total = read(scene, settings, &state.total());
            let spread = &state.errors.as_ref().unwrap().standard_error;
            assert_eq!(state.errors.as_ref().unwrap().accuracy.ended, Some(Ended::Reached));
            let (mut inside, mut all) = (0.0, 0.0);
            for node in (0..total.node_count()).filter(|&node| state.valid[node]) {
                let of = |field: &Field| f64::from(field.values()[node].y);
                let (off, truth, half) = (of(&total) - of(truth), of(truth), CONFIDENCE_95 * of(spread));
                let rounding = ROUNDING * truth.max(floor);
                if truth.is_nan() || half < rounding && off.abs() <= rounding {
                    continue;
                }
                all += 1.0;
                inside += f64::from(u8::from(off.abs() <= half + rounding));
                errors.push(off / truth.max(floor));
            }
            shares.push(inside / all);
        }
        let limit = f64::from(target.get());
        let within = errors.iter().filter(|error| error.abs() <= limit).count() as f64 / errors.len() as f64;
        Self { covered: Estimate::new(shares), rms: rms(errors), within }
    }

    /// Fails unless intervals hold the truth 93 to 97 % of the time and the target is met.
    #[track_caller]
    fn assert_kept(&self, target: f64, what: &str) {
        let Self { covered, rms, within } = self;
        println!(
            "{what}: covered {:.4} ± {:.4}, rms {rms:.5}, within {within:.4}",
            covered.mean, covered.error
        );
        assert!(covered.error < 0.005, "{what}: more seeds are needed, {covered:?}");
        assert!((0.93..=0.97).contains(&covered.mean), "{what}: {covered:?}");
        // Half an interval is 2.36 standard errors of the mean.
        assert!(*rms < target / 2.0, "{what}: a root mean square of {rms}");
        assert!(*within > 0.95, "{what}: {within} of values");
    }
}

/// A floor under a square light and a screen that hides half of it.
fn shadowed_floor() -> Arc<Scene> {
    let corners = [[-1.0, -2.0], [3.0, -2.0], [3.0, 2.0], [-1.0, 2.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let floor = quad(corners, [40, 40], 0);
    let materials = vec![grey(0.0, 0.0), two_sided(grey(0.0, 0.0))];
    built(scene(vec![floor, screen::screen(1)], materials, vec![screen::light()]))
}

fn field_of(scene: &Arc<Scene>, value: impl Fn(Vec3) -> f64) -> Field {
    let basis = lumel_basis::VertexBasis::new(Arc::clone(scene));
    let value = |&vertex: &u32| Vec3::splat(value(scene.positions()[vertex as usize]) as f32);
    Field::from_values(basis.first_vertices().iter().map(value).collect())
}

#[test]
fn in_a_penumbra_the_truth_lies_within_95_of_100_intervals() {
    let scene = shadowed_floor();
    // The screen itself does not count.
    let truth = field_of(&scene, |p| if p.z > 0.5 { f64::NAN } else { screen::irradiance(p.as_dvec3()) });
    for (target, text) in [(0.05, "5%"), (0.02, "2%"), (0.01, "1%")] {
        let honesty = Honesty::of(&scene, &truth, &settings(text, 0), 0..24);
        honesty.assert_kept(target, &format!("penumbra at {text}"));
    }
}

/// A room of walls of different greys with a lamp and a board in it.
fn room() -> Arc<Scene> {
    let greys = [0.2, 0.7, 0.5, 0.6, 0.4, 0.8, 0.5].map(|albedo| grey(albedo, 0.0));
    let mut meshes = cuboid(Vec3::ZERO, Vec3::ONE, 9, Facing::Inward, [0, 1, 2, 3, 4, 5]);
    let board = [[0.3, 0.3], [0.7, 0.3], [0.7, 0.8], [0.3, 0.8]].map(|[x, y]| Vec3::new(x, y, 0.53));
    meshes.push(quad(board, [4, 4], 6));
    let mut materials = greys.to_vec();
    materials[6] = two_sided(materials[6].clone());
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.3, 0.3, 10.0));
    built(scene(meshes, materials, vec![light]))
}

/// A solve of the same discrete operator whose errors are a tenth of those that are looked for.
fn reference(scene: &Arc<Scene>, settings: &Settings, samples: u32) -> SolveState {
    let (target_error, memory) = (TargetError::Off, Memory(2 << 30));
    let samples = Settings { direct_samples: samples, indirect_samples: samples, ..settings.clone() };
    solved(scene, Settings { target_error, memory, seed: 1 << 40, ..samples })
}

#[test]
fn with_all_that_bounces_carry_the_truth_lies_within_95_of_100_intervals() {
    let scene = room();
    for (projection, target, text) in [
        (Projection::Point, 0.05, "5%"),
        (Projection::Point, 0.02, "2%"),
        (Projection::Area, 0.05, "5%"),
        (Projection::LeastSquares, 0.05, "5%"),
    ] {
        let settings = Settings { projection, ..settings(text, 4) };
        let truth = reference(&scene, &settings, 1 << 16);
        let truth = read(&scene, &settings, &truth.total());
        let honesty = Honesty::of(&scene, &truth, &settings, 0..16);
        honesty.assert_kept(target, &format!("room at {text}, {projection:?}"));
    }
}

#[test]
fn on_the_varying_sphere_the_known_irradiance_lies_within_95_of_100_intervals() {
    let scene = built(varying_sphere(4));
    let truth = field_of(&scene, |_| 2.0);
    let settings = Settings {
        bounces: BounceLimit::All,
        remainder: 1e-4,
        emitters: EmitterSampling::Rays,
        ..settings("4%", 0)
    };
    Honesty::of(&scene, &truth, &settings, 0..12).assert_kept(0.04, "varying sphere");
}

#[test]
fn a_solve_to_an_error_has_the_same_bits_on_any_number_of_threads() {
    let scene = room();
    for projection in [Projection::Point, Projection::Area] {
        let states = [1, 3].map(|n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| solved(&scene, Settings { projection, ..settings("5%", 2) }))
        });
        assert!(states[0] == states[1], "{projection:?}");
        assert!(states[0].errors.as_ref().unwrap().accuracy.rounds > 1, "nothing was added");
    }
}

/// Stops at the start of a round and remembers how the one before it ended.
struct Stopper<'a> {
    at: Step,
    control: &'a Control,
    last: std::sync::Mutex<Option<SolveState>>,
}

impl Observer for Stopper<'_> {
    fn step_started(&self, step: Step) {
        if step == self.at {
            self.control.cancel();
        }
    }

    fn step_done(&self, _: Step, state: &SolveState) {
        *self.last.lock().unwrap() = Some(state.clone());
    }
}

#[test]
fn a_solve_that_is_stopped_keeps_its_last_finished_round() {
    let (scene, control) = (room(), Control::default());
    let stopper = Stopper { at: Step::Round(2), control: &control, last: Default::default() };
    let baker = Baker::new(scene, settings("2%", 2));
    let mut state = SolveState::new();
    let result = baker.run(&mut state, &control, &stopper);
    assert!(matches!(result, Err(SolveError::Cancelled)));
    let accuracy = state.errors.as_ref().unwrap().accuracy;
    assert_eq!((accuracy.rounds, accuracy.ended, state.bounces.len()), (2, None, 3));
    assert_eq!(Some(&state), stopper.last.into_inner().unwrap().as_ref());
    let solution = baker.solution(&state);
    let errors = solution.standard_error.unwrap();
    assert_eq!(errors.len(), solution.irradiance.len());
    assert!(errors.iter().any(|error| error.y > 0.0));
    // Continued from a file, it has the bits of a solve that was not stopped.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.checkpoint.npz");
    baker.checkpoint(&state).save(&file).unwrap();
    let resumed = baker.resume(&Saved::load_for(&file, baker.scene()).unwrap()).unwrap();
    assert!(resumed == state, "the checkpoint is not the state");
    state = resumed;
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let mut whole = SolveState::new();
    baker.run(&mut whole, &Control::default(), &Silent).unwrap();
    assert!(whole.errors.as_ref().unwrap().accuracy.rounds > 2 && state == whole);
}

/// Another number of bounces, another rule for it, or another tail, for a solve with two bounces.
fn other_bounces(settings: &Settings) -> [Settings; 4] {
    let with = |bounces| Settings { bounces, ..settings.clone() };
    let all = Settings { remainder: 0.1, ..with(BounceLimit::All) };
    let tail = Settings { tail: Tail::Geometric, ..settings.clone() };
    [with(BounceLimit::Count(1)), with(BounceLimit::Count(4)), all, tail]
}

fn run(baker: &Baker, mut state: SolveState) -> SolveState {
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

#[test]
fn a_solve_that_has_reached_its_target_has_the_bits_of_one_with_the_bounces_it_is_resumed_with() {
    // After the first round, so that all have the same.
    let (scene, usual) = (room(), settings("90%", 2));
    for projection in [Projection::Point, Projection::Area] {
        let usual = Settings { projection, ..usual.clone() };
        let baker = Baker::new(Arc::clone(&scene), usual.clone());
        let state = run(&baker, SolveState::new());
        assert_eq!(state.errors.as_ref().unwrap().accuracy.ended, Some(Ended::Reached));
        let saved = Saved::Checkpoint(Box::new(baker.checkpoint(&state)));
        for other in other_bounces(&usual) {
            let what = format!("{projection:?}, {} bounces, tail {:?}", other.bounces, other.tail);
            let there = baker.relit(Arc::clone(&scene), other.clone());
            let resumed = there.resume(&saved).unwrap();
            assert!(resumed.errors.is_none() && resumed.tail.is_none(), "{what}: errors of another sum");
            let whole = run(&there, SolveState::new());
            assert!(run(&there, resumed) == whole, "{what}: resumed");
            assert!(run(&there, state.clone()) == whole, "{what}: continued");
            assert!(whole.total() != state.total() && whole.errors != state.errors, "{what}: no difference");
            // And back.
            let back = Saved::Checkpoint(Box::new(there.checkpoint(&whole)));
            assert!(run(&baker, baker.resume(&back).unwrap()) == state, "{what}: back");
        }
        assert!(baker.resume(&saved).unwrap() == state, "the same bounces are not solved again");
    }
}

#[test]
fn a_solve_resumed_with_other_bounces_keeps_its_rounds_and_adds_what_they_lack() {
    let (scene, usual) = (room(), settings("4%", 2));
    let baker = Baker::new(Arc::clone(&scene), usual.clone());
    let control = Control::default();
    let stopper = Stopper { at: Step::Round(2), control: &control, last: Default::default() };
    let mut state = SolveState::new();
    assert_eq!(baker.run(&mut state, &control, &stopper), Err(SolveError::Cancelled));
    let saved = Saved::Checkpoint(Box::new(baker.checkpoint(&state)));
    for other in other_bounces(&usual) {
        let there = baker.relit(Arc::clone(&scene), other.clone());
        let resumed = run(&there, there.resume(&saved).unwrap());
        assert_eq!(resumed.rounds[..2], state.rounds[..2]);
        let kept = SolveState { rounds: state.rounds[..2].to_vec(), bounces: Vec::new(), ..state.clone() };
        let whole = run(&there, SolveState { tail: None, errors: None, ..kept });
        assert!(resumed == whole, "{} bounces, tail {:?}", other.bounces, other.tail);
        let accuracy = resumed.errors.unwrap().accuracy;
        assert!(accuracy.rounds > 2 && accuracy.ended == Some(Ended::Reached), "{accuracy:?}");
        let wanted = other.stop().wanted(&PowerLog::of(there.integrals(), &resumed.bounces));
        assert_eq!(
            (wanted, resumed.tail.is_some()),
            (Some(resumed.bounces.len()), other.tail.is_added(other.bounces))
        );
    }
}

/// Keeps the last snapshot.
#[derive(Default)]
struct Album(std::sync::Mutex<Option<Snapshot>>);

impl Observer for Album {
    fn wants_snapshot(&self) -> bool {
        true
    }

    fn snapshot(&self, snapshot: Snapshot) {
        *self.0.lock().unwrap() = Some(snapshot);
    }
}

#[test]
fn bounces_add_up_to_the_mean_whose_error_is_told() {
    let (mut state, album) = (SolveState::new(), Album::default());
    let tail = Tail::Geometric;
    Baker::new(room(), Settings { tail, ..settings("5%", 3) })
        .run(&mut state, &Control::default(), &album)
        .unwrap();
    assert!(state.bounces.len() == 4 && state.tail.is_some());
    // The mean of the replicates' totals is that of their bounces and tails, each rounded once.
    let snapshot = album.0.into_inner().unwrap().unwrap();
    for (sum, mean) in state.total().values().iter().zip(snapshot.total.values()) {
        assert!((*sum - *mean).abs().max_element() <= 1e-6 * mean.max_element(), "{sum} is not {mean}");
    }
}

#[test]
fn memory_ends_a_solve_before_its_target_and_too_little_of_it_refuses_one() {
    let scene = room();
    let with = |memory: u64| Settings { memory: Memory(memory), ..settings("0.1%", 1) };
    let Method::Replicates { rays, memory: Memory(first), .. } =
        Baker::new(Arc::clone(&scene), with(1 << 30)).method()
    else {
        panic!("no replicates")
    };
    assert_eq!(rays, 256 / 8);
    let state = solved(&scene, with(2 * first));
    let accuracy = state.errors.unwrap().accuracy;
    assert_eq!((accuracy.ended, accuracy.rounds), (Some(Ended::Memory), 2));
    assert!(accuracy.share < 0.95 && accuracy.worst > 0.001);
    // Half of the rays need half of the memory; with less than 16 there is no start.
    let baker = Baker::new(Arc::clone(&scene), with(first / 2));
    let half = Memory(first / 2);
    assert!(matches!(baker.method(), Method::Replicates { rays: 16, memory, .. } if memory == half));
    let baker = Baker::new(scene, with(first / 2 - 1));
    let result = baker.run(&mut SolveState::new(), &Control::default(), &Silent);
    assert_eq!(result, Err(SolveError::Memory { needed: first / 2, allowed: first / 2 - 1 }));
}

#[test]
fn only_what_is_above_the_target_gets_more_samples() {
    let rays = |target: &str| {
        let (mut state, control) = (SolveState::new(), Control::default());
        Baker::new(shadowed_floor(), settings(target, 0)).run(&mut state, &control, &Silent).unwrap();
        (state.errors.unwrap().accuracy, control.rays())
    };
    let (first, rays_at_first) = rays("90%");
    let (last, rays_at_last) = rays("2%");
    assert_eq!(first.rounds, 1);
    assert!(last.rounds >= 4, "{last:?}");
    // All nodes would have 8 times as many samples after four rounds; the penumbra is a fifth of the floor.
    let ratio = rays_at_last as f64 / rays_at_first as f64 / f64::from(1 << (last.rounds - 1));
    assert!(ratio < 0.5, "{ratio} of what doubling all would take");
}
