//! `cargo x bench instructions`: instructions of the kernels, counted by callgrind.
//!
//! Counts do not depend on what else the machine does, so they show small regressions. Valgrind 3.19 and earlier know
//! no AVX-512: what is counted then is the AVX2 path.

use crate::cargo::executable;
use crate::embree;
use crate::shell::say;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::process::Command;

/// Counts all workloads, or those whose names follow, prints them and writes them to the file after `--json`.
pub(crate) fn instructions(arguments: &[String]) -> Result<()> {
    let mut names = Vec::new();
    let mut json_file = None;
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--json" => json_file = Some(rest.next().context("--json needs a file")?),
            name if name.starts_with('-') => {
                bail!("usage: cargo x bench instructions [--json FILE] [WORKLOAD]...")
            }
            name => names.push(name.to_owned()),
        }
    }
    let version = Command::new("valgrind").arg("--version").output();
    let Ok(version) = version else {
        bail!("there is no valgrind to count instructions with; try `apt-get install valgrind`");
    };
    let version = String::from_utf8_lossy(&version.stdout).trim().to_owned();
    let program = executable("rays")?;
    let library = embree::library();
    let start = |mut command: Command| {
        if let Ok(library) = &library {
            command.env(embree::VARIABLE, library);
        }
        command.output().with_context(|| format!("cannot start {command:?}"))
    };
    if names.is_empty() {
        let mut list = Command::new(&program);
        list.args(["--workload", "all"]);
        names = String::from_utf8(start(list)?.stdout)?.lines().map(str::to_owned).collect();
    }
    println(&format!("{version}, Cornell box of 40,064 triangles\n"));
    println(&format!("{:<28}{:<12}{:>24}", "", "with", "instructions per ray"));
    let mut results = Vec::new();
    for name in names {
        let mut command = Command::new("valgrind");
        command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no"]);
        command.arg("--toggle-collect=*workload*counted*").arg(&program).args(["--workload", &name]);
        let output = start(command)?;
        let row = row(&String::from_utf8(output.stdout)?, &String::from_utf8_lossy(&output.stderr))
            .with_context(|| format!("callgrind did not count {name}"))?;
        let [name, with, per] = ["workload", "with", "per"].map(|key| row[key].as_str().unwrap_or_default());
        let count = row["instructions"].as_f64().unwrap_or_default();
        println(&format!("{name:<28}{with:<12}{count:>16.1} per {per}"));
        results.push(row);
    }
    if let Some(file) = json_file {
        let all = json!({"valgrind": version, "workloads": results});
        std::fs::write(file, serde_json::to_string_pretty(&all)?)
            .with_context(|| format!("cannot write {file}"))?;
    }
    Ok(())
}

/// What the workload printed (its name, the number of rays, the instruction set), and callgrind's sum.
fn row(printed: &str, log: &str) -> Option<Value> {
    let mut words = printed.split_whitespace();
    let (name, n, with) = (words.next()?, words.next()?.parse::<f64>().ok()?, words.next()?);
    let collected = log.lines().find_map(|line| line.split_once("Collected :"))?.1.trim();
    let count: f64 = collected.parse().ok().filter(|count| *count > 0.0)?;
    let per = if name == "build" { "triangle" } else { "ray" };
    // Embree chooses by itself; it sees the same processor.
    let with = if name.starts_with("embree") { "-" } else { with };
    Some(json!({"workload": name, "with": with, "per": per, "n": n, "instructions": count / n}))
}

/// Results go to stdout; a closed one is no reason to stop.
fn println(line: &str) {
    use std::io::Write;
    if writeln!(std::io::stdout(), "{line}").is_err() {
        say("stdout is closed");
    }
}
