//! Programs that read our files as users do: NumPy, Khronos' glTF validator, and three.js in a browser.

use crate::cargo::root;
use crate::shell::{say, succeeds};
use crate::{browser, node};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Sets up the programs below `target` and tells the tests where they are.
///
/// What cannot be had is printed with the reason; the tests that need it say that they are skipped.
///
/// # Errors
/// In CI, where no test may be skipped.
pub(crate) fn provide(tests: &mut Command) -> Result<()> {
    match python_with_numpy() {
        Some(python) => {
            tests.env("LUMEL_PYTHON", python);
        }
        None => missing("Python 3 with the package numpy", "`python3 -m pip install numpy`")?,
    }
    let Some(modules) = node::modules() else {
        return missing(
            "Node.js with the packages gltf-validator and three",
            "`apt-get install nodejs npm`, or get them from https://nodejs.org",
        );
    };
    match browser::find(&modules) {
        Some(browser) => {
            tests.env(browser::VARIABLE, browser);
        }
        None => missing(
            "a browser of the Chromium family",
            &format!("`apt-get install chromium`, or name one in {}", browser::VARIABLE),
        )?,
    }
    tests.env("NODE_PATH", modules);
    Ok(())
}

fn missing(what: &str, remedy: &str) -> Result<()> {
    if std::env::var_os("CI").is_some() {
        bail!("some tests need {what}, and CI must not skip them; try {remedy}");
    }
    say(&format!("skipped: some tests need {what}; try {remedy}"));
    Ok(())
}

/// A Python with NumPy: the system's, or one in a virtual environment.
fn python_with_numpy() -> Option<PathBuf> {
    let environment = root().join("target/python");
    let local = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let has_numpy = |python: &Path| succeeds(Command::new(python).args(["-c", "import numpy"]));
    let of_system = PYTHONS.map(PathBuf::from);
    if let Some(python) = of_system.iter().chain([&local]).find(|python| has_numpy(python)) {
        return Some(python.clone());
    }
    // A Python that is too old, or a stand-in that only opens a shop, makes no environment.
    let mut environments =
        of_system.iter().map(|python| succeeds(Command::new(python).args(["-m", "venv"]).arg(&environment)));
    let made = environments.any(|made| made)
        && succeeds(Command::new(&local).args(["-m", "pip", "install", "--quiet", "numpy"]));
    made.then_some(local)
}

/// What Python 3 is called: `python` where it comes from python.org for Windows.
const PYTHONS: [&str; 2] = ["python3", "python"];
