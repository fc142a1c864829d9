//! Errors of reading and writing files, with remedies.

use lumel_basis::VertexCountError;
use lumel_scene::Scene;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be written. An existing file is unchanged, and no partial file is left.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The path has no file name: it ends in `..` or `/`, or is empty.
    #[error("a file name is missing at the end of the path: \"{}\"", path.display())]
    NoFileName {
        /// The file to write.
        path: PathBuf,
    },
    /// The folder does not exist.
    #[error("the folder does not exist; create it or choose another: \"{}\"", path.display())]
    NoFolder {
        /// The file to write.
        path: PathBuf,
    },
    /// The path names a folder, a device or a pipe.
    #[error("this is {what}, not a file that can be replaced; choose another name: \"{}\"", path.display())]
    NotAFile {
        /// The file to write.
        path: PathBuf,
        /// "a folder", for example.
        what: &'static str,
    },
    /// The existing file is read-only.
    #[error("the file is write-protected; remove it or choose another name: \"{}\"", path.display())]
    WriteProtected {
        /// The file to write.
        path: PathBuf,
    },
    /// The folder is not writable.
    #[error("no permission to write here; choose another folder or change its permissions: \"{}\"", path.display())]
    NoPermission {
        /// The file to write.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The disk or the quota is full.
    #[error("the disk is full; free some space or choose another disk: \"{}\"", path.display())]
    DiskFull {
        /// The file to write.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file would be longer than the system allows.
    #[error("the file would be longer than the system allows; raise the limit of this process (ulimit -f) or choose another disk: \"{}\"", path.display())]
    TooLong {
        /// The file to write.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Any other error of the system.
    #[error("cannot write ({source}): \"{}\"", path.display())]
    Io {
        /// The file to write.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The content cannot be expressed in the format.
    #[error("{problem}: \"{}\"", path.display())]
    Content {
        /// The file to write.
        path: PathBuf,
        /// The problem and the remedy.
        problem: String,
    },
}

impl ExportError {
    /// Classifies an error of the system by its remedy.
    pub(crate) fn io(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::NoFolder { path },
            io::ErrorKind::IsADirectory => Self::NotAFile { path, what: "a folder" },
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                Self::NoPermission { path, source }
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::WriteZero => {
                Self::DiskFull { path, source }
            }
            io::ErrorKind::FileTooLarge => Self::TooLong { path, source },
            _ => Self::Io { path, source },
        }
    }

    pub(crate) fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), problem: problem.into() }
    }
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system cannot open or read the file.
    #[error("cannot read ({source}): \"{}\"", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file as a whole is invalid.
    #[error("{problem}: \"{}\"", path.display())]
    BadFile {
        /// The file.
        path: PathBuf,
        /// The problem and the remedy.
        problem: String,
    },
    /// The archive has no member of this name.
    #[error("there is no \"{member}\" in the file: \"{}\"", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The array or other member.
        member: String,
    },
    /// A member of the archive is invalid.
    #[error("\"{member}\" {problem}: \"{}\"", path.display())]
    BadMember {
        /// The file.
        path: PathBuf,
        /// The array or other member.
        member: String,
        /// The problem and the remedy.
        problem: String,
    },
}

/// Why a solution cannot be saved, loaded or used.
#[derive(Debug, thiserror::Error)]
pub enum SolutionError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] ExportError),
    /// The file could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is not a solution in a format known to this version.
    #[error("{problem}: \"{}\"", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it is instead, and the remedy.
        problem: String,
    },
    /// Two arrays do not cover the same vertices.
    #[error("the solution has {count} values of \"{array}\" for {vertices} vertices")]
    Length {
        /// The array.
        array: String,
        /// Its length.
        count: usize,
        /// The number of positions.
        vertices: usize,
    },
    /// The light does not cover the vertices of the scene.
    #[error(transparent)]
    Vertices(#[from] VertexCountError),
    /// A value is infinite or not a number.
    #[error("the solution is not a finite number in \"{array}\" at vertex {vertex}")]
    NotFinite {
        /// The array.
        array: String,
        /// The first such vertex.
        vertex: usize,
    },
    /// The solution does not have the requested bounce.
    #[error("the solution has no bounce {wanted}; it has {count} bounces, counted from 0 (direct light)")]
    NoSuchBounce {
        /// The requested bounce.
        wanted: usize,
        /// How many it has.
        count: usize,
    },
    /// The solution is of light that was shot.
    #[error(
        "the solution has no bounce {wanted}: its light was shot, which tells no bounces apart; choose direct light or all light, or \
         bake with the schedule gather"
    )]
    Shot {
        /// The requested bounce.
        wanted: usize,
    },
    /// The solution has no layer of that name.
    #[error("the solution has no layer \"{wanted}\"; {}", layers_text(names))]
    NoSuchLayer {
        /// The layer asked for.
        wanted: String,
        /// Those it has.
        names: Vec<String>,
    },
    /// A lightmap that does not hold together.
    #[error("this lightmap cannot be used, it {problem}: {}", path.display())]
    Lightmap {
        /// The file.
        path: PathBuf,
        /// What it does.
        problem: String,
    },
    /// The solution was computed for different geometry.
    #[error(
        "{} was computed for scene \"{}\" ({}), not for \"{}\" ({}): \
         bake this scene again or open the scene it belongs to",
        solution_name(file.as_deref()), theirs.name, theirs.size(), ours.name, ours.size()
    )]
    OtherScene {
        /// The file of the solution, if it was read from one.
        file: Option<PathBuf>,
        /// The scene the solution was computed for.
        theirs: Box<SceneLabel>,
        /// The scene it was meant to be used with.
        ours: Box<SceneLabel>,
    },
}

/// How messages identify a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneLabel {
    /// Its name.
    pub name: String,
    /// Number of its vertices.
    pub vertices: usize,
    /// Hash of its geometry, hexadecimal.
    pub geometry_hash: String,
}

impl SceneLabel {
    /// That of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self {
            name: scene.name().to_owned(),
            vertices: scene.vertex_count(),
            geometry_hash: scene.geometry_hash().to_hex().to_string(),
        }
    }

    /// Checks that what belongs to this scene belongs to that one: the same geometry, whatever its name.
    pub(crate) fn check_is(self, scene: &Scene, file: Option<&Path>) -> Result<(), SolutionError> {
        let ours = Self::of(scene);
        if (self.vertices, &self.geometry_hash) == (ours.vertices, &ours.geometry_hash) {
            return Ok(());
        }
        let file = file.map(Path::to_owned);
        Err(SolutionError::OtherScene { file, theirs: Box::new(self), ours: Box::new(ours) })
    }

    fn size(&self) -> String {
        let prefix: String = self.geometry_hash.chars().take(8).collect();
        format!("{} vertices, {prefix}..", self.vertices)
    }
}

fn layers_text(names: &[String]) -> String {
    match names {
        [] => "it has no layers, which a bake with --layers lights makes".to_owned(),
        names => format!("its layers are {}", names.join(", ")),
    }
}

fn solution_name(file: Option<&Path>) -> String {
    file.map_or_else(|| "the solution".to_owned(), |file| format!("solution \"{}\"", file.display()))
}
