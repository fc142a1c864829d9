//! What Cargo knows of our packages and of those they are built from.

use crate::cargo::cargo;
use anyhow::{Result, bail};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Members of the workspace that are for ourselves.
pub(crate) const FOR_OURSELVES: &[&str] = &["lumel_testkit", "lumel_fuzz", "xtask"];

/// All packages of the lock file and how they depend on each other, for any system.
pub(crate) fn read() -> Result<Value> {
    let output = cargo(&["metadata", "--format-version", "1", "--locked"]).output()?;
    if !output.status.success() {
        bail!("cargo metadata failed: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// All packages.
pub(crate) fn packages(metadata: &Value) -> impl Iterator<Item = &Value> {
    metadata["packages"].as_array().into_iter().flatten()
}

/// Members of the workspace.
pub(crate) fn ours(metadata: &Value) -> impl Iterator<Item = &Value> {
    packages(metadata).filter(|package| package["source"].is_null())
}

/// Ids of the packages that our programs and libraries are built from, on any system.
pub(crate) fn shipped(metadata: &Value) -> BTreeSet<&str> {
    let ours = ours(metadata);
    let ours = ours.filter(|p| !p["name"].as_str().is_some_and(|name| FOR_OURSELVES.contains(&name)));
    built_from(metadata, ours.filter_map(|p| p["id"].as_str()))
}

/// The given packages and all that they are built from, by their ids; what only their tests use is left out.
pub(crate) fn built_from<'a>(metadata: &'a Value, roots: impl Iterator<Item = &'a str>) -> BTreeSet<&'a str> {
    let nodes: BTreeMap<&str, &Value> = metadata["resolve"]["nodes"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|node| Some((node["id"].as_str()?, node)))
        .collect();
    let mut open: Vec<&str> = roots.collect();
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        if found.insert(id) {
            let dependencies = nodes.get(id).and_then(|node| node["deps"].as_array()).into_iter().flatten();
            let is_built_in = |dependency: &&Value| {
                dependency["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"] != "dev")
            };
            open.extend(dependencies.filter(is_built_in).filter_map(|dependency| dependency["pkg"].as_str()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_only_tests_use_is_not_shipped() {
        let package = |name: &str, source: Value| json!({"id": name, "name": name, "source": source});
        let dep = |name: &str, kinds: &[Value]| {
            let kinds: Vec<Value> = kinds.iter().map(|kind| json!({"kind": kind})).collect();
            json!({"pkg": name, "dep_kinds": kinds})
        };
        let metadata = json!({
            "packages": [package("lumel", Value::Null), package("xtask", Value::Null), package("a", json!("registry"))],
            "resolve": {"nodes": [
                {"id": "lumel", "deps": [
                    dep("a", &[Value::Null]), dep("t", &[json!("dev")]), dep("b", &[json!("dev"), json!("build")]),
                ]},
                {"id": "a", "deps": [dep("c", &[Value::Null])]},
                {"id": "t", "deps": [dep("u", &[Value::Null])]},
                {"id": "xtask", "deps": [dep("v", &[Value::Null])]},
            ]},
        });
        assert_eq!(Vec::from_iter(shipped(&metadata)), ["a", "b", "c", "lumel"]);
    }
}
