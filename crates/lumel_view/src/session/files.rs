//! Files that a session reads and writes, on other threads.

use super::file_light::{LightUse, LoadedLight, SavedFile, light_from};
use super::{Computed, Session};
use crate::document::error_text;
use crate::inputs::Inputs;
use crate::lights::shining;
use crate::mesh::{Given, Mesh};
use crate::notice::Level;
use crate::point_light::PointIllumination;
use crate::relief::ReliefPrefs;
use crate::selection::Selection;
use crate::task::Background;
use lumel::{
    Baker, CameraEntry, LightFile, Project, Saved, Scene, SettingsPatch, SkyEntry, SolutionSelection,
    VertexLighting,
};
use lumel_export::{ColorScale, GlbOptions, GltfMaterials, RadFile, write_glb, write_obj, write_ply};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The formats of lit meshes, by extension.
pub const MESH_FORMATS: [&str; 3] = ["glb", "ply", "obj"];

/// How a lit mesh is saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshExport {
    /// What of the light.
    pub light: Selection,
    /// What multiplies the colours that viewers show.
    pub exposure: ColorScale,
    /// What the materials of a GLB file are.
    pub materials: GltfMaterials,
}

/// The formats of solutions, by extension.
pub const SOLUTION_FORMATS: [&str; 2] = ["npz", "rad"];

/// The lower-case extension of a path if it is one of these.
pub(super) fn extension_of(path: &Path, formats: &[&str]) -> Result<String, String> {
    let found = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if formats.contains(&found.as_str()) {
        return Ok(found);
    }
    let all = formats.iter().map(|f| format!(".{f}")).collect::<Vec<_>>().join(", ");
    Err(format!("the name must end in {all}: {}", path.display()))
}

impl Session {
    /// Reads a solution for the open scene.
    pub fn load_solution(&mut self, path: &Path, usage: LightUse) {
        let Some(document) = &self.document else {
            self.notices.push(Level::Warning, "Open the scene of the solution first");
            return;
        };
        let (scene, opened, given) =
            (Arc::clone(&document.scene), Arc::clone(&document.opened), document.given.clone());
        let path = path.to_owned();
        let what = format!("reading {}", path.display());
        self.loading = Some(Background::start(what, Arc::clone(&self.wakes.event), move || {
            let (mesh, file) = load_light(&path, &scene, &opened, &given)?;
            Ok(LoadedLight { path, file, mesh, usage })
        }));
    }

    /// Writes the solution: all bounces (`.npz`), or their sum over π (`.rad`).
    ///
    /// # Errors
    /// When there is nothing to write, or the name says no format.
    pub fn save_solution(&mut self, path: &Path) -> Result<(), String> {
        let format = extension_of(path, &SOLUTION_FORMATS)?;
        if self.light.bounces.is_empty() && self.computed.as_ref().is_some_and(|c| c.file.is_none()) {
            return Err("there is no solution yet: the mesh is not refined".to_owned());
        }
        let solution = self.solution().ok_or("there is no solution yet: solve first")?;
        let (Some(document), false) = (&self.document, self.light.is_empty()) else {
            return Err("there is no solution yet: solve first".to_owned());
        };
        let scene = Arc::clone(&document.scene);
        let whole = format == "npz" && !self.is_solving();
        let solution_of = whole.then_some(self.light_generation);
        let what = if self.is_solving() { "the bounces so far" } else { "the solution" };
        self.write(path, what, solution_of, move |path| {
            if format == "npz" {
                solution.save(path).map_err(|e| error_text(&e))
            } else {
                let lighting =
                    solution.lighting(&scene, &SolutionSelection::Sum).map_err(|e| error_text(&e))?;
                let rad = RadFile::from_lighting(&scene, &lighting).map_err(|e| error_text(&e))?;
                rad.write(path).map_err(|e| error_text(&e))
            }
        });
        Ok(())
    }

    /// Writes the mesh with the chosen part of the light.
    ///
    /// # Errors
    /// When nothing is open, the name says no format, or the file is the scene itself.
    pub fn save_mesh(&mut self, path: &Path, export: MeshExport, relief: &ReliefPrefs) -> Result<(), String> {
        let format = extension_of(path, &MESH_FORMATS)?;
        let document = self.document.as_ref().ok_or("open a scene first")?;
        self.refuse_sources(path)?;
        let MeshExport { light: selection, exposure, materials } = export;
        let scene = relief.with_green_up(&document.scene);
        let light = self.selected_light(selection);
        let directions = self.light.select_directional(selection, scene.vertex_count()).cloned();
        let lit = !self.light.is_empty();
        let what =
            if lit { format!("the mesh with {selection}") } else { "the mesh without light".to_owned() };
        self.write(path, &what, None, move |path| {
            let lighting = VertexLighting::new(&scene, &light).map_err(|e| error_text(&e))?;
            let lighting = lighting.with_incident(directions.as_deref()).map_err(|e| error_text(&e))?;
            match format.as_str() {
                "glb" => write_glb(path, &scene, &lighting, GlbOptions { materials, exposure }),
                "ply" => write_ply(path, &scene, &lighting, exposure),
                _ => write_obj(path, &scene, &lighting, exposure),
            }
            .map(drop)
            .map_err(|e| error_text(&e))
        });
        Ok(())
    }

    /// A file beside the scene with its name and another extension; in the current folder for built-in scenes.
    pub fn path_beside_scene(&self, extension: &str) -> String {
        let Some(document) = &self.document else { return String::new() };
        let source = Path::new(&document.request.name);
        let file = source.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let stem = file.split('.').next().unwrap_or_default();
        let name = format!("{stem}.{extension}");
        if source.exists() { source.with_file_name(name).to_string_lossy().into_owned() } else { name }
    }

    /// Refuses to replace the files that the scene is made from.
    pub(super) fn refuse_sources(&self, path: &Path) -> Result<(), String> {
        let Some(document) = &self.document else { return Ok(()) };
        let source = Path::new(&document.request.name);
        let mut sources = vec![source.to_owned()];
        if let Some((file, project)) = &document.project {
            sources.extend(project.scene.as_ref().map(|mesh| folder_of(file).join(mesh)));
        }
        let same = |a: &PathBuf| a.canonicalize().is_ok_and(|a| path.canonicalize().is_ok_and(|b| a == b));
        if sources.iter().any(same) {
            return Err(format!(
                "this file belongs to the open scene and would be overwritten: {}",
                path.display()
            ));
        }
        Ok(())
    }

    /// Writes a file on another thread and tells when it is there.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        what: &str,
        solution_of: Option<u64>,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
    ) {
        let (path, what) = (path.to_owned(), what.to_owned());
        let doing = format!("saving {}", path.display());
        self.saving.push(Background::start(doing, Arc::clone(&self.wakes.event), move || {
            write(&path)?;
            Ok(SavedFile { path, solution_of, what })
        }));
    }

    /// Writes a project file: the scene by its name, lights, views, settings and slots.
    ///
    /// # Errors
    /// When nothing is open, the mesh is not in the project's folder or below, or the file cannot be written.
    pub fn save_project(&mut self, path: &Path) -> Result<(), String> {
        extension_of(path, &["toml"])?;
        let document = self.document.as_ref().ok_or("open a scene first")?;
        let old = document.project.as_ref();
        let mut project = old.map(|(_, project)| project.clone()).unwrap_or_default();
        match old {
            Some((file, Project { scene: Some(mesh), .. })) => {
                project.scene = Some(relative(&folder_of(file).join(mesh), path)?);
            }
            Some(_) => {}
            None if Path::new(&document.request.name).exists() => {
                project.scene = Some(relative(Path::new(&document.request.name), path)?);
            }
            None => project.builtin = Some(document.request.name.clone()),
        }
        let options = &document.request.options;
        project.max_edge = options.max_edge.or(project.max_edge);
        project.subdivide = options.subdivide.or(project.subdivide);
        for name in &options.two_sided {
            if !project.two_sided.contains(name) {
                project.two_sided.push(name.clone());
            }
        }
        project.lights = self.lights.iter().map(crate::lights::EditLight::entry).collect();
        for entry in document.repainted_materials() {
            project.materials.retain(|old| old.name != entry.name);
            project.materials.push(entry);
        }
        if self.sky != document.sky || self.sky.file.is_some() {
            let mut sky = self.sky.entry();
            if let Some(SkyEntry::Image(entry)) = &mut sky {
                entry.image = relative(&entry.image, path)?;
            }
            project.sky = sky;
        }
        project.slots = self.slots.entries();
        project.bake = SettingsPatch::complete(&self.settings);
        let view = CameraEntry::from(&self.camera.camera());
        project.cameras.retain(|camera| camera.name != view.name);
        project.cameras.insert(0, view);
        project.moved(document.scene.origin()).write(path).map_err(|e| error_text(&e))?;
        self.edits_are_saved();
        self.notices.push(Level::Info, format!("Saved the project: {}", path.display()));
        if let Some(document) = &mut self.document {
            document.request.name = path.to_string_lossy().into_owned();
            document.project = Some((path.to_owned(), project));
        }
        Ok(())
    }

    pub(super) fn poll_files(&mut self) {
        self.poll_sky();
        if let Some(result) = self.loading.as_ref().and_then(Background::poll) {
            self.loading = None;
            match result {
                Ok(loaded) => self.take_in(loaded),
                Err(problem) => {
                    self.notices.push(Level::Error, format!("Cannot load the solution: {problem}"))
                }
            }
        }
        let (mut done, mut failed) = (Vec::new(), false);
        self.saving.retain(|task| task.poll().map(|result| done.push(result)).is_none());
        for result in done {
            match result {
                Ok(saved) => self.saved(&saved),
                Err(problem) => {
                    failed = true;
                    self.notices.push(Level::Error, format!("Cannot save: {problem}"));
                }
            }
        }
        self.open_what_waits(failed);
    }

    fn saved(&mut self, saved: &SavedFile) {
        self.notices.push(Level::Info, format!("Saved {}: {}", saved.what, saved.path.display()));
        if saved.solution_of == Some(self.light_generation)
            && let Some(computed) = &mut self.computed
        {
            computed.saved = true;
            if let Some(recovery) = &self.recovery {
                recovery.remove();
            }
        }
    }

    fn take_in(&mut self, loaded: LoadedLight) {
        let LoadedLight { path, file, mesh, usage } = loaded;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if usage == LightUse::Compare {
            let light = light_from(&file);
            return self.keep(name, light, mesh);
        }
        self.end_solve();
        self.show_mesh(&mesh);
        self.show_light(file, name.clone(), true);
        self.note_refined_for(self.computed.as_ref().map(|computed| computed.inputs.clone()));
        self.notices.push(Level::Info, format!("Loaded {name}"));
    }

    /// Replaces the light that is shown by that of a file; stops a running solve.
    pub(super) fn show_light(&mut self, file: LightFile, name: String, saved: bool) {
        self.end_solve();
        let Some(document) = &self.document else { return };
        let mut light = light_from(&file);
        let solution = match file {
            LightFile::Solution(solution) => Some(Arc::new(*solution)),
            LightFile::Rad(_) => None,
        };
        light.points = solution.as_deref().and_then(|s| PointIllumination::of(s, &document.scene));
        let relit = document.relit(&self.lights).ok();
        let same_lights = match (&solution, &relit) {
            (Some(solution), Some(scene)) => solution.has_lighting_of(scene),
            _ => false,
        };
        if !same_lights && solution.is_some() {
            let text = format!("{name} was computed for different lights or materials");
            self.notices.push(Level::Warning, text);
        }
        let inputs = Inputs {
            scene: relit.unwrap_or_else(|| Arc::clone(&document.scene)),
            lights: same_lights.then(|| shining(&self.lights)),
            settings: solution.as_ref().and_then(|s| serde_json::from_value(s.meta.settings.clone()).ok()),
        };
        // A solve resumes from the file, so show the file's settings.
        if let (true, Some(settings)) = (same_lights, &inputs.settings) {
            self.settings = settings.clone();
        }
        self.computed = Some(Computed {
            complete: solution.as_ref().is_none_or(|s| s.meta.complete),
            saved,
            file: solution,
            origin: Some(name),
            ..Computed::unfinished(inputs)
        });
        self.stats.clear();
        self.unshot = None;
        self.light = light;
        self.light_generation += 1;
    }
}

/// Light from a file, with the mesh that it is on: one whose edges were split where light needed it, or that which was opened.
///
/// # Errors
/// A file that cannot be read, or is of another scene.
pub fn load_light(
    path: &Path,
    scene: &Scene,
    opened: &Baker,
    given: &Given,
) -> Result<(Mesh, LightFile), String> {
    // A file that is none is told by what reads it.
    let splits = Saved::load_splits(path).unwrap_or_default();
    let mesh = match splits.is_empty() {
        true => Mesh::of(opened),
        false => Mesh::refined(&*given.read(scene)?, &splits)?,
    };
    let file = LightFile::load_for(path, &mesh.scene).map_err(|e| error_text(&e))?;
    Ok((mesh, file))
}

fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A file's path as seen from a project file, which may only name what lies in its folder or below.
fn relative(file: &Path, project: &Path) -> Result<PathBuf, String> {
    let folder = folder_of(project);
    let absolute = |path: &Path| path.canonicalize().map_err(|e| format!("{e}: {}", path.display()));
    let (file, folder) = (absolute(file)?, absolute(&folder)?);
    file.strip_prefix(&folder).map(Path::to_owned).map_err(|_| {
        format!(
            "a project can only refer to files in its folder; save it where this file is in the folder or below: {}",
            file.display()
        )
    })
}
