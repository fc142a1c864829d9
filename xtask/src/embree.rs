//! Embree 4 for the benchmark of rays, from a wheel of PyPI. Nothing else uses it.

use crate::cargo::root;
use crate::shell::run;
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The environment variable that names the library.
pub(crate) const VARIABLE: &str = "LUMEL_EMBREE";

/// The package, with Embree 4.4 as built by Intel.
const PACKAGE: &str = "embreex==4.4.0.post1";

/// The library: the one the environment variable names, or one below `target`, which is fetched if need be.
pub(crate) fn library() -> Result<PathBuf> {
    if let Some(file) = std::env::var_os(VARIABLE) {
        return Ok(file.into());
    }
    let folder = root().join("target/bench/embree");
    if let Some(file) = find(&folder) {
        return Ok(file);
    }
    std::fs::create_dir_all(&folder)?;
    python(&["-m", "pip", "download", "--quiet", "--no-deps", "--dest"], &[&folder, Path::new(PACKAGE)])?;
    let wheel = files(&folder).find(|file| file.extension().is_some_and(|extension| extension == "whl"));
    let wheel = wheel.context("pip downloaded no wheel")?;
    python(&["-m", "zipfile", "--extract"], &[&wheel, &folder])?;
    find(&folder).with_context(|| format!("{} has no libembree4 for this system", wheel.display()))
}

fn python(arguments: &[&str], paths: &[&Path]) -> Result<()> {
    let mut command = Command::new("python3");
    command.args(arguments).args(paths).stdout(Stdio::null());
    if Command::new("python3").arg("--version").output().is_err() {
        bail!("there is no python3 to fetch {PACKAGE} with; set {VARIABLE} to a libembree4");
    }
    run(&mut command)
}

/// The library in an unpacked wheel.
fn find(folder: &Path) -> Option<PathBuf> {
    let is_library = |file: &PathBuf| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.contains("embree4") && [".so", ".dylib", ".dll"].iter().any(|kind| name.contains(kind))
    };
    files(&folder.join("embreex.libs")).chain(files(&folder.join("embreex"))).find(is_library)
}

fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path())
}
