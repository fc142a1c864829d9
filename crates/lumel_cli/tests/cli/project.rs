use crate::common::{Place, run};
use serde_json::Value;

/// A floor of two triangles, a metre square.
pub(crate) const FLOOR: &str = "v -0.5 0 -0.5\nv -0.5 0 0.5\nv 0.5 0 0.5\nv 0.5 0 -0.5\nf 1 2 3 4\n";

const PROJECT: &str = r#"
scene = "meshes/floor.obj"
max_edge = 0.3
two_sided = ["none"]

[[light]]
center = [0.0, 1.0, 0.0]
u = [0.2, 0.0, 0.0]
v = [0.0, 0.0, 0.2]
radiance = [10.0, 9.0, 8.0]

[[camera]]
name = "door"
position = [0.0, 1.0, 2.0]
target = [0.0, 0.0, 0.0]
fov_deg = 40.0

[bake]
preset = "draft"
bounces = 1
direct_samples = 4
indirect_samples = 4
seed = 5
"#;

fn project() -> Place {
    let place = Place::new();
    place.write("project/meshes/floor.obj", FLOOR);
    place.write("project/room.lumel.toml", PROJECT);
    place
}

#[test]
fn a_project_brings_scene_lights_cameras_and_settings() {
    let place = project();
    run(&mut place.lumel("bake project/room.lumel.toml --indirect-samples 9")).done();
    let solution = place.solution("room.npz");
    let settings = &solution.meta.settings;
    assert_eq!((&settings["seed"], &settings["bounces"]), (&5.into(), &1.into()));
    assert_eq!(settings["indirect_samples"], 9, "the command line goes first");
    assert!(solution.vertex_count() > 16, "edges are split");
    assert!(solution.irradiance.iter().all(|e| e.x > e.z && e.z > 0.0));
    let line = "render project/room.lumel.toml --solution room.npz -o a.png --camera door --size 20x15";
    run(&mut place.lumel(line)).done();
    let info = run(&mut place.lumel("info project/room.lumel.toml --json")).done();
    let info: Value = serde_json::from_str(&info.stdout).unwrap();
    assert_eq!(info["lights"].as_array().unwrap().len(), 1);
    assert_eq!(info["cameras"][0]["name"], "door");
    // Without the project's light nothing is left.
    run(&mut place.lumel("bake project/meshes/floor.obj -o a.npz")).failed("nothing emits light");
}

#[test]
fn projects_stay_in_their_folder_unless_allowed_to_leave() {
    let place = project();
    place.write("outside.obj", FLOOR);
    place.write("project/out.lumel.toml", &PROJECT.replace("meshes/floor.obj", "../outside.obj"));
    run(&mut place.lumel("bake project/out.lumel.toml -o a.npz")).failed("--allow-outside-paths");
    assert!(!place.path("a.npz").exists());
    run(&mut place.lumel("bake project/out.lumel.toml -o a.npz --allow-outside-paths")).done();
}

#[test]
fn mistakes_in_projects_are_found() {
    let place = project();
    let refused = |from: &str, to: &str, words: &str| {
        place.write("project/bad.lumel.toml", &PROJECT.replace(from, to));
        let run = run(&mut place.lumel("bake project/bad.lumel.toml -o a.npz")).failed(words);
        assert!(run.stderr.contains("bad.lumel.toml"), "{}", run.stderr);
    };
    refused("max_edge = 0.3", "max_edge = nan", "longest edge");
    refused("[bake]", "[bake]\nbounce = 2", "unknown field `bounce`");
    refused("seed = 5", "remainder = nan", "remainder");
    refused("seed = 5", "seed = ", "bad.lumel.toml");
    refused("max_edge = 0.3", "sky = [nan, 0, 0]", "sky");
    refused("direct_samples = 4", "direct_samples = 0", "direct_samples is 0 but must be");
    refused("direct_samples = 4", "direct_samples = -1", "direct_samples");
    refused("seed = 5", "bounces = 10001", "bad.lumel.toml");
    refused("u = [0.2, 0.0, 0.0]", "u = [0.0, 0.0, 0.2]", "light 1");
    assert!(!place.path("a.npz").exists());
}
