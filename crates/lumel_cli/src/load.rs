//! Scenes and settings from the command line.

use crate::args::{SceneArgs, SettingsArgs};
use crate::console::Console;
use crate::failure::{hinted, with_hint};
use crate::parse::LightChoice;
use glam::Vec3;
use lumel::{
    Baker, Bvh, Control, EmitterSampling, Light, LightFileError, MaxEdge, OpenError, OpenOptions, Opened,
    Project, Scene, Settings, SettingsError, SettingsPatch, SolveState, Warnings, suggested_light,
};
use lumel_scene::TriId;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Further warnings are only counted: a broken file can have one per face.
const MAX_WARNINGS: usize = 20;

/// A scene with its settings and warnings.
pub(crate) struct Loaded {
    /// The scene with the changes from the command line.
    pub(crate) scene: Arc<Scene>,
    /// The bake settings of its project.
    pub(crate) patch: SettingsPatch,
    /// What was left out.
    pub(crate) warnings: Warnings,
    /// The longest edge that suited the scene, if edges were split without a length, metres.
    pub(crate) auto_edge: Option<f32>,
}

/// Opens and builds the scene.
pub(crate) fn load(args: &SceneArgs) -> anyhow::Result<Loaded> {
    load_with(args, &args.open_options())
}

/// The same, but mesh files stay as they are unless the command line gives a longest edge.
pub(crate) fn load_as_it_is(args: &SceneArgs) -> anyhow::Result<Loaded> {
    let given = args.max_edge.or((!Project::is_file_name(Path::new(&args.scene))).then_some(MaxEdge::Off));
    load_with(args, &OpenOptions { max_edge: given, ..args.open_options() })
}

fn load_with(args: &SceneArgs, options: &OpenOptions) -> anyhow::Result<Loaded> {
    let Opened { mut builder, mut warnings, settings: patch, auto_edge, .. } = open(args, options)?;
    let new_lights = || args.lights.iter().filter_map(LightChoice::as_new);
    if new_lights().next().is_some() {
        builder.clear_lights();
    }
    for entry in new_lights() {
        let light = entry.moved(-builder.origin).light()?;
        builder.add_named_light(entry.name.clone().unwrap_or_default(), light);
    }
    if let Some(sky) = &args.sky {
        builder.sky = sky.load(sky.file(), &mut warnings)?;
    }
    let (scene, more) = builder.build().map_err(|error| in_scene(error, args))?;
    warnings.append(more);
    Ok(Loaded { scene: Arc::new(scene), patch, warnings, auto_edge })
}

/// Like [`load`], and reports the warnings.
pub(crate) fn load_and_warn(args: &SceneArgs, console: &Console) -> anyhow::Result<Loaded> {
    let loaded = load(args)?;
    for warning in loaded.warnings.iter().take(MAX_WARNINGS) {
        console.warning(&warning.to_string());
    }
    if let Some(more) = loaded.warnings.len().checked_sub(MAX_WARNINGS).filter(|&n| n > 0) {
        console.warning(&format!("{more} more warnings about this scene; see `lumel info {}`", args.scene));
    }
    Ok(loaded)
}

fn open(args: &SceneArgs, options: &OpenOptions) -> anyhow::Result<Opened> {
    lumel::open(&args.scene, options).map_err(|error| match error {
        OpenError::NotFound { name } => hinted(
            format!("there is no file \"{name}\" and no built-in scene of that name"),
            format!("built-in scenes are {}", lumel_builtin::NAMES.join(", ")),
        ),
        OpenError::NotBuiltin(path) => hinted(
            format!("only built-in scenes can be subdivided: {}", path.display()),
            "split long edges with --max-edge",
        ),
        error => in_scene(error, args),
    })
}

/// An error that names the scene.
fn in_scene(error: impl Into<anyhow::Error>, args: &SceneArgs) -> anyhow::Error {
    let error = error.into();
    if crate::failure::text(&error).contains(&args.scene) {
        return error;
    }
    error.context(format!("cannot use {}", args.scene))
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

/// Refuses a scene that would stay dark.
pub(crate) fn check_shines(scene: &Scene, emitters: EmitterSampling) -> anyhow::Result<()> {
    let emissive = (0..scene.triangle_count() as u32).any(|tri| scene.material(TriId(tri)).emits());
    let surfaces = emissive && emitters != EmitterSampling::Off;
    if surfaces || !scene.sky().is_zero() || scene.lights().iter().any(shines) {
        return Ok(());
    }
    let but = if emissive { " with --no-emissive" } else { "" };
    Err(hinted(
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
    for finding in findings.iter().take(MAX_WARNINGS) {
        console.warning_with_hint(&finding.to_string(), &finding.remedy());
    }
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
pub(crate) fn source_files(scene: &str) -> Vec<PathBuf> {
    let path = Path::new(scene);
    let mut files = vec![path.to_owned()];
    if Project::is_file_name(path)
        && let Ok(project) = Project::read(path)
    {
        let sky = project.sky.as_ref().and_then(|sky| sky.file());
        let named = project.scene.as_deref().into_iter().chain(sky);
        files.extend(named.map(|file| path.parent().unwrap_or(Path::new("")).join(file)));
    }
    files
}

/// The name of a scene for output files: its file name without extensions.
pub(crate) fn file_stem(scene: &str) -> String {
    let stem = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy();
    let stem = stem.strip_suffix(".lumel").unwrap_or(&stem);
    if stem.is_empty() { "scene".to_owned() } else { stem.to_owned() }
}

/// Adds a hint to the error for light that does not match the scene.
pub(crate) fn light_hint(error: LightFileError) -> anyhow::Error {
    match error {
        LightFileError::OtherScene { .. } | LightFileError::OtherPositions { .. } => belongs_hint(error),
        error => error.into(),
    }
}

/// Adds a hint to the error for a solution that does not match the scene.
pub(crate) fn belongs_hint(error: impl Into<anyhow::Error>) -> anyhow::Error {
    with_hint(error, "use the scene with the --max-edge and --subdivide of the bake")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_after_the_scene() {
        let stems = ["room.glb", "a/b/room.lumel.toml", "cornell-box", "room.v2.obj", ".."].map(file_stem);
        assert_eq!(stems, ["room", "room", "cornell-box", "room.v2", "scene"]);
    }
}
