//! Packages of Node.js that tests use, below `target/node`.

use crate::cargo::root;
use crate::shell::succeeds;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::Command;

/// Names and versions, which are fixed: what tests see must not change by itself.
const PACKAGES: [[&str; 2]; 2] = [["gltf-validator", "2.0.0-dev.3.10"], ["three", "0.187.0"]];

/// A Chromium without a window that needs nothing else of the system, for [`HAS_BROWSER`].
pub(crate) const BROWSER: [&str; 2] = ["@sparticuz/chromium", "147.0.0"];

/// Whether this is the system that it is built for.
pub(crate) const HAS_BROWSER: bool = cfg!(all(target_os = "linux", target_arch = "x86_64"));

/// Node's package manager, which is a script on Windows.
const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

/// Where packages and what comes with them are.
pub(crate) fn folder() -> PathBuf {
    root().join("target/node")
}

/// The folder of modules, with all packages in it.
pub(crate) fn modules() -> Option<PathBuf> {
    let folder = folder();
    let modules = folder.join("node_modules");
    let (manifest, wanted) = (folder.join("package.json"), manifest());
    let mut probe = Command::new("node");
    probe.args(["-e", "require('gltf-validator')"]).env("NODE_PATH", &modules);
    if std::fs::read_to_string(&manifest).is_ok_and(|text| text == wanted) && succeeds(&mut probe) {
        return Some(modules);
    }
    let mut install = Command::new(NPM);
    install.args(["install", "--silent", "--no-package-lock", "--prefix"]).arg(&folder);
    let is_written = std::fs::create_dir_all(&folder).is_ok() && std::fs::write(&manifest, wanted).is_ok();
    if !(is_written && succeeds(&mut install)) {
        // It says what is there, which is not so.
        let _ = std::fs::remove_file(&manifest);
        return None;
    }
    succeeds(&mut probe).then_some(modules)
}

/// What npm shall install, in its words.
fn manifest() -> String {
    let packages = PACKAGES.iter().chain(HAS_BROWSER.then_some(&BROWSER));
    let packages = packages.map(|[name, version]| ((*name).to_owned(), Value::from(*version)));
    json!({ "private": true, "dependencies": packages.collect::<Map<_, _>>() }).to_string()
}
