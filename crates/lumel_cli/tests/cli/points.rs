use crate::common::{Place, TINY, run};
use lumel_export::Solution;
use serde_json::Value;

#[test]
fn light_is_carried_on_points_and_read_measured_compared_and_drawn_at_vertices() {
    let place = Place::new();
    let bake = place.bake_furnace("--basis points --point-spacing 0.1 -o a.npz -o a.glb -o a.png").done();
    assert!(bake.stdout.contains("points carried the bounces, 0.1 m from each other"), "{}", bake.stdout);
    assert!(bake.stdout.contains("direct at vertices"), "{}", bake.stdout);
    assert!(bake.stderr.contains("scatters about") && bake.stderr.contains("of memory"), "{}", bake.stderr);
    let solution = place.solution("a.npz");
    let points = solution.points.as_ref().unwrap();
    assert!(points.len() > 300 && points.radii.iter().all(|radius| *radius == 0.2));
    // Half of the light is reflected each time, in a furnace of albedo one half.
    for bounces in [&points.bounces, &solution.bounces] {
        let halves = bounces[0].iter().zip(&bounces[1]).map(|(direct, bounce)| bounce.y / direct.y);
        assert!(halves.into_iter().all(|half| (half - 0.5).abs() < 0.01));
    }
    let line = "measure furnace --solution a.npz --point 0,-0.4,0.3 --normal 0,1,0 --json";
    let measured: Value = serde_json::from_str(&run(&mut place.lumel(line)).done().stdout).unwrap();
    let [direct, bounce] = [0, 1].map(|k| measured["bounces"][k][0][1].as_f64().unwrap());
    assert!((bounce / direct - 0.5).abs() < 0.02, "{measured}");
    run(&mut place.lumel("render furnace --solution a.npz --bounce 1 -o b.png")).done();
    place.bake_furnace("-o b.npz").done();
    run(&mut place.lumel("compare a.npz b.npz --max-error 0.02")).done();
    let resumed = place.bake_furnace("--basis points --point-spacing 0.1 --resume a.npz -o c.npz").done();
    assert!(resumed.stdout.contains("direct from the checkpoint"), "{}", resumed.stdout);
    assert_eq!(place.solution("c.npz").irradiance, solution.irradiance);
}

#[test]
fn a_project_may_have_points_as_its_basis_and_the_command_line_another() {
    let place = Place::new();
    place.write("a.lumel.toml", "builtin = \"furnace\"\nbasis = \"points\"\n[bake]\npreset = \"draft\"\n");
    let points = |options: &str| {
        run(place.lumel(&format!("bake a.lumel.toml -o a.npz {options}")).args(TINY)).done();
        place.solution("a.npz").points.map(|points| points.len())
    };
    let by_preset = points("").unwrap();
    // 12 500 of a draft, within what borders and density make of it.
    assert!((11_500..13_500).contains(&by_preset), "{by_preset}");
    assert_eq!(points("--basis vertex"), None);
    let few = "900 points";
    let line = "bake a.lumel.toml -o b.npz --levels 2";
    let few = run(place.lumel(line).args(TINY).args(["--point-spacing", few])).done();
    assert!(few.stderr.contains("about 1125 points") && few.stdout.contains("on 2 levels"), "{}", few.stderr);
}

#[test]
fn what_does_not_go_together_with_points_is_refused() {
    let place = Place::new();
    let refused = |options: &str, reason: &str| drop(place.bake_furnace(options).failed(reason));
    refused("--basis points --adaptive 5% -o a.npz", "adaptive");
    refused("--basis points --layers lights -o a.npz", "layers");
    refused("--basis points --directional sh1 -o a.npz", "directional");
    refused("--basis vertex --point-spacing 0.1 -o a.npz", "use --basis points");
    refused("--basis points --point-spacing off -o a.npz", "exclude each other");
    refused("--levels 2 -o a.npz", "levels are levels of points");
    refused("--basis points --levels 2 --target-error 5% -o a.npz", "target_error");
    refused("--basis points --point-spacing 1e-7 -o a.npz", "use a --point-spacing of at least");
    refused("--basis points --point-spacing fine -o a.npz", "a length in metres greater than zero");
    refused("--basis points -o a.exr", "--basis points writes no .exr files");
}

#[test]
fn pictures_show_indirect_light_of_the_points_and_direct_light_of_the_vertices() {
    let place = Place::new();
    let line = "bake cornell-box --basis points --levels 2 -o a.npz -o a.png";
    run(place.lumel(line).args(TINY).args(["--point-spacing", "2000 points", "--bounces", "1"])).done();
    let at_vertices = Solution { points: None, ..place.solution("a.npz") };
    at_vertices.save(&place.path("b.npz")).unwrap();
    let picture = |options: &str| {
        run(&mut place.lumel(&format!("render cornell-box -o b.png --exposure 0 --size 64x48 {options}")))
            .done();
        std::fs::read(place.path("b.png")).unwrap()
    };
    assert!(picture("--solution a.npz --bounce 0") == picture("--solution b.npz --bounce 0"));
    assert!(picture("--solution a.npz --bounce 1") != picture("--solution b.npz --bounce 1"));
    // The picture of a bake is that of its solution.
    run(&mut place.lumel("render cornell-box --solution a.npz -o c.png")).done();
    let [baked, rendered] = ["a.png", "c.png"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert!(baked == rendered);
}
