//! What the manifests of our crates say of them.

use crate::metadata::{built_from, ours, packages};
use serde_json::Value;
use std::path::Path;

/// Lists what is missing or wrong in the manifests of our crates.
pub(crate) fn check(metadata: &Value, problems: &mut Vec<String>) {
    for package in ours(metadata).filter(|package| package["name"] != "xtask") {
        let name = package["name"].as_str().unwrap_or_default();
        for field in ["description", "license", "readme", "rust_version"] {
            if package[field].as_str().is_none_or(str::is_empty) {
                problems.push(format!("the manifest of {name} has no {}", field.replace('_', "-")));
            }
        }
        for field in ["keywords", "categories"] {
            let n = package[field].as_array().map_or(0, Vec::len);
            // crates.io takes no more than five.
            if !(1..=5).contains(&n) {
                problems.push(format!("the manifest of {name} has {n} {field}, not 1 to 5"));
            }
        }
        if let Some(file) = readme(package).filter(|file| !Path::new(file).is_file()) {
            problems.push(format!("{name} has no readme {file}"));
        }
        if let Some((dependency, version)) = newest_dependency(metadata, package) {
            problems
                .push(format!("{name} promises an older Rust than {dependency} needs, which is {version}"));
        }
    }
}

/// The readme, beside the manifest.
fn readme(package: &Value) -> Option<String> {
    let folder = Path::new(package["manifest_path"].as_str()?).parent()?;
    Some(folder.join(package["readme"].as_str()?).to_string_lossy().into_owned())
}

/// What a package is built from that needs a newer Rust than the package promises to need, and which Rust.
fn newest_dependency<'a>(metadata: &'a Value, package: &'a Value) -> Option<(&'a str, &'a str)> {
    let promised = version(package["rust_version"].as_str()?)?;
    let all = built_from(metadata, package["id"].as_str().into_iter());
    let built = packages(metadata).filter(|other| other["id"].as_str().is_some_and(|id| all.contains(id)));
    let needed = built.filter_map(|other| Some((other["name"].as_str()?, other["rust_version"].as_str()?)));
    needed.filter(|(_, needed)| version(needed) > Some(promised)).max_by_key(|(_, needed)| version(needed))
}

/// Major and minor number of a version of Rust.
fn version(text: &str) -> Option<(u32, u32)> {
    let (major, rest) = text.split_once('.')?;
    let minor = rest.split('.').next()?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_crate_cannot_promise_an_older_rust_than_it_is_built_from() {
        let package =
            |name: &str, rust: &str| json!({"id": name, "name": name, "source": null, "rust_version": rust});
        let metadata = json!({
            "packages": [package("top", "1.89"), package("old", "1.9"), package("new", "1.90.1")],
            "resolve": {"nodes": [
                {"id": "top", "deps": [
                    {"pkg": "old", "dep_kinds": [{"kind": null}]}, {"pkg": "new", "dep_kinds": [{"kind": "dev"}]},
                ]},
                {"id": "old", "deps": []},
                {"id": "new", "deps": [{"pkg": "top", "dep_kinds": [{"kind": null}]}]},
            ]},
        });
        let found = |i: usize| newest_dependency(&metadata, &metadata["packages"][i]);
        assert_eq!(found(0), None, "tests may need a newer one");
        assert_eq!(found(2), None);
        let mut tighter = metadata.clone();
        tighter["packages"][0]["rust_version"] = json!("1.91");
        assert_eq!(newest_dependency(&tighter, &tighter["packages"][2]), Some(("top", "1.91")));
    }

    #[test]
    fn what_a_manifest_lacks_is_listed() {
        let metadata = json!({
            "packages": [{"id": "a", "name": "a", "source": null, "description": "", "keywords": [], "license": "MIT"}],
            "resolve": {"nodes": []},
        });
        let mut problems = Vec::new();
        check(&metadata, &mut problems);
        assert_eq!(
            problems,
            [
                "the manifest of a has no description",
                "the manifest of a has no readme",
                "the manifest of a has no rust-version",
                "the manifest of a has 0 keywords, not 1 to 5",
                "the manifest of a has 0 categories, not 1 to 5",
            ]
        );
    }
}
