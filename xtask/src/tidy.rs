//! Rules that no compiler checks.

use crate::cargo::root;
use crate::metadata::{FOR_OURSELVES, packages, shipped};
use crate::{manifests, metadata};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A file longer than this has more than one concept in it.
const MAX_LINES: usize = 800;

/// Crates in the order data flows: each may depend only on those before it.
const ORDER: &[&str] = &[
    "lumel_sample",
    "lumel_scene",
    "lumel_builtin",
    "lumel_import",
    "lumel_accel",
    "lumel_uv",
    "lumel_basis",
    "lumel_lightmap",
    "lumel_transport",
    "lumel_solve",
    "lumel_render_cpu",
    "lumel_render_gpu",
    "lumel_export",
    "lumel",
    "lumel_cli",
    "lumel_view",
];

/// Radiosity and radiance differ by pi; where the types that keep them apart are defined, where directions are
/// warped, and where angles are read from files or bound directions, it may appear.
const PI_ALLOWED: &[&str] = &[
    "lumel_scene/src/units.rs",
    "lumel_sample/src/warp",
    "lumel_import/src/gltf/lights.rs",
    "lumel_transport/src/light_cone.rs",
    "lumel_transport/src/cap.rs",
    "lumel_testkit/",
];

/// Licences that our dependencies may have; any of the alternatives of an expression will do.
const LICENCES: &[&str] = &[
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "Zlib",
    "ISC",
    "Unicode-3.0",
    "CC0-1.0",
    "0BSD",
    "Unlicense",
    "MIT-0",
    "BSL-1.0",
    // Fonts.
    "OFL-1.1",
    "Ubuntu-font-1.0",
];

/// Licences of what only tests use.
const TEST_LICENCES: &[&str] = &["MPL-2.0"];

pub(crate) fn tidy() -> Result<()> {
    let mut problems = Vec::new();
    check_sources(&mut problems)?;
    let metadata = metadata::read()?;
    check_crate_graph(&metadata, &mut problems);
    check_licences(&metadata, &mut problems);
    manifests::check(&metadata, &mut problems);
    check_changelog(&mut problems)?;
    if !problems.is_empty() {
        bail!("tidy found {} problems:\n  {}", problems.len(), problems.join("\n  "));
    }
    Ok(())
}

fn check_sources(problems: &mut Vec<String>) -> Result<()> {
    for file in sources(&root())? {
        let name = file.strip_prefix(root()).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        let text = std::fs::read_to_string(&file).with_context(|| format!("cannot read {name}"))?;
        let n_lines = text.lines().count();
        if n_lines > MAX_LINES {
            problems.push(format!("{name} has {n_lines} lines; split it"));
        }
        let product = name.starts_with("crates/")
            && name.contains("/src/")
            && !PI_ALLOWED.iter().any(|allowed| name.contains(allowed));
        // What follows `cfg(test)` belongs to the tests.
        let mut in_product = product && !name.ends_with("tests.rs");
        for (i, line) in text.lines().enumerate() {
            in_product &= line.trim() != "#[cfg(test)]";
            let code = line.split("//").next().unwrap_or_default();
            if in_product && uses_pi(code) {
                problems.push(format!("{name}:{}: pi belongs into units.rs or warp.rs", i + 1));
            }
            if unfinished(line) {
                problems.push(format!("{name}:{}: an unfinished mark", i + 1));
            }
        }
    }
    Ok(())
}

fn uses_pi(code: &str) -> bool {
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    words.into_iter().any(|word| {
        word == "PI" || word == "TAU" || word.starts_with("FRAC_PI_") || word.starts_with("FRAC_1_PI")
    }) || code.contains("3.14159")
}

fn unfinished(line: &str) -> bool {
    // Written apart so that this file does not find itself.
    [concat!("TO", "DO"), concat!("XX", "X"), concat!("HA", "CK"), concat!("#[ign", "ore")]
        .iter()
        .any(|mark| line.contains(mark))
}

/// All Rust and WGSL files below a folder, build outputs apart, in order.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in
            std::fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))?
        {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path);
            } else if name.ends_with(".rs") || name.ends_with(".wgsl") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Changes that users notice have a place to be told.
fn check_changelog(problems: &mut Vec<String>) -> Result<()> {
    let text = std::fs::read_to_string(root().join("CHANGELOG.md")).context("cannot read CHANGELOG.md")?;
    if !text.lines().any(|line| line == "## [Unreleased]") {
        problems.push("CHANGELOG.md has no section \"## [Unreleased]\"".to_owned());
    }
    Ok(())
}

fn check_crate_graph(metadata: &Value, problems: &mut Vec<String>) {
    let rank = |name: &str| ORDER.iter().position(|crate_name| *crate_name == name);
    for package in packages(metadata).filter(|p| p["source"].is_null()) {
        let name = package["name"].as_str().unwrap_or_default();
        let Some(own) = rank(name) else {
            if name.starts_with("lumel") && !FOR_OURSELVES.contains(&name) {
                problems.push(format!("crate {name} has no place in the order of crates"));
            }
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let other = dependency["name"].as_str().unwrap_or_default();
            let is_normal = dependency["kind"].is_null();
            if is_normal && (other == "lumel_testkit" || rank(other).is_some_and(|rank| rank >= own)) {
                problems.push(format!("crate {name} must not depend on {other}"));
            }
        }
    }
}

fn check_licences(metadata: &Value, problems: &mut Vec<String>) {
    let shipped = shipped(metadata);
    for package in packages(metadata).filter(|p| !p["source"].is_null()) {
        let text = |field: &str| package[field].as_str().unwrap_or_default();
        let (name, licence) = (text("name"), text("license"));
        let in_tests_only = !shipped.contains(text("id"));
        if !is_allowed(licence, |l| LICENCES.contains(&l) || in_tests_only && TEST_LICENCES.contains(&l)) {
            problems.push(format!("{name} has the licence \"{licence}\", which is not in our list"));
        }
    }
}

/// Whether an SPDX expression can be met with allowed licences. `/` is an old way to write OR.
fn is_allowed(expression: &str, allowed: impl Fn(&str) -> bool) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    any_of(&mut words, &allowed) && words.next().is_none()
}

type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

fn any_of(words: &mut Words<'_>, allowed: &impl Fn(&str) -> bool) -> bool {
    let mut met = all_of(words, allowed);
    while words.next_if_eq(&"OR").is_some() {
        met |= all_of(words, allowed);
    }
    met
}

fn all_of(words: &mut Words<'_>, allowed: &impl Fn(&str) -> bool) -> bool {
    let mut met = one(words, allowed);
    while words.next_if_eq(&"AND").is_some() {
        met &= one(words, allowed);
    }
    met
}

fn one(words: &mut Words<'_>, allowed: &impl Fn(&str) -> bool) -> bool {
    match words.next() {
        Some("(") => any_of(words, allowed) & words.next_if_eq(&")").is_some(),
        Some(licence) if words.next_if_eq(&"WITH").is_some() => {
            words.next().is_some_and(|exception| allowed(&format!("{licence} WITH {exception}")))
        }
        Some(licence) => allowed(licence),
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn licence_expressions_are_met_by_the_licences_of_the_list() {
        let met = |expression| is_allowed(expression, |licence| LICENCES.contains(&licence));
        for good in [
            "MIT",
            "MIT OR Apache-2.0",
            "MIT/Apache-2.0",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "(GPL-3.0 OR MIT) AND (OFL-1.1 AND Ubuntu-font-1.0)",
            "GPL-3.0 OR MIT AND Zlib",
            "Apache-2.0 WITH LLVM-exception",
        ] {
            assert!(met(good), "{good}");
        }
        for bad in [
            "",
            "GPL-3.0",
            "MIT AND GPL-3.0",
            "(MIT OR Apache-2.0) AND GPL-3.0",
            "GPL-3.0 OR MIT AND LGPL-3.0",
            "MIT WITH an-exception",
            "(MIT",
            "MIT Apache-2.0",
            "MPL-2.0",
        ] {
            assert!(!met(bad), "{bad}");
        }
    }

    #[test]
    fn pi_is_found_as_a_word_only() {
        assert!(
            uses_pi("let a = PI * r;") && uses_pi("std::f32::consts::FRAC_PI_2") && uses_pi("3.14159265")
        );
        assert!(!uses_pi("PIXELS + API"));
    }
}
