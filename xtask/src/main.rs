//! `cargo x`: tests, checks and benchmarks of the lumel workspace.

mod tidy;
mod tools;

use anyhow::{Context, Result, bail};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo x COMMAND [ARGUMENTS]

  test [ARGUMENTS]   set up what the tests need, then run all of them; arguments go to `cargo test`
  ci                 what has to pass before a change lands: fmt, clippy, test, doc, tidy
  tidy               check file lengths, the crate graph, licences, unfinished marks and where pi is used
  bench [ARGUMENTS]  measure ray tracing and solving; arguments go to the benchmark, see `cargo x bench --help`
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

/// Prints a line on stderr; a closed one is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

fn dispatch() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().unwrap_or_default();
    let rest: Vec<String> = arguments.collect();
    match command.as_str() {
        "test" => test(&rest),
        "ci" => ci(),
        "tidy" => tidy::tidy(),
        "bench" => bench(&rest),
        _ => bail!("unknown command \"{command}\"\n\n{USAGE}"),
    }
}

/// The root of the workspace.
fn root() -> PathBuf {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    here.parent().map_or(here.clone(), PathBuf::from)
}

fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

fn run(mut command: Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {command:?}"))?;
    if !status.success() {
        bail!("{command:?} failed: {status}");
    }
    Ok(())
}

fn test(arguments: &[String]) -> Result<()> {
    let mut command = cargo(&["test", "--workspace"]);
    command.args(arguments);
    tools::provide(&mut command)?;
    run(command)
}

fn ci() -> Result<()> {
    run(cargo(&["fmt", "--all", "--check"]))?;
    tidy::tidy()?;
    run(cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    let mut doc = cargo(&["doc", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    run(doc)?;
    test(&[])
}

fn bench(arguments: &[String]) -> Result<()> {
    let mut command = cargo(&["bench", "--package", "lumel", "--bench", "bake", "--"]);
    command.args(arguments);
    run(command)
}
