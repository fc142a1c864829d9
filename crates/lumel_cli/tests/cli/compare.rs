use crate::common::{Place, run};
use serde_json::Value;

#[test]
fn a_solution_does_not_differ_from_itself() {
    let place = Place::new();
    place.bake_furnace("-o a.npz -o a.rad").done();
    let same = run(&mut place.lumel("compare a.npz a.npz --max-error 0")).done();
    for name in ["direct", "bounce 1", "bounce 2", "sum"] {
        assert!(same.stdout.lines().any(|line| line.starts_with(name)), "{}", same.stdout);
    }
    // Division by pi and back rounds twice.
    for line in [
        "compare a.rad a.npz --max-error 1e-6",
        "compare a.npz a.rad --max-error 1e-6",
        "compare a.rad a.rad",
    ] {
        run(&mut place.lumel(line)).done();
    }
}

#[test]
fn noise_is_measured_and_limited() {
    let place = Place::new();
    // A light, as the furnace itself has no noise.
    let light = "rect center=0,0.4,0 u=0.2,0,0 v=0,0,0.2 radiance=9,9,9";
    for seed in ["1", "2"] {
        let words = ["--no-emissive", "--light", light, "--bounces", "1", "--seed", seed, "-o"];
        run(place.lumel("bake furnace").args(crate::common::TINY).args(words).arg(format!("{seed}.npz")))
            .done();
    }
    let json = run(&mut place.lumel("compare 1.npz 2.npz --json")).done();
    let found: Value = serde_json::from_str(&json.stdout).unwrap();
    let sum = &found["sum"];
    let relative = sum["relative_rmse"].as_f64().unwrap();
    assert!(relative > 1e-4 && relative < 0.5, "{relative}");
    assert!((sum["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.05);
    assert!(sum["correlation"].as_f64().unwrap() > 0.9);
    assert!(sum["percentiles"]["p50"].as_f64() < sum["percentiles"]["p100"].as_f64());
    assert_eq!(found["bounces"].as_array().unwrap().len(), 2);
    let code = |limit: f64| run(&mut place.lumel(&format!("compare 1.npz 2.npz --max-error {limit}"))).code;
    assert_eq!((code(relative * 0.9), code(relative * 1.1)), (1, 0));
}

#[test]
fn light_on_other_vertices_is_refused_by_name() {
    let place = Place::new();
    place.bake_furnace("--bounces 0 -o furnace.npz -o furnace.rad").done();
    let words = ["--preset", "draft", "--bounces", "0", "--direct-samples", "1", "--indirect-samples", "1"];
    run(place.lumel("bake sphere -o sphere.npz").args(words)).done();
    let refused = run(&mut place.lumel("compare furnace.npz sphere.npz")).failed("\"furnace\"");
    assert!(refused.stderr.contains("\"sphere\"") && refused.stderr.contains("hint:"), "{}", refused.stderr);
    run(&mut place.lumel("compare furnace.rad sphere.npz")).failed("MD5");
    run(&mut place.lumel("compare missing.npz sphere.npz")).failed("missing.npz");
    for bad in ["nan", "-1", "x"] {
        run(&mut place.lumel(&format!("compare furnace.npz furnace.npz --max-error {bad}")))
            .failed("--max-error");
    }
}
