//! The scenes of this folder, and helpers to look at what was loaded.

#![allow(dead_code, reason = "not every test uses all of it")]

use lumel_import::{ImportError, ImportOptions, load};
use lumel_scene::{Scene, SceneBuilder, Warnings};
use std::path::{Path, PathBuf};

/// A scene of the repository.
pub(crate) fn own(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes").join(file)
}

/// Loads a file with default options.
pub(crate) fn import(path: &Path) -> Result<(SceneBuilder, Warnings), ImportError> {
    load(path, &ImportOptions::default()).map(|imported| (imported.scene, imported.warnings))
}

/// Loads and builds a file; errors as text.
pub(crate) fn build(path: &Path) -> Result<(Scene, Warnings), String> {
    let (builder, mut warnings) = import(path).map_err(|error| error.to_string())?;
    let (scene, more) = builder.build().map_err(|error| error.to_string())?;
    warnings.append(more);
    Ok((scene, warnings))
}

/// Triangles and their total area before the scene is built, when back sides are not there yet.
pub(crate) fn triangles_and_area(builder: &SceneBuilder) -> (usize, f64) {
    let corners =
        builder.objects.iter().flat_map(|object| object.faces.iter().map(|face| object.corners(face)));
    corners.fold((0, 0.0), |(count, area), corners| {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        (count + 1, area + 0.5 * (b - a).cross(c - a).length())
    })
}

/// Triangles that are left out as they are in the place of others.
pub(crate) fn coincident(warnings: &Warnings) -> usize {
    let left_out = warnings.iter().filter(|warning| warning.message.contains("face the same way: left out"));
    left_out.filter_map(|warning| warning.message.split(' ').next()?.parse::<usize>().ok()).sum()
}
