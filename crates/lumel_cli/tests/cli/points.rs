use crate::common::{Place, TINY, run};
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
    let few = run(place.lumel("bake a.lumel.toml -o b.npz").args(TINY).args(["--point-spacing", few])).done();
    assert!(few.stderr.contains("about 900 points"), "{}", few.stderr);
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
    refused("--basis points --point-spacing 1e-7 -o a.npz", "use a --point-spacing of at least");
    refused("--basis points --point-spacing fine -o a.npz", "a length in metres greater than zero");
    refused("--basis points -o a.exr", "--basis points writes no .exr files");
}
