//! Mistakes that a radiosity solver invites, each with a coarse scene that shows it.

use crate::gather::gathers;
use glam::Vec3;
use lumel_scene::{Light, ObjectMesh, Radiance, RectLight};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{bulb, ceiling_light, cube, grey, scene};
use lumel_testkit::{
    Combination, Estimate, ROUNDING, Stage, Storage, assert_nodes_near, correlation, form_factor, measure,
    ratio_bias, replicates, triangle_integral,
};
use lumel_transport::{LightSampling, Plan, Source};
use std::f64::consts::PI;

/// Two by two cells in the xy plane over `[0, 2]²`.
fn floor() -> ObjectMesh {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    quad(corners, [2, 2], 0)
}

/// Compares each node of the floor with the closed form of an unblocked light, in every combination.
#[track_caller]
fn assert_floor_under(light: RectLight, others: Vec<ObjectMesh>) {
    let mut objects = vec![floor()];
    objects.extend(others);
    let stage = Stage::new(scene(objects, vec![grey(0.0, 0.0)], vec![Light::Rect(light)]));
    let corners = light.corners().map(|p| p.as_dvec3());
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(256, 1));
        let expected = stage.expected(&operator, &|point, normal| {
            let e = f64::from(light.radiance.0.x) * PI * form_factor::polygon(&corners, point, normal);
            if point.z < 0.1 { e } else { f64::NAN }
        });
        let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
        // A corner has a triangle of 128 samples, over which light varies by its own size.
        let bound =
            if combination.method.storage == Storage::VertexArea { ratio_bias(128, 1.0) } else { 2e-4 };
        assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn the_cosine_at_the_light_is_that_of_a_unit_direction() {
    // Small and at another distance than one: without normalising, light would fall with 1/r³ or 1/r.
    assert_floor_under(ceiling_light(Vec3::new(0.4, 0.3, 3.0), 0.1, 0.1, 100.0), vec![]);
    assert_floor_under(ceiling_light(Vec3::new(0.5, 0.5, 0.5), 0.2, 0.2, 10.0), vec![]);
}

#[test]
fn samples_reach_all_corners_of_the_light() {
    assert_floor_under(ceiling_light(Vec3::new(1.0, 1.0, 0.6), 2.0, 2.0, 1.0), vec![]);
}

#[test]
fn no_sample_leaves_the_light() {
    // A frame just below the light hides all but the light itself: rays to its edge lean by 3 at most and pass
    // the frame's plane 0.003 further in, while the opening is wider than the light by 0.01.
    let z = 0.999;
    let opening = [0.49, 1.51];
    let strip = |x: [f32; 2], y: [f32; 2]| {
        // Facing down: area sampling takes back faces for the inside of something.
        let corners = [[0, 0], [0, 1], [1, 1], [1, 0]].map(|[i, j]| Vec3::new(x[i], y[j], z));
        quad(corners, [1, 1], 0)
    };
    let [low, high] = opening;
    let frame = vec![
        strip([-9.0, low], [-9.0, 9.0]),
        strip([high, 9.0], [-9.0, 9.0]),
        strip([low, high], [-9.0, low]),
        strip([low, high], [high, 9.0]),
    ];
    assert_floor_under(ceiling_light(Vec3::new(1.0, 1.0, 1.0), 1.0, 1.0, 1.0), frame);
}

#[test]
fn neighbouring_vertices_have_independent_noise() {
    // A strong gradient under a close light, half of it behind a screen: every estimator is noisy.
    let corners = [[0.5, 0.0], [1.5, 0.0], [1.5, 2.0], [0.5, 2.0]].map(|[x, y]| Vec3::new(x, y, 0.3));
    let screen = quad(corners, [1, 1], 0);
    let light = Light::Rect(ceiling_light(Vec3::new(1.0, 1.0, 0.6), 2.0, 2.0, 1.0));
    let stage = Stage::new(scene(vec![floor(), screen], vec![grey(0.5, 0.0)], vec![light]));
    let lit = stage.field(|p, _| if p.x == 0.5 { 2.0 } else { 0.0 });
    let on_floor: Vec<usize> =
        stage.nodes().iter().enumerate().filter(|(_, (p, _))| p.z < 0.1).map(|(i, _)| i).collect();
    let passes = 64;
    for combination in Combination::all().filter(|c| c.method.storage == Storage::Vertex) {
        let operator = stage.operator(combination.method, combination.estimator.plan(16, 16));
        for source in [Source::Emitters(None), Source::Field(&lit)] {
            let fields = replicates(&*operator.transport, source, passes);
            let series: Vec<Vec<f64>> = on_floor
                .iter()
                .map(|&node| fields.iter().map(|f| f64::from(f.values()[node].x)).collect::<Vec<_>>())
                .filter(|series: &Vec<f64>| series.iter().any(|e| *e != series[0]))
                .collect();
            let mut squares = Vec::new();
            for (i, a) in series.iter().enumerate() {
                squares.extend(series[..i].iter().map(|b| correlation(a, b).powi(2)));
            }
            if squares.is_empty() {
                continue;
            }
            // Squared correlations of independent series have mean 1/(n - 1) and about twice that squared as
            // variance; pairs share nodes but are uncorrelated.
            let (pairs, one) = (squares.len() as f64, 1.0 / f64::from(passes - 1));
            let mean = squares.iter().sum::<f64>() / pairs;
            let tolerance = 4.0 * one * (2.0 / pairs).sqrt();
            assert!((mean - one).abs() < tolerance, "{combination}, {source:?}: {mean} for {one}");
        }
    }
}

#[test]
fn quantities_have_their_factor_of_pi_and_no_other() {
    // Radiance one all around is irradiance π; 4π W at a metre's distance are 1 W/m²; a rectangle of radiance one
    // brings π times its form factor; irradiance one reflected by albedo 0.5 in a closed room is 0.5.
    let black = vec![grey(0.0, 0.0)];
    let up = (Vec3::Z, Vec3::Z);
    let plan = |sampler| Plan { sampler, light_sampling: LightSampling::Area, ..Plan::default() };
    for (solver, sampler) in gathers() {
        let e = |builder, n| {
            let stage = Stage::new(builder);
            let transport = stage.points(solver, &[up], plan(sampler));
            Estimate::of_node(&replicates(&*transport, Source::Emitters(None), n), 0)
        };
        let mut sky = scene(vec![floor()], black.clone(), vec![]);
        sky.sky = Radiance::splat(1.0).into();
        e(sky, 2).assert_near(PI, ROUNDING * PI, format!("sky, {solver}, {sampler}"));
        let point = scene(vec![floor()], black.clone(), vec![bulb(Vec3::Z * 2.0, (4.0 * PI) as f32)]);
        e(point, 2).assert_near(1.0, 1e-4, format!("point, {solver}, {sampler}"));
        let rect = scene(
            vec![floor()],
            black.clone(),
            vec![Light::Rect(ceiling_light(Vec3::Z * 2.0, 2.0, 2.0, 1.0))],
        );
        e(rect, 64).assert_near(PI * 0.554126423980, 2e-4, format!("rectangle, {solver}, {sampler}"));
        let room = Stage::new(cube(1, [(); 6].map(|()| grey(0.5, 0.0))));
        let ones = room.field(|_, _| 1.0);
        let inside = [(Vec3::splat(0.5), Vec3::Z)];
        let field = measure(&*room.points(solver, &inside, plan(sampler)), Source::Field(&ones), 0).field;
        assert!((f64::from(field.values()[0].x) - 0.5).abs() < ROUNDING, "room, {solver}, {sampler}");
    }
}

#[test]
fn light_at_a_hit_weighs_the_right_corners() {
    // One triangle with light at one corner at a time, seen from a skew point.
    let corners = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let mut triangle = quad([corners[0], corners[1], corners[1] + corners[2], corners[2]], [1, 1], 0);
    triangle.faces.truncate(1);
    triangle.faces[0].vertices = [0, 1, 2];
    triangle.positions[2] = corners[2];
    let point = (Vec3::new(0.3, 0.1, 0.4), Vec3::new(0.2, 0.1, -1.0));
    let (at, normal) = (point.0.as_dvec3(), point.1.as_dvec3().normalize());
    let stage = Stage::new(scene(vec![triangle], vec![grey(0.5, 0.0)], vec![]));
    for (k, corner) in corners.into_iter().enumerate() {
        let source = stage.field(|p, _| if p == corner { 2.0 } else { 0.0 });
        let truth = triangle_integral(200, |u, v| {
            let weights = [u, v, 1.0 - u - v];
            let y: glam::DVec3 = corners.iter().zip(weights).map(|(c, w)| c.as_dvec3() * w).sum();
            let (to, distance) = ((y - at).normalize(), y.distance(at));
            weights[k] * normal.dot(to).max(0.0) * -to.z / (PI * distance * distance)
        });
        for (solver, sampler) in gathers() {
            let transport = stage.points(solver, &[point], Plan { sampler, ..Plan::default() });
            let fields = replicates(&*transport, Source::Field(&source), 64);
            // The integrand's kink at the horizon does not cross the triangle; quadrature errs by 1e-6.
            let label = format!("corner {k}, {solver}, {sampler}");
            Estimate::of_node(&fields, 0).assert_near(truth, 1e-4 * truth, label);
        }
    }
}
