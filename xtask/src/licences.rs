//! `cargo x licences`: the licences of all that the programs contain, for those who pass the programs on.

use crate::cargo::root;
use crate::metadata::{self, packages, shipped};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// How the names of files begin that have to be passed on, in lower case.
const STARTS: [&str; 5] = ["license", "licence", "copying", "notice", "unlicense"];

/// What the programs contain that is no package: name, licence, and the folder that holds it with its licence text.
const ASSETS: [(&str, &str, &str); 1] = [("Noto Sans", "OFL-1.1", "crates/lumel_render_cpu/fonts")];

/// Writes one text file with the name, the licence and the licence texts of each package that the programs are built
/// from on any system. A text that several packages have in common is written once, below all their names.
pub(crate) fn write(arguments: &[String]) -> Result<()> {
    let [file] = arguments else { bail!("usage: cargo x licences FILE") };
    let metadata = metadata::read()?;
    let text = text(&metadata)?;
    std::fs::write(file, text).with_context(|| format!("cannot write {file}"))
}

fn text(metadata: &Value) -> Result<String> {
    let shipped = shipped(metadata);
    let mut out = String::from("lumel contains the following packages and files.\n\n");
    let mut owners: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut add = |name: String, licence: &str, folder: &Path| -> Result<()> {
        writeln!(out, "{name}: {licence}")?;
        for file in texts(folder)? {
            let text = std::fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
            let text = String::from_utf8_lossy(&text).trim().replace("\r\n", "\n");
            owners.entry(text).or_default().push(name.clone());
        }
        Ok(())
    };
    for (name, licence, folder) in ASSETS {
        add(name.to_owned(), licence, &root().join(folder))?;
    }
    for package in packages(metadata).filter(|package| !package["source"].is_null()) {
        let field = |name: &str| package[name].as_str().unwrap_or_default();
        if !shipped.contains(field("id")) {
            continue;
        }
        let name = format!("{} {}", field("name"), field("version"));
        let folder = Path::new(field("manifest_path")).parent().context("a manifest has no folder")?;
        add(name, field("license"), folder)?;
    }
    for (text, names) in owners {
        let line = "-".repeat(80);
        write!(out, "\n{line}\n{}\n{line}\n\n{text}\n", names.join(", "))?;
    }
    Ok(out)
}

/// The licence texts in the folder of a package, in order.
fn texts(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("cannot list {}; try `cargo fetch`", folder.display()))?;
    let is_text = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file() && STARTS.iter().any(|start| name.starts_with(start))
    };
    let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_text).collect();
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_programs_contain_is_named_with_its_licence() {
        let text = text(&metadata::read().unwrap()).unwrap();
        for line in [
            "\nglam ",
            "\nwgpu ",
            "Permission is hereby granted, free of charge",
            "Apache License",
            "\nNoto Sans: OFL-1.1",
            "SIL OPEN FONT LICENSE",
        ] {
            assert!(text.contains(line), "{line}");
        }
        assert!(!text.contains("\nproptest ") && !text.contains("\nlumel "), "tests and lumel itself");
    }
}
