//! Partly blocked light against the part of the light that is seen.

use glam::{DVec3, Vec3};
use lumel_scene::{Light, SceneBuilder};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_testkit::{
    AtPoints, Combination, Estimate, Stage, Storage, form_factor, measure, mesh, ratio_bias, replicates,
};
use lumel_transport::{LightSampling, Source};
use std::f64::consts::PI;

const LIGHT: [[f64; 2]; 2] = [[-0.5, 0.5], [-0.5, 0.5]];
const SCREEN: [[f64; 2]; 2] = [[0.0, 1.0], [-1.0, 1.0]];

/// A unit light at z = 2 and half-way below it a screen that blocks x > 0; with a floor or without.
fn screened(floor: Option<(f32, f32)>) -> SceneBuilder {
    let rectangle = |x: [f32; 2], y: [f32; 2], z, cells| {
        let corner = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| Vec3::new(x[i], y[j], z));
        mesh::quad(corner, cells, 0)
    };
    // The screen faces down: back faces make area sampling ask whether it is inside something.
    let mut objects = vec![rectangle([1.0, 0.0], [-1.0, 1.0], 1.0, [1, 1])];
    objects.extend(floor.map(|(from, to)| rectangle([from, to], [-0.5, 0.5], 0.0, [4, 2])));
    let light = Light::Rect(ceiling_light(Vec3::Z * 2.0, 1.0, 1.0, 1.0));
    scene(objects, vec![grey(0.0, 0.0)], vec![light])
}

/// Irradiance on the floor: the light without the shadow that the screen throws on it, seen from the floor.
fn truth(point: DVec3) -> f64 {
    let lit = form_factor::polygon(&form_factor::facing_down(LIGHT[0], LIGHT[1], 2.0), point, DVec3::Z);
    let hidden = form_factor::hidden_part(LIGHT, 2.0, SCREEN, 1.0, point);
    PI * (lit - hidden.map_or(0.0, |corners| form_factor::polygon(&corners, point, DVec3::Z)))
}

#[test]
fn penumbra_is_light_minus_the_projected_screen() {
    let stage = Stage::new(screened(None));
    let known = [
        (-0.75, 0.183489300),
        (-0.25, 0.174847641),
        (0.0, 0.115418399),
        (0.25, 0.049944845),
        (0.5, 0.0),
        (1.0, 0.0),
        (1.5, 0.0),
        (2.0, 0.039537654),
        (2.25, 0.041533091),
        (2.5, 0.039069838),
    ];
    for (x, e) in known {
        // The table has nine digits.
        assert!((truth(DVec3::X * x) - e).abs() < 1e-9, "{x}: {}", truth(DVec3::X * x));
        for combination in AtPoints::all() {
            let point = (Vec3::X * x as f32, Vec3::Z);
            let plan = combination.estimator.plan(64, 1);
            let transport = stage.points(combination.solver, &[point], plan);
            let fields = replicates(&*transport, Source::Emitters(None), 64);
            // Origins are pushed up by 1.5e-5: the shadow moves by as much, the light comes closer by less.
            let shift = 5e-5 * e;
            Estimate::of_node(&fields, 0).assert_near(e, shift, format!("x = {x}, {combination}"));
        }
    }
}

#[test]
fn umbra_is_black_and_full_light_has_no_noise_with_analytic_lights() {
    let stage = Stage::new(screened(None));
    for combination in AtPoints::all().filter(|c| c.estimator.light == LightSampling::Analytic) {
        let at = |x: f32| {
            let plan = combination.estimator.plan(16, 1);
            let transport = stage.points(combination.solver, &[(Vec3::X * x, Vec3::Z)], plan);
            let fields = replicates(&*transport, Source::Emitters(None), 16);
            Estimate::of_node(&fields, 0)
        };
        for x in [0.6, 1.0, 1.4] {
            let dark = at(x);
            assert_eq!((dark.mean, dark.error), (0.0, 0.0), "{combination}, x = {x}");
        }
        for x in [-0.75f32, -0.6, 2.6] {
            let lit = at(x);
            assert_eq!(lit.error, 0.0, "{combination}, x = {x}");
            let e = truth(DVec3::X * f64::from(x));
            assert!((lit.mean / e - 1.0).abs() < 5e-5, "{combination}, x = {x}: {} {e}", lit.mean);
        }
    }
}

#[test]
fn every_basis_measures_the_penumbra_on_a_floor() {
    // No vertex lies on the edge of the umbra, where the light that is seen is less than a sample.
    let stage = Stage::new(screened(Some((-1.1, 0.7))));
    let floor = |point: DVec3, normal: DVec3| if normal.z > 0.0 { truth(point) } else { f64::NAN };
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(64, 1));
        let expected = stage.expected(&operator, &floor);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
        // A corner has a triangle of 32 samples. Quadrature of the kink at the edge of the umbra adds less than 1e-3.
        let bound = match combination.method.storage {
            Storage::Vertex => 1e-4,
            Storage::VertexArea => ratio_bias(32, 0.3) + 1e-3,
        };
        lumel_testkit::assert_nodes_near(&fields, &expected, bound, combination);
    }
}

#[test]
fn a_floor_in_the_umbra_is_black_in_every_basis_with_analytic_lights() {
    let stage = Stage::new(screened(Some((0.6, 1.4))));
    for combination in Combination::all().filter(|c| c.estimator.light == LightSampling::Analytic) {
        let operator = stage.operator(combination.method, combination.estimator.plan(16, 1));
        let field = measure(&*operator.transport, Source::Emitters(None), 0).field;
        for ((point, _), e) in stage.nodes().into_iter().zip(field.values()).filter(|((_, n), _)| n.z > 0.0) {
            assert_eq!(*e, Vec3::ZERO, "{combination} at {point}");
        }
    }
}
