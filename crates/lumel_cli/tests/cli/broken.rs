use crate::common::{Place, run};
use lumel_testkit::shared;
use serde_json::Value;
use std::path::Path;

/// Scene files that cannot be loaded.
const BROKEN: [(&str, &str); 12] = [
    ("empty.obj", ""),
    ("points-only.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
    ("index-too-large.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
    ("index-zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
    ("not-a-number.obj", "v 0 zero 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("empty.gltf", ""),
    ("not-json.gltf", "{ asset: "),
    ("no-meshes.gltf", r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "scene": 0}"#),
    ("future.gltf", r#"{"asset": {"version": "3.0", "minVersion": "3.0"}}"#),
    (
        "cycle.gltf",
        r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0,
        "nodes": [{"children": [1]}, {"children": [0]}]}"#,
    ),
    (
        "buffer-missing.gltf",
        r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0,
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "missing.bin"}]}"#,
    ),
    (
        "too-short.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n",
    ),
];

#[test]
fn broken_scenes_are_errors_that_leave_no_output() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in BROKEN {
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        assert_refused(&file);
    }
}

#[test]
fn broken_scenes_of_other_projects_are_errors_that_leave_no_output() {
    let Some(cases) = shared::path_or_skip("loader-cases") else { return };
    let manifest = std::fs::read_to_string(cases.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let mut n_cases = 0;
    for case in manifest["cases"].as_array().unwrap().iter().filter(|case| case["outcome"] == "error") {
        assert_refused(&cases.join(case["file"].as_str().unwrap()));
        n_cases += 1;
    }
    assert!(n_cases > 10);
}

/// Checks that a bake of a file fails with an error that names it, and writes nothing.
#[track_caller]
fn assert_refused(file: &Path) {
    let place = Place::new();
    let words = ["--sky", "1,1,1", "--preset", "draft", "-o", "a.npz", "-o", "a.glb"];
    let run = run(place.lumel("bake").arg(file).args(words)).failed("error: ");
    assert!(run.stderr.contains(file.file_name().unwrap().to_str().unwrap()), "{}", run.stderr);
    assert!(place.files().is_empty(), "{}: {:?}", file.display(), place.files());
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
