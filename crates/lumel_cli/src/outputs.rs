//! Files that a bake writes.

use crate::failure::{hinted, with_hint};
use crate::picture;
use anyhow::{Context, bail};
use lumel::{Baker, FileFormat, Solution, SolutionSelection};
use lumel_export::check_obj;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    /// Light, or a lit mesh.
    Light(FileFormat),
    /// A picture.
    Picture,
}

/// All contents by their extension.
fn contents() -> impl Iterator<Item = (&'static str, Content)> {
    let light = FileFormat::ALL.into_iter().map(|(extension, format)| (extension, Content::Light(format)));
    light.chain([("png", Content::Picture)])
}

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Output {
    /// Its path.
    pub(crate) path: PathBuf,
    content: Content,
}

impl Output {
    /// A file whose extension selects the format.
    pub(crate) fn new(path: &Path) -> anyhow::Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let Some((_, content)) = contents().find(|(known, _)| *known == extension) else {
            let all: Vec<String> = contents().map(|(extension, _)| format!(".{extension}")).collect();
            let all = all.join(", ");
            let problem = if extension.is_empty() { "no extension" } else { "an unknown extension" };
            return Err(hinted(
                format!("the output has {problem}: {}", path.display()),
                format!("use one of {all}"),
            ));
        };
        Ok(Self { path: path.to_owned(), content })
    }

    /// Whether it is a picture.
    pub(crate) fn is_picture(&self) -> bool {
        self.content == Content::Picture
    }

    /// Checks that the additional files of this format do not replace existing foreign files.
    pub(crate) fn check_company(&self) -> anyhow::Result<()> {
        if self.content == Content::Light(FileFormat::Obj) {
            check_obj(&self.path)?;
        }
        Ok(())
    }

    /// Writes the file. Returns its size in bytes.
    pub(crate) fn write(
        &self,
        baker: &Baker,
        solution: &Solution,
        cancel: &AtomicBool,
    ) -> anyhow::Result<u64> {
        let (path, scene) = (&self.path, baker.scene());
        match self.content {
            Content::Light(format) => format.write(path, scene, solution)?,
            Content::Picture => {
                let lighting = solution.lighting(scene, &SolutionSelection::Sum)?;
                picture::write_default(path, scene, &**baker.tracer(), &lighting, cancel)?;
            }
        }
        Ok(fs::metadata(path).with_context(|| format!("cannot find {}", path.display()))?.len())
    }
}

/// Checks before a long bake that all files can be written and that none would replace a source of the scene.
pub(crate) fn check(paths: &[&Path], sources: &[PathBuf]) -> anyhow::Result<()> {
    let sources: Vec<PathBuf> = sources.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let mut seen = Vec::new();
    for path in paths {
        check_writable(path)?;
        let place =
            folder_of(path).canonicalize().unwrap_or_default().join(path.file_name().unwrap_or_default());
        if seen.contains(&place) {
            bail!("a file would be written twice: {}", path.display());
        }
        if path.canonicalize().is_ok_and(|path| sources.contains(&path)) {
            bail!("this file is part of the scene and would be replaced: {}", path.display());
        }
        seen.push(place);
    }
    Ok(())
}

/// Checks that a file can be written by creating a temporary one in its folder.
pub(crate) fn check_writable(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if path.file_name().is_none() || path.is_dir() {
        bail!("this is a folder, not a file that can be written: {}", path.display());
    }
    if !folder.is_dir() {
        let message = format!("the folder \"{}\" does not exist: {}", folder.display(), path.display());
        return Err(hinted(message, "create it or choose another"));
    }
    if fs::metadata(path).is_ok_and(|old| old.permissions().readonly()) {
        let message = format!("the file is write-protected: {}", path.display());
        return Err(hinted(message, "remove it or choose another name"));
    }
    let probe = tempfile::Builder::new().prefix(".lumel-").suffix(".tmp").tempfile_in(folder);
    let error = probe.err().map(|error| anyhow::Error::new(error.into_inner_error()));
    error.map_or(Ok(()), |error| {
        let error = error.context(format!("cannot write into the folder of {}", path.display()));
        Err(with_hint(error, "choose another folder or change its permissions"))
    })
}

/// The folder a file is in; a bare name is in the current one.
pub(crate) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The cause without the name of the temporary file.
trait InnerError {
    fn into_inner_error(self) -> std::io::Error;
}

impl InnerError for std::io::Error {
    fn into_inner_error(self) -> std::io::Error {
        self.raw_os_error().map_or(self, std::io::Error::from_raw_os_error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_tell_the_format_in_any_case() {
        assert_eq!(Output::new(Path::new("a.GLB")).unwrap().content, Content::Light(FileFormat::Glb));
        assert_eq!(Output::new(Path::new("x/a.b.npz")).unwrap().content, Content::Light(FileFormat::Npz));
        for bad in ["a", "a.mtl", ".npz", "a.npz/"] {
            let result = Output::new(Path::new(bad));
            assert!(result.is_err() || bad.ends_with('/'), "{bad}");
        }
        let error = Output::new(Path::new("a.exr")).unwrap_err();
        assert_eq!(crate::failure::hint(&error), Some("use one of .npz, .glb, .ply, .obj, .rad, .png"));
    }

    #[test]
    fn files_that_cannot_be_written_are_found_in_time() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let text =
            |paths: &[&Path], sources: &[PathBuf]| crate::failure::text(&check(paths, sources).unwrap_err());
        assert!(check(&[&file("a.npz"), &file("b.npz")], &[]).is_ok());
        assert!(text(&[&file("missing/a.npz")], &[]).contains("does not exist"));
        assert!(text(&[folder.path()], &[]).contains("folder"));
        assert!(text(&[&file("a.npz"), &file("./a.npz")], &[]).contains("twice"));
        fs::write(file("room.glb"), "x").unwrap();
        assert!(text(&[&file("room.glb")], &[file("room.glb")]).contains("part of the scene"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
    }
}
