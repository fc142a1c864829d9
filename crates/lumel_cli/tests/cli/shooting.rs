use crate::common::{Place, TINY, run};
use serde_json::Value;

#[test]
fn light_is_shot_measured_and_drawn_but_single_bounces_are_refused_with_a_remedy() {
    let place = Place::new();
    let bake = place.bake_furnace("--schedule shoot -o a.npz").done();
    let shots = bake.stdout.lines().find(|line| line.contains(" shots ")).unwrap();
    assert!(shots.ends_with("of the light") && bake.stdout.contains("in what is unshot"), "{}", bake.stdout);
    let solution = place.solution("a.npz");
    assert_eq!((solution.bounces.len(), solution.tail.is_some()), (1, true));
    // E = π Lₑ/(1 − ρ): 2 in a furnace of albedo one half; direct light is half of it.
    for (all, direct) in solution.irradiance.iter().zip(&solution.bounces[0]) {
        assert!((all.y / direct.y - 2.0).abs() < 0.02, "{all} of {direct}");
    }
    let refused = run(&mut place.lumel("render furnace --solution a.npz --bounce 1 -o a.png"));
    refused.failed("bake with the schedule gather");
    run(&mut place.lumel("render furnace --solution a.npz --bounce 0 -o a.png")).done();
    let line = "measure furnace --solution a.npz --point 0.5,0.01,0.5 --normal 0,1,0 --json";
    let measured: Value = serde_json::from_str(&run(&mut place.lumel(line)).done().stdout).unwrap();
    let [all, direct] = [&measured["irradiance"][0][1], &measured["bounces"][0][0][1]];
    let ratio = all.as_f64().unwrap() / direct.as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 0.05, "{measured}");
}

#[test]
fn a_number_of_bounces_cannot_be_shot() {
    let place = Place::new();
    let refused = place.bake_furnace("--schedule shoot --bounces 3 -o a.npz").failed("bounces all");
    assert!(refused.stderr.contains("schedule shoot"), "{}", refused.stderr);
    place.write("a.lumel.toml", "scene = \"furnace\"\n[bake]\nschedule = \"shoot\"\npreset = \"draft\"\n");
    run(place.lumel("bake a.lumel.toml -o b.npz").args(TINY)).done();
    assert!(place.solution("b.npz").meta.is_shot());
    place.bake_furnace("--schedule wait").failed("gather, shoot");
}

#[test]
fn progress_tells_shots() {
    let place = Place::new();
    let line = "bake sphere --schedule shoot --remainder 0.01 --progress json -o a.npz";
    let run = run(place.lumel(line).args(TINY)).done();
    let events = run.stderr.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let shots: Vec<Value> = events.filter(|e| e["event"] == "step_done" && e["step"] == "shot").collect();
    assert!(shots.len() > 3 && shots.iter().enumerate().all(|(k, e)| e["shot"] == k + 1), "{}", run.stderr);
    let missing: Vec<f64> = shots.iter().map(|e| e["remainder"].as_f64().unwrap()).collect();
    assert!(missing.is_sorted_by(|a, b| a > b) && missing.last() < Some(&0.01), "{missing:?}");
}
