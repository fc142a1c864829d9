//! The program in the README is the one that runs as a test of [`lumel::Bake`].

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

const README: &str = include_str!("../../../README.md");
const DOCUMENTED: &str = include_str!("../src/bake.rs");

/// The lines between two that are fences of code, without those that documentation hides.
fn program<'a>(lines: impl Iterator<Item = &'a str>, fence: &str) -> Vec<&'a str> {
    let code = lines.skip_while(|line| *line != fence).skip(1).take_while(|line| *line != "```");
    code.filter(|line| !line.starts_with('#')).collect()
}

#[test]
fn the_program_in_the_readme_is_the_documented_one() {
    let readme = program(README.lines(), "```rust");
    let documented = DOCUMENTED.lines().filter_map(|line| line.strip_prefix("///"));
    let documented = program(documented.map(|line| line.strip_prefix(' ').unwrap_or(line)), "```");
    assert!(readme.len() > 10, "{readme:?}");
    assert_eq!(readme, documented);
}
