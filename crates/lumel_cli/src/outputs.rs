//! Files that a bake writes.

use crate::args::{Basis, Png};
use crate::commands::Lightmapped;
use crate::failure::{hinted, with_hint};
use crate::picture;
use crate::source::SceneSource;
use anyhow::{Context, bail};
use lumel::{
    Baker, FileFormat, Lighting, LightmapSolution, Scene, Solution, SolutionSelection, gated, tracer_of,
};
use lumel_export::{
    GlbOptions, LightmapTarget, Lock, PngDepth, Precision, check_obj, remove_strays, write_glb,
    write_lightmap_exr, write_lightmap_glb, write_lightmap_png, write_pages,
};
use lumel_render_cpu::NormalMaps;
use serde_json::Value;
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    /// Light at vertices, or a lit mesh.
    Light(FileFormat),
    /// The pages of a lightmap.
    Pages,
    /// A lightmap, for other commands.
    Lightmap,
    /// The mesh with a lightmap.
    LightmapGlb,
    /// A picture.
    Picture,
}

/// All contents by their extension.
fn contents(basis: Basis) -> Vec<(&'static str, Content)> {
    match basis {
        Basis::Vertex | Basis::Points => {
            let light =
                FileFormat::ALL.into_iter().map(|(extension, format)| (extension, Content::Light(format)));
            light.chain([("png", Content::Picture)]).collect()
        }
        Basis::Lightmap => {
            vec![
                ("exr", Content::Pages),
                ("glb", Content::LightmapGlb),
                ("npz", Content::Lightmap),
                ("png", Content::Picture),
            ]
        }
    }
}

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Output {
    /// Its path.
    pub(crate) path: PathBuf,
    content: Content,
}

/// What there is to write.
pub(crate) struct Light<'a> {
    pub(crate) baker: &'a Baker,
    /// At vertices.
    pub(crate) solution: &'a Solution,
    /// In lumels, if it was asked for.
    pub(crate) lightmapped: Option<&'a Lightmapped>,
    /// What a GLB file with a lightmap is made for.
    pub(crate) target: LightmapTarget,
    /// How one with light at vertices is written.
    pub(crate) glb: GlbOptions,
    /// How the scene was opened, where that can be said.
    pub(crate) source: Option<SceneSource>,
    /// What a PNG file with a lightmap holds.
    pub(crate) png: Png,
    /// Where green of normal maps points.
    pub(crate) green: NormalMaps,
}

/// A scene whose normal maps have green up, where that of its files points some way.
pub(crate) fn with_green_up(scene: &Scene, green: NormalMaps) -> Cow<'_, Scene> {
    match green {
        NormalMaps::Down => Cow::Owned(scene.with_green_flipped()),
        NormalMaps::Up | NormalMaps::Off => Cow::Borrowed(scene),
    }
}

impl Output {
    /// A file whose extension selects the format, among those for light that is stored in this basis.
    pub(crate) fn new(path: &Path, basis: Basis) -> anyhow::Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let contents = contents(basis);
        let find = |contents: &[(&str, Content)]| {
            contents.iter().find(|(known, _)| *known == extension).map(|(_, content)| *content)
        };
        if let Some(content) = find(&contents) {
            return Ok(Self { path: path.to_owned(), content });
        }
        let all: Vec<String> = contents.iter().map(|(extension, _)| format!(".{extension}")).collect();
        let all = all.join(", ");
        let other = if basis == Basis::Lightmap { Basis::Vertex } else { Basis::Lightmap };
        let problem = match extension.as_str() {
            "" => "the output has no extension".to_owned(),
            _ if find(&self::contents(other)).is_some() => {
                let name = match basis {
                    Basis::Vertex => "--basis vertex",
                    Basis::Points => "--basis points",
                    Basis::Lightmap => "--basis lightmap",
                };
                format!("{name} writes no .{extension} files")
            }
            _ => "the output has an unknown extension".to_owned(),
        };
        Err(hinted(format!("{problem}: {}", path.display()), format!("use one of {all}")))
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

    /// What the file says of how the scene was opened.
    fn source(&self, light: &Light<'_>) -> Option<Value> {
        light.source.as_ref()?.beside(&self.path)
    }

    /// Writes the file, or one for each page. Returns each with its size in bytes.
    pub(crate) fn write(
        &self,
        light: &Light<'_>,
        cancel: &AtomicBool,
    ) -> anyhow::Result<Vec<(PathBuf, u64)>> {
        let Light { baker, solution, target, png, green, .. } = light;
        let mut paths = vec![self.path.clone()];
        match (self.content, light.lightmapped) {
            (Content::Light(FileFormat::Glb), _) => {
                let scene = with_green_up(baker.scene(), *green);
                let lighting = solution.lighting(&scene, &SolutionSelection::Sum)?;
                write_glb(&self.path, &scene, &lighting, light.glb)?;
            }
            (Content::Light(FileFormat::Npz), _) => solution.save_from(self.source(light), &self.path)?,
            (Content::Light(format), _) => {
                format.write(&self.path, &with_green_up(baker.scene(), *green), solution)?;
            }
            (Content::Picture, None) => {
                let scene = with_green_up(baker.scene(), *green);
                let tracer = &**baker.tracer();
                let scattered = solution.scattered_light(&scene, &SolutionSelection::Sum)?;
                let scattered = scattered.map(|light| gated(light, &scene, tracer));
                let lighting: Box<dyn Lighting> = match &scattered {
                    Some(scattered) => Box::new(scattered.lighting(&scene)?),
                    None => Box::new(solution.lighting(&scene, &SolutionSelection::Sum)?),
                };
                picture::write_default(&self.path, &scene, tracer, &*lighting, cancel)?;
            }
            (Content::Picture, Some(Lightmapped { scene, lightmap, .. })) => {
                let depth = match png {
                    Png::Picture => None,
                    Png::Sixteen => Some(PngDepth::Sixteen),
                    Png::Eight => Some(PngDepth::Eight),
                };
                if let Some(depth) = depth {
                    let write =
                        |page, path: &Path| write_lightmap_png(path, lightmap, page, depth).map(|_| ());
                    let paths = write_pages(&self.path, lightmap.atlas.pages().len(), write)?;
                    return paths.into_iter().map(sized).collect();
                }
                let (scene, light) = (with_green_up(scene, *green), lightmap.by_direction(0));
                picture::write_default(&self.path, &scene, &*tracer_of(&scene), &light, cancel)?;
            }
            (Content::LightmapGlb, Some(Lightmapped { scene, lightmap, .. })) => {
                write_lightmap_glb(&self.path, &with_green_up(scene, *green), lightmap, *target)?;
            }
            (Content::Pages, Some(Lightmapped { lightmap, .. })) => {
                let settings = solution.meta.settings.to_string();
                let attributes = [("scene", baker.scene().name()), ("settings", &*settings)];
                let write = |page, path: &Path| {
                    write_lightmap_exr(path, lightmap, page, Precision::Float, &attributes)
                };
                paths = write_pages(&self.path, lightmap.atlas.pages().len(), write)?;
            }
            (Content::Lightmap, Some(Lightmapped { scene, lightmap, .. })) => {
                let settings = solution.meta.settings.clone();
                let mut solution = LightmapSolution::new(scene, settings, Arc::clone(lightmap));
                solution.meta.source = self.source(light);
                solution.save(&self.path)?;
            }
            (Content::Pages | Content::LightmapGlb | Content::Lightmap, None) => {}
        }
        paths.into_iter().map(sized).collect()
    }
}

/// A file that was written and its size.
pub(crate) fn sized(path: PathBuf) -> anyhow::Result<(PathBuf, u64)> {
    let found = fs::metadata(&path).with_context(|| format!("cannot find {}", path.display()))?;
    Ok((path, found.len()))
}

/// The right to write files, until it is dropped.
#[must_use]
pub(crate) struct Claim(
    #[expect(dead_code, reason = "locks are given back when they are dropped")] Vec<Lock>,
);

/// Checks before a long bake that all files can be written, that none would replace a source of the scene, and that nobody
/// else writes them. Removes what killed processes have left beside them.
pub(crate) fn claim(paths: &[&Path], sources: &[PathBuf]) -> anyhow::Result<Claim> {
    let sources: Vec<PathBuf> = sources.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let mut seen = Vec::new();
    let mut locks = Vec::new();
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
        remove_strays(folder_of(path));
        let lock = Lock::take(path);
        locks.extend(lock.map_err(|error| with_hint(error, "wait for it, or choose another name"))?);
        seen.push(place);
    }
    Ok(Claim(locks))
}

/// Checks that a file can be written by creating a temporary one in its folder.
pub(crate) fn check_writable(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if path.file_name().is_none() || path.is_dir() {
        bail!("this is a folder, not a file that can be written: {}", path.display());
    }
    if fs::metadata(path).is_ok_and(|old| !old.is_file()) {
        let message = format!("this is a device or a pipe, which cannot be written: {}", path.display());
        return Err(hinted(message, "write a file, and copy it there"));
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
        assert_eq!(
            Output::new(Path::new("a.GLB"), Basis::Vertex).unwrap().content,
            Content::Light(FileFormat::Glb)
        );
        assert_eq!(
            Output::new(Path::new("x/a.b.npz"), Basis::Vertex).unwrap().content,
            Content::Light(FileFormat::Npz)
        );
        for bad in ["a", "a.mtl", ".npz", "a.npz/"] {
            let result = Output::new(Path::new(bad), Basis::Vertex);
            assert!(result.is_err() || bad.ends_with('/'), "{bad}");
        }
        for (name, basis, problem, hint) in [
            ("a.tif", Basis::Vertex, "unknown extension", "use one of .npz, .glb, .ply, .obj, .rad, .png"),
            ("a.exr", Basis::Vertex, "--basis vertex writes no .exr files", "use one of .npz, .glb, .ply"),
            (
                "a.ply",
                Basis::Lightmap,
                "--basis lightmap writes no .ply files",
                "use one of .exr, .glb, .npz, .png",
            ),
        ] {
            let error = Output::new(Path::new(name), basis).unwrap_err();
            assert!(error.to_string().contains(problem), "{error}");
            assert!(crate::failure::hint(&error).unwrap().starts_with(hint), "{error}");
        }
        assert_eq!(Output::new(Path::new("a.glb"), Basis::Lightmap).unwrap().content, Content::LightmapGlb);
    }

    #[test]
    fn files_that_cannot_be_written_are_found_in_time() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let text = |paths: &[&Path], sources: &[PathBuf]| {
            crate::failure::text(&claim(paths, sources).err().unwrap())
        };
        assert!(claim(&[&file("a.npz"), &file("b.npz")], &[]).is_ok());
        assert!(text(&[&file("missing/a.npz")], &[]).contains("does not exist"));
        assert!(text(&[folder.path()], &[]).contains("folder"));
        assert!(text(&[&file("a.npz"), &file("./a.npz")], &[]).contains("twice"));
        fs::write(file("room.glb"), "x").unwrap();
        assert!(text(&[&file("room.glb")], &[file("room.glb")]).contains("part of the scene"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
    }
}
