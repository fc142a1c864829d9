//! Every example runs. `cargo test` without a target builds them beside the tests.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use std::path::PathBuf;
use std::process::Command;

/// Runs an example without arguments and returns what it prints.
fn run(name: &str) -> String {
    let tests: PathBuf = std::env::current_exe().unwrap();
    let folder = tests.parent().and_then(|deps| deps.parent()).unwrap().join("examples");
    let program = folder.join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let hint = "build the examples first: `cargo build -p lumel --examples`";
    let output =
        Command::new(&program).output().unwrap_or_else(|e| panic!("{}: {e}; {hint}", program.display()));
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// The first number on a line of what an example prints.
fn number(text: &str, line: &str) -> f32 {
    let line =
        text.lines().find_map(|l| l.strip_prefix(line)).unwrap_or_else(|| panic!("no {line:?} in {text}"));
    let digits = |c: char| c.is_ascii_digit() || c == '.';
    line.split(|c| !digits(c)).find_map(|word| word.parse().ok()).unwrap()
}

#[test]
fn bake_in_memory_lights_the_side_of_the_wall_that_faces_the_light() {
    let text = run("bake_in_memory").replace(['[', ']'], " ");
    let [towards, away] = ["wall, towards light", "wall, away from it"].map(|line| number(&text, line));
    assert!(towards > 2.0 * away && away > 0.0, "{text}");
}

#[test]
fn bake_file_bakes_the_cornell_box() {
    assert_eq!(number(&run("bake_file"), "cornell-box:"), 10719.0);
}

#[test]
fn relight_live_traces_hemisphere_rays_in_the_first_frame_only() {
    let text = run("relight_live");
    let rays = |frame: &str| {
        let line = text.lines().find(|line| line.starts_with(frame)).unwrap();
        let word = line.split(", ").nth(1).and_then(|part| part.split_whitespace().next());
        word.unwrap().parse::<u64>().unwrap()
    };
    assert!(rays("frame 3") < rays("frame 0") / 2, "{text}");
}

#[test]
fn layers_add_up_and_are_dimmed_without_a_solve() {
    let text = run("layers");
    let [ceiling, bulb, all, dimmed] = ["ceiling", "bulb", "all", "dimmed"].map(|line| number(&text, line));
    assert!((ceiling + bulb - all).abs() < 2e-4 && (0.5 * ceiling + bulb - dimmed).abs() < 2e-4, "{text}");
    assert!(ceiling > 0.1 && bulb > 0.1, "{text}");
}

#[test]
fn measure_points_tells_seven_values_with_their_errors() {
    assert_eq!(run("measure_points").lines().filter(|line| line.contains('±')).count(), 7);
}

#[test]
fn own_basis_agrees_with_the_vertex_basis() {
    assert!(run("own_basis").contains("20032 triangles"));
}

#[test]
fn own_transport_agrees_with_the_operator_it_is_made_from() {
    assert!(run("own_transport").contains("a matrix of"));
}
