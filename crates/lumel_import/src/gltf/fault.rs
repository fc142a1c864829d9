//! Why a glTF file is refused.

use crate::{ImportError, PathError};
use std::fmt::Display;
use std::path::Path;

/// What is wrong and where in the document; [`Fault::in_file`] adds the file.
#[derive(Debug)]
pub(super) enum Fault {
    /// The document breaks the rules of glTF.
    Malformed(String),
    /// The document requires something that lumel does not support.
    Unsupported(String),
    /// A buffer's file may not or cannot be accessed.
    Reference(PathError),
    /// A buffer's file cannot be read.
    File(ImportError),
}

impl Fault {
    /// A [`Malformed`](Self::Malformed) at a place such as `accessor 3` or `node "Lamp"`.
    pub(super) fn at(place: impl Display, problem: impl Display) -> Self {
        Self::Malformed(format!("{place}: {problem}"))
    }

    /// `place` refers to an item beyond the end of a list.
    pub(super) fn absent(place: impl Display, what: &str, index: usize, count: usize) -> Self {
        Self::at(place, format_args!("refers to {what} {index} of {count}"))
    }

    /// The error for the user.
    pub(super) fn in_file(self, path: &Path) -> ImportError {
        match self {
            Self::Malformed(message) => ImportError::malformed(path, message),
            Self::Unsupported(what) => ImportError::unsupported(path, what),
            Self::Reference(source) => ImportError::Reference { path: path.to_owned(), source },
            Self::File(error) => error,
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Malformed(text) | Self::Unsupported(text) => f.write_str(text),
            Self::Reference(error) => error.fmt(f),
            Self::File(error) => error.fmt(f),
        }
    }
}
