//! The browser of the tests: a Chromium without a window, which draws with its own software renderer.

use crate::node;
use crate::shell::succeeds;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names another browser of the Chromium family.
pub(crate) const VARIABLE: &str = "LUMEL_BROWSER";

/// Where browsers usually are, for systems that npm has none for.
const USUAL: [&str; 4] = [
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    "/usr/bin/chromium",
    "/usr/bin/google-chrome",
];

/// Unpacks to the folder for temporary files, with libraries that are in no minimal system: those are for AWS.
const UNPACK: &str = "require('@sparticuz/chromium').executablePath()";

/// The program: the one that was named, that of npm, or that of the system.
pub(crate) fn find(modules: &Path) -> Option<PathBuf> {
    if let Some(named) = std::env::var_os(VARIABLE) {
        return Some(named.into());
    }
    let of_npm = if node::HAS_BROWSER { unpacked(modules) } else { None };
    of_npm.or_else(|| USUAL.iter().map(PathBuf::from).find(|browser| browser.is_file()))
}

/// That of npm, unpacked. What was interrupted leaves no such folder.
fn unpacked(modules: &Path) -> Option<PathBuf> {
    let [_, version] = node::BROWSER;
    let folder = node::folder().join(format!("chromium-{version}"));
    if !folder.is_dir() {
        let partial = node::folder().join("chromium.partial");
        // Of an earlier try.
        let _ = std::fs::remove_dir_all(&partial);
        std::fs::create_dir_all(&partial).ok()?;
        let mut unpack = Command::new("node");
        unpack.args(["-e", UNPACK]).env("NODE_PATH", modules);
        unpack.env("TMPDIR", &partial).env("AWS_LAMBDA_JS_RUNTIME", "nodejs20.x");
        if !succeeds(&mut unpack) {
            return None;
        }
        std::fs::rename(&partial, &folder).ok()?;
    }
    Some(folder.join("chromium"))
}
