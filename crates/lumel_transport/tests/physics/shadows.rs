//! Partly blocked light against the part of the light that is seen.

use glam::{DVec3, Vec3};
use lumel_scene::SceneBuilder;
use lumel_testkit::scene::{grey, scene};
use lumel_testkit::{
    AtPoints, Combination, Estimate, Stage, Storage, measure, mesh, ratio_bias, replicates, screen,
};
use lumel_transport::{LightSampling, Source};

/// The light and its screen, with a floor or without.
fn screened(floor: Option<(f32, f32)>) -> SceneBuilder {
    // The screen faces down: back faces make area sampling ask whether it is inside something.
    let mut objects = vec![screen::screen(0)];
    objects.extend(floor.map(|(from, to)| {
        let corners = [[from, -0.5], [to, -0.5], [to, 0.5], [from, 0.5]].map(|[x, y]| Vec3::new(x, y, 0.0));
        mesh::quad(corners, [4, 2], 0)
    }));
    scene(objects, vec![grey(0.0, 0.0)], vec![screen::light()])
}

#[test]
fn penumbra_is_light_minus_the_projected_screen() {
    let stage = Stage::new(screened(None));
    for (x, e) in screen::KNOWN {
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
            let e = screen::irradiance(DVec3::X * f64::from(x));
            assert!((lit.mean / e - 1.0).abs() < 5e-5, "{combination}, x = {x}: {} {e}", lit.mean);
        }
    }
}

#[test]
fn every_basis_measures_the_penumbra_on_a_floor() {
    // No vertex lies on the edge of the umbra, where the light that is seen is less than a sample.
    let stage = Stage::new(screened(Some((-1.1, 0.7))));
    let floor =
        |point: DVec3, normal: DVec3| if normal.z > 0.0 { screen::irradiance(point) } else { f64::NAN };
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
