//! `cargo x`: tests, checks and benchmarks of the lumel workspace.

mod arm;
mod bench;
mod browser;
mod cargo;
mod embree;
mod fuzz;
mod instructions;
mod licences;
mod manifests;
mod metadata;
mod node;
mod shell;
mod system;
mod tidy;
mod tools;

use anyhow::{Result, bail};
use cargo::cargo;
use shell::{run, say};
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo x COMMAND [ARGUMENTS]

  test [ARGUMENTS]   set up what the tests need, then run all of them; arguments go to `cargo test`
  arm [ARGUMENTS]    run the tests of the ray tracer as compiled for 64-bit ARM, in an emulator (needs qemu-user)
  ci                 what has to pass before a change lands: fmt, clippy, test, doc, tidy
  tidy               check file lengths, the crate graph, manifests, licences, unfinished marks and where pi is used
  licences FILE      write the licences of all packages that the programs contain
  fuzz TARGET [SECONDS]
                     feed a reader inputs that a fuzzer makes up, for ten minutes (needs cargo-fuzz and a C++ compiler)
  bench [ARGUMENTS]  measure ray tracing and solving: `rays` and `bake`; arguments go to them, as does --help
  bench rays         measure ray tracing against Embree 4, which it fetches from PyPI
  bench bake         measure solves
  bench surfaces     measure the projections: power and error of light over all surfaces
  bench adaptive     measure meshes that follow light beside uniform ones: time, and error over all surfaces
  bench lightmap     measure lightmaps beside light at vertices: time, and error over all surfaces
  bench instructions count instructions of the ray tracer's kernels (needs valgrind)
  bench peers        measure Mitsuba, Blender Cycles and Radiance beside lumel; fetches them from PyPI
  bench frame        measure what a picture costs on this machine's graphics device
  bench point_frames measure what a picture of light at scattered points costs there
  bench window       measure what an open window costs, and how much it slows a solve (needs Xvfb and xdotool)
";

fn main() -> ExitCode {
    match dispatch() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error:#}"));
            ExitCode::from(2)
        }
    }
}

fn dispatch() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().unwrap_or_default();
    let rest: Vec<String> = arguments.collect();
    match command.as_str() {
        "test" => test(&rest),
        "arm" => arm::test(&rest),
        "ci" => ci(),
        "tidy" => tidy::tidy(),
        "licences" => licences::write(&rest),
        "fuzz" => fuzz::fuzz(&rest),
        "bench" => bench::bench(&rest),
        _ => bail!("unknown command \"{command}\"\n\n{USAGE}"),
    }
}

/// Features of all builds here: with the same ones everywhere, nothing is built twice.
const FEATURES: [&str; 2] = ["--features", "lumel_view/inspection"];

/// A Cargo command on all crates.
fn cargo_on_all(command: &str) -> Command {
    let mut command = cargo(&[command, "--workspace"]);
    command.args(FEATURES);
    command
}

fn test(arguments: &[String]) -> Result<()> {
    let mut command = cargo_on_all("test");
    command.args(arguments);
    tools::provide(&mut command)?;
    system::provide()?;
    run(&mut command)?;
    if !arguments.is_empty() {
        return Ok(());
    }
    for instructions in lesser_instructions() {
        say(&format!("tests of light transport with {instructions} instructions"));
        let mut command = cargo_on_all("test");
        run(command.args(["--test", "physics"]).env("LUMEL_TEST_INSTRUCTIONS", instructions))?;
    }
    Ok(())
}

/// Instruction sets that this machine has, but would not use.
fn lesser_instructions() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") {
        return vec!["portable", "avx2"];
    }
    vec!["portable"]
}

fn ci() -> Result<()> {
    run(&mut cargo(&["fmt", "--all", "--check"]))?;
    tidy::tidy()?;
    let mut clippy = cargo_on_all("clippy");
    clippy.args(["--all-targets", "--", "-D", "warnings"]);
    run(&mut clippy)?;
    let mut doc = cargo_on_all("doc");
    doc.arg("--no-deps").env("RUSTDOCFLAGS", "-D warnings");
    run(&mut doc)?;
    test(&[])
}
