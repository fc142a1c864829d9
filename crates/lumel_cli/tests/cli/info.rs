use crate::common::{Place, run};
use crate::project::FLOOR;
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
fn lengths_of_edges_are_told_and_what_would_suit() {
    let place = Place::new();
    place.write("floor.obj", FLOOR);
    let info = |line: &str| -> Value {
        let run = run(&mut place.lumel(&format!("info {line} --json"))).done();
        serde_json::from_str(&run.stdout).unwrap()
    };
    let (floor, diagonal) = (info("floor.obj"), 2f64.sqrt());
    let close = |value: &Value, wanted: f64| (value.as_f64().unwrap() / wanted - 1.0).abs() < 1e-6;
    // Four sides and a diagonal that two triangles share; the sheet has two sides.
    for (quantile, length) in
        [("min", 1.0), ("p5", 1.0), ("median", 1.0), ("p95", diagonal), ("max", diagonal)]
    {
        assert!(close(&floor["edges"][quantile], length), "{quantile} in {floor}");
    }
    assert!(close(&floor["auto"]["max_edge"], diagonal / 63.9), "{floor}");
    run(&mut place.lumel("bake floor.obj -o floor.npz --sky 1,1,1 --bounces 0 --preset draft")).done();
    assert_eq!(floor["auto"]["vertices"], place.solution("floor.npz").vertex_count());
    let text = run(&mut place.lumel("info floor.obj")).done().stdout;
    assert!(text.contains("edges       1 to 1.4142 m; 5% 1 m, median 1 m, 95% 1.4142 m"), "{text}");
    assert!(text.contains("max-edge    auto splits to at most 0.022132 m: 8450 vertices"), "{text}");

    // Where a length is given, edges are split, and nothing else would be chosen.
    let split = info("floor.obj --max-edge 0.4");
    assert!(split["edges"]["max"].as_f64().unwrap() <= 0.4 && split["auto"].is_null(), "{split}");
    assert_eq!(info("floor.obj --max-edge 40cm"), split);
    place.write("floor.lumel.toml", "scene = \"floor.obj\"\n");
    assert_eq!(info("floor.lumel.toml")["auto"], floor["auto"], "projects stay as they are, too");
    let fine = info("furnace --subdivide 5");
    assert_eq!((&fine["auto"]["max_edge"], &fine["auto"]["vertices"]), (&Value::Null, &fine["vertices"]));
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
fn lights_and_layers_have_the_names_that_pictures_of_them_are_asked_for_by() {
    let place = Place::new();
    let rect = "rect center=0,0.4,0 u=0.1,0,0 v=0,0,0.1 radiance=1,2,3";
    let named = format!("{rect} name=lamp");
    let info = |more: &[&str]| {
        let lights = ["--light", named.as_str(), "--light", rect, "--light", named.as_str()];
        let mut command = place.lumel("info furnace --sky 1,0,0.5");
        run(command.args(lights).args(more)).done().stdout
    };
    let json: Value = serde_json::from_str(&info(&["--json"])).unwrap();
    let names = |list: &str| -> Vec<String> {
        let entries = json[list].as_array().unwrap().iter();
        entries.map(|entry| entry["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names("lights"), ["lamp", "light 2", "lamp"]);
    let layers = names("layers");
    assert_eq!(
        (&layers[..3], json["layers"][0]["lights"].as_u64()),
        (&["lamp".into(), "light 2".into(), "sky".into()][..], Some(2))
    );
    let text = info(&[]);
    for part in ["\"light 2\" rectangle", "\"lamp\": a group of 2 lights", " \"sky\"\n"] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    // Every layer is one that a picture can show.
    let bake = |line: &str| {
        let mut command = place.lumel(line);
        command.args(["--sky", "1,0,0.5", "--light", &named, "--light", rect, "--light", &named]);
        run(command.args(crate::common::TINY)).done();
    };
    bake("bake furnace --bounces 1 --layers lights -o a.npz");
    let solution = place.solution("a.npz");
    assert_eq!(solution.layers.iter().map(|layer| layer.name.clone()).collect::<Vec<_>>(), layers);
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
    let warnings: Vec<&str> =
        info["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap()).collect();
    let [_, dark] = warnings[..] else { panic!("{warnings:?}") };
    assert!(
        dark.starts_with("nothing emits light in scene \"a\"; add a light that suits the scene: --sky "),
        "{dark}"
    );
    let lit = run(&mut place.lumel("info a.obj --sky 1,1,1 --json")).done();
    assert!(!lit.stdout.contains("nothing emits light"), "{}", lit.stdout);
    // Two faces in one place: the edges of both are the same.
    place.write("b.obj", "v 0 0 0\nv 3 0 0\nv 0 0 -4\nf 1 2 3\nf 1 3 2\n");
    let doubled = run(&mut place.lumel("info b.obj --json")).done();
    let doubled: Value = serde_json::from_str(&doubled.stdout).unwrap();
    assert_eq!((&doubled["edges"]["min"], &doubled["edges"]["max"]), (&3.0.into(), &5.0.into()));
}
