//! Fuzzing of the readers, by `cargo fuzz`.

use crate::cargo::{cargo, root};
use crate::shell::{run, succeeds};
use anyhow::{Context, Result, bail};

/// How long a target runs where nothing is said, seconds.
const SECONDS: u32 = 600;

/// The largest input, bytes: larger ones hide what matters in them.
const MAX_INPUT: u32 = 6000;

/// Runs one fuzz target: `TARGET [SECONDS]`.
///
/// Starts from the inputs in `fuzz/corpus` and what earlier runs have found in `fuzz/found`; an input that lumel fails
/// on is left in `fuzz/artifacts`.
pub(crate) fn fuzz(arguments: &[String]) -> Result<()> {
    let (target, seconds) = match arguments {
        [target] => (target, SECONDS),
        [target, seconds] => (target, seconds.parse().context("the second argument is a number of seconds")?),
        _ => bail!("usage: cargo x fuzz TARGET [SECONDS]; targets: {}", targets()?.join(", ")),
    };
    let known = targets()?;
    if !known.contains(target) {
        bail!("there is no fuzz target \"{target}\"; targets: {}", known.join(", "));
    }
    if !succeeds(cargo(&["fuzz", "--version"]).env("RUSTC_BOOTSTRAP", "1")) {
        bail!("there is no cargo-fuzz; try `cargo install cargo-fuzz`");
    }
    let found = root().join("fuzz/found").join(target);
    std::fs::create_dir_all(&found).with_context(|| format!("cannot make {}", found.display()))?;
    let corpus = root().join("fuzz/corpus").join(target);
    // No sanitizer: there is hardly any unsafe code, and without one the stable compiler will do.
    let mut command = cargo(&["fuzz", "run", "-O", "--sanitizer", "none", target]);
    command.args([found, corpus]).arg("--").args([
        format!("-max_total_time={seconds}"),
        format!("-max_len={MAX_INPUT}"),
        "-rss_limit_mb=2048".into(),
        "-timeout=10".into(),
    ]);
    // Coverage is measured by an option that the stable compiler hides.
    run(command.env("RUSTC_BOOTSTRAP", "1"))
}

/// The names of all targets: each has a folder of inputs.
fn targets() -> Result<Vec<String>> {
    let folder = root().join("fuzz/corpus");
    let entries = std::fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let mut names: Vec<String> = entries
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<std::io::Result<_>>()?;
    names.sort();
    Ok(names)
}
