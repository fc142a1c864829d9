use crate::common::{Place, TINY, assert_same_light, run};
use serde_json::Value;

#[test]
fn every_kind_of_output_is_written_and_can_be_read() {
    let place = Place::new();
    let run = place.bake_furnace("-o a.npz -o b.GLB -o c.ply -o d.rad -o e.png -o f.obj").done();
    assert_eq!(place.files(), ["a.npz", "b.GLB", "c.ply", "d.rad", "e.png", "f.mtl", "f.obj"]);
    let solution = place.solution("a.npz");
    assert_eq!(solution.bounces.len(), 3);
    assert!(solution.meta.complete && solution.meta.statistics["rays"].as_u64().unwrap() > 1000);
    assert_eq!(&std::fs::read(place.path("b.GLB")).unwrap()[..4], b"glTF");
    assert!(std::fs::read(place.path("c.ply")).unwrap().starts_with(b"ply\n"));
    let rad = lumel_export::RadFile::read(&place.path("d.rad")).unwrap();
    assert_eq!(rad.values.len(), solution.vertex_count());
    let picture = image::open(place.path("e.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (960, 720));
    assert!(picture.to_rgb8().pixels().any(|pixel| pixel.0 != [0; 3]));
    let triangles = |scene: &str| -> Value {
        let info = crate::common::run(&mut place.lumel(&format!("info {scene} --json"))).done();
        serde_json::from_str::<Value>(&info.stdout).unwrap()["triangles"].clone()
    };
    assert_eq!(triangles("f.obj"), triangles("furnace"));
    for file in ["a.npz", "b.GLB", "c.ply", "d.rad", "e.png", "f.obj"] {
        assert!(run.stdout.contains(&format!("wrote {file}, ")), "{}", run.stdout);
    }
}

#[test]
fn light_by_direction_lies_beside_the_same_irradiance() {
    let place = Place::new();
    place.bake_furnace("--projection area --bounces 1 -o plain.npz").done();
    let asked = "--projection area --bounces 1 --directional sh1";
    let run = place.bake_furnace(&format!("{asked} -o a.npz -o a.glb")).done();
    assert!(run.stdout.contains("\ndirectional "), "{}", run.stdout);
    let (plain, solution) = (place.solution("plain.npz"), place.solution("a.npz"));
    assert_same_light(&plain, &solution);
    assert_eq!(
        (plain.directional, solution.directional.as_ref().unwrap().len()),
        (None, solution.vertex_count())
    );
    let glb = std::fs::read(place.path("a.glb")).unwrap();
    assert!(glb.windows(6).any(|bytes| bytes == b"_SH1R\""));
    // It is made of the bounces, which may have been computed without it.
    place.bake_furnace(&format!("{asked} --resume plain.npz -o resumed.npz")).done();
    assert_eq!(place.solution("resumed.npz").directional, solution.directional);
}

#[test]
fn the_summary_says_what_happened() {
    let place = Place::new();
    let run = place.bake_furnace("--bounces 1").done();
    assert_eq!(place.files(), ["furnace.npz"], "the default output, and no checkpoint");
    assert!(
        run.stderr.starts_with("note: needs about ") && run.stderr.lines().count() == 1,
        "{}",
        run.stderr
    );
    let solve = run.stdout.lines().find_map(|line| line.strip_prefix("solve ")).unwrap();
    let (seconds, unit) = solve.split_once(' ').unwrap();
    assert!(seconds.parse::<f64>().unwrap() >= 0.0 && unit == "s", "{solve}");
    for part in
        ["scene furnace: ", " vertices, ", "load ", "build ", "direct ", "bounce 1 ", "Mrays/s", "total "]
    {
        assert!(run.stdout.contains(part), "no {part} in {}", run.stdout);
    }
}

#[test]
fn the_summary_can_be_json() {
    let place = Place::new();
    let run = place.bake_furnace("--bounces 1 --json").done();
    let summary: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(summary["scene"], "furnace");
    assert_eq!(summary["steps"].as_array().unwrap().last().unwrap()["step"], "bounce 1");
    let shares: f64 = summary["steps"].as_array().unwrap().iter().filter_map(|s| s["share"].as_f64()).sum();
    assert!((shares - 1.0).abs() < 1e-9);
    assert_eq!(summary["files"][0]["path"], "furnace.npz");
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let place = Place::new();
    for projection in ["point", "area", "least-squares"] {
        for threads in [1, 2, 7] {
            place
                .bake_furnace(&format!(
                    "--projection {projection} --threads {threads} -o {projection}{threads}.npz"
                ))
                .done();
        }
        let one = place.solution(&format!("{projection}1.npz"));
        assert_same_light(&one, &place.solution(&format!("{projection}2.npz")));
        assert_same_light(&one, &place.solution(&format!("{projection}7.npz")));
    }
}

#[test]
fn settings_reach_the_solution() {
    let place = Place::new();
    place
        .bake_furnace(
            "--sampler halton --seed 9 --light-sampling area --bounces all --remainder 0.2 --tail geometric \
             --sky 0.1,0.2,0.3 --subdivide 0 -o a.npz",
        )
        .done();
    let solution = place.solution("a.npz");
    let settings = &solution.meta.settings;
    assert_eq!(settings["sampler"], "halton");
    assert_eq!(settings["seed"], 9);
    assert_eq!(settings["light_sampling"], "area");
    assert_eq!(settings["bounces"], "all");
    assert_eq!(settings["indirect_samples"], 8);
    assert!(solution.tail.is_some());
}

#[test]
fn lights_on_the_command_line_replace_those_of_the_scene() {
    let place = Place::new();
    let light = "rect center=0.278,0.5,0.28 u=0.05,0,0 v=0,0,0.05 radiance=1,0,0";
    let words = ["--light", light, "--max-edge", "0.2", "--bounces", "0", "-o", "a.npz"];
    run(place.lumel("bake cornell-box").args(TINY).args(words)).done();
    let sum: glam::Vec3 = place.solution("a.npz").irradiance.iter().sum();
    assert!(sum.x > 0.0 && sum.y == 0.0 && sum.z == 0.0, "{sum}");
}

#[test]
fn progress_as_json_is_one_object_a_line() {
    let place = Place::new();
    let run = place.bake_furnace("--progress json").done();
    let events: Vec<Value> = run.stderr.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let bounces: Vec<&Value> =
        events.iter().filter(|e| e["event"] == "step_done" && e["step"] == "bounce").collect();
    assert_eq!(bounces.len(), 3);
    assert!(bounces.iter().enumerate().all(|(k, e)| e["bounce"] == k && e["seconds"].is_number()));
    let failed = place.bake_furnace("--progress json --resume missing.npz");
    assert_eq!(failed.code, 2);
    let last: Value = serde_json::from_str(failed.stderr.lines().last().unwrap()).unwrap();
    assert_eq!(last["event"], "error");
    assert!(last["message"].as_str().unwrap().contains("missing.npz"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_checkpoint_that_cannot_be_written_is_told_once_and_costs_nothing_else() {
    let place = Place::new();
    let full = place.bake_furnace("-o full.npz").done();
    assert!(!full.stderr.contains("warning"), "{}", full.stderr);
    // Large enough for the .rad file, too small for any checkpoint.
    let size = std::fs::metadata(place.path("full.npz")).unwrap().len();
    let vertices = place.solution("full.npz").vertex_count() as u64;
    let (rad, blocks) = (36 + 12 * vertices, (36 + 12 * vertices) / 512 + 2);
    assert!(rad < blocks * 512 && 2 * blocks * 1024 < size, "{rad} {size}");
    let script = format!(
        "trap '' XFSZ; ulimit -f {blocks}; exec {} bake furnace {} -o a.rad",
        crate::common::LUMEL,
        TINY.join(" ")
    );
    let run = run(assert_cmd::Command::new("sh").args(["-c", &script]).current_dir(place.folder())).done();
    assert_eq!(run.stderr.matches("warning: no checkpoint").count(), 1, "{}", run.stderr);
    assert_eq!(place.files(), ["a.rad", "full.npz"]);
}

#[test]
fn strict_turns_warnings_into_exit_code_1() {
    let place = Place::new();
    place.write("a.obj", "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n");
    let words = ["--sky", "1,1,1", "-o", "a.npz"];
    let relaxed = run(place.lumel("bake a.obj").args(TINY).args(words)).done();
    assert!(relaxed.stderr.starts_with("warning: "), "{}", relaxed.stderr);
    let strict = run(place.lumel("bake a.obj --strict").args(TINY).args(words));
    assert_eq!(strict.code, 1);
    assert!(place.path("a.npz").exists());
}

#[test]
fn a_target_error_is_reached_and_told_and_every_value_has_its_standard_error() {
    let place = Place::new();
    let line = "bake sphere --bounces 2 --target-error 5% --target-share 0.9 -o a.npz";
    let run = crate::common::run(&mut place.lumel(line)).done();
    assert_eq!(place.files(), ["a.npz"], "no checkpoint is left");
    for part in
        ["8 independent solves", "round 1 ", "direct ", "within 5.0 % (target: 90.0 %)", "95 % interval"]
    {
        assert!(run.stdout.contains(part), "no {part} in {}", run.stdout);
    }
    let solution = place.solution("a.npz");
    let errors = solution.standard_error.unwrap();
    assert_eq!(errors.len(), solution.irradiance.len());
    assert!(errors.iter().any(|error| error.y > 0.0));
    assert_eq!(solution.meta.settings["target_share"].as_f64().unwrap() as f32, 0.9);
    let json = crate::common::run(&mut place.lumel(&format!("{line} --json"))).done();
    let error = serde_json::from_str::<Value>(&json.stdout).unwrap()["error"].clone();
    assert_eq!((error["reached"].as_bool(), error["ended"].as_str()), (Some(true), Some("reached")));
    assert!(error["share"].as_f64().unwrap() >= 0.9 && error["worst"].as_f64() >= error["median"].as_f64());
    let resumed = crate::common::run(&mut place.lumel(&format!("{line} --resume a.npz")));
    resumed.failed("target error");
}

#[test]
fn a_target_error_that_is_not_reached_is_said_plainly() {
    let place = Place::new();
    let line = "bake sphere --bounces 1 --target-error 0.01% --memory 12MiB -o a.npz";
    let run = crate::common::run(&mut place.lumel(line)).done();
    assert!(
        run.stdout.contains("of values are within 0.01 % (target: 95.0 %; not reached)"),
        "{}",
        run.stdout
    );
    let warning =
        "warning: the target error was not reached: more rays do not fit into memory; raise --memory";
    assert!(run.stderr.contains(warning), "{}", run.stderr);
    assert_eq!(crate::common::run(&mut place.lumel(&format!("{line} --strict"))).code, 1);
    let line = "--target-error 1% --memory 1KiB -o b.npz";
    assert!(place.bake_furnace(line).failed("stored rays").stderr.contains("--memory"));
    place.bake_furnace("--target-error 1% --solver neumann -o b.npz").failed("neumann");
    assert_eq!(place.files(), ["a.npz"]);
}

#[test]
fn progress_tells_rounds_and_what_they_reached() {
    let place = Place::new();
    let line = "bake sphere --bounces 1 --target-error 3% --progress json -o a.npz";
    let run = crate::common::run(&mut place.lumel(line)).done();
    let events = run.stderr.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let rounds: Vec<Value> = events.filter(|e| e["event"] == "step_done" && e["step"] == "round").collect();
    assert!(!rounds.is_empty(), "{}", run.stderr);
    assert!(
        rounds.iter().enumerate().all(|(k, e)| e["round"] == k + 1 && e["share_below_target"].is_number())
    );
}
