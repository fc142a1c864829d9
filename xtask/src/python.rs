//! A Python that reads our files with NumPy, as users do.

use crate::{root, say};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A Python with NumPy: the system's, or one in a virtual environment below `target`.
///
/// `None`, with the reason printed, when there is no Python or NumPy cannot be installed.
///
/// # Errors
/// In CI, where no test may be skipped.
pub(crate) fn with_numpy() -> Result<Option<PathBuf>> {
    let system = PathBuf::from("python3");
    let environment = root().join("target/python");
    let local = environment.join("bin/python");
    for python in [&system, &local] {
        if succeeds(python, &["-c", "import numpy"]) {
            return Ok(Some(python.clone()));
        }
    }
    let made = succeeds(&system, &["-m", "venv", &environment.to_string_lossy()])
        && succeeds(&local, &["-m", "pip", "install", "--quiet", "numpy"]);
    if made {
        return Ok(Some(local));
    }
    let reason = "the tests that read solutions with NumPy need Python 3 with the package numpy";
    if std::env::var_os("CI").is_some() {
        bail!("{reason}");
    }
    say(&format!("skipped: {reason}; install it with `python3 -m pip install numpy`"));
    Ok(None)
}

fn succeeds(program: &Path, arguments: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
