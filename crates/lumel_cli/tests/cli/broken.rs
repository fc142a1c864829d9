use crate::common::{Place, run};
use serde_json::Value;
use std::path::Path;

/// Broken scene files from other projects, which lie beside the workspace where there are any.
const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/loader-cases");

#[test]
fn broken_scenes_are_errors_that_leave_no_output() {
    let cases = Path::new(CASES);
    let Ok(manifest) = std::fs::read_to_string(cases.join("manifest.json")) else {
        assert!(std::env::var_os("CI").is_none(), "there are no loader cases in {CASES}");
        println!("skipped: there are no loader cases in {CASES}");
        return;
    };
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let mut n_cases = 0;
    for case in manifest["cases"].as_array().unwrap().iter().filter(|case| case["outcome"] == "error") {
        let place = Place::new();
        let file = cases.join(case["file"].as_str().unwrap());
        let words = ["--sky", "1,1,1", "--preset", "draft", "-o", "a.npz", "-o", "a.glb"];
        let run = run(place.lumel("bake").arg(&file).args(words)).failed("error: ");
        assert!(run.stderr.contains(file.file_name().unwrap().to_str().unwrap()), "{}", run.stderr);
        assert!(place.files().is_empty(), "{}: {:?}", file.display(), place.files());
        n_cases += 1;
    }
    assert!(n_cases > 10);
}

#[test]
fn damaged_files_of_our_own_are_errors() {
    let place = Place::new();
    place.bake_furnace("--bounces 0 -o a.npz -o a.glb").done();
    for (file, line) in [("a.npz", "compare a.npz a.npz"), ("a.glb", "info a.glb")] {
        let whole = std::fs::read(place.path(file)).unwrap();
        for part in [0, 1, 10, 100, whole.len() / 2, whole.len() - 1] {
            std::fs::write(place.path(file), &whole[..part]).unwrap();
            run(&mut place.lumel(line)).failed(file);
        }
        let mut damaged = whole.clone();
        damaged[whole.len() / 2..].iter_mut().step_by(97).for_each(|byte| *byte ^= 0x55);
        std::fs::write(place.path(file), &damaged).unwrap();
        let run = run(&mut place.lumel(line));
        assert!([0, 2].contains(&run.code) && !run.stderr.contains("bug in lumel"), "{}", run.stderr);
    }
}
