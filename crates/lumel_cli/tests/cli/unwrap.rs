use crate::common::{Place, run};
use lumel_import::{ImportOptions, load};
use serde_json::Value;

/// A floor of one square metre, and a shelf of two sides above a quarter of it.
const FLOOR_AND_SHELF: &str = "\
o Floor
v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 1 2 3 4
o Shelf
v 0 0.5 0\nv 0 0.5 0.5\nv 0.5 0.5 0.5\nv 0.5 0.5 0\nf 5 6 7 8
";

fn report(place: &Place, line: &str) -> Value {
    let run = run(&mut place.lumel(&format!("unwrap {line} --json"))).done();
    serde_json::from_str(&run.stdout).unwrap()
}

#[test]
fn a_scene_gets_places_and_a_picture_and_comes_back() {
    let place = Place::new();
    let line = "unwrap cornell-box --subdivide 0 --lumels 65536 -o box.glb -o atlas.png";
    let text = run(&mut place.lumel(line)).done().stdout;
    for part in [
        "atlas       1 page of ",
        "charts      15 in ",
        " lumels per metre\n",
        "wrote box.glb, ",
        "wrote atlas.png, ",
    ] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    assert_eq!(place.files(), ["atlas.png", "box.glb"]);
    let imported = load(&place.path("box.glb"), &ImportOptions::default()).unwrap();
    let info = run(&mut place.lumel("info cornell-box --subdivide 0 --json")).done().stdout;
    let info: Value = serde_json::from_str(&info).unwrap();
    let triangles: usize = imported.scene.objects.iter().map(|object| object.faces.len()).sum();
    assert_eq!(triangles as u64, info["triangles"]["total"].as_u64().unwrap());
    assert!(image::open(place.path("atlas.png")).unwrap().width() >= 256);
}

#[test]
fn the_report_has_all_objects_in_numbers() {
    let place = Place::new();
    place.write("room.obj", FLOOR_AND_SHELF);
    let report = report(&place, "room.obj --two-sided none --density 20");
    assert_eq!((&report["charts"], &report["triangles"]), (&Value::from(2), &Value::from(4)));
    assert_eq!(report["density"], 20.0);
    let [floor, shelf] = [0, 1].map(|i| &report["objects"][i]);
    assert_eq!((&floor["name"], &shelf["name"]), (&Value::from("Floor"), &Value::from("Shelf")));
    assert!((floor["lumels"].as_f64().unwrap() - 400.0).abs() < 0.1, "{floor}");
    assert!((shelf["lumels"].as_f64().unwrap() - 100.0).abs() < 0.1, "{shelf}");
    assert_eq!(floor["method"], "conformal");
    assert_eq!(report["findings"], serde_json::json!([]));
    // Both sides of both.
    assert_eq!(crate::unwrap::report(&place, "room.obj --density 20")["charts"], 4);
}

#[test]
fn objects_can_be_finer_than_others() {
    let place = Place::new();
    place.write("room.obj", FLOOR_AND_SHELF);
    let report = report(&place, "room.obj --density 20 --density-factor Shelf=2");
    assert_eq!(report["objects"][1]["density"], 40.0);
    let line = "unwrap room.obj --density-factor Table=2";
    run(&mut place.lumel(line)).failed("scene \"room\" has no object \"Table\"");
    run(&mut place.lumel("unwrap room.obj --density-factor Table")).failed("it must be NAME=X");
}

#[test]
fn the_layout_of_an_unwrapped_file_is_kept_unless_a_new_one_is_wanted() {
    let place = Place::new();
    place.write("room.obj", FLOOR_AND_SHELF);
    run(&mut place.lumel("unwrap room.obj --density 20 -o own.glb")).done();
    let [kept, new] = ["", "--uv new"].map(|uv| report(&place, &format!("own.glb --density 50 {uv}")));
    assert_eq!((&kept["kept"], &kept["shared"]), (&Value::from(2), &Value::from(true)));
    assert_eq!((&new["kept"], &new["shared"]), (&Value::from(0), &Value::from(false)));
    assert_eq!(
        [&kept, &new].map(|report| &report["objects"][0]["method"]),
        [&Value::from("given"), &"conformal".into()]
    );
    let text = run(&mut place.lumel("unwrap own.glb")).done().stdout;
    let row = "kept        the lightmap coordinates of all objects, on the square that they share\n";
    assert!(text.contains(row), "{text}");
}

#[test]
fn a_project_says_how_a_scene_is_laid_out_and_the_command_line_says_it_better() {
    let place = Place::new();
    place.write("room.obj", FLOOR_AND_SHELF);
    let project = "scene = \"room.obj\"\nbasis = \"lightmap\"\ntwo_sided = [\"none\"]\n[lightmap]\ndensity = 20\ngutter = 3\n\
                   [[object]]\nname = \"Shelf\"\ndensity_factor = 2\n";
    place.write("room.lumel.toml", project);
    let densities = |line: &str| {
        let report = report(&place, &format!("room.lumel.toml {line}"));
        let density = |object: usize| report["objects"][object]["density"].as_f64().unwrap();
        ([density(0), density(1)], report["gutter"].as_u64().unwrap())
    };
    assert_eq!(densities(""), ([20.0, 40.0], 3));
    assert_eq!(densities("--density 10 --gutter 2 --density-factor Shelf=3"), ([10.0, 30.0], 2));
    let ([floor, shelf], _) = densities("--lumels 5000");
    assert!(floor != 20.0 && (shelf / floor - 2.0).abs() < 1e-5, "{floor} {shelf}");
    let sun = ["--light", "sun direction=0,-1,0 irradiance=1,1,1"];
    let bake =
        |line: &str| run(place.lumel(&format!("bake room.lumel.toml --preset draft {line}")).args(sun));
    bake("-o a.ply").failed("--basis lightmap writes no .ply files");
    let text = bake("").done().stdout;
    assert!(text.contains(" lumels of 20 per metre\n"), "{text}");
    assert!(place.path("room.exr").exists());
    bake("--basis vertex -o a.npz").done();
}

#[test]
fn several_pages_have_a_picture_each() {
    let place = Place::new();
    let line = "cornell-box --subdivide 0 --density 400 --atlas-size 512 -o atlas.png";
    let report = report(&place, line);
    let pages = report["pages"].as_array().unwrap().len();
    assert!(pages > 1, "{report}");
    let expected: Vec<String> = (0..pages).map(|page| format!("atlas-{page}.png")).collect();
    assert_eq!(report["outputs"], serde_json::json!(expected));
    assert!(expected.iter().all(|name| place.path(name).exists()));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let place = Place::new();
    for threads in [1, 3] {
        let line =
            format!("unwrap cornell-box --subdivide 2 --lumels 30000 --threads {threads} -o {threads}.glb");
        run(&mut place.lumel(&line)).done();
    }
    assert!(std::fs::read(place.path("1.glb")).unwrap() == std::fs::read(place.path("3.glb")).unwrap());
}

#[test]
fn what_did_not_go_as_asked_is_a_warning_that_names_the_object() {
    let place = Place::new();
    place.write("room.obj", FLOOR_AND_SHELF);
    let mut command = place.lumel("unwrap room.obj --density 100 --atlas-size 64 --strict");
    let run = run(&mut command);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(
        run.stderr.contains("warning: object \"Floor\": a triangle is longer than a page of 64 lumels"),
        "{}",
        run.stderr
    );
    assert!(!run.stderr.contains("Shelf"), "{}", run.stderr);
}

#[test]
fn when_time_is_up_simple_charts_are_told_of_once() {
    let place = Place::new();
    let one = run(&mut place.lumel("unwrap sphere --subdivide 0 --lumels 30000 --time-limit 0")).done();
    assert!(one.stderr.contains("it has planar charts: time was up"), "{}", one.stderr);
    let tent = |i: u32| {
        let (x, n) = (3 * i, 4 * i);
        format!(
            "o Tent{i}\ns 1\nv {x} 0 0\nv {} 0 0\nv {} 0.2 1\nv {} 0 2\nf {} {} {}\nf {} {} {}\n",
            x + 2,
            x + 1,
            x + 1,
            n + 1,
            n + 3,
            n + 2,
            n + 3,
            n + 1,
            n + 4
        )
    };
    place.write("tents.obj", &(0..30).map(tent).collect::<String>());
    let many =
        run(&mut place.lumel("unwrap tents.obj --two-sided none --lumels 30000 --time-limit 0")).done();
    for part in [
        "object \"Tent0\": it has planar charts: time was up; and 29 more like it\n",
        "note: 29 more objects or faults; `lumel unwrap --json` lists all\n",
    ] {
        assert!(many.stderr.contains(part), "{}", many.stderr);
    }
    assert_eq!(many.stderr.matches("time was up").count(), 1, "{}", many.stderr);
}

#[test]
fn mistakes_are_told_with_a_remedy() {
    let place = Place::new();
    let failed = |line: &str, words: &str| {
        let run = run(&mut place.lumel(&format!("unwrap cornell-box {line}"))).failed(words);
        assert!(run.stdout.is_empty() && place.files().is_empty(), "{line}");
    };
    failed("-o box.obj", "use a file name that ends in .glb, or in .png");
    failed("-o missing/box.glb", "does not exist");
    failed("--atlas-size 1001", "the page size is 1001; it must be a multiple of 4");
    failed("--density 0", "it must be above zero");
    failed("--density 10 --lumels 10", "cannot be used with");
    failed("--align 3", "[possible values: 1, 4]");
    failed("--gutter 17", "from 0 to 16");
}
