//! A folder for the files of one input.

use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A PNG of one grey texel, for scenes to refer to.
const TEXTURE: &[u8] = include_bytes!("grey.png");

thread_local! {
    static FOLDER: TempDir = tempfile::tempdir().expect("a folder for temporary files");
}

/// Calls `read` with the path of the first of some files, which lie in one folder beside a texture, `grey.png`.
///
/// The folder is the same for every call of a thread, which makes thousands of calls per second possible; files of
/// other names may lie in it.
pub(crate) fn with_files<T>(files: &[(&str, &[u8])], read: impl FnOnce(&Path) -> T) -> T {
    FOLDER.with(|folder| {
        let path = |name: &str| -> PathBuf { folder.path().join(name) };
        for (name, content) in files.iter().chain(&[("grey.png", TEXTURE)]) {
            std::fs::write(path(name), content).expect("a file in a temporary folder");
        }
        read(&path(files[0].0))
    })
}
