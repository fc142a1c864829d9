//! Pages of lightmaps as images.

mod dither;
mod exr;
mod npz;
mod png;
mod shared_exponent;

use crate::ExportError;
use glam::Vec3;
use lumel_lightmap::Lightmap;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub(crate) use dither::{Curve, dithered, dithered_over};
pub use exr::{Precision, write_lightmap_exr};
pub use npz::LightmapSolution;
pub(crate) use png::encode_rgb;
pub use png::{PngDepth, write_lightmap_png};
pub(crate) use shared_exponent::shared_exponent;

/// The file of one of several pages of a lightmap or an atlas: `room-2.exr` for `room.exr`; the file itself if there is one.
pub fn path_of_page(path: &Path, page: usize, pages: usize) -> PathBuf {
    if pages == 1 {
        return path.to_owned();
    }
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{page}."));
    name.push(path.extension().unwrap_or_default());
    path.with_file_name(name)
}

/// Writes something of several pages by `write(page, its file)`, in their order. Returns the files.
///
/// # Errors
/// The first error.
pub fn write_pages<E>(
    path: &Path,
    pages: usize,
    write: impl Fn(usize, &Path) -> Result<(), E>,
) -> Result<Vec<PathBuf>, E> {
    let written = |page| {
        let path = path_of_page(path, page, pages);
        write(page, &path).map(|()| path)
    };
    (0..pages).map(written).collect()
}

/// The lumels of a page, of which a file of `path` is to be made.
pub(crate) fn lumels_of(path: &Path, lightmap: &Lightmap, page: usize) -> Result<Range<usize>, ExportError> {
    let Some(&[width, height]) = lightmap.atlas.pages().get(page) else {
        return Err(ExportError::content(path, format!("the lightmap has no page {page}")));
    };
    let first = lightmap.atlas.first_lumel(page);
    Ok(first..first + width as usize * height as usize)
}

/// Refuses a lightmap without layers, whose numbers of lumels differ, or with light that is not finite.
pub(crate) fn check(path: &Path, lightmap: &Lightmap) -> Result<(), ExportError> {
    let refuse = |problem: String| Err(ExportError::content(path, problem));
    let n = lightmap.atlas.lumel_count();
    if lightmap.layers.is_empty() {
        return refuse("the lightmap has no light".into());
    }
    if lightmap.valid.len() != n {
        return refuse(format!(
            "validity of {} lumels does not belong to an atlas of {n}",
            lightmap.valid.len()
        ));
    }
    for layer in &lightmap.layers {
        if layer.values.len() != n {
            let found = layer.values.len();
            return refuse(format!("\"{}\" has {found} lumels, and the atlas {n}", layer.name));
        }
        if let Some(lumel) = layer.values.iter().position(|value| !value.is_finite()) {
            let (page, [x, y]) = lightmap.atlas.column_and_row(lumel);
            return refuse(format!("\"{}\" is not finite at lumel ({x}, {y}) of page {page}", layer.name));
        }
    }
    Ok(())
}

/// The largest of all channels, and 0 at least.
pub(crate) fn largest(values: &[Vec3]) -> f32 {
    values.iter().fold(0.0, |largest, value| value.max_element().max(largest))
}
