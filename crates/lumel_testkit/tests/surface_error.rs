//! Errors over surfaces, where they are known.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use glam::{DVec3, Vec3};
use lumel_sample::SamplerKind;
use lumel_scene::{Light, SceneBuilder};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{ceiling_light, grey, scene, two_sided};
use lumel_testkit::{
    Method, Reference, Solver, Stage, Storage, SurfaceError, fitted_slope, form_factor, measure,
};
use lumel_transport::{LightSampling, Plan, Source};
use std::f64::consts::PI;

/// The unit square in the xy plane, of `cells²` cells.
fn floor(cells: u32) -> SceneBuilder {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    scene(vec![quad(corners, [cells; 2], 0)], vec![grey(0.0, 0.0)], vec![])
}

/// The error of the interpolant of `f` on the floor.
fn interpolated(cells: u32, f: impl Fn(DVec3) -> f64) -> SurfaceError {
    let stage = Stage::new(floor(cells));
    let field = stage.field(|p, _| f(p.as_dvec3()) as f32);
    let reference = Reference::known(stage.scene(), 20_000, 1, |p, _| f(p));
    reference.error_of_field(&**stage.basis(), &field)
}

#[test]
fn linear_light_has_no_error_over_surfaces() {
    let objects = cuboid(Vec3::ZERO, Vec3::ONE, 3, Facing::Inward, [0; 6]);
    let stage = Stage::new(scene(objects, vec![two_sided(grey(0.5, 0.0))], vec![]));
    let f = |p: DVec3, n: DVec3| 2.0 + p.x - 0.5 * p.y + 0.25 * p.z + 3.0 * n.z.max(0.0);
    let field = stage.field(|p, n| f(p.as_dvec3(), n.as_dvec3()) as f32);
    let error = Reference::known(stage.scene(), 2000, 1, f).error_of_field(&**stage.basis(), &field);
    // A few operations in f32.
    assert!(error.rms < 1e-6 && error.bias.abs() < 1e-6 && error.percentile_95 < 1e-6, "{error:?}");
    // With the light of the other sides, all is wrong.
    let other = stage.field(|p, n| f(p.as_dvec3(), -n.as_dvec3()) as f32);
    let error = Reference::known(stage.scene(), 2000, 1, f).error_of_field(&**stage.basis(), &other);
    assert!(error.rms > 0.3, "{error:?}");
}

#[test]
fn quadratic_light_has_the_error_of_linear_interpolation() {
    // Over a cell of side h, x² minus its interpolant is −t(h − t): the mean is −h²/6, the mean square h⁴/30.
    let f = |p: DVec3| p.x * p.x;
    let (mean, power) = (1.0 / 3.0, 1.0 / 5.0f64);
    let mut law = Vec::new();
    for cells in [2, 4, 8] {
        let h = 1.0 / f64::from(cells);
        let error = interpolated(cells, f);
        let (rms, bias) = (h * h / 30f64.sqrt() / power.sqrt(), h * h / 6.0 / mean);
        assert!((error.rms - rms).abs() < 4.0 * error.rms_error, "{cells} cells: {error:?}, not {rms}");
        assert!((error.bias - bias).abs() < 4.0 * error.bias_error, "{cells} cells: {error:?}, not {bias}");
        // The claimed errors are of use: twenty thousand points know both to a few percent.
        assert!(error.rms_error < 0.02 * rms && error.bias_error < 0.02 * bias, "{cells} cells: {error:?}");
        // t(h − t) is h²/4 (1 − s²) at a distance of s h/2 from the middle of the cell: 95 % of it are farther than s = 0.05.
        let percentile = h * h / 4.0 * (1.0 - 0.05 * 0.05) / power.sqrt();
        assert!((error.percentile_95 / percentile - 1.0).abs() < 0.01, "{cells} cells: {error:?}");
        law.push((h, error.rms));
    }
    let slope = fitted_slope(&law);
    assert!((slope - 2.0).abs() < 0.03, "{slope}");
}

/// A square light of radiance one half a metre above the floor.
fn lit_floor(cells: u32) -> (Stage, impl Fn(DVec3, DVec3) -> f64) {
    let light = ceiling_light(Vec3::new(0.5, 0.5, 0.5), 0.4, 0.4, 1.0);
    let corners = light.corners().map(|p| p.as_dvec3());
    let stage = Stage::new(SceneBuilder { lights: vec![Light::Rect(light)], ..floor(cells) });
    (stage, move |point, normal| PI * form_factor::polygon(&corners, point, normal))
}

#[test]
fn light_of_a_polygon_has_the_error_of_interpolating_its_closed_form() {
    for method in Method::ALL {
        let mut law = Vec::new();
        for cells in [8, 16, 32] {
            let (stage, exact) = lit_floor(cells);
            let reference = Reference::known(stage.scene(), 4000, 2, &exact);
            let plan = Plan { direct_samples: 256, indirect_samples: 4, ..Plan::default() };
            let operator = stage.operator(method, plan);
            let field = measure(&*operator.transport, Source::Emitters(None), 0).field;
            let error = reference.error_of_field(&*operator.basis, &field);
            law.push((1.0 / f64::from(cells), error.rms));
            if method.storage == Storage::Vertex {
                // Nothing blocks the light, so points measure it exactly: only interpolation is left.
                let nodal = stage.field(|p, n| exact(p.as_dvec3(), n.as_dvec3()) as f32);
                let known = reference.error_of_field(&*operator.basis, &nodal);
                assert!((error.rms / known.rms - 1.0).abs() < 0.05, "{method}, {cells}: {error:?} {known:?}");
            }
        }
        // Interpolation errs with h²; averages over areas with h^1.5, as borders are off-centre.
        let expected = if method.storage == Storage::Vertex { 2.0 } else { 1.5 };
        let slope = fitted_slope(&law);
        assert!((slope - expected).abs() < 0.25, "{method}: slope {slope}, {law:?}");
    }
}

#[test]
fn a_measured_reference_agrees_with_the_closed_form_up_to_its_noise() {
    let (stage, exact) = lit_floor(8);
    // Few points on the light, so that the reference is noisy.
    let plan = Plan {
        sampler: SamplerKind::Random,
        direct_samples: 4,
        light_sampling: LightSampling::Area,
        ..Plan::default()
    };
    let field = stage.field(|p, n| exact(p.as_dvec3(), n.as_dvec3()) as f32);
    for solver in Solver::ALL {
        let towards = |receivers| stage.towards(solver, receivers, plan);
        let measured = Reference::measured(stage.scene(), 4000, 2, towards, None, 8);
        let known = Reference::known(stage.scene(), 4000, 2, &exact);
        assert_eq!(measured.points(), known.points(), "{solver}: the floor is free");
        let [found, truth] = [&measured, &known].map(|r| r.error_of_field(&**stage.basis(), &field));
        // Left in, the noise would be most of the error.
        assert!(measured.noise() > truth.rms, "{solver}: {} {truth:?}", measured.noise());
        let (rms, bias) = ((found.rms - truth.rms).abs(), (found.bias - truth.bias).abs());
        assert!(rms < 4.0 * found.rms_error, "{solver}: {found:?} {truth:?}");
        assert!(bias < 4.0 * found.bias_error, "{solver}: {found:?} {truth:?}");
        // The claimed errors are of use.
        assert!(found.rms_error < 0.2 * truth.rms && found.bias_error < 2e-3, "{solver}: {found:?}");
    }
}

#[test]
fn points_inside_geometry_are_no_part_of_a_measured_reference() {
    // A box of a fifth of the floor stands on it.
    let mut builder = floor(4);
    let (min, max) = (Vec3::new(0.3, 0.25, -0.1), Vec3::new(0.7, 0.75, 0.4));
    builder.objects.extend(cuboid(min, max, 2, Facing::Outward, [0; 6]));
    let stage = Stage::new(builder);
    let towards = |receivers| stage.towards(Solver::Traced, receivers, Plan::default());
    let reference = Reference::measured(stage.scene(), 2000, 3, towards, None, 2);
    let is_inside = |p: Vec3| p.z.abs() < 1e-3 && (p - 0.5).abs().x < 0.19 && (p - 0.5).abs().y < 0.24;
    let positions = || reference.points().iter().map(|at| stage.scene().position(*at));
    assert!(!positions().any(is_inside));
    let on_floor = positions().filter(|p| p.z.abs() < 1e-3).count();
    assert!(on_floor > 100, "{on_floor}");
}

#[test]
fn the_reflected_part_of_a_reference_is_gathered_from_a_field() {
    // In a closed room of albedo one half with irradiance 2 everywhere, half of it arrives again.
    let objects = cuboid(Vec3::ZERO, Vec3::ONE, 2, Facing::Inward, [0; 6]);
    let stage = Stage::new(scene(objects, vec![grey(0.5, 0.0)], vec![]));
    let two = stage.field(|_, _| 2.0);
    let one = stage.field(|_, _| 1.0);
    let towards = |receivers| stage.towards(Solver::Traced, receivers, Plan::default());
    let reference = Reference::measured(stage.scene(), 500, 4, towards, Some(&two), 2);
    let error = reference.error_of_field(&**stage.basis(), &one);
    assert!(error.n_points == 500 && error.rms < 1e-5 && error.bias.abs() < 1e-5, "{error:?}");
}
