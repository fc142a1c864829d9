//! Power: none is lost, and the solver knows how much is left.

use crate::{go_on, integrals, mean, solved, solved_by};
use glam::Vec3;
use lumel_basis::Basis;
use lumel_sample::SamplerKind;
use lumel_scene::SceneBuilder;
use lumel_solve::{SolveState, Stop};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{bulb, ceiling_light, cube, grey, scene};
use lumel_testkit::{Estimate, Method, ROUNDING, Solver, Stage, measure, ratio_bias, replicates};
use lumel_transport::{ChunkSink, Control, EmitterSampling, Job, Plan, Source, Sums};
use std::sync::Mutex;

fn plan(sampler: SamplerKind, n_rays: u32) -> Plan {
    Plan {
        sampler,
        indirect_samples: n_rays,
        direct_samples: n_rays,
        emitters: EmitterSampling::Rays,
        ..Plan::default()
    }
}

/// A cube of six greys with a box that floats in it; only the ceiling emits.
fn cluttered() -> SceneBuilder {
    let albedos = [0.5, 0.8, 0.7, 0.3, 0.75, 0.6];
    let mut builder = cube(2, albedos.map(|albedo| grey(albedo, 0.0)));
    builder.materials[5] = grey(0.6, 1.0);
    builder.objects.extend(cuboid(Vec3::splat(0.3), Vec3::new(0.7, 0.6, 0.5), 1, Facing::Outward, [1; 6]));
    builder
}

/// Adds the weights of all measurements of each node.
struct Weights(Mutex<Vec<f64>>);

impl ChunkSink for Weights {
    fn accept(&self, _: u32, sums: Sums) {
        let mut weights = self.0.lock().expect("no panic");
        for (node, weight) in sums.nodes.iter().zip(&sums.weights) {
            weights[node.index()] += weight;
        }
    }
}

#[test]
fn between_samples_and_nodes_no_power_is_lost() {
    // The sum over nodes of area times light is that over samples of their share of the area times what arrives, if
    // the weights of a node add up to its area.
    let stage = Stage::new(cube(3, [0; 6].map(|_| grey(0.5, 1.0))));
    for method in Method::OVER_AREAS {
        for sampler in SamplerKind::ALL {
            let operator = stage.operator(method, plan(sampler, 128));
            let field = stage.field(|p, _| p.x);
            for source in [Source::Emitters(None), Source::Field(&field)] {
                let weights = Weights(Mutex::new(vec![0.0; field.node_count()]));
                let job = Job { source, bounce: 0, pass: 0, active: None };
                let chunks = 0..operator.transport.shape().chunks;
                operator
                    .transport
                    .measure(&job, chunks, &Control::default(), &weights)
                    .expect("nobody cancels");
                for (weight, area) in
                    weights.0.into_inner().expect("no panic").iter().zip(operator.basis.node_areas())
                {
                    let off = weight / f64::from(*area) - 1.0;
                    assert!(off.abs() < ROUNDING, "{method}, {sampler}, {source:?}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn a_closed_scene_receives_all_that_it_reflects() {
    let stage = Stage::new(cluttered());
    // A steep field, at its highest in one corner of the room.
    let source = stage.field(|p, _| (-6.0 * p.length()).exp() * 100.0);
    for method in Method::OVER_AREAS {
        for sampler in SamplerKind::ALL {
            let operator = stage.operator(method, plan(sampler, 128));
            let integrals = integrals(&stage, &operator);
            let sent = integrals.reflected(&source).x;
            let fields = replicates(&*operator.transport, Source::Field(&source), 48);
            // Every node has at least 64 samples; light changes by half of itself under a hat.
            let bound = ratio_bias(64, 0.5) * sent;
            let label = format!("{method}, {sampler}");
            Estimate::new(fields.iter().map(|f| integrals.incident(f).x)).assert_near(sent, bound, label);
        }
    }
}

#[test]
fn a_bounce_carries_on_the_last_one_and_not_the_running_sum() {
    let stage = Stage::new(cluttered());
    let energy_of = |method, seed| {
        let operator = stage.operator(method, Plan { seed, ..plan(SamplerKind::Sobol, 128) });
        let state = solved_by(&operator, &stage, Stop::Bounces(4));
        let integrals = integrals(&stage, &operator);
        let pair = |w: &[lumel_basis::Field]| integrals.incident(&w[1]).x / integrals.reflected(&w[0]).x;
        state.bounces.windows(2).map(pair).collect::<Vec<f64>>()
    };
    for method in Method::OVER_AREAS {
        let runs: Vec<Vec<f64>> = (0..24).map(|seed| energy_of(method, seed)).collect();
        for bounce in 0..4 {
            let estimate = Estimate::new(runs.iter().map(|ratios| ratios[bounce]));
            estimate.assert_near(1.0, ratio_bias(64, 0.3), format!("{method}, bounce {}", bounce + 1));
        }
    }
}

#[test]
fn mean_indirect_light_of_a_closed_room_is_that_of_its_albedo() {
    // CIE 171:2006 5.8 in style: a cube of 4 m with a point source of 10000 lm in its middle.
    let known = [
        (0.05, 5.482456),
        (0.1, 11.574074),
        (0.2, 26.041667),
        (0.3, 44.642857),
        (0.4, 69.444444),
        (0.5, 104.166667),
        (0.6, 156.25),
        (0.7, 243.055556),
        (0.8, 416.666667),
        (0.9, 937.5),
        (0.95, 1979.166667),
    ];
    for (albedo, lux) in known {
        let room = cuboid(Vec3::ZERO, Vec3::splat(4.0), 2, Facing::Inward, [0; 6]);
        let lights = vec![bulb(Vec3::splat(2.0), 10_000.0)];
        let stage = Stage::new(scene(room, vec![grey(albedo, 0.0)], lights));
        let indirect = (0..8).map(|seed| {
            let plan = Plan { seed, ..plan(SamplerKind::Sobol, 64) };
            let operator = stage.operator(Method::AREA, plan);
            let stop = Stop::Remainder { fraction: 1e-3, at_most: 400 };
            let mut state = solved_by(&operator, &stage, stop);
            state.tail = integrals(&stage, &operator).tail(&state.bounces);
            mean(&operator, &state.total()) - mean(&operator, &state.bounces[0])
        });
        // The direct light's share of the bias is carried through all bounces; it varies by its own size.
        let bound = ratio_bias(3 * 32, 0.5) * lux;
        Estimate::new(indirect).assert_near(lux, bound, format!("{}, albedo {albedo}", Method::AREA));
    }
}

#[test]
fn direct_light_of_a_bulb_in_a_cube_has_its_closed_form() {
    let room = cuboid(Vec3::ZERO, Vec3::splat(4.0), 4, Facing::Inward, [0; 6]);
    let stage = Stage::new(scene(room, vec![grey(0.0, 0.0)], vec![bulb(Vec3::splat(2.0), 10_000.0)]));
    let points = [(Vec3::new(2.0, 2.0, 0.0), Vec3::Z), (Vec3::ZERO, Vec3::Z)];
    for solver in Solver::ALL {
        let transport = stage.points(solver, &points, Plan::default());
        let field = measure(&*transport, Source::Emitters(None), 0).field;
        for (e, lux) in field.values().iter().zip([198.943679, 38.286729]) {
            assert!((f64::from(e.x) / lux - 1.0).abs() < 1e-4, "{solver}: {e} {lux}");
        }
    }
    for method in Method::OVER_AREAS {
        let means = (0..16).map(|seed| {
            let operator = stage.operator(method, Plan { seed, ..plan(SamplerKind::Sobol, 128) });
            mean(&operator, &measure(&*operator.transport, Source::Emitters(None), 0).field)
        });
        let label = format!("{method}, mean over the walls");
        Estimate::new(means).assert_near(104.166667, ratio_bias(64, 0.3) * 104.2, label);
    }
}

/// A furnace: bounce n brings exactly ρⁿ.
pub(crate) fn furnace(albedo: f32) -> Stage {
    Stage::new(cube(2, [(); 6].map(|()| grey(albedo, 1.0))))
}

#[test]
fn stopping_by_remainder_stops_where_it_promised() {
    let stage = furnace(0.5);
    let bounces = |fraction, at_most| {
        let stop = Stop::Remainder { fraction, at_most };
        solved(&stage, Method::VERTEX, plan(SamplerKind::Sobol, 1), stop).bounces.len()
    };
    // After n terms of the series 2⁻ⁿ/(1 − 2⁻ⁿ) of what was found is missing.
    assert_eq!(bounces(1e-3, 64), 10, "2^-10 / (1 - 2^-10) = 0.00098");
    assert_eq!(bounces(0.02, 64), 6, "1/63 = 0.016");
    assert_eq!(bounces(1e-3, 4), 5, "direct light and at most four bounces");
    let count =
        |n| solved(&stage, Method::VERTEX, plan(SamplerKind::Sobol, 1), Stop::Bounces(n)).bounces.len();
    assert_eq!([count(0), count(3)], [1, 4]);
}

/// What is missing of all light, as a share of what was found, where a solve stops for `fraction`; and what was missing one
/// bounce before.
fn missing(builder: SceneBuilder, fraction: f32) -> [f64; 2] {
    let stage = Stage::new(builder);
    let operator = stage.operator(Method::AREA, plan(SamplerKind::Sobol, 256));
    let integrals = integrals(&stage, &operator);
    let mut state = solved_by(&operator, &stage, Stop::Remainder { fraction, at_most: 64 });
    let stopped = state.bounces.len();
    go_on(&operator, &stage, Stop::Remainder { fraction: 1e-6, at_most: 64 }, &mut state);
    let all = integrals.incident(&state.total()).x;
    [stopped, stopped - 1].map(|n| {
        let found: f64 = state.bounces[..n].iter().map(|field| integrals.incident(field).x).sum();
        (all - found) / found
    })
}

#[test]
fn less_light_than_promised_is_missing_in_a_cluttered_room() {
    let fraction = 0.01;
    let [missing, before] = missing(cluttered(), fraction);
    // The ratio of bounces is still settling when the solve stops: by some per cent.
    assert!(missing < 1.05 * f64::from(fraction), "{missing}");
    assert!(before > 0.95 * f64::from(fraction), "one bounce less would not have done");
}

#[test]
fn light_on_a_roof_does_not_end_bounces_in_the_room_below() {
    let mut builder = cluttered();
    let corners = [[-0.5, -0.5], [1.5, -0.5], [1.5, 1.5], [-0.5, 1.5]].map(|[x, y]| Vec3::new(x, y, 3.0));
    builder.objects.push(quad(corners, [1; 2], 1));
    builder.lights.push(ceiling_light(Vec3::new(0.5, 0.5, 4.0), 1.0, 1.0, 20.0).into());
    let fraction = 0.01;
    let [missing, before] = missing(builder, fraction);
    assert!(missing < 1.05 * f64::from(fraction), "{missing}");
    assert!(before > 0.95 * f64::from(fraction), "one bounce less would not have done: {before}");
}

#[test]
fn a_dark_scene_stops_at_once() {
    let stage = Stage::new(cube(1, [(); 6].map(|()| grey(0.5, 0.0))));
    let stop = Stop::Remainder { fraction: 1e-3, at_most: 64 };
    let state = solved(&stage, Method::VERTEX, plan(SamplerKind::Sobol, 4), stop);
    assert_eq!(state.bounces.len(), 1);
    let black = Stage::new(cube(1, [(); 6].map(|()| grey(0.0, 1.0))));
    let state = solved(&black, Method::VERTEX, plan(SamplerKind::Sobol, 4), stop);
    assert_eq!(state.bounces.len(), 1, "nothing is reflected");
}

#[test]
fn the_tail_completes_a_truncated_series() {
    // Exactly, when all bounces have one shape …
    let stage = furnace(0.8);
    let operator = stage.operator(Method::VERTEX, plan(SamplerKind::Sobol, 1));
    let mut state = solved_by(&operator, &stage, Stop::Bounces(2));
    state.tail = integrals(&stage, &operator).tail(&state.bounces);
    for e in state.total().values() {
        // 1/(1 - 0.8), where rounding of the ratio counts 5 times for itself and 4 times more in the tail.
        assert!((f64::from(e.x) / 5.0 - 1.0).abs() < 25.0 * ROUNDING, "{e}");
    }
    // … and better than nothing when they have not.
    let stage = Stage::new(cluttered());
    let operator = stage.operator(Method::VERTEX, plan(SamplerKind::Sobol, 256));
    let all = solved_by(&operator, &stage, Stop::Remainder { fraction: 1e-6, at_most: 64 }).total();
    let mut state: SolveState = solved_by(&operator, &stage, Stop::Bounces(3));
    let error = |state: &SolveState| {
        let total = state.total();
        lumel_testkit::rms(total.values().iter().zip(all.values()).map(|(a, b)| f64::from(a.x - b.x)))
    };
    let without = error(&state);
    state.tail = integrals(&stage, &operator).tail(&state.bounces);
    let with = error(&state);
    assert!(with < 0.2 * without, "{with} {without}");
}

#[test]
fn the_tail_is_not_resumed() {
    let stage = furnace(0.5);
    let operator = stage.operator(Method::VERTEX, plan(SamplerKind::Sobol, 1));
    let mut state = solved_by(&operator, &stage, Stop::Bounces(2));
    state.tail = integrals(&stage, &operator).tail(&state.bounces);
    go_on(&operator, &stage, Stop::Bounces(3), &mut state);
    assert_eq!(state, solved_by(&operator, &stage, Stop::Bounces(3)));
}
