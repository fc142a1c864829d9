//! Shooting: the brightest nodes first, by the same operator as gathering.

use crate::determinism::furnished;
use crate::{as_solved, integrals, solved_by};
use glam::{DVec3, Vec3};
use lumel_basis::{Basis, Field, NodeId, Sampling};
use lumel_scene::{Light, Material, SceneBuilder};
use lumel_solve::{Integrals, Observer, Shoot, ShotLight, SolveState, Step, Stop, brightest, solve};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{bulb, ceiling_light, grey, scene, two_sided};
use lumel_testkit::{Method, Operator, Stage};
use lumel_transport::{Control, Job, Plan, Source, accumulate};
use std::sync::Mutex;

/// The share of all light that may be missing where a solve is to end at the fixed point.
const LITTLE: f32 = 1e-6;

/// A room of red, black, emissive and grey walls with a sheet in it that is lit on both sides, and a box over some vertices.
fn mixed() -> SceneBuilder {
    let red = Material::diffuse("red", Vec3::new(0.8, 0.2, 0.1));
    let materials = vec![grey(0.7, 0.0), red, grey(0.0, 0.0), grey(0.5, 0.4), two_sided(grey(0.6, 0.0))];
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 4, Facing::Inward, [1, 0, 2, 0, 0, 3]);
    let (min, max) = (Vec3::new(0.2, 0.2, -0.1), Vec3::new(0.6, 0.6, 0.3));
    objects.extend(cuboid(min, max, 2, Facing::Outward, [0; 6]));
    let sheet = [[0.7, 0.1], [0.7, 0.5], [0.9, 0.5], [0.9, 0.1]];
    objects.push(quad(sheet.map(|[x, y]| Vec3::new(x, y, 0.5)), [3, 3], 4));
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.4, 0.4, 5.0));
    scene(objects, materials, vec![light, bulb(Vec3::new(0.8, 0.8, 0.6), 3.0)])
}

fn plan() -> Plan {
    Plan { direct_samples: 16, indirect_samples: 64, ..Plan::default() }
}

fn shot_by(operator: &Operator, stage: &Stage, remainder: f32, observer: &dyn Observer) -> SolveState {
    let mut state = SolveState::new();
    let (integrals, control) = (integrals(stage, operator), Control::default());
    solve(as_solved(operator), &integrals, &Shoot { remainder }, &mut state, &control, observer)
        .expect("nobody cancels");
    state
}

/// The operator of all shots, applied to a field.
fn applied(operator: &Operator, field: &Field, valid: &[bool]) -> Field {
    let nodes: Vec<NodeId> = (0..field.node_count() as u32).map(NodeId).collect();
    let sampling = operator.transport.shape().sampling;
    let active = (sampling == Sampling::Point).then_some(valid);
    let job = Job { source: Source::Shot(field, &nodes), bounce: 1, pass: 0, active };
    let measured = accumulate(&*operator.transport, &job, &Control::default(), None).expect("nobody cancels");
    let mut arrived = measured.field;
    operator.basis.adjacency().complete(&mut arrived, &measured.known);
    arrived
}

/// The largest difference of two fields by the largest value of the second.
fn difference(a: &Field, b: &Field) -> f64 {
    let pairs = a.values().iter().zip(b.values());
    let largest = pairs.map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
    f64::from(largest / b.values().iter().map(|value| value.max_element()).fold(0.0, f32::max))
}

/// Keeps the state after every step.
#[derive(Default)]
struct States(Mutex<Vec<SolveState>>);

impl Observer for States {
    fn step_done(&self, step: Step, state: &SolveState) {
        if matches!(step, Step::Shot(_)) {
            self.0.lock().expect("no panic").push(state.clone());
        }
    }
}

fn parts(state: &SolveState) -> (&Field, &ShotLight) {
    (&state.bounces[0], state.shot.as_ref().expect("light was shot"))
}

#[test]
fn after_every_shot_all_light_but_the_unshot_has_been_reflected_once() {
    for scene in [furnished(), mixed()] {
        let stage = Stage::new(scene);
        for method in Method::ALL {
            let operator = stage.operator(method, plan());
            let states = States::default();
            shot_by(&operator, &stage, 0.03, &states);
            let states = states.0.into_inner().expect("no panic");
            assert!(states.len() > 3, "{method}: {} shots", states.len());
            for state in &states {
                let (direct, shot) = parts(state);
                let sent =
                    state.total().values().iter().zip(shot.unshot.values()).map(|(t, u)| *t - *u).collect();
                let arrived = applied(&operator, &Field::from_values(sent), &state.valid);
                let expected = Field::sum(direct.node_count(), [direct, &arrived]);
                // Every shot rounds once, to 6e-8 of what it adds to.
                let off = difference(&state.total(), &expected);
                assert!(off < 3e-6, "{method}: {off:e} after {} shots", shot.shots);
            }
        }
    }
}

#[test]
fn unshot_power_falls_with_every_shot_to_what_may_be_missing() {
    for scene in [furnished(), mixed()] {
        let stage = Stage::new(scene);
        for method in Method::ALL {
            let operator = stage.operator(method, plan());
            let (states, integrals) = (States::default(), integrals(&stage, &operator));
            let end = shot_by(&operator, &stage, 1e-3, &states);
            let power =
                |state: &SolveState| integrals.unshot_powers(&parts(state).1.unshot).iter().sum::<f64>();
            let powers: Vec<f64> = states.0.into_inner().expect("no panic").iter().map(power).collect();
            assert!(powers.windows(2).all(|pair| pair[1] < pair[0]), "{method}: {powers:?}");
            assert!(integrals.missing(&end) < 1e-3, "{method}");
            assert!(powers.len() > 10 && powers.last() == Some(&power(&end)), "{method}");
        }
    }
}

#[test]
fn on_stored_rays_shooting_and_gathering_find_the_same_light() {
    for scene in [furnished(), mixed()] {
        let stage = Stage::new(scene);
        for method in [Method::VERTEX, Method::AREA] {
            let operator = stage.operator(method, plan());
            let shot = shot_by(&operator, &stage, LITTLE, &lumel_solve::Silent);
            let gathered = solved_by(&operator, &stage, Stop::Bounces(60));
            assert_eq!(shot.valid, gathered.valid);
            let off = difference(&shot.total(), &gathered.total());
            // What is missing, and rounding.
            assert!(off < 1e-5, "{method}: {off:e}");
        }
    }
}

#[test]
fn what_reflects_nothing_receives_and_never_shoots() {
    let stage = Stage::new(mixed());
    let operator = stage.operator(Method::AREA, plan());
    let (states, integrals) = (States::default(), integrals(&stage, &operator));
    let end = shot_by(&operator, &stage, 1e-3, &states);
    let black: Vec<usize> =
        (0..end.node_count()).filter(|&node| stage.reflecting_areas()[node] == Vec3::ZERO).collect();
    assert!(!black.is_empty());
    let (_, shot) = parts(&end);
    for node in black {
        let id = NodeId(node as u32);
        assert!(shot.reflected.node(id).0.min_element() > 0.0);
        // All that has arrived there stays unshot.
        let off = (shot.unshot.node(id).0 - end.total().node(id).0).abs().max_element();
        assert!(off < 1e-5 * end.total().node(id).0.max_element(), "{off}");
        assert_eq!(integrals.unshot_powers(&shot.unshot)[node], 0.0);
    }
}

#[test]
fn what_black_surfaces_alone_receive_takes_no_shot() {
    let mut builder = furnished();
    builder.materials = vec![grey(0.0, 0.0)];
    let stage = Stage::new(builder);
    let end = shot_by(&stage.operator(Method::AREA, plan()), &stage, 1e-3, &lumel_solve::Silent);
    assert_eq!((end.shot.is_none(), end.bounces.len()), (true, 1));
}

#[test]
fn any_number_of_threads_shoots_the_same_bits_and_so_does_a_solve_that_was_resumed() {
    let stage = Stage::new(mixed());
    for method in Method::ALL {
        let operator = stage.operator(method, Plan { indirect_samples: 16, ..plan() });
        let run = |n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start");
            pool.install(|| {
                let states = States::default();
                shot_by(&operator, &stage, 0.1, &states);
                states.0.into_inner().expect("no panic")
            })
        };
        let one = run(1);
        let end = one.last().expect("there are shots");
        for n in [2, 7] {
            assert!(run(n) == one, "{method}: {n} threads");
        }
        for state in [&one[0], &one[one.len() / 2]] {
            let (mut state, control) = (state.clone(), Control::default());
            let integrals = integrals(&stage, &operator);
            let shoot = Shoot { remainder: 0.1 };
            solve(as_solved(&operator), &integrals, &shoot, &mut state, &control, &lumel_solve::Silent)
                .expect("nobody cancels");
            assert!(state == *end, "{method}");
        }
    }
}

/// All columns of the operator in double precision: `columns[j][i]`.
fn dense(operator: &Operator, valid: &[bool]) -> Vec<Vec<DVec3>> {
    let n = valid.len();
    let column = |j: usize| {
        let mut unit = vec![Vec3::ZERO; n];
        unit[j] = Vec3::ONE;
        let arrived = applied(operator, &Field::from_values(unit), valid);
        arrived.values().iter().map(|value| value.as_dvec3()).collect()
    };
    (0..n).map(column).collect()
}

/// Solves `x = e + K x` by elimination, channel by channel.
fn dense_solution(columns: &[Vec<DVec3>], direct: &[DVec3]) -> Vec<DVec3> {
    let n = direct.len();
    let mut solution = vec![DVec3::ZERO; n];
    for channel in 0..3 {
        let entry = |i: usize, j: usize| f64::from(u8::from(i == j)) - columns[j][i][channel];
        let mut rows: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| entry(i, j)).chain([direct[i][channel]]).collect()).collect();
        for k in 0..n {
            // Diagonally dominant enough: no pivots are needed.
            let (above, below) = rows.split_at_mut(k + 1);
            for row in below {
                let factor = row[k] / above[k][k];
                (k..=n).for_each(|j| row[j] -= factor * above[k][j]);
            }
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| rows[k][j] * solution[j][channel]).sum();
            solution[k][channel] = (rows[k][n] - known) / rows[k][k];
        }
    }
    solution
}

#[test]
fn shooting_ends_at_the_solution_of_the_dense_equations() {
    let stage = Stage::new(mixed());
    for method in [Method::VERTEX.traced(), Method::AREA] {
        let operator = stage.operator(method, plan());
        let measures = Integrals::new(Vec::new(), stage.reflecting_areas());
        let shot = shot_by(&operator, &stage, LITTLE, &lumel_solve::Silent);
        let direct: Vec<DVec3> = shot.bounces[0].values().iter().map(|value| value.as_dvec3()).collect();
        let (n, columns) = (direct.len(), dense(&operator, &shot.valid));
        let exact = dense_solution(&columns, &direct);
        // The schedule itself, in double precision: to the last digits.
        let (mut total, mut unshot) = (direct.clone(), direct.clone());
        for _ in 0..2000 {
            let field = Field::from_values(unshot.iter().map(|value| value.as_vec3()).collect());
            let nodes = brightest(&measures.unshot_powers(&field), 0.2);
            let sent: Vec<(usize, DVec3)> =
                nodes.iter().map(|node| (node.index(), std::mem::take(&mut unshot[node.index()]))).collect();
            for (j, light) in sent {
                for i in 0..n {
                    let arrived = columns[j][i] * light;
                    total[i] += arrived;
                    unshot[i] += arrived;
                }
            }
        }
        let largest = exact.iter().map(|value| value.max_element()).fold(0.0, f64::max);
        let off = |found: &dyn Fn(usize) -> DVec3| {
            (0..n).map(|i| (found(i) - exact[i]).abs().max_element()).fold(0.0, f64::max) / largest
        };
        let in_double = off(&|i| total[i]);
        assert!(in_double < 1e-10, "{method}: {in_double:e}");
        // The solver keeps light in single precision.
        let solved = shot.total();
        let in_single = off(&|i| solved.values()[i].as_dvec3());
        assert!(in_single < 1e-5, "{method}: {in_single:e}");
    }
}
