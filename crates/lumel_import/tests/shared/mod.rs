//! The folder of test data beside the repository, and helpers to look at what was loaded.

#![allow(dead_code, reason = "not every test uses all of it")]
#![allow(clippy::print_stdout, reason = "a skipped test says so")]

use lumel_import::{ImportError, ImportOptions, load};
use lumel_scene::{Scene, SceneBuilder, Warnings};
use std::path::{Path, PathBuf};

/// A folder of the shared test data. Where it is absent, says so and returns `None`; under CI that is a failure.
pub(crate) fn folder(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(name);
    if path.is_dir() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "test data is missing: {}", path.display());
    println!("skipped: no test data at {}", path.display());
    None
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
