//! Every case of the shared manifest of awkward and damaged files.

#![allow(missing_docs, clippy::unwrap_used, reason = "a test")]

mod support;

use lumel_testkit::shared;
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

/// Keys of the manifest that this test understands: a new one must not go unnoticed.
const KEYS: [&str; 5] = ["file", "outcome", "triangles", "source", "note"];

/// No case is larger than a megabyte or so; a second is generous even for a busy machine.
const TIME_LIMIT: Duration = Duration::from_secs(5);

#[test]
fn every_case_of_the_manifest_has_its_outcome() {
    let Some(folder) = shared::path_or_skip("loader-cases") else { return };
    let text = std::fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let cases = manifest["cases"].as_array().unwrap();
    assert!(cases.len() >= 92, "only {} cases", cases.len());
    let failures: Vec<String> = cases.iter().filter_map(|case| check(&folder, case).err()).collect();
    assert!(failures.is_empty(), "{} of {} cases:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

fn check(folder: &Path, case: &Value) -> Result<(), String> {
    let file = case["file"].as_str().unwrap();
    if let Some(key) = case.as_object().unwrap().keys().find(|key| !KEYS.contains(&key.as_str())) {
        return Err(format!("{file}: this test does not know the key \"{key}\""));
    }
    let started = Instant::now();
    let result = support::build(&folder.join(file));
    if started.elapsed() > TIME_LIMIT {
        return Err(format!("{file}: took {:?}", started.elapsed()));
    }
    let outcome = case["outcome"].as_str().unwrap();
    match (outcome, result) {
        ("load" | "load_or_error", Ok((scene, warnings))) => {
            let range = case["triangles"].as_array().unwrap();
            let [least, most] = [&range[0], &range[1]].map(|n| n.as_u64().unwrap());
            // Back sides of two-sided faces are not in the file, and what is there twice is.
            let count = (scene.traced_count() + support::coincident(&warnings)) as u64;
            let in_range = (least..=most).contains(&count);
            if in_range { Ok(()) } else { Err(format!("{file}: {count} triangles, not {least} to {most}")) }
        }
        ("error" | "load_or_error", Err(message)) => {
            let clean = !message.is_empty() && message.len() < 1000 && !message.contains("panicked");
            if clean { Ok(()) } else { Err(format!("{file}: message is not clean: {message}")) }
        }
        ("load", Err(message)) => Err(format!("{file}: {message}")),
        ("error", Ok((scene, _))) => {
            Err(format!("{file}: loaded with {} triangles, should fail", scene.triangles().len()))
        }
        (other, _) => Err(format!("{file}: unknown outcome {other}")),
    }
}
