//! How fast the complete estimators converge.

use glam::Vec3;
use lumel_basis::{Basis, Field};
use lumel_sample::SamplerKind;
use lumel_scene::Light;
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{ceiling_light, cube, grey, scene};
use lumel_testkit::{Method, Solver, Stage, fitted_slope, measure, rms};
use lumel_transport::{LightSampling, Plan, Source, Transport};

/// Receivers at one point times passes: independent replicates.
const AT_ONCE: usize = 32;
const PASSES: u32 = 8;
const COUNTS: [u32; 4] = [16, 64, 256, 1024];

/// RMS errors of the receivers' irradiance for each count, and the exponent of their power law.
///
/// With 256 replicates each RMS is known to 4.4 % and the slope over a factor of 64 to 0.02.
fn errors(transport: impl Fn(u32) -> Box<dyn Transport>, source: Source<'_>, truth: f64) -> ([f64; 4], f64) {
    let error = |count: u32| {
        let transport = transport(count);
        rms((0..PASSES).flat_map(|pass| {
            let field = measure(&*transport, source, pass).field;
            field.values().iter().map(|e| f64::from(e.x) - truth).collect::<Vec<_>>()
        }))
    };
    let errors = COUNTS.map(error);
    let points: Vec<(f64, f64)> = COUNTS.into_iter().map(f64::from).zip(errors).collect();
    (errors, fitted_slope(&points))
}

#[track_caller]
fn assert_slope(sampler: SamplerKind, errors: [f64; 4], slope: f64, what: &str) {
    if sampler == SamplerKind::Random {
        assert!((slope + 0.5).abs() < 0.07, "{what}, {sampler}: {slope} {errors:?}");
    } else {
        assert!(slope <= -0.65, "{what}, {sampler}: {slope} {errors:?}");
    }
}

#[test]
fn gathering_in_a_cube_converges_faster_than_random() {
    // The wall-constant cube: radiances 0.1, 0.9, 0.3, 0.6 and 1 over albedo one half.
    let stage = Stage::new(cube(1, [(); 6].map(|()| grey(0.5, 0.0))));
    let walls = [(Vec3::X, 0.1), (-Vec3::X, 0.9), (Vec3::Y, 0.3), (-Vec3::Y, 0.6), (-Vec3::Z, 1.0)];
    let radiance = |n: Vec3| walls.iter().find(|(wall, _)| wall.dot(n) > 0.9).map_or(0.0, |(_, l)| *l);
    let source: Field = stage.field(|_, n| 2.0 * std::f32::consts::PI * radiance(n));
    let points = [(Vec3::new(0.3, 0.2, 0.0), Vec3::Z); AT_ONCE];
    for solver in Solver::ALL {
        let of = |sampler| {
            let plan = |n| Plan { sampler, indirect_samples: n, ..Plan::default() };
            let (errors, slope) =
                errors(|n| stage.points(solver, &points, plan(n)), Source::Field(&source), 1.545682021);
            assert_slope(sampler, errors, slope, &format!("gather, {solver}"));
            errors
        };
        let [random, .., sobol] = SamplerKind::ALL.map(of);
        let better = sobol[2] * 4.0 <= random[2];
        assert!(better, "{solver}: at 256 rays Sobol is four times better: {sobol:?} {random:?}");
    }
}

#[test]
fn direct_light_in_a_penumbra_converges_faster_than_random() {
    let corners = [[0.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 1.0));
    // The shadow's edge runs askew over the light, as in any scene but a tidy one.
    let turned = corners.map(|p| Vec3::new(p.x + 0.35 * p.y, p.y - 0.35 * p.x, p.z));
    let light = Light::Rect(ceiling_light(Vec3::Z * 2.0, 1.0, 1.0, 1.0));
    let stage = Stage::new(scene(vec![quad(turned, [1, 1], 0)], vec![grey(0.0, 0.0)], vec![light]));
    let points = [(Vec3::ZERO, Vec3::Z); AT_ONCE];
    for light_sampling in [LightSampling::Area, LightSampling::Analytic] {
        let at = |sampler, n| {
            // Shadow rays are the same for every solver.
            let plan = Plan { sampler, light_sampling, direct_samples: n, ..Plan::default() };
            stage.points(Solver::Stored, &points, plan)
        };
        let best = at(SamplerKind::Sobol, 1 << 15);
        let values = measure(&*best, Source::Emitters(None), 99).field;
        let truth = values.values().iter().map(|e| f64::from(e.x)).sum::<f64>() / AT_ONCE as f64;
        for sampler in SamplerKind::ALL {
            let (errors, slope) = errors(|n| at(sampler, n), Source::Emitters(None), truth);
            // The analytic estimator leaves noise to the penumbra's share alone: it may be steeper than random.
            if light_sampling == LightSampling::Area || sampler != SamplerKind::Random {
                assert_slope(sampler, errors, slope, &format!("penumbra, {light_sampling:?}"));
            }
        }
    }
}

#[test]
fn area_sampling_of_light_and_sky_converges_faster_than_random() {
    // Position on the floor, point on each of two lights and direction to the sky must all be stratified together.
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let wall =
        quad([[0.0, 0.3], [1.0, 0.3], [1.0, 0.0], [0.0, 0.0]].map(|[x, z]| Vec3::new(x, 1.0, z)), [1, 1], 0);
    let lights = vec![
        Light::Rect(ceiling_light(Vec3::new(-0.3, 0.4, 0.4), 0.8, 1.2, 1.0)),
        Light::Rect(ceiling_light(Vec3::new(1.2, 0.9, 0.5), 1.0, 0.7, 3.0)),
    ];
    let mut builder = scene(vec![quad(corners, [1, 1], 0), wall], vec![grey(0.0, 0.0)], lights);
    builder.sky = lumel_scene::Radiance::splat(1.0).into();
    let stage = Stage::new(builder);
    let flux = |sampler, n: u32, pass| {
        let plan = Plan {
            sampler,
            light_sampling: LightSampling::Area,
            direct_samples: 2 * n,
            indirect_samples: 2 * n,
            ..Plan::default()
        };
        let operator = stage.operator(Method::AREA, plan);
        let field = measure(&*operator.transport, Source::Emitters(None), pass).field;
        let areas = operator.basis.node_areas();
        let on_floor = |(node, _): &(usize, f32)| stage.nodes()[*node].1.z > 0.9;
        let nodes = areas.iter().copied().enumerate().filter(on_floor);
        nodes.map(|(node, area)| f64::from(field.values()[node].x * area)).sum::<f64>()
    };
    let passes = 100u32;
    let mean = (0..32).map(|pass| flux(SamplerKind::Sobol, 1 << 12, 1000 + pass)).sum::<f64>() / 32.0;
    for sampler in [SamplerKind::Random, SamplerKind::Halton, SamplerKind::Sobol] {
        let errors = COUNTS.map(|n| rms((0..passes).map(|pass| flux(sampler, n, pass) - mean)));
        let points: Vec<(f64, f64)> = COUNTS.into_iter().map(f64::from).zip(errors).collect();
        assert_slope(sampler, errors, fitted_slope(&points), "floor");
    }
}
