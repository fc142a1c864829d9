//! Which files a scene file may refer to.

use std::io;
use std::path::{Component, Path, PathBuf};

/// Where the files that a scene file refers to may lie.
///
/// Scene files are untrusted: with [`WithinFolder`](Self::WithinFolder), loading one neither reads nor looks for
/// anything outside its own folder, whether through `..`, an absolute path or a symbolic link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathPolicy {
    /// In the folder of the scene file or below it.
    #[default]
    WithinFolder,
    /// Anywhere the user may read.
    Anywhere,
}

/// Why a file that a scene refers to is not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// It lies outside the scene's folder.
    #[error("\"{reference}\" lies outside the folder of the scene; allow it with --allow-outside-paths")]
    Outside {
        /// The path in the scene file.
        reference: String,
    },
    /// There is no such file.
    #[error("\"{reference}\" does not exist; looked for it in {}", folder.display())]
    Missing {
        /// The path in the scene file.
        reference: String,
        /// Where it was looked for.
        folder: PathBuf,
    },
    /// It is a folder, a device or another file without readable content.
    #[error("\"{reference}\" is not a regular file")]
    NotAFile {
        /// The path in the scene file.
        reference: String,
    },
    /// The operating system denies access.
    #[error("\"{reference}\" cannot be reached: {source}")]
    Io {
        /// The path in the scene file.
        reference: String,
        /// The error of the operating system.
        source: io::Error,
    },
}

/// Finds the files that one file refers to, within what the policy allows.
#[derive(Clone, Debug)]
pub(crate) struct Resolver {
    /// Relative references start here.
    base: PathBuf,
    /// Nothing outside is read, in canonical form; `None` allows everything.
    fence: Option<PathBuf>,
}

impl Resolver {
    /// A resolver for the references in `scene_file`.
    ///
    /// # Errors
    /// The folder of the scene file cannot be reached.
    pub(crate) fn new(scene_file: &Path, policy: PathPolicy) -> io::Result<Self> {
        let base = folder_of(scene_file).canonicalize()?;
        let fence = (policy == PathPolicy::WithinFolder).then(|| base.clone());
        Ok(Self { base, fence })
    }

    /// A resolver for the references in a file that the scene refers to: relative to that file, behind the same
    /// fence.
    pub(crate) fn beside(&self, file: &Path) -> Self {
        Self { base: folder_of(file).to_owned(), fence: self.fence.clone() }
    }

    /// The canonical path of an existing regular file.
    ///
    /// The reference is tried as given, then with backslashes as slashes.
    ///
    /// # Errors
    /// See [`PathError`].
    pub(crate) fn resolve(&self, reference: &str) -> Result<PathBuf, PathError> {
        match self.resolve_as_given(reference, reference) {
            Err(PathError::Missing { .. }) if reference.contains('\\') => {
                self.resolve_as_given(&reference.replace('\\', "/"), reference)
            }
            result => result,
        }
    }

    fn resolve_as_given(&self, path: &str, reference: &str) -> Result<PathBuf, PathError> {
        let reference = || reference.to_owned();
        let path = self.base.join(path);
        if self.is_outside(&without_dots(&path)) || has_drive(&reference()) && self.fence.is_some() {
            return Err(PathError::Outside { reference: reference() });
        }
        let found = match path.canonicalize() {
            Ok(found) => found,
            Err(error) if is_absence(&error) => {
                return Err(PathError::Missing { reference: reference(), folder: self.base.clone() });
            }
            Err(source) => return Err(PathError::Io { reference: reference(), source }),
        };
        if self.is_outside(&found) {
            return Err(PathError::Outside { reference: reference() });
        }
        // Opening a pipe or a device can wait for ever.
        if found.is_file() { Ok(found) } else { Err(PathError::NotAFile { reference: reference() }) }
    }

    fn is_outside(&self, path: &Path) -> bool {
        self.fence.as_ref().is_some_and(|fence| !path.starts_with(fence))
    }
}

/// The folder a file lies in; the current one for a bare file name.
fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The path with `.` and `..` resolved lexically, so that nothing outside the fence is accessed to resolve a path.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// Whether a path starts with a Windows drive (`C:\textures`), which other systems treat as a file name.
fn has_drive(reference: &str) -> bool {
    matches!(reference.as_bytes(), [letter, b':', b'/' | b'\\', ..] if letter.is_ascii_alphabetic())
}

/// Names that are too long or contain a zero byte cannot exist either.
fn is_absence(error: &io::Error) -> bool {
    use io::ErrorKind::{InvalidFilename, InvalidInput, NotADirectory, NotFound};
    matches!(error.kind(), NotFound | NotADirectory | InvalidFilename | InvalidInput)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A folder with `scene/box.obj`, `scene/tex/wood.png` and `secret.txt` outside the scene.
    fn files() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("scene/tex")).unwrap();
        for file in ["scene/box.obj", "scene/tex/wood.png", "secret.txt"] {
            fs::write(folder.path().join(file), "x").unwrap();
        }
        let scene = folder.path().join("scene/box.obj");
        (folder, scene)
    }

    fn resolver(scene: &Path, policy: PathPolicy) -> Resolver {
        Resolver::new(scene, policy).unwrap()
    }

    #[test]
    fn files_below_the_scene_are_found_however_they_are_spelled() {
        let (_folder, scene) = files();
        let resolver = resolver(&scene, PathPolicy::WithinFolder);
        let wood = scene.with_file_name("tex").join("wood.png").canonicalize().unwrap();
        for spelling in ["tex/wood.png", "tex\\wood.png", "./tex/../tex/wood.png", ".\\tex\\wood.png"] {
            assert_eq!(resolver.resolve(spelling).unwrap(), wood, "{spelling}");
        }
        assert_eq!(resolver.resolve(wood.to_str().unwrap()).unwrap(), wood);
        let below = resolver.beside(&wood);
        assert_eq!(below.resolve("wood.png").unwrap(), wood);
        assert!(below.resolve("../box.obj").is_ok(), "up from a sub-folder stays inside the scene's folder");
        assert!(matches!(below.resolve("../../secret.txt"), Err(PathError::Outside { .. })));
    }

    #[test]
    fn nothing_outside_the_folder_is_read_unless_allowed() {
        let (folder, scene) = files();
        let fenced = resolver(&scene, PathPolicy::WithinFolder);
        let secret = folder.path().join("secret.txt");
        let spellings = ["../secret.txt", "..\\secret.txt", "tex/../../secret.txt", secret.to_str().unwrap()];
        for spelling in spellings {
            let error = fenced.resolve(spelling).unwrap_err();
            assert!(matches!(error, PathError::Outside { .. }), "{spelling}: {error}");
            assert!(error.to_string().contains("--allow-outside-paths"), "{error}");
            let free = resolver(&scene, PathPolicy::Anywhere);
            assert_eq!(free.resolve(spelling).unwrap(), secret.canonicalize().unwrap(), "{spelling}");
        }
        for spelling in ["C:\\secret.txt", "c:/secret.txt", "/nowhere/at/all", "../absent"] {
            let error = fenced.resolve(spelling).unwrap_err();
            assert!(
                matches!(error, PathError::Outside { .. }),
                "{spelling} tells whether it exists: {error}"
            );
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_does_not_lead_outside() {
        let (folder, scene) = files();
        let secret = folder.path().join("secret.txt");
        std::os::unix::fs::symlink(&secret, scene.with_file_name("link.txt")).unwrap();
        std::os::unix::fs::symlink(folder.path(), scene.with_file_name("up")).unwrap();
        let fenced = resolver(&scene, PathPolicy::WithinFolder);
        for spelling in ["link.txt", "up/secret.txt"] {
            assert!(matches!(fenced.resolve(spelling), Err(PathError::Outside { .. })), "{spelling}");
            assert!(resolver(&scene, PathPolicy::Anywhere).resolve(spelling).is_ok(), "{spelling}");
        }
        assert!(fenced.resolve("up/scene/tex/wood.png").is_ok(), "back inside");
    }

    #[test]
    fn what_is_not_there_or_not_a_file_is_named() {
        let (_folder, scene) = files();
        let resolver = resolver(&scene, PathPolicy::WithinFolder);
        for absent in ["absent.png", "box.obj/x.png", "a\0b", &"x".repeat(5000)] {
            assert!(matches!(resolver.resolve(absent), Err(PathError::Missing { .. })), "{absent}");
        }
        for folder in ["tex", "", "."] {
            assert!(matches!(resolver.resolve(folder), Err(PathError::NotAFile { .. })), "{folder}");
        }
    }
}
