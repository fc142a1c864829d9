//! What goes into reading a scene file, and what comes out.

use crate::PathPolicy;
use crate::text::escaped;
use lumel_scene::{SceneBuilder, Warnings};
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

/// Why vertex colours of files that lumel has written are not used.
pub(crate) const BAKED_COLORS: &str =
    "lumel has baked its vertex colours: they are light and left out of the albedo";

/// The name of the scene in a file.
pub(crate) fn scene_name(path: &Path) -> String {
    escaped(&path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy())
}
