//! Scenes and files that tests and benchmarks read from outside the repository: too large for it, or not ours to
//! publish.
//!
//! They are read only when the environment variable [`VARIABLE`] names the folder that holds them. A test that needs
//! them says that it was skipped when the variable is not set, and fails when the folder lacks what it needs.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The environment variable that names the folder. A relative path starts at the root of the repository.
pub const VARIABLE: &str = "LUMEL_TEST_SHARED";

/// The file or folder `name` of the shared folder; `None` if no shared folder is named.
///
/// # Panics
/// If a shared folder is named but does not contain `name`.
#[must_use]
pub fn path(name: &str) -> Option<PathBuf> {
    resolve(std::env::var_os(VARIABLE), name)
}

/// [`path`] for a test: without a shared folder, says on stderr that the test is skipped, and why.
///
/// # Panics
/// As [`path`].
#[must_use]
pub fn path_or_skip(name: &str) -> Option<PathBuf> {
    let path = path(name);
    if path.is_none() {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or("a test");
        let line =
            format!("skipped: {test} reads {name} from the folder that {VARIABLE} names, which is not set\n");
        // Straight to stderr: output of the print macros is hidden when a test passes. A closed stderr is no failure.
        let _ = std::io::stderr().write_all(line.as_bytes());
    }
    path
}

fn resolve(folder: Option<OsString>, name: &str) -> Option<PathBuf> {
    let folder = folder.filter(|folder| !folder.is_empty())?;
    let path = root().join(folder).join(name);
    assert!(path.exists(), "{VARIABLE} is set, but {} does not exist", path.display());
    Some(path)
}

/// The root of the repository.
fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_read_unless_a_folder_is_named() {
        assert_eq!(resolve(None, "Cargo.toml"), None);
        assert_eq!(resolve(Some(OsString::new()), "Cargo.toml"), None);
    }

    #[test]
    fn a_relative_folder_starts_at_the_root_of_the_repository() {
        let found = resolve(Some("crates/lumel_testkit".into()), "src/shared.rs").unwrap();
        assert!(std::fs::read_to_string(found).unwrap().contains(VARIABLE));
    }

    #[test]
    fn an_absolute_folder_is_taken_as_it_is() {
        let folder = std::env::temp_dir();
        assert_eq!(resolve(Some(folder.clone().into()), "").unwrap(), folder.join(""));
    }

    #[test]
    #[should_panic(expected = "LUMEL_TEST_SHARED is set, but")]
    fn a_named_folder_that_lacks_a_file_is_a_failure() {
        let _ = resolve(Some("crates".into()), "no such file");
    }
}
