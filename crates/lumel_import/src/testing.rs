//! Helpers of the unit tests.

use crate::{ImportError, ImportOptions, Imported, load};
use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use tempfile::TempDir;

/// A folder with the given files.
pub(crate) fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        let path: PathBuf = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).unwrap();
        std::fs::write(path, content).unwrap();
    }
    folder
}

/// Loads the first of some files.
pub(crate) fn try_load(files: &[(&str, &[u8])]) -> Result<Imported, ImportError> {
    let folder = folder(files);
    load(&folder.path().join(files[0].0), &ImportOptions::default())
}

/// The error of the first of some files, as text without the folder.
pub(crate) fn load_error(files: &[(&str, &[u8])]) -> String {
    let folder = folder(files);
    let error = load(&folder.path().join(files[0].0), &ImportOptions::default()).unwrap_err();
    without_folder(&error.to_string(), folder.path())
}

/// A scene and its warnings as text without the folder.
pub(crate) fn load_with_warnings(files: &[(&str, &[u8])]) -> (Imported, Vec<String>) {
    let folder = folder(files);
    let imported = load(&folder.path().join(files[0].0), &ImportOptions::default()).unwrap();
    let texts = imported.warnings.iter().map(|w| without_folder(&w.to_string(), folder.path())).collect();
    (imported, texts)
}

fn without_folder(text: &str, folder: &Path) -> String {
    let canonical = folder.canonicalize().unwrap();
    let start = |folder: &Path| format!("{}{MAIN_SEPARATOR}", folder.display());
    text.replace(&start(&canonical), "").replace(&start(folder), "")
}

/// A PNG of one row of texels.
pub(crate) fn png_row(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = image::RgbaImage::from_fn(texels.len() as u32, 1, |x, _| image::Rgba(texels[x as usize]));
    image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

/// A PNG of one colour.
pub(crate) fn png(rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = image::RgbaImage::from_pixel(2, 2, image::Rgba(rgba));
    image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}
