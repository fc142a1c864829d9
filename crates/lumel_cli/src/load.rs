//! Scenes and settings from the command line.

use crate::args::{Basis, SceneArgs, SettingsArgs, Tessellation};
use crate::console::Console;
use crate::failure::{hinted, with_hint};
use crate::parse::LightChoice;
use crate::report;
use glam::Vec3;
use lumel::{
    AutoEdge, Baker, Bvh, Control, EmitterSampling, Light, LightmapEntry, MaxEdge, OpenError, OpenOptions,
    Opened, PointNeed, PointSpacing, Project, Saved, Scene, SceneBuilder, SceneError, Settings,
    SettingsError, SettingsPatch, SolveState, Warnings, suggested_light,
};
use lumel_export::SolutionMeta;
use lumel_scene::TriId;
use serde::Deserialize;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene with its settings and warnings.
pub(crate) struct Loaded {
    /// The scene with the changes from the command line.
    pub(crate) scene: Arc<Scene>,
    /// The same with no edge split, if that was wanted.
    pub(crate) whole: Option<Arc<Scene>>,
    /// The bake settings of its project.
    pub(crate) patch: SettingsPatch,
    /// What its project says about lightmaps.
    pub(crate) lightmap: LightmapEntry,
    /// What was left out.
    pub(crate) warnings: Warnings,
    /// What was chosen, if the lengths of edges suit the scene.
    pub(crate) auto_edge: Option<AutoEdge>,
}

/// What `--max-edge auto` would make of a mesh.
pub(crate) struct Auto {
    /// The longest edge where it is finest, metres; `None` if the mesh is fine enough as it is.
    pub(crate) max_edge: Option<f32>,
    /// Vertices of the scene then.
    pub(crate) vertices: usize,
}

/// Which scenes are made of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meshes {
    /// The one that vertices carry light on.
    Split,
    /// Also the one with no edge split, which lightmaps are for.
    SplitAndWhole,
}

/// The scene with the edges split that were split for light of it.
pub(crate) fn refined(scene: Arc<Scene>, splits: &[[u32; 2]]) -> anyhow::Result<Arc<Scene>> {
    if splits.is_empty() {
        return Ok(scene);
    }
    scene.refined(splits).map(Arc::new).map_err(belongs_hint)
}

/// The scene as it is in its files, unless they or the command line give a length of edges; then that, and nothing else.
pub(crate) fn load_as_it_is(args: &SceneArgs) -> anyhow::Result<(Loaded, Option<Auto>)> {
    let given = args.max_edge.or_else(|| length_of_project(&args.scene));
    let options =
        OpenOptions { max_edge: given.or(Some(MaxEdge::Off)), ..args.open_options(&Tessellation::default()) };
    let opened = open(args, &options)?;
    let auto = if given.is_none() { Some(auto(&opened).map_err(|e| in_scene(e, args))?) } else { None };
    Ok((build(args, opened)?, auto))
}

/// The scene with no edge split at all, which a lightmap is for.
pub(crate) fn load_whole(args: &SceneArgs) -> anyhow::Result<Loaded> {
    let options = OpenOptions { max_edge: Some(MaxEdge::Off), ..args.open_options(&Tessellation::default()) };
    build(args, open(args, &options)?)
}

/// The project file, if the scene is one that can be read.
pub(crate) fn project(scene: &Path) -> Option<Project> {
    Project::is_file_name(scene).then(|| Project::read(scene).ok())?
}

/// The length of edges that a project gives, if it is one and does.
fn length_of_project(scene: &Path) -> Option<MaxEdge> {
    project(scene)?.max_edge.filter(|max_edge| matches!(max_edge, MaxEdge::Length(_)))
}

fn auto(opened: &Opened) -> Result<Auto, SceneError> {
    let mut builder = opened.builder.clone();
    let budget = opened.settings.preset.unwrap_or_default().vertex_budget();
    let (max_edge, _) = builder.tessellate_to_suit(budget);
    Ok(Auto { max_edge, vertices: builder.build()?.0.vertex_count() })
}

fn build(args: &SceneArgs, opened: Opened) -> anyhow::Result<Loaded> {
    let Opened { builder, whole, mut warnings, settings: patch, auto_edge, project } = opened;
    // What is wrong with one is wrong with the other.
    let whole = whole.map(|whole| built(args, whole, &mut Warnings::default())).transpose()?;
    let scene = built(args, builder, &mut warnings)?;
    let lightmap = project.map(|project| project.lightmap).unwrap_or_default();
    Ok(Loaded { scene, whole, patch, lightmap, warnings, auto_edge })
}

/// The scene with the lights and the sky of the command line.
fn built(args: &SceneArgs, mut builder: SceneBuilder, warnings: &mut Warnings) -> anyhow::Result<Arc<Scene>> {
    let new_lights = || args.lights.iter().filter_map(LightChoice::as_new);
    if new_lights().next().is_some() {
        builder.clear_lights();
    }
    for entry in new_lights() {
        let light = entry.moved(-builder.origin).light()?;
        builder.add_named_light(entry.name.clone().unwrap_or_default(), light);
    }
    if let Some(sky) = &args.sky {
        builder.sky = sky.load(sky.file(), warnings)?;
    }
    let (scene, more) = builder.build().map_err(|error| in_scene(error, args))?;
    warnings.append(more);
    Ok(Arc::new(scene))
}

/// What opening a scene for light that was baked needs.
pub(crate) fn tessellation_of(solution: &Path) -> Tessellation {
    // What is wrong with the file is told when its light is read.
    let meta = SolutionMeta::load(solution).ok();
    let settings = meta.as_ref().and_then(|meta| Settings::deserialize(&meta.settings).ok());
    let splits = Saved::load_splits(solution).unwrap_or_default();
    let follows_light = settings.is_some_and(|settings| settings.refines_mesh());
    Tessellation {
        vertex_budget: meta.and_then(|meta| meta.vertex_budget),
        adaptive: Some(follows_light || !splits.is_empty()),
        splits,
    }
}

/// Opens and builds the scene, with about so many more vertices at most where the lengths of edges suit the scene. Reports the
/// warnings.
pub(crate) fn load_and_warn(
    args: &SceneArgs,
    tessellation: &Tessellation,
    meshes: Meshes,
    console: &Console,
) -> anyhow::Result<Loaded> {
    let keeps_whole = meshes == Meshes::SplitAndWhole;
    let options = OpenOptions { keeps_whole, ..args.open_options(tessellation) };
    let loaded = build(args, open(args, &options)?)?;
    let scene = refined(loaded.scene, &tessellation.splits)?;
    let loaded = Loaded { scene, ..loaded };
    warn(&loaded.warnings, args, console);
    Ok(loaded)
}

/// Reports the warnings about a scene, up to some number.
pub(crate) fn warn(warnings: &Warnings, args: &SceneArgs, console: &Console) {
    let more = |n| format!("{n} more warnings about this scene; see `lumel info {}`", args.scene.display());
    console.warnings(warnings.iter(), more);
}

fn open(args: &SceneArgs, options: &OpenOptions) -> anyhow::Result<Opened> {
    lumel::open(&args.scene, options).map_err(|error| match error {
        OpenError::NotFound { name } => hinted(
            format!("there is no file \"{name}\" and no built-in scene of that name"),
            match most_similar(&name) {
                Some(similar) => format!("did you mean {similar}?"),
                None => format!("built-in scenes are {}", lumel_builtin::NAMES.join(", ")),
            },
        ),
        OpenError::NotBuiltin(path) => hinted(
            format!("only built-in scenes can be subdivided: {}", path.display()),
            "split long edges with --max-edge",
        ),
        error => in_scene(error, args),
    })
}

/// Names at least this similar are probably what was meant; 1 is the same name.
const SIMILAR: f64 = 0.85;

/// The built-in scene, or the file beside a missing one, whose name is most similar.
fn most_similar(name: &str) -> Option<String> {
    let path = Path::new(name);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name()?.to_str()?;
    let files = fs::read_dir(folder).into_iter().flatten().flatten().filter_map(|entry| {
        let file = entry.file_name().into_string().ok()?;
        let is_scene = entry.file_type().is_ok_and(|kind| !kind.is_dir());
        is_scene
            .then(|| (strsim::jaro_winkler(wanted, &file), path.with_file_name(file).display().to_string()))
    });
    let builtin =
        lumel_builtin::NAMES.iter().map(|known| (strsim::jaro_winkler(name, known), (*known).to_owned()));
    let most = builtin.chain(files).filter(|(likeness, _)| *likeness >= SIMILAR);
    most.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, name)| name)
}

/// An error that names the scene.
fn in_scene(error: impl Into<anyhow::Error>, args: &SceneArgs) -> anyhow::Error {
    let error = error.into();
    let scene = args.scene.display().to_string();
    if crate::failure::text(&error).contains(&scene) {
        return error;
    }
    error.context(format!("cannot use {scene}"))
}

/// The settings: those of the preset, replaced by the project's, replaced by the command line's.
pub(crate) fn settings(
    project: SettingsPatch,
    args: &SettingsArgs,
    scene: &SceneArgs,
) -> anyhow::Result<Settings> {
    let settings = project.overridden_by(args.patch.clone()).settings();
    settings.validate().map_err(|error| match error {
        SettingsError::Conflict { .. } => {
            let hint = error.remedy();
            with_hint(error, hint)
        }
        error => in_scene(error, scene),
    })?;
    Ok(settings)
}

/// The settings of a project for what the command line says of the basis.
pub(crate) fn with_basis(
    project: SettingsPatch,
    basis: Option<Basis>,
    args: &SettingsArgs,
) -> anyhow::Result<SettingsPatch> {
    let is_on = |spacing: Option<PointSpacing>| spacing.is_some_and(|spacing| spacing != PointSpacing::Off);
    match basis {
        Some(Basis::Vertex) if is_on(args.patch.point_spacing) => {
            let problem = "--basis vertex carries light on vertices, not on points";
            Err(hinted(problem, "use --basis points, or leave out --point-spacing"))
        }
        Some(Basis::Vertex) => Ok(SettingsPatch { point_spacing: Some(PointSpacing::Off), ..project }),
        Some(Basis::Points) if args.patch.point_spacing == Some(PointSpacing::Off) => {
            let problem = "--basis points and --point-spacing off exclude each other";
            Err(hinted(problem, "leave out one of them"))
        }
        Some(Basis::Points) if !is_on(project.point_spacing) => {
            Ok(SettingsPatch { point_spacing: Some(PointSpacing::Auto), ..project })
        }
        Some(Basis::Points | Basis::Lightmap) | None => Ok(project),
    }
}

/// Refuses more points than fit into memory; says how many there will be before they are made.
pub(crate) fn announce_points(scene: &Scene, settings: &Settings, console: &Console) -> anyhow::Result<()> {
    let Some(need) = settings.point_spacing.need(scene, settings.levels) else { return Ok(()) };
    let PointNeed { spacing, points, memory, least_spacing } = need;
    if let Some(least) = least_spacing {
        let least = report::significant(least.into());
        let problem =
            format!("about {points} points, {spacing} m from each other, would not fit into memory");
        return Err(hinted(problem, format!("use a --point-spacing of at least {least}")));
    }
    let spacing = report::significant(spacing.into());
    console
        .note(&format!("scatters about {points} points, {spacing} m from each other, in {memory} of memory"));
    Ok(())
}

/// Refuses a scene that would stay dark.
pub(crate) fn check_shines(scene: &Scene, emitters: EmitterSampling) -> anyhow::Result<()> {
    why_dark(scene, emitters).map_or(Ok(()), |(problem, remedy)| Err(hinted(problem, remedy)))
}

/// Why a scene would stay dark, and what to do about it.
pub(crate) fn why_dark(scene: &Scene, emitters: EmitterSampling) -> Option<(String, String)> {
    let emissive = (0..scene.triangle_count() as u32).any(|tri| scene.material(TriId(tri)).emits());
    let surfaces = emissive && emitters != EmitterSampling::Off;
    if surfaces || !scene.sky().is_zero() || scene.lights().iter().any(shines) {
        return None;
    }
    let but = if emissive { " with --no-emissive" } else { "" };
    Some((
        format!("nothing emits light in scene \"{}\"{but}", scene.name()),
        format!("add a light that suits the scene: {}", suggested_light(scene, &Bvh::build(scene))),
    ))
}

fn shines(light: &Light) -> bool {
    light.strength() != Vec3::ZERO
}

/// Warns of lights that are lost: those that reach nothing, and light on back faces.
///
/// Returns whether there are any.
pub(crate) fn warn_of_lost_light(baker: &Baker, console: &Console) -> bool {
    // Nothing cancels it: it takes a moment.
    let findings = baker.light_findings(&Control::default()).unwrap_or_default();
    let hinted = findings.iter().map(|finding| (finding.to_string(), Some(finding.remedy())));
    console.grouped_warnings(hinted, |n| format!("{n} more warnings about lights that are lost"));
    !findings.is_empty()
}

/// Warns of a bake without any light.
pub(crate) fn warn_of_darkness(baker: &Baker, state: &SolveState, console: &Console) {
    if state.bounces.first().is_some_and(|direct| baker.power(direct) == 0.0) {
        let scene = baker.scene();
        let message = format!("no light arrives at any surface of scene \"{}\"", scene.name());
        let hint = format!("add a light that suits the scene: {}", suggested_light(scene, &**baker.tracer()));
        console.warning_with_hint(&message, &hint);
    }
}

/// The files of a scene that the command line or the project names.
pub(crate) fn source_files(scene: &Path) -> Vec<PathBuf> {
    let mut files = vec![scene.to_owned()];
    if let Some(project) = project(scene) {
        let sky = project.sky.as_ref().and_then(|sky| sky.file());
        let named = project.scene.as_deref().into_iter().chain(sky);
        files.extend(named.map(|file| scene.parent().unwrap_or(Path::new("")).join(file)));
    }
    files
}

/// The name of a scene for output files: its file name without extensions.
pub(crate) fn file_stem(scene: &Path) -> OsString {
    let Some(stem) = scene.file_stem() else { return "scene".into() };
    let project = Path::new(stem).extension().is_some_and(|extension| extension == "lumel");
    if project { Path::new(stem).file_stem().unwrap_or(stem).to_owned() } else { stem.to_owned() }
}

/// Adds a hint to the error for a solution that does not match the scene.
pub(crate) fn belongs_hint(error: impl Into<anyhow::Error>) -> anyhow::Error {
    with_hint(
        error,
        "use the scene with the --max-edge, --subdivide and --two-sided of the bake; light from before OBJ files had two sides \
         needs --two-sided none",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_after_the_scene() {
        let stems = ["room.glb", "a/b/room.lumel.toml", "cornell-box", "room.v2.obj", ".."]
            .map(|scene| file_stem(Path::new(scene)));
        assert_eq!(stems, ["room", "room", "cornell-box", "room.v2", "scene"]);
    }
}
