//! No lines where surfaces meet.

use crate::{Placed, measured, placements, room, settings, surface_point};
use glam::{DVec3, Vec3};
use lumel::{BounceLimit, LumelLight, Lumels, Scene, SceneBuilder, Settings, SolvedLight};
use lumel_lightmap::Lightmap;
use lumel_scene::{Face, MaterialId, ObjectMesh, Radiance, Sky, Smoothing, SurfacePoint};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{grey, scene};
use lumel_testkit::{Estimate, form_factor, rms};
use std::f64::consts::PI;

fn finished((lumels, light): &(Lumels, LumelLight), denoises: bool) -> Lightmap {
    let nothing = SolvedLight::default();
    let known = denoises.then_some(&nothing);
    Lightmap::finished(&lumels.scene, &lumels.atlas, &lumels.coverage, light, known, None)
}

/// A floor from 0 to 1 along x, and a wall that leans over it or away from it, in one mesh with one edge.
fn fold(degrees: f32) -> (ObjectMesh, [DVec3; 4]) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let up = Vec3::new(cos, 0.0, sin);
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y * 2.0, Vec3::Y * 2.0, up, up + Vec3::Y * 2.0];
    let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]].map(face).into();
    let wall = [0, 3, 5, 4].map(|k: usize| positions[k].as_dvec3());
    (ObjectMesh { name: "fold".to_owned(), positions, faces, ..ObjectMesh::default() }, wall)
}

#[test]
fn no_dark_line_is_where_two_sides_of_a_fold_meet() {
    for degrees in [50.0, 90.0, 130.0] {
        let (mesh, wall) = fold(degrees);
        let sky = Sky::Uniform(Radiance::splat(1.0));
        let builder = SceneBuilder { sky, ..scene(vec![mesh], vec![grey(0.0, 0.0)], vec![]) };
        for placed in placements(&builder) {
            let few = Settings { bounces: BounceLimit::Count(0), direct_samples: 64, ..settings() };
            let bakes: Vec<_> =
                (0..4).map(|seed| measured(&placed, 1.0, 14.0, Settings { seed, ..few.clone() })).collect();
            for denoises in [false, true] {
                let maps: Vec<Lightmap> = bakes.iter().map(|bake| finished(bake, denoises)).collect();
                let scene = &bakes[0].0.scene;
                // A thousandth of the floor from the edge, and a lumel and a half from it.
                for away in [1e-3, 0.1] {
                    let point = |i: i32| DVec3::new(away, 0.1 + 1.8 * f64::from(i) / 47.0, 0.0);
                    let points: Vec<DVec3> = (0..48).map(point).collect();
                    let places: Vec<SurfacePoint> = points
                        .iter()
                        .map(|&point| surface_point(&placed, scene, point, DVec3::Z).unwrap())
                        .collect();
                    // What the floor sees of the sky so far from there.
                    let seen = |farther: f64| {
                        let of = |&point: &DVec3| {
                            1.0 - form_factor::polygon(&wall, point + DVec3::X * farther, DVec3::Z)
                        };
                        PI * points.iter().map(of).sum::<f64>()
                    };
                    let sum = |map: &Lightmap| places.iter().map(|at| f64::from(map.at(0, *at).0.x)).sum();
                    let found = Estimate::new(maps.iter().map(sum));
                    let noise = found.tolerance(100);
                    let what = format!("{degrees}°, {}, {away}, {denoises}", placed.place);
                    assert!(found.mean > 0.99 * seen(0.0) - noise, "{what}: a dark line");
                    // The light of a lumel is that of its middle, and a denoised one has some of its neighbours'.
                    assert!(found.mean < 1.01 * seen(1.5 / 14.0) + noise, "{what}: a bright line");
                }
            }
        }
    }
}

/// The room with a wall of its own, of two objects or one, close to the lamp.
fn with_wall(n: u32) -> SceneBuilder {
    let mut builder = room();
    let width = 1.6 / n as f32;
    for i in 0..n {
        let x = [i as f32 * width, (i + 1) as f32 * width].map(|x| x + 0.9);
        let corners = [[x[0], 0.1], [x[1], 0.1], [x[1], 1.7], [x[0], 1.7]];
        builder.objects.push(quad(corners.map(|[x, y]| Vec3::new(x, y, 0.4)), [1, 1], 0));
    }
    builder
}

/// Points of the wall along its middle, on each of its two sides.
fn beside_the_border(placed: &Placed, scene: &Scene) -> [Vec<SurfacePoint>; 2] {
    [1e-4, -1e-4].map(|side| {
        let at = |i| DVec3::new(1.7 + side, 0.2 + 1.4 * f64::from(i) / 59.0, 0.4);
        (0..60).map(|i| surface_point(placed, scene, at(i), DVec3::Z).unwrap()).collect()
    })
}

#[test]
fn the_border_of_two_charts_on_a_flat_wall_is_below_the_noise() {
    let whole = Placed::as_given(with_wall(1));
    let samples =
        Settings { bounces: BounceLimit::Count(1), direct_samples: 16, indirect_samples: 32, ..settings() };
    let bakes = |placed: &Placed| {
        (0..4)
            .map(|seed| measured(placed, 0.4, 8.0, Settings { seed, ..samples.clone() }))
            .collect::<Vec<_>>()
    };
    let read = |map: &Lightmap, points: &[SurfacePoint]| -> Vec<f64> {
        points.iter().map(|at| f64::from(map.at(0, *at).0.x)).collect()
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of_whole = bakes(&whole);
    let points = beside_the_border(&whole, &of_whole[0].0.scene);
    let known: Vec<f64> =
        of_whole.iter().map(|bake| mean(&read(&finished(bake, false), &points[0]))).collect();
    for placed in placements(&with_wall(2)) {
        let of_two = bakes(&placed);
        let (lumels, light) = &of_two[0];
        let points = beside_the_border(&placed, &lumels.scene);
        let charts = [0, 1].map(|side: usize| lumels.atlas.chart(points[side][0].tri));
        assert!(charts[0] != charts[1]);
        let noise = light.noise(&lumels.atlas, &lumels.coverage);
        let of_wall = (0..light.len())
            .filter(|&i| charts.contains(&lumels.atlas.chart(lumels.coverage.shares(i)[0].tri)));
        let noise = rms(of_wall.map(|i| f64::from(noise[i])));
        for denoises in [false, true] {
            let maps: Vec<_> = of_two.iter().map(|bake| finished(bake, denoises)).collect();
            let [left, right] = [0, 1].map(|side: usize| read(&maps[0], &points[side]));
            let jump = rms(left.iter().zip(&right).map(|(left, right)| left - right));
            assert!(jump < 0.5 * noise, "{}: {jump} {noise}", placed.place);
            // Nor is it brighter or darker there than on a wall of one chart.
            let off = maps.iter().zip(&known).map(|(map, known)| mean(&read(map, &points[0])) / known - 1.0);
            Estimate::new(off).assert_near(0.0, 0.005, format!("{}, {denoises}", placed.place));
        }
    }
}
