use crate::common::{Place, TINY, run};
use glam::Vec3;
use lumel_export::{Array, ArrayData, NpzReader, write_npz};
use serde_json::Value;

/// A light below the ceiling of the furnace, whose floor is at y = -0.5.
const LIGHT: &str = "rect center=0,0.4,0 u=0.2,0,0 v=0,0,0.15 radiance=10,20,30";

/// Irradiance below the middle of a parallel rectangle of half-edges `a`, `b` and radiance 1, at distance `h`.
fn below_rectangle(a: f64, b: f64, h: f64) -> f64 {
    let (x, y) = (a / h, b / h);
    let part = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    4.0 * 0.5 * (part(x, y) + part(y, x))
}

fn measure_json(place: &Place, words: &[&str]) -> Value {
    let run = run(place.lumel("measure furnace").args(TINY).args(["--json"]).args(words)).done();
    serde_json::from_str(&run.stdout).unwrap()
}

fn vectors(npz: &mut NpzReader, name: &str) -> Vec<Vec3> {
    let Array { shape, data: ArrayData::F32(values) } = npz.array(name).unwrap() else { panic!("{name}") };
    assert_eq!(shape.last(), Some(&3));
    values.chunks_exact(3).map(Vec3::from_slice).collect()
}

#[test]
fn direct_light_has_its_closed_form() {
    let place = Place::new();
    let words =
        ["--no-emissive", "--light", LIGHT, "--bounces", "0", "--point", "0,-0.5,0", "--normal", "0,3,0"];
    let measured = measure_json(&place, &words);
    let wanted = below_rectangle(0.2, 0.15, 0.9);
    for (channel, radiance) in [10.0, 20.0, 30.0].into_iter().enumerate() {
        let found = measured["irradiance"][0][channel].as_f64().unwrap();
        assert!((found / (radiance * wanted) - 1.0).abs() < 1e-4, "{found} {}", radiance * wanted);
    }
    assert_eq!(measured["bounces"].as_array().unwrap().len(), 1);
    assert_eq!(measured["bounces"][0], measured["irradiance"]);
    assert_eq!(measured["bounce_errors"][0], measured["standard_error"]);
}

#[test]
fn the_table_has_a_line_for_each_point() {
    let place = Place::new();
    let words = "--point 0,-0.5,0 --normal 0,1,0 --point -0.1,-0.5,0.2 --normal 0,1,0";
    let run = run(place.lumel("measure furnace").args(TINY).args(words.split(' '))).done();
    assert_eq!(run.stdout.lines().count(), 3, "{}", run.stdout);
    assert!(run.stdout.lines().nth(2).unwrap().starts_with("-0.1 -0.5 0.2 "), "{}", run.stdout);
}

#[test]
fn points_from_a_file_are_measured_into_a_file() {
    let place = Place::new();
    let points = [Vec3::new(0.0, -0.5, 0.0), Vec3::new(0.1, -0.5, 0.2), Vec3::new(-0.5, 0.0, 0.0)];
    let normals = [Vec3::Y, Vec3::Y, Vec3::X];
    write_npz(&place.path("points.npz"), |npz| {
        npz.array("points", &Array::from_vectors(&points))?;
        // As `numpy.array` makes them.
        let values = normals.iter().flat_map(|n| n.to_array().map(f64::from)).collect();
        npz.array("normals", &Array { shape: vec![3, 3], data: ArrayData::F64(values) })
    })
    .unwrap();
    let words = ["--points", "points.npz", "-o", "light.npz", "--bounces", "2"];
    let run = run(place.lumel("measure furnace").args(TINY).args(words)).done();
    assert!(run.stdout.contains("measured 3 points"), "{}", run.stdout);
    let mut npz = NpzReader::open(&place.path("light.npz")).unwrap();
    assert_eq!(vectors(&mut npz, "points"), points);
    assert_eq!(vectors(&mut npz, "normals"), normals);
    let (irradiance, error) = (vectors(&mut npz, "irradiance"), vectors(&mut npz, "standard_error"));
    assert_eq!(npz.array("bounces").unwrap().shape, [3, 3, 3]);
    assert_eq!(npz.array("bounce_errors").unwrap().shape, [3, 3, 3]);
    let bounces = vectors(&mut npz, "bounces");
    for i in 0..3 {
        let sum = bounces[i] + bounces[3 + i] + bounces[6 + i];
        assert!((sum - irradiance[i]).length() < 1e-4 * sum.length(), "{sum} {}", irradiance[i]);
        assert!(error[i].is_finite());
    }
}

#[test]
fn the_light_of_a_solution_is_reused() {
    let place = Place::new();
    let light = ["--light", LIGHT];
    // What is read by least squares is known again to rounding only.
    let settings = ["--no-emissive", "--bounces", "2", "--tail", "geometric", "--projection", "point"];
    run(place.lumel("bake furnace -o a.npz").args(TINY).args(light).args(settings)).done();
    let at = ["--point", "0,-0.5,0", "--normal", "0,1,0"];
    let solved = measure_json(&place, &[&light[..], &settings, &at].concat());
    let reuse = |more: &[&str]| {
        let words =
            [&["measure", "furnace", "--solution", "a.npz", "--json"], &light[..], &at, more].concat();
        run(place.lumel("").args(words))
    };
    let reused: Value = serde_json::from_str(&reuse(&[]).done().stdout).unwrap();
    assert_eq!(solved, reused, "the settings are those of the solution");
    let finer: Value = serde_json::from_str(&reuse(&["--indirect-samples", "64"]).done().stdout).unwrap();
    assert_ne!(finer["bounces"][1], reused["bounces"][1]);
    reuse(&["--sky", "1,1,1"]).failed("materials or lights");
    assert_eq!(reuse(&["--bounces", "3"]).code, 2, "bounces are those of the solution");
    let foreign = ["measure", "sphere", "--solution", "a.npz", "--point", "0,0,0", "--normal", "0,1,0"];
    run(place.lumel("").args(foreign)).failed("\"furnace\"");
}

#[test]
fn incomplete_points_are_refused() {
    let place = Place::new();
    let refused = |words: &str, part: &str| {
        run(place.lumel("measure furnace").args(words.split(' '))).failed(part);
    };
    refused("--point 0,0,0", "--normal");
    refused("--point 0,0,0 --normal 0,0,0", "direction");
    refused("--point nan,0,0 --normal 0,1,0", "not a finite number");
    refused("--point 0,0 --normal 0,1,0", "three numbers");
    refused("--points missing.npz", "missing.npz");
    refused("--point 0,0,0 --normal 0,1,0 -o a.txt", ".npz");
    write_npz(&place.path("few.npz"), |npz| {
        npz.array("points", &Array::from_vectors(&[Vec3::ZERO; 2]))?;
        npz.array("normals", &Array::from_vectors(&[Vec3::Y]))
    })
    .unwrap();
    refused("--points few.npz", "2 points and 1 normals");
    write_npz(&place.path("flat.npz"), |npz| npz.array("points", &Array::list(ArrayData::F32(vec![0.0; 3]))))
        .unwrap();
    refused("--points flat.npz", "not (n, 3)");
    write_npz(&place.path("nan.npz"), |npz| {
        npz.array("points", &Array::from_vectors(&[Vec3::NAN]))?;
        npz.array("normals", &Array::from_vectors(&[Vec3::Y]))
    })
    .unwrap();
    refused("--points nan.npz", "point 0");
}
