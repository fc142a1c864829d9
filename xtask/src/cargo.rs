//! Cargo, and where it builds.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    here.parent().map_or(here.clone(), PathBuf::from)
}

pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// A benchmark of the package `lumel`, compiled.
pub(crate) fn executable(name: &str) -> Result<PathBuf> {
    let mut build = cargo(&["bench", "--package", "lumel", "--bench", name, "--no-run"]);
    build.arg("--message-format=json").stderr(Stdio::inherit());
    let output = build.output()?;
    if !output.status.success() {
        bail!("the benchmark cannot be compiled");
    }
    let messages = String::from_utf8(output.stdout)?;
    let mut executables = messages.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        let is_it = message["target"]["name"] == name;
        is_it.then(|| message["executable"].as_str().map(PathBuf::from)).flatten()
    });
    executables.next_back().with_context(|| format!("cargo names no executable for the benchmark {name}"))
}
