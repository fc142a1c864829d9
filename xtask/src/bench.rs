//! `cargo x bench`: which benchmark to run, and what it needs beside it.

use crate::cargo::{cargo, executable, root};
use crate::embree;
use crate::instructions::instructions;
use crate::shell::{run, say};
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// A benchmark of the workspace.
struct Benchmark {
    name: &'static str,
    package: &'static str,
    features: &'static [&'static str],
}

const BENCHMARKS: [Benchmark; 11] = [
    Benchmark { name: "rays", package: "lumel", features: &[] },
    Benchmark { name: "bake", package: "lumel", features: &[] },
    Benchmark { name: "surfaces", package: "lumel", features: &[] },
    Benchmark { name: "adaptive", package: "lumel", features: &[] },
    Benchmark { name: "points", package: "lumel", features: &[] },
    Benchmark { name: "shooting", package: "lumel", features: &[] },
    Benchmark { name: "lightmap", package: "lumel", features: &[] },
    Benchmark { name: "frame", package: "lumel_render_gpu", features: &[] },
    Benchmark { name: "point_frames", package: "lumel_render_gpu", features: &[] },
    Benchmark { name: "first_look", package: "lumel_view", features: &[] },
    Benchmark { name: "window", package: "lumel_view", features: &["--features", "inspection"] },
];

/// Compares lightmaps with those of another renderer.
const CYCLES: &str = "--cycles";

/// What runs when no name is given.
const USUAL: [&str; 2] = ["rays", "bake"];

/// Runs the benchmark that the first argument names, with the others; without a name, the usual ones.
pub(crate) fn bench(arguments: &[String]) -> Result<()> {
    let (name, rest) = match arguments.split_first() {
        Some((name, rest)) if !name.starts_with('-') => (Some(name.as_str()), rest),
        _ => (None, arguments),
    };
    let rest = with_full_paths(rest)?;
    let Some(name) = name else { return usual(&rest) };
    match name {
        "instructions" => return instructions(&rest),
        "peers" => return peers("run.py", &rest),
        "lightmap" if rest.iter().any(|argument| argument == CYCLES) => {
            let rest: Vec<String> = rest.into_iter().filter(|argument| argument != CYCLES).collect();
            return peers("run_lightmaps.py", &rest);
        }
        _ => {}
    }
    match BENCHMARKS.iter().find(|benchmark| benchmark.name == name) {
        Some(benchmark) => benchmark.run(&rest),
        None => {
            let names = BENCHMARKS.map(|benchmark| benchmark.name).join(", ");
            bail!("unknown benchmark \"{name}\"; there are {names}, peers, instructions")
        }
    }
}

/// Makes the files after `--json` and `--plot` independent of the folder that the benchmark is started in.
fn with_full_paths(arguments: &[String]) -> Result<Vec<String>> {
    let mut full = arguments.to_vec();
    for i in 1..full.len() {
        if ["--json", "--plot"].contains(&full[i - 1].as_str()) {
            full[i] = std::path::absolute(&full[i])?.to_string_lossy().into_owned();
        }
    }
    Ok(full)
}

/// Runs the usual benchmarks; a JSON file holds the results of all of them by name.
fn usual(arguments: &[String]) -> Result<()> {
    let json = arguments.iter().position(|argument| argument == "--json").map(|i| i + 1);
    let json = json.filter(|i| *i < arguments.len());
    let mut all = serde_json::Map::new();
    for benchmark in BENCHMARKS.iter().filter(|benchmark| USUAL.contains(&benchmark.name)) {
        let mut own = arguments.to_vec();
        if let Some(i) = json {
            own[i] = format!("{}.{}", arguments[i], benchmark.name);
        }
        benchmark.run(&own)?;
        // After a question for help there is no file.
        if let Some(file) = json.map(|i| &own[i]).filter(|file| Path::new(file).exists()) {
            let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {file}"))?;
            all.insert(benchmark.name.to_owned(), serde_json::from_str(&text)?);
            std::fs::remove_file(file)?;
        }
    }
    if let Some(file) = json.map(|i| &arguments[i]) {
        let text = serde_json::to_string_pretty(&all)?;
        std::fs::write(file, text).with_context(|| format!("cannot write {file}"))?;
    }
    Ok(())
}

impl Benchmark {
    fn run(&self, arguments: &[String]) -> Result<()> {
        let mut command = cargo(&["bench", "--package", self.package, "--bench", self.name]);
        command.args(self.features).arg("--").args(arguments);
        if self.name == "rays" {
            match embree::library() {
                Ok(file) => {
                    command.env(embree::VARIABLE, file);
                }
                Err(reason) => say(&format!("Embree cannot be had: {reason:#}")),
            }
        }
        run(&mut command)
    }
}

/// Compares lumel with other renderers, by a script that sets up an environment for them.
fn peers(script: &str, arguments: &[String]) -> Result<()> {
    let mut command = Command::new("python3");
    command.arg(root().join("bench/peers").join(script)).args(arguments);
    run(command.env("LUMEL_PEERS", executable("peers")?))
}
