//! Spheres: light that falls evenly wherever it comes from, and light between two of them.

use crate::{integrals, mean, plan, solved_by};
use glam::Vec3;
use lumel_basis::{Basis, Field};
use lumel_scene::SceneBuilder;
use lumel_solve::{SolveState, Stop};
use lumel_testkit::mesh::{Facing, equal_area_radius, sphere};
use lumel_testkit::scene::{grey, scene, varying_sphere};
use lumel_testkit::{Estimate, Method, Operator, Stage, rms};

/// All bounces: the first ones, and the series of the rest. Light is well mixed in a sphere, so the series is good.
fn converged(operator: &Operator, stage: &Stage) -> Field {
    let stop = Stop::Remainder { fraction: 0.02, at_most: 60 };
    let mut state: SolveState = solved_by(operator, stage, stop);
    state.tail = integrals(stage, operator).tail(&state.bounces);
    state.total()
}

/// The error of the mean irradiance on the varying sphere, which is 2 everywhere.
fn sphere_error(builder: SceneBuilder, method: Method, n_rays: u32, n_seeds: u64) -> Estimate {
    let stage = Stage::new(builder);
    let errors = (0..n_seeds).map(|seed| {
        let operator = stage.operator(method, plan(seed, n_rays));
        mean(&operator, &converged(&operator, &stage)) - 2.0
    });
    Estimate::new(errors)
}

#[test]
fn irradiance_on_the_varying_sphere_is_two_and_errs_with_the_square_of_the_mesh() {
    // Four dimensions converge slower than two: area sampling needs more to show its error above the noise.
    for (method, n_rays, n_seeds) in [(Method::VERTEX, 256, 8), (Method::AREA, 1024, 16)] {
        let coarse = sphere_error(varying_sphere(1), method, n_rays, n_seeds);
        let fine = sphere_error(varying_sphere(2), method, n_rays, n_seeds);
        let order = (coarse.mean / fine.mean).abs().log2();
        let noise = (coarse.error / coarse.mean).hypot(fine.error / fine.mean);
        assert!(noise < 0.07, "{method}: noise of {noise} would hide the order");
        assert!((order - 2.0).abs() < 0.3, "{method}: order {order}, {coarse:?} {fine:?}");
        println!("{method}: errors {:.5} and {:.5}, order {order:.2}", coarse.mean, fine.mean);
    }
}

#[test]
fn every_vertex_of_the_builtin_sphere_gets_two() {
    let stage = Stage::new(lumel_builtin::scene("sphere", 0).unwrap());
    let operator = stage.operator(Method::VERTEX, plan(1, 64));
    let field = converged(&operator, &stage);
    let errors: Vec<f64> = field.values().iter().map(|e| f64::from(e.x) - 2.0).collect();
    // Level 4 errs by less than 0.2 % (1/256 of an icosahedron's error of order one half); 64 Sobol rays of light
    // that varies by one half bring 1 % of noise.
    let mean_error = mean(&operator, &field) - 2.0;
    assert!(mean_error.abs() < 4e-3, "{mean_error}");
    assert!(rms(errors.iter().copied()) < 0.02, "{}", rms(errors.iter().copied()));
    assert!(errors.iter().all(|e| e.abs() < 0.1), "no vertex stands out");
}

#[test]
fn two_concentric_spheres_exchange_what_their_areas_say() {
    // Radii 1/2 and 1, albedos 0.5 and 0.8, the inner one emits: B = 4/3 and 2/3. The polyhedra have the areas of the
    // spheres and the inner one is convex, so that 1 and 1/4 are their form factors exactly.
    let level = 2;
    let ball = |r, facing, m| sphere(Vec3::ZERO, equal_area_radius(r, level), level, facing, m);
    let objects = vec![ball(0.5, Facing::Outward, 0), ball(1.0, Facing::Inward, 1)];
    let stage = Stage::new(scene(objects, vec![grey(0.5, 1.0), grey(0.8, 0.0)], vec![]));
    let inner: Vec<bool> = stage.nodes().iter().map(|(p, _)| p.length() < 0.75).collect();
    // Facets see light that varies by a few per cent; its effect on the means over areas is of second order. Vertices
    // lie outside of the sphere of the same area, and light from the inner one falls with the square of the radius.
    let outside = 2.0 * (equal_area_radius(1.0, level) - 1.0);
    for (method, n_rays, bound) in [(Method::AREA, 128, 1e-3), (Method::VERTEX, 64, outside)] {
        let means: Vec<[f64; 2]> = (0..8)
            .map(|seed| {
                let operator = stage.operator(method, plan(seed, n_rays));
                let field = converged(&operator, &stage);
                let areas = operator.basis.node_areas();
                [true, false].map(|inside| {
                    let nodes = (0..inner.len()).filter(|&i| inner[i] == inside);
                    let (sum, area) = nodes.fold((0.0, 0.0), |(sum, area), i| {
                        let a = f64::from(areas[i]);
                        (sum + a * f64::from(field.values()[i].x), area + a)
                    });
                    sum / area
                })
            })
            .collect();
        let [on_inner, on_outer] = [0, 1].map(|k| Estimate::new(means.iter().map(|m| m[k])));
        on_inner.assert_near(2.0 / 3.0, bound, format!("{method}, inner"));
        on_outer.assert_near(5.0 / 6.0, bound, format!("{method}, outer"));
        println!("{method}: {:.5} and {:.5}", on_inner.mean, on_outer.mean);
    }
}
