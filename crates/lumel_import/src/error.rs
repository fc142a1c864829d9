//! Why a scene file cannot be imported.

use crate::paths::PathError;
use crate::text::escaped;
use std::io;
use std::path::{Path, PathBuf};

/// File formats [`load`](crate::load) understands, for messages.
pub(crate) const SUPPORTED: &str = "obj, gltf, glb and ply";

/// Why a scene file cannot be imported. What is not essential causes a warning instead.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// A file cannot be opened or read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The file breaks the rules of its format.
    #[error("{}: {message}", place(path, *line))]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1, in formats that have lines.
        line: Option<usize>,
        /// The problem, the object and the remedy.
        message: String,
    },
    /// The file appears well-formed but requires something that lumel does not support.
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported, and the remedy.
        what: String,
    },
    /// A file that the scene depends on may not or cannot be read.
    #[error("{}: the scene depends on a file that cannot be used", path.display())]
    Reference {
        /// The scene file.
        path: PathBuf,
        /// The file and the reason.
        #[source]
        source: PathError,
    },
    /// The file contains no surfaces.
    #[error("{}: no triangles; a scene needs surfaces to light", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
}

impl ImportError {
    /// A [`Malformed`](Self::Malformed) at a line.
    pub(crate) fn at_line(path: &Path, line: usize, message: impl Into<String>) -> Self {
        Self::Malformed { path: path.to_owned(), line: Some(line), message: message.into() }
    }

    /// A [`Malformed`](Self::Malformed) in a file without lines.
    pub(crate) fn malformed(path: &Path, message: impl Into<String>) -> Self {
        Self::Malformed { path: path.to_owned(), line: None, message: message.into() }
    }

    /// An [`Unsupported`](Self::Unsupported).
    pub(crate) fn unsupported(path: &Path, what: impl Into<String>) -> Self {
        Self::Unsupported { path: path.to_owned(), what: what.into() }
    }

    /// The same with control characters spelled out in what comes from the file.
    pub(crate) fn escaped(self) -> Self {
        match self {
            Self::Malformed { path, line, message } => {
                Self::Malformed { path, line, message: escaped(&message) }
            }
            Self::Unsupported { path, what } => Self::Unsupported { path, what: escaped(&what) },
            other => other,
        }
    }

    /// An [`Io`](Self::Io), made for `map_err`.
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        |source| Self::Io { path: path.to_owned(), source }
    }
}

/// `file` or `file:line`, the form that editors jump to.
fn place(path: &Path, line: Option<usize>) -> String {
    line.map_or_else(|| path.display().to_string(), |line| format!("{}:{line}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_malformed_line_is_named_the_way_editors_jump_to() {
        let error = ImportError::at_line(Path::new("a/box.obj"), 17, "face refers to vertex 99 of 8");
        assert_eq!(error.to_string(), "a/box.obj:17: face refers to vertex 99 of 8");
        let error = ImportError::malformed(Path::new("a/box.glb"), "no JSON chunk");
        assert_eq!(error.to_string(), "a/box.glb: no JSON chunk");
    }
}
