//! Unblocked light at points against the form factors of elements.

use glam::{DVec3, Vec3};
use lumel_sample::SamplerKind;
use lumel_scene::{Light, Radiance, RectLight};
use lumel_testkit::scene::{backdrop, bulb, ceiling_light, grey, lights_only, scene};
use lumel_testkit::{AtPoints, Estimate, ROUNDING, Solver, Stage, form_factor, measure, mesh, replicates};
use lumel_transport::{EmitterSampling, LightSampling, Plan, Source};
use std::f64::consts::PI;

/// Rays start 1.5e-5 above a point near the origin; nothing here is closer than a third of a metre, and irradiance
/// falls with the square of the distance at most.
const ORIGIN_SHIFT: f64 = 1e-4;

/// Measures a point in the light of radiance one of a rectangle: `E = πF`.
#[track_caller]
fn assert_form_factor(light: RectLight, normal: Vec3, factor: f64, what: &str) {
    let stage = Stage::new(lights_only(vec![Light::Rect(light)]));
    for combination in AtPoints::all() {
        let AtPoints { solver, estimator } = combination;
        let transport = stage.points(solver, &[(Vec3::ZERO, normal)], estimator.plan(16, 1));
        let fields = replicates(&*transport, Source::Emitters(None), 64);
        let estimate = Estimate::of_node(&fields, 0);
        estimate.assert_near(PI * factor, ORIGIN_SHIFT * PI * factor, format!("{what}, {combination}"));
        if estimator.light == LightSampling::Analytic {
            assert_eq!(
                estimate.error, 0.0,
                "{what}, {combination}: nothing is in the way, so there is no noise"
            );
        }
    }
}

fn ceiling(x: [f32; 2], y: [f32; 2], z: f32) -> RectLight {
    let center = Vec3::new(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), z);
    ceiling_light(center, x[1] - x[0], y[1] - y[0], 1.0)
}

/// In the plane x = `distance`, from the xy plane up, with one edge opposite the origin.
fn standing(height: f32, width: f32, distance: f32) -> RectLight {
    RectLight {
        center: Vec3::new(distance, 0.5 * width, 0.5 * height),
        u: Vec3::Z * (0.5 * height),
        v: Vec3::Y * (0.5 * width),
        radiance: Radiance::splat(1.0),
        texture: None,
    }
}

#[test]
fn parallel_rectangles_over_an_element_have_their_form_factors() {
    assert_form_factor(
        ceiling([0.0, 1.0], [0.0, 1.0], 1.0),
        Vec3::Z,
        0.138531605995,
        "1 x 1 over its corner",
    );
    assert_form_factor(
        ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0),
        Vec3::Z,
        0.554126423980,
        "2 x 2 over its centre",
    );
    assert_form_factor(
        ceiling([0.0, 2.0], [0.0, 1.0], 0.5),
        Vec3::Z,
        0.220777622335,
        "2 x 1 over its corner",
    );
}

#[test]
fn standing_rectangles_before_an_element_have_their_form_factors() {
    assert_form_factor(standing(1.0, 1.0, 1.0), Vec3::Z, 0.055734197003, "1 x 1 at 1");
    assert_form_factor(standing(2.0, 1.0, 0.5), Vec3::Z, 0.158774804514, "2 x 1 at 0.5");
}

#[test]
fn tilted_elements_see_only_what_lies_above_their_horizon() {
    let known = [
        (30.0, 0.479887560075),
        (60.0, 0.289365194440),
        (90.0, 0.111468394005),
        (120.0, 0.012301982450),
        (150.0, 0.0),
    ];
    for (degrees, factor) in known {
        let angle = f32::to_radians(degrees);
        let normal = Vec3::new(angle.sin(), 0.0, angle.cos());
        assert_form_factor(ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), normal, factor, &format!("{degrees} deg"));
    }
}

#[test]
fn an_element_behind_a_light_gets_nothing() {
    let light = RectLight { u: Vec3::X, v: Vec3::Y, ..ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0) };
    assert_form_factor(light, Vec3::Z, 0.0, "turned away");
}

/// Measures the light of an emissive mesh of radiosity one by each way that emission can be found.
#[track_caller]
fn assert_glow(mesh: lumel_scene::ObjectMesh, points: &[(Vec3, Vec3)], truth: &[f64], what: &str) {
    let materials = vec![grey(0.0, 0.0), grey(0.0, 1.0)];
    let stage = Stage::new(scene(vec![backdrop(), mesh], materials, Vec::new()));
    for emitters in [EmitterSampling::Auto, EmitterSampling::Lights, EmitterSampling::Rays] {
        // Both together cost most, and samplers are tried with each of them.
        let is_tried =
            |c: &AtPoints| emitters != EmitterSampling::Auto || c.estimator.sampler == SamplerKind::Sobol;
        for combination in AtPoints::all().filter(is_tried) {
            let plan = Plan { emitters, ..combination.estimator.plan(64, 64) };
            let transport = stage.points(combination.solver, points, plan);
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            for (point, &truth) in truth.iter().enumerate() {
                let label = format!("{what}, point {point}, {emitters:?}, {combination}");
                Estimate::of_node(&fields, point).assert_near(truth, ORIGIN_SHIFT * truth, label);
            }
        }
    }
}

#[test]
fn a_disk_light_made_of_triangles_has_the_form_factor_of_a_disk() {
    for (radius, height, aside) in [(1.0, 1.0, 0.0), (0.5, 2.0, 0.0), (1.0, 1.0, 1.0)] {
        let disk = mesh::disk_facing_down(Vec3::new(aside as f32, 0.0, height as f32), radius, 48, 1);
        let normal = DVec3::Z;
        let exact: f64 = mesh::triangles(&disk).map(|t| form_factor::polygon(&t, DVec3::ZERO, normal)).sum();
        let round = form_factor::element_to_disk(radius, height, aside);
        // A polygon of the same area errs by the fourth moment of its outline: (π/n)⁴ is 2e-5 for n = 48; corners
        // nearer than the disk's rim weigh more, which allows for a few of that.
        assert!((exact / round - 1.0).abs() < 1e-4, "{exact} {round}");
        let what = format!("disk r {radius}, h {height}, s {aside}");
        assert_glow(disk, &[(Vec3::ZERO, Vec3::Z)], &[exact], &what);
    }
}

#[test]
fn an_emissive_sphere_has_the_form_factor_of_a_sphere() {
    let level = 3;
    let radius = mesh::equal_area_radius(1.0, level);
    // Twice the radius away, 60 degrees from the normal: wholly above the horizon.
    let center = Vec3::new(3f32.sqrt(), 0.0, 1.0);
    let sphere = mesh::sphere(center, radius, level, mesh::Facing::Outward, 1);
    // It is convex: the triangles that face the element are seen whole.
    let front = mesh::triangles(&sphere).map(|t| form_factor::polygon(&t, DVec3::ZERO, DVec3::Z));
    let exact: f64 = front.sum();
    let round = form_factor::element_to_sphere(1.0, 2.0, 0.5);
    // 1280 triangles: sagitta 0.002 of the radius, half of it left by the equal area.
    assert!((exact / round - 1.0).abs() < 4e-3, "{exact} {round}");
    assert_glow(sphere, &[(Vec3::ZERO, Vec3::Z)], &[exact], "sphere");
}

#[test]
fn point_lights_follow_the_inverse_square_and_the_cosine() {
    // CIE 171:2006 5.2 in style: 10000 lm three metres above a plane.
    let stage = Stage::new(lights_only(vec![bulb(Vec3::new(0.0, 0.0, 3.0), 10_000.0)]));
    let known = [
        (0.0, 88.419413),
        (0.5, 84.859172),
        (1.0, 75.493818),
        (1.5, 63.267782),
        (2.0, 50.932660),
        (3.0, 31.260983),
    ];
    for (x, lux) in known {
        for solver in Solver::ALL {
            let transport = stage.points(solver, &[(Vec3::X * x, Vec3::Z)], Plan::default());
            let e = f64::from(measure(&*transport, Source::Emitters(None), 0).field.values()[0].x);
            assert!((e / lux - 1.0).abs() < ORIGIN_SHIFT, "x = {x}, {solver}: {e}");
        }
    }
}

#[test]
fn an_area_source_lights_floor_and_wall_as_the_polygon_formula_says() {
    // CIE 171:2006 5.3 in style: a square metre in the middle of the ceiling of a room of 4 x 4 x 3 m, 1000 lm.
    let light = ceiling_light(Vec3::new(0.0, 0.0, 3.0), 1.0, 1.0, (1000.0 / PI) as f32);
    let stage = Stage::new(lights_only(vec![Light::Rect(light)]));
    let floor = [(0.0, 34.106795), (0.5, 32.408078), (1.0, 27.989156), (1.5, 22.362204), (2.0, 16.910640)];
    let wall = [(2.5, 18.740141), (2.0, 26.064865), (1.5, 24.285141), (1.0, 19.460589), (0.5, 14.737993)];
    let on_floor = floor.map(|(x, lux)| ((Vec3::X * x, Vec3::Z), lux));
    let on_wall = wall.map(|(z, lux)| ((Vec3::new(2.0, 0.0, z), -Vec3::X), lux));
    for (point, lux) in on_floor.into_iter().chain(on_wall) {
        for combination in AtPoints::all() {
            let plan = combination.estimator.plan(16, 1);
            let transport = stage.points(combination.solver, &[point], plan);
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            // Half a metre below the light the wall's origin is pushed by up to 3.1e-5 of its coordinate.
            let label = format!("{point:?}, {combination}");
            Estimate::of_node(&fields, 0).assert_near(lux, 2.0 * ORIGIN_SHIFT * lux, label);
        }
    }
}

#[test]
fn sky_of_radiance_one_lights_an_open_element_with_pi() {
    let mut builder = lights_only(Vec::new());
    builder.objects[0].positions.iter_mut().for_each(|p| *p *= 1e-3);
    builder.sky = Radiance::splat(1.0).into();
    let stage = Stage::new(builder);
    for combination in AtPoints::all() {
        let point = (Vec3::Z, Vec3::new(0.2, 0.3, 1.0));
        let transport = stage.points(combination.solver, &[point], combination.estimator.plan(1, 1));
        let e = f64::from(measure(&*transport, Source::Emitters(None), 0).field.values()[0].x);
        assert!((e / PI - 1.0).abs() < ROUNDING, "{combination}: {e}");
    }
}
