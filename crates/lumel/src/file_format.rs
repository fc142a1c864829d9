//! Files of light that a bake writes.

use lumel_export::{
    ColorScale, ExportError, RadFile, Solution, SolutionError, SolutionSelection, write_glb, write_obj,
    write_ply,
};
use lumel_scene::Scene;
use std::path::{Path, PathBuf};

/// A format for light or a lit mesh, told by the extension of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileFormat {
    /// `.npz`: the whole solution.
    Npz,
    /// `.glb`: the lit mesh.
    Glb,
    /// `.ply`: the lit mesh.
    Ply,
    /// `.obj`: the lit mesh without irradiance, and files beside it.
    Obj,
    /// `.rad`: irradiance over π.
    Rad,
}

/// Why a file of light was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The extension is none of a known format.
    #[error("the extension of this file is not one of {known}: {path}", known = FileFormat::extensions(), path = .0.display())]
    Format(PathBuf),
    /// The solution, or writing it.
    #[error(transparent)]
    Solution(#[from] SolutionError),
    /// Writing.
    #[error(transparent)]
    Export(#[from] ExportError),
}

impl FileFormat {
    /// All formats by their extensions.
    pub const ALL: [(&str, Self); 5] =
        [("npz", Self::Npz), ("glb", Self::Glb), ("ply", Self::Ply), ("obj", Self::Obj), ("rad", Self::Rad)];

    /// The format of a file by its extension.
    ///
    /// # Errors
    /// [`SaveError::Format`].
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = Self::ALL.iter().find(|(known, _)| *known == extension);
        known.map(|(_, format)| *format).ok_or_else(|| SaveError::Format(path.to_owned()))
    }

    fn extensions() -> String {
        Self::ALL.map(|(extension, _)| format!(".{extension}")).join(", ")
    }

    /// Writes all light of a solution, atomically.
    ///
    /// # Errors
    /// See [`SaveError`].
    pub fn write(self, path: &Path, scene: &Scene, solution: &Solution) -> Result<(), SaveError> {
        let lighting = || solution.lighting(scene, &SolutionSelection::Sum);
        match self {
            Self::Npz => solution.save(path)?,
            Self::Glb => drop(write_glb(path, scene, &lighting()?, ColorScale::Auto)?),
            Self::Ply => drop(write_ply(path, scene, &lighting()?, ColorScale::Auto)?),
            Self::Obj => drop(write_obj(path, scene, &lighting()?, ColorScale::Auto)?),
            Self::Rad => {
                let rad = RadFile::from_lighting(scene, &lighting()?).map_err(SolutionError::from)?;
                rad.write(path)?;
            }
        }
        Ok(())
    }
}
