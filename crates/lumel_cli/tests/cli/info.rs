use crate::common::{Place, run};
use serde_json::Value;

#[test]
fn a_scene_is_described_in_numbers() {
    let place = Place::new();
    let run = run(&mut place.lumel("info furnace --json")).done();
    let info: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(info["name"], "furnace");
    assert_eq!(info["triangles"]["traced"], info["triangles"]["total"]);
    assert!((info["area"].as_f64().unwrap() - 6.0).abs() < 1e-4);
    assert_eq!(info["size"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(info["emissive"]["triangles"], info["triangles"]["total"]);
    assert!(info["vertices"].as_u64().unwrap() > 8 && info["cameras"][0]["name"].is_string());
}

#[test]
fn the_text_names_everything() {
    let place = Place::new();
    let text = run(&mut place.lumel("info cornell-box")).done().stdout;
    for part in
        ["cornell-box", "\"short block\"", "albedo 0.73826", "rectangle 0.13 x 0.105 m", "\"front\"", "m²"]
    {
        assert!(text.contains(part), "no {part} in {text}");
    }
    assert!(text.lines().all(|line| line.starts_with(' ') || line.find(' ') < Some(12)), "{text}");
}

#[test]
fn lights_and_sky_of_the_command_line_are_shown() {
    let place = Place::new();
    let light = "rect center=0,0.4,0 u=0.5,0,0 v=0,0,0.25 radiance=1,2,3";
    let run = run(place.lumel("info furnace --json --sky 1,0,0.5").args(["--light", light])).done();
    let info: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(info["lights"][0]["kind"], "rect");
    assert_eq!(info["lights"][0]["normal"], serde_json::json!([0.0, -1.0, 0.0]));
    // That of a diffuse emitter of half a square metre.
    let power = info["lights"][0]["power"][1].as_f64().unwrap();
    assert!((power - 4.0 * 1.0_f64.atan()).abs() < 1e-5, "{power}");
    assert_eq!(info["sky"], serde_json::json!([1.0, 0.0, 0.5]));
}

#[test]
fn warnings_are_part_of_the_description() {
    let place = Place::new();
    place.write("a.obj", "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n");
    let text = run(&mut place.lumel("info a.obj")).done();
    assert!(text.stderr.contains("warning: ") && text.stderr.contains("missing.mtl"), "{}", text.stderr);
    let json = run(&mut place.lumel("info a.obj --json --strict"));
    assert_eq!((json.code, json.stderr.as_str()), (1, ""));
    let info: Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(info["warnings"].as_array().unwrap().len(), 1);
}
