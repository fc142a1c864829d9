//! Reads OBJ, glTF, PLY and textures into lumel scenes.
//!
//! [`load`] chooses the reader and returns a [`SceneBuilder`](lumel_scene::SceneBuilder) with the content of the file,
//! and warnings about missing textures, unknown materials, polygons without area and the like. Malformed files are
//! errors that name file, line and object. Control characters in names and messages are spelled out. No input makes this crate panic, hang or allocate much more than the size
//! of the file.

mod color;
mod error;
mod format;
mod gltf;
mod image;
mod imported;
mod lines;
mod mtl;
mod obj;
mod paths;
mod ply;
mod polygon;
mod sky;
mod tally;
#[cfg(test)]
mod testing;
mod text;

pub use error::ImportError;
use format::Format;
pub use image::{TextureError, load_texture};
pub use imported::{ImportOptions, Imported};
use lumel_scene::{Warning, Warnings};
pub use paths::{PathError, PathPolicy};
pub use sky::load_sky;
use std::path::{Path, PathBuf};
use text::escaped;

/// Reads a scene file. The format is determined by the extension, otherwise by the content.
///
/// # Errors
/// See [`ImportError`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let is_empty = std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() == 0);
    let imported = Format::of(path).and_then(|format| match format {
        Format::Obj => obj::load(path, options),
        // Their parsers would tell of a missing header.
        Format::Gltf | Format::Ply if is_empty => {
            Err(ImportError::malformed(path, "the file is empty; export or copy it again"))
        }
        Format::Gltf => gltf::load(path, options),
        Format::Ply => ply::load(path, options),
    });
    let mut imported = imported.map_err(ImportError::escaped)?;
    let mut warnings = Warnings::default();
    for Warning { subject, message } in imported.warnings.iter() {
        warnings.push(escaped(subject), escaped(message));
    }
    imported.warnings = warnings;
    Ok(imported)
}

/// The file that `file` refers to by `reference`, if the policy allows it.
///
/// # Errors
/// See [`PathError`].
pub fn resolve(file: &Path, reference: &str, policy: PathPolicy) -> Result<PathBuf, PathError> {
    let reached = paths::Resolver::new(file, policy);
    reached
        .map_err(|source| PathError::Io { reference: file.display().to_string(), source })?
        .resolve(reference)
}
