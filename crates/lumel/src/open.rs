//! From a name on the command line to a scene.

use crate::max_edge::MaxEdge;
use crate::project::{MaterialEntry, ObjectEntry, Project, ProjectError};
use crate::settings::SettingsPatch;
use crate::two_sided::make_two_sided;
use lumel_import::{ImportError, ImportOptions, PathError, PathPolicy, TextureError};
use lumel_scene::{Light, SceneBuilder, SceneError, Warnings};
use std::path::{Path, PathBuf};

/// How to open a scene.
#[derive(Clone, Debug, Default)]
pub struct OpenOptions {
    /// Whether files may refer to files outside their folder.
    pub paths: PathPolicy,
    /// Longest edge after tessellation; replaces the project's. Where neither says, files get [`MaxEdge::Auto`] and built-in
    /// scenes stay as they are, and so do all whose mesh is to [follow light](Self::adaptive).
    pub max_edge: Option<MaxEdge>,
    /// Whether edges are split later, where light needs it; replaces what the [setting](crate::Adaptive) of the project says.
    pub adaptive: Option<bool>,
    /// How many vertices [`MaxEdge::Auto`] may add, about; replaces the [budget](crate::Preset::vertex_budget) of the
    /// project's preset. Where neither says, it is that of [`Preset::Medium`](crate::Preset::Medium).
    pub vertex_budget: Option<u32>,
    /// Levels of refinement of a built-in scene; replaces the project's.
    pub subdivide: Option<u32>,
    /// Names of materials or objects that have two sides, whatever the files say; "all" for all.
    pub two_sided: Vec<String>,
    /// Whether the scene is also wanted with no edge split, for a lightmap.
    pub keeps_whole: bool,
}

/// A scene that can still be changed before it is built.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The scene, tessellated.
    pub builder: SceneBuilder,
    /// The same with no edge split, if that is wanted.
    pub whole: Option<SceneBuilder>,
    /// What had to be left out.
    pub warnings: Warnings,
    /// The bake settings of its project file.
    pub settings: SettingsPatch,
    /// The project file, if it is one; for editing. Its lights and views are [moved](Project::moved) to the coordinates of
    /// the builder.
    pub project: Option<Project>,
    /// What [`MaxEdge::Auto`] chose, if it was what chose.
    pub auto_edge: Option<AutoEdge>,
}

/// What [`MaxEdge::Auto`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoEdge {
    /// The longest edge where the scene is finest, metres; `None` if it split none.
    pub length: Option<f32>,
    /// How many vertices it might add, about.
    pub vertex_budget: u32,
}

/// Why a scene cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Neither a file nor a built-in scene.
    #[error("there is no file \"{name}\" and no built-in scene of that name; built-in scenes: {}", lumel_builtin::NAMES.join(", "))]
    NotFound {
        /// What was asked for.
        name: String,
    },
    /// The mesh file.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The project file.
    #[error(transparent)]
    Project(#[from] ProjectError),
    /// A file that the project file refers to.
    #[error("{}: {source}", .project.display())]
    Reference {
        /// The project file.
        project: PathBuf,
        /// What is wrong with the reference.
        source: PathError,
    },
    /// The image of the sky in a project file.
    #[error("{}: {source}", .project.display())]
    Sky {
        /// The project file.
        project: PathBuf,
        /// What is wrong with the image.
        source: TextureError,
    },
    /// The tessellation.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// `subdivide` for a mesh from a file.
    #[error("only built-in scenes can be subdivided; use a longest edge for {}", .0.display())]
    NotBuiltin(PathBuf),
}

/// Opens a mesh file, a project file (`.toml`) or a built-in scene.
///
/// A file of the given name goes before a built-in scene. Paths need not be UTF-8.
///
/// # Errors
/// See [`OpenError`].
pub fn open(name: impl AsRef<Path>, options: &OpenOptions) -> Result<Opened, OpenError> {
    let path = name.as_ref();
    let mut opened = if Project::is_file_name(path) && path.exists() {
        open_project(path, options)?
    } else {
        let (builder, warnings) = open_mesh(path, options.subdivide, options)?;
        Opened {
            builder,
            whole: None,
            warnings,
            settings: SettingsPatch::default(),
            project: None,
            auto_edge: None,
        }
    };
    two_sided(&path.display().to_string(), &options.two_sided, &mut opened.builder, &mut opened.warnings);
    let of_project = opened.project.as_ref().and_then(|project| project.max_edge);
    let is_builtin = opened.project.as_ref().map_or(!path.exists(), |project| project.builtin.is_some());
    let is_adaptive = options.adaptive.unwrap_or(opened.settings.settings().refines_mesh());
    let max_edge = options.max_edge.or(of_project).unwrap_or(MaxEdge::usual(is_builtin || is_adaptive));
    let preset = opened.settings.preset.unwrap_or_default();
    let vertex_budget = options.vertex_budget.unwrap_or(preset.vertex_budget());
    opened.whole = options.keeps_whole.then(|| opened.builder.clone());
    if let Some(whole) = &mut opened.whole {
        // As it is opened by itself.
        MaxEdge::Off.apply(whole, vertex_budget)?;
    }
    let (length, warnings) = max_edge.apply(&mut opened.builder, vertex_budget)?;
    opened.warnings.append(warnings);
    let auto_edge = (max_edge == MaxEdge::Auto).then_some(AutoEdge { length, vertex_budget });
    Ok(Opened { auto_edge, ..opened })
}

fn open_mesh(
    path: &Path,
    subdivide: Option<u32>,
    options: &OpenOptions,
) -> Result<(SceneBuilder, Warnings), OpenError> {
    if !path.exists() {
        let scene = path.to_str().and_then(|name| lumel_builtin::scene(name, subdivide.unwrap_or(0)));
        let missing = || OpenError::NotFound { name: path.display().to_string() };
        return scene.map(|s| (s, Warnings::default())).ok_or_else(missing);
    }
    if subdivide.is_some() {
        return Err(OpenError::NotBuiltin(path.to_owned()));
    }
    let imported = lumel_import::load(path, &ImportOptions { paths: options.paths })?;
    Ok((imported.scene, imported.warnings))
}

fn open_project(path: &Path, options: &OpenOptions) -> Result<Opened, OpenError> {
    let project = Project::read(path)?;
    let subdivide = options.subdivide.or(project.subdivide);
    let (mut builder, mut warnings) = match (&project.scene, &project.builtin) {
        (Some(file), _) => {
            let file = resolve(path, file, options)?;
            open_mesh(&file, subdivide, options)?
        }
        (None, name) => {
            let name = name.clone().unwrap_or_default();
            let scene =
                lumel_builtin::scene(&name, subdivide.unwrap_or(0)).ok_or(OpenError::NotFound { name })?;
            (scene, Warnings::default())
        }
    };
    let project = project.moved(-builder.origin);
    apply(&project, path, options, &mut builder, &mut warnings)?;
    let settings = project.settings();
    Ok(Opened { builder, whole: None, warnings, settings, project: Some(project), auto_edge: None })
}

fn resolve(project: &Path, reference: &Path, options: &OpenOptions) -> Result<PathBuf, OpenError> {
    let found = lumel_import::resolve(project, &reference.to_string_lossy(), options.paths);
    found.map_err(|source| OpenError::Reference { project: project.to_owned(), source })
}

/// Puts a project's lights, cameras and other changes into its scene.
fn apply(
    project: &Project,
    path: &Path,
    options: &OpenOptions,
    builder: &mut SceneBuilder,
    warnings: &mut Warnings,
) -> Result<(), OpenError> {
    if !project.lights.is_empty() {
        builder.clear_lights();
    }
    let invalid = |message| ProjectError::Invalid { path: path.to_owned(), message };
    for entry in project.lights.iter().filter(|entry| !entry.off) {
        let mut light = entry.light().map_err(|error| invalid(error.to_string()))?;
        if let (Some(texture), Light::Rect(light)) = (&entry.texture, &mut light) {
            let file = resolve(path, texture, options)?;
            match lumel_import::load_texture(&file, lumel_scene::Encoding::Srgb) {
                Ok(texture) => {
                    light.texture = Some(lumel_scene::TextureId(builder.textures.len() as u32));
                    builder.textures.push(texture);
                }
                Err(error) => {
                    warnings.push(path.display().to_string(), format!("light without its texture: {error}"))
                }
            }
        }
        builder.add_named_light(entry.name.clone().unwrap_or_default(), light);
    }
    builder.cameras.splice(0..0, project.cameras.iter().map(|camera| camera.camera()));
    if let Some(sky) = &project.sky {
        let file = sky.file().map(|file| resolve(path, file, options)).transpose()?;
        let loaded = sky.load(file.as_deref(), warnings);
        builder.sky = loaded.map_err(|source| OpenError::Sky { project: path.to_owned(), source })?;
    }
    for MaterialEntry { name, albedo } in &project.materials {
        let mut found = false;
        for material in builder.materials.iter_mut().filter(|material| material.name == *name) {
            material.albedo = *albedo;
            found = true;
        }
        if !found {
            let text = format!("there is no material \"{name}\" to give an albedo to");
            warnings.push(path.display().to_string(), text);
        }
    }
    for ObjectEntry { name, density_factor } in &project.objects {
        let named = builder.objects.iter_mut().filter(|object| object.name == *name);
        if named.map(|object| object.density_factor = Some(*density_factor)).count() == 0 {
            let text = format!("there is no object \"{name}\" to give a density factor to");
            warnings.push(path.display().to_string(), text);
        }
    }
    two_sided(&path.display().to_string(), &project.two_sided, builder, warnings);
    Ok(())
}

/// Makes materials and objects two-sided; warns of names that there are none of.
fn two_sided(subject: &str, names: &[String], builder: &mut SceneBuilder, warnings: &mut Warnings) {
    for name in names {
        if !make_two_sided(builder, name) {
            let text = format!("there is no material or object \"{name}\" to make two-sided");
            warnings.push(subject, text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LightEntry, MaterialEntry, Preset};
    use glam::{DVec3, Vec3};

    fn open_with(lights: Vec<LightEntry>) -> Opened {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        let project = Project { builtin: Some("cornell-box".into()), lights, ..Project::default() };
        project.write(&path).unwrap();
        let opened = open(&path, &OpenOptions::default()).unwrap();
        assert_eq!(opened.project, Some(project));
        opened
    }

    #[test]
    fn a_scene_that_is_kept_whole_is_that_which_is_opened_with_no_edge_split() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        // A square that is there twice, split along both diagonals.
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 2 4 1\nf 2 3 4\n";
        std::fs::write(&path, text).unwrap();
        let hash = |builder: SceneBuilder| builder.build().unwrap().0.geometry_hash();
        let opened = |max_edge, keeps_whole| {
            let options = OpenOptions { max_edge: Some(max_edge), keeps_whole, ..OpenOptions::default() };
            open(&path, &options).unwrap()
        };
        let whole = opened(MaxEdge::Length(0.3), true).whole.unwrap();
        assert_eq!(hash(whole), hash(opened(MaxEdge::Off, false).builder));
    }

    #[test]
    fn materials_of_a_project_replace_the_albedos_of_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        let entry = |name: &str| MaterialEntry { name: name.into(), albedo: Vec3::new(0.1, 0.2, 0.3) };
        let materials = vec![entry("white"), entry("gold")];
        let project = Project { builtin: Some("cornell-box".into()), materials, ..Project::default() };
        project.write(&path).unwrap();
        let opened = open(&path, &OpenOptions::default()).unwrap();
        let white = opened.builder.materials.iter().find(|material| material.name == "white").unwrap();
        assert_eq!(white.albedo, Vec3::new(0.1, 0.2, 0.3));
        let warnings: Vec<String> = opened.warnings.iter().map(ToString::to_string).collect();
        assert!(warnings.iter().any(|w| w.contains("there is no material \"gold\"")), "{warnings:?}");
    }

    #[test]
    fn objects_of_a_project_have_its_density_factors_instead_of_those_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        let entry = |name: &str| ObjectEntry { name: name.into(), density_factor: 2.5 };
        let objects = vec![entry("floor"), entry("cellar")];
        Project { builtin: Some("cornell-box".into()), objects, ..Project::default() }.write(&path).unwrap();
        let opened = open(&path, &OpenOptions::default()).unwrap();
        for object in &opened.builder.objects {
            assert_eq!(object.density_factor, (object.name == "floor").then_some(2.5), "{}", object.name);
        }
        let warnings: Vec<String> = opened.warnings.iter().map(ToString::to_string).collect();
        assert!(warnings.iter().any(|w| w.contains("there is no object \"cellar\"")), "{warnings:?}");
        let scene = opened.builder.build().unwrap().0;
        let floor = scene.object_names().iter().position(|name| name == "floor").unwrap();
        assert_eq!(scene.density_factors()[floor], 2.5);
    }

    #[test]
    fn the_budget_is_that_of_the_options_or_the_preset_of_the_project_or_medium() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lumel.toml");
        let budget = |preset, max_edge, vertex_budget| {
            let bake = SettingsPatch { preset, ..SettingsPatch::default() };
            let builtin = Some("furnace".into());
            Project { builtin, max_edge, bake, ..Project::default() }.write(&path).unwrap();
            let options = OpenOptions { vertex_budget, ..OpenOptions::default() };
            let auto = open(&path, &options).unwrap().auto_edge?;
            Some((auto.length.is_some(), auto.vertex_budget))
        };
        let auto = Some(MaxEdge::Auto);
        assert_eq!(budget(None, auto, None), Some((true, 200_000)));
        assert_eq!(budget(Some(Preset::Draft), auto, None), Some((true, 50_000)));
        assert_eq!(budget(Some(Preset::Draft), auto, Some(7)), Some((false, 7)));
        assert_eq!(budget(None, None, None), None, "built-in scenes stay as they are");
        assert_eq!(budget(None, Some(MaxEdge::Length(0.1)), None), None);
    }

    #[test]
    fn lights_that_are_off_stay_in_the_project_and_out_of_the_scene() {
        let on = LightEntry {
            center: Some(DVec3::ZERO),
            u: Some(Vec3::X),
            v: Some(Vec3::Z),
            radiance: Some(Vec3::ONE),
            ..LightEntry::default()
        };
        let off = LightEntry { off: true, ..on.clone() };
        assert_eq!(open_with(Vec::new()).builder.lights.len(), 1, "the light of the Cornell box");
        assert_eq!(open_with(vec![off.clone(), on.clone()]).builder.lights, [on.light().unwrap()]);
        let named = LightEntry { name: Some("lamp".into()), ..on.clone() };
        assert_eq!(open_with(vec![off.clone(), on, named]).builder.light_names, ["", "lamp"]);
        assert!(open_with(vec![off]).builder.lights.is_empty(), "nor does that of the mesh come back");
    }
}
