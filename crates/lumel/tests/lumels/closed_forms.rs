//! Form factors, polygons and shadows in closed form.

use crate::{Placed, measured, placements, settings, surface_point};
use glam::{DVec2, DVec3, Vec3};
use lumel::{BounceLimit, LumelLight, Lumels, SceneBuilder, Settings};
use lumel_basis::Field;
use lumel_lightmap::Lightmap;
use lumel_scene::{DirectionalLight, Light, Material, ObjectMesh, Radiance, RectLight};
use lumel_testkit::mesh::{quad, triangles};
use lumel_testkit::scene::{grey, scene};
use lumel_testkit::{Estimate, assert_nodes_near, form_factor, screen};
use lumel_uv::Piece;
use std::f64::consts::PI;

/// Origins of rays lie a little above their surface, and coordinates have few digits far from their origin.
fn rounding(placed: &Placed) -> f64 {
    if placed.shift == Vec3::ZERO { 1e-4 } else { 2e-3 }
}

/// Light at the lumels of a scene, from independent samples.
fn bakes(placed: &Placed, per_metre: f32, n: u64, settings: &Settings) -> (Lumels, Vec<LumelLight>) {
    let bake = |seed| measured(placed, 0.2, per_metre, Settings { seed, ..settings.clone() });
    let (mut lumels, lights): (Vec<_>, Vec<_>) = (0..n).map(bake).unzip();
    (lumels.remove(0), lights)
}

/// The mean of `f` of position and normal in the scene as given over each lumel that is covered whole, by quadrature; NaN for
/// others.
fn means(lumels: &Lumels, placed: &Placed, f: &dyn Fn(DVec3, DVec3) -> f64) -> Vec<f64> {
    const N: u32 = 8;
    let scene = &lumels.scene;
    let mean = |index: usize| {
        let (_, [x, y]) = lumels.atlas.column_and_row(lumels.coverage.lumels()[index] as usize);
        let shares = lumels.coverage.shares(index).iter();
        let pieces: Vec<_> =
            shares.filter_map(|share| Piece::new(&lumels.atlas, share.tri, [x, y])).collect();
        if pieces.iter().map(Piece::area).sum::<f32>() < 0.9999 {
            return f64::NAN;
        }
        let value = |i: u32| {
            let [u, v] = [i / N, i % N].map(|i| (f64::from(i) + 0.5) / f64::from(N));
            let place = DVec2::new(f64::from(x) + u, f64::from(y) + v);
            let inside = pieces.iter().map(|piece| piece.at(place));
            let (at, _) = inside.max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap();
            f(placed.home(scene, scene.position(at)), placed.normal(scene, at.tri))
        };
        (0..N * N).map(value).sum::<f64>() / f64::from(N * N)
    };
    (0..lumels.coverage.len()).map(mean).collect()
}

/// The mean of values over all surfaces with a normal in the scene as given.
fn mean_over(lumels: &Lumels, placed: &Placed, normal: DVec3, values: &[Vec3]) -> f64 {
    let (mut sum, mut whole) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        for share in lumels.coverage.shares(index) {
            if placed.normal(&lumels.scene, share.tri).dot(normal) > 0.9 {
                sum += f64::from(share.area * value.x);
                whole += f64::from(share.area);
            }
        }
    }
    sum / whole
}

/// A rectangle from a corner along two edges, to the side of their cross product.
fn rectangle(corner: Vec3, along: Vec3, up: Vec3, material: u32) -> ObjectMesh {
    quad([corner, corner + along, corner + along + up, corner + up], [1, 1], material)
}

fn black() -> Material {
    grey(0.0, 0.0)
}

#[test]
fn between_rectangles_light_is_their_form_factor() {
    let floor = |material| rectangle(Vec3::ZERO, Vec3::X, Vec3::Y, material);
    let wall = |height: f32, material| rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z * height, material);
    let ceiling = rectangle(Vec3::Z, Vec3::Y, Vec3::X, 1);
    let emitting = || vec![black(), grey(0.0, 1.0)];
    // Upright sunlight, of which the floor reflects a radiosity of 1 and the wall gets nothing.
    let sun = Light::Directional(DirectionalLight { direction: Vec3::NEG_Z, irradiance: Vec3::splat(2.0) });
    let between = form_factor::perpendicular_rectangles;
    let cases: [(&str, SceneBuilder, usize, DVec3, f64); 4] = [
        (
            "opposite",
            scene(vec![floor(0), ceiling], emitting(), vec![]),
            0,
            DVec3::Z,
            form_factor::parallel_rectangles(1.0, 1.0, 1.0),
        ),
        (
            "beside a wall that emits",
            scene(vec![floor(0), wall(2.0, 1)], emitting(), vec![]),
            0,
            DVec3::Z,
            between(1.0, 2.0, 1.0),
        ),
        (
            "beside a floor that reflects",
            scene(vec![floor(1), wall(1.0, 0)], vec![black(), grey(0.5, 0.0)], vec![sun]),
            1,
            DVec3::X,
            between(1.0, 1.0, 1.0),
        ),
        (
            "beside a floor that reflects, high",
            scene(vec![floor(1), wall(2.0, 0)], vec![black(), grey(0.5, 0.0)], vec![sun]),
            1,
            DVec3::X,
            between(2.0, 1.0, 1.0),
        ),
    ];
    for (name, builder, source, normal, factor) in cases {
        for placed in placements(&builder) {
            let (lumels, lights) = bakes(&placed, 9.0, 6, &settings());
            let mean = |light: &LumelLight| mean_over(&lumels, &placed, normal, &light.sources[source]);
            let mean = Estimate::new(lights.iter().map(mean));
            mean.assert_near(factor, rounding(&placed) * factor, format!("{name}, {}", placed.place));
        }
    }
}

fn direct() -> Settings {
    Settings { bounces: BounceLimit::Count(0), ..settings() }
}

/// Direct light at the lumels that have an expected value.
fn assert_direct(placed: &Placed, per_metre: f32, expected: &dyn Fn(DVec3, DVec3) -> f64) {
    let (lumels, lights) = bakes(placed, per_metre, 16, &direct());
    let expected = means(&lumels, placed, expected);
    assert!(expected.iter().filter(|e| e.is_finite()).count() > 100);
    let fields: Vec<Field> =
        lights.iter().map(|light| Field::from_values(light.sources[0].clone())).collect();
    let finite = || expected.iter().enumerate().filter(|(_, e)| e.is_finite());
    let mean = |field: &Field| finite().map(|(i, _)| f64::from(field.values()[i].x)).sum();
    let mean = Estimate::new(fields.iter().map(mean));
    let known: f64 = finite().map(|(_, e)| e).sum();
    mean.assert_near(known, rounding(placed) * known, format!("all lumels, {}", placed.place));
    assert_nodes_near(&fields, &expected, rounding(placed), placed.place);
}

#[test]
fn polygons_that_shine_are_seen_as_far_as_they_are_above_the_horizon() {
    let floor = rectangle(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0, 0);
    // A tilted rectangle that is half below the plane of the floor, and a triangle over it.
    let lamp = RectLight {
        center: Vec3::new(2.4, 0.3, 0.1),
        u: Vec3::new(0.1, 0.5, 0.1),
        v: Vec3::new(0.3, 0.0, -0.3),
        radiance: Radiance::splat(3.0),
        texture: None,
    };
    let mut triangle = rectangle(Vec3::new(-0.6, -0.5, 1.1), Vec3::Y * 0.7, Vec3::new(0.9, 0.2, 0.2), 1);
    triangle.faces.truncate(1);
    let [below] = triangles(&triangle).collect::<Vec<_>>()[..] else { panic!("one triangle") };
    let shining = lamp.corners().map(|corner| corner.as_dvec3());
    let expected = |point: DVec3, normal: DVec3| {
        let lamp = 3.0 * PI * form_factor::polygon(&shining, point, normal);
        if point.z < 0.5 { lamp + 2.0 * form_factor::polygon(&below, point, normal) } else { f64::NAN }
    };
    assert!(form_factor::polygon(&shining, DVec3::X, DVec3::Z) > 0.01);
    let builder = scene(vec![floor, triangle], vec![black(), grey(0.0, 2.0)], vec![lamp.into()]);
    for placed in placements(&builder) {
        assert_direct(&placed, 9.0, &expected);
    }
}

#[test]
fn a_screen_throws_the_shadow_it_should() {
    let floor = rectangle(Vec3::new(-1.0, -0.5, 0.0), Vec3::X * 4.0, Vec3::Y, 0);
    let builder = scene(vec![floor, screen::screen(0)], vec![black()], vec![screen::light()]);
    for placed in placements(&builder) {
        let expected = |point: DVec3, _| if point.z < 0.5 { screen::irradiance(point) } else { f64::NAN };
        assert_direct(&placed, 10.0, &expected);
    }
    // As it is read.
    let placed = Placed::as_given(builder);
    let (Lumels { scene, atlas, coverage }, light) = measured(&placed, 1.0, 32.0, direct());
    let lightmap = Lightmap::finished(&scene, &atlas, &coverage, &light, None, None);
    for (x, known) in screen::KNOWN {
        let at = surface_point(&placed, &scene, DVec3::X * x, DVec3::Z).unwrap();
        let read = f64::from(lightmap.at(0, at).0.x);
        // Between lumels light is linear, which it is not in penumbrae; their noise is a percent.
        let may_be_off = if (0.51..1.49).contains(&x) { 0.0 } else { 0.004 };
        assert!((read - known).abs() <= may_be_off, "{x}: {read} {known}");
    }
}
