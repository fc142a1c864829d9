//! The inputs in `fuzz/corpus`, without a fuzzer.

#![allow(missing_docs, clippy::unwrap_used, reason = "a test")]

use lumel_fuzz::TARGETS;
use std::path::{Path, PathBuf};

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus")
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Feeds a target all its inputs; one that panics is named.
fn replay(name: &str) {
    let inputs = entries(&corpus().join(name));
    assert!(!inputs.is_empty());
    for path in inputs {
        let input = std::fs::read(&path).unwrap();
        if std::panic::catch_unwind(|| lumel_fuzz::run(name, &input)).is_err() {
            panic!("{} breaks a promise", path.display());
        }
    }
}

#[test]
fn every_kept_obj_file_is_read_or_refused() {
    replay("obj");
}

#[test]
fn every_kept_material_library_is_read_or_refused() {
    replay("mtl");
}

#[test]
fn every_kept_gltf_file_is_read_or_refused() {
    replay("gltf");
}

#[test]
fn every_kept_ply_file_is_read_or_refused() {
    replay("ply");
}

#[test]
fn every_kept_archive_is_read_or_refused() {
    replay("npz");
}

#[test]
fn every_kept_project_file_is_read_or_refused() {
    replay("project");
}

#[test]
fn every_kept_light_is_read_or_refused() {
    replay("light");
}

#[test]
fn every_target_has_inputs_and_every_folder_a_target() {
    let folders = entries(&corpus());
    let folders = folders.iter().map(|path| path.file_name().unwrap().to_str().unwrap());
    let mut names = TARGETS.map(|target| target.name);
    names.sort_unstable();
    assert_eq!(Vec::from_iter(folders), names);
}
