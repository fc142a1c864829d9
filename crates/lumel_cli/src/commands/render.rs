//! `lumel render`

use crate::args::{Basis, ProgressMode, RenderArgs, SceneArgs};
use crate::command_run::{CommandRun, thread_pool};
use crate::console::{self, Console};
use crate::failure::{hinted, with_hint};
use crate::load::{self, Loaded, Meshes};
use crate::outcome::Outcome;
use crate::outputs::{self, Output};
use crate::parse::{CameraChoice, LightChoice};
use crate::picture::{self, Subject};
use crate::report;
use crate::source::{self, SceneSource};
use anyhow::Context;
use glam::Vec3;
use lumel::{
    Camera, Coefficients, Directional, Fitting, LightFile, LightFileError, Lighting, LightmapSolution,
    RayTracer, Scene, SolutionSelection, VertexLighting, gated, tracer_of,
};
use lumel_render_cpu::{
    Display, Exposure, FalseColor, NormalMaps, Picture, Relief, Resolution, Show, ToneMapper,
    camera_chosen_for, camera_for,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is to be drawn, and where.
struct Request<'a> {
    args: &'a RenderArgs,
    scene: SceneArgs,
    solution: Option<PathBuf>,
    /// Whether the solution says what the scene is.
    is_remembered: bool,
    normal_maps: NormalMaps,
    output: PathBuf,
}

impl<'a> Request<'a> {
    /// That of the command line; a solution alone names its scene.
    fn new(args: &'a RenderArgs) -> anyhow::Result<Self> {
        let given = &args.scene.scene;
        let output = args.output.clone().unwrap_or_else(|| {
            let mut name = load::file_stem(given);
            name.push(".png");
            name.into()
        });
        let normal_maps = args.normal_maps.unwrap_or_default();
        if !source::is_solution(given) {
            let (scene, solution) = (args.scene.clone(), args.solution.clone());
            return Ok(Self { args, scene, solution, is_remembered: false, normal_maps, output });
        }
        if args.solution.is_some() {
            let message = format!("this is a solution, not a scene: {}", given.display());
            return Err(hinted(message, "leave out --solution, or name the scene of that solution"));
        }
        let remembered = SceneSource::load(given)?;
        Ok(Self {
            args,
            normal_maps: args.normal_maps.or(remembered.normal_maps()).unwrap_or_default(),
            scene: remembered.overridden_by(&args.scene),
            solution: Some(given.clone()),
            is_remembered: true,
            output,
        })
    }

    /// The error for light of a different scene.
    fn other_scene(&self, error: impl Into<anyhow::Error>) -> anyhow::Error {
        if !self.is_remembered {
            return load::belongs_hint(error);
        }
        let scene = self.scene.scene.display();
        let error = error.into().context(format!("the scene has changed since the bake: {scene}"));
        with_hint(error, "bake it again, or name the scene as it was: lumel render SCENE --solution FILE")
    }
}

/// Draws.
pub(crate) fn run(args: &RenderArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let request = Request::new(args)?;
    let display = display(&request)?;
    if !Output::new(&request.output, Basis::Vertex).is_ok_and(|output| output.is_picture()) {
        let message = format!("images can only be written as .png: {}", request.output.display());
        return Err(hinted(message, "use a file name that ends in .png"));
    }
    let mut sources = load::source_files(&request.scene.scene);
    sources.extend(request.solution.clone());
    let _claim = outputs::claim(&[&request.output], &sources)?;
    let pool = thread_pool(&args.threads)?;
    let run = CommandRun::start(ProgressMode::None, console)?;
    let Some(picture) = pool.install(|| render(&request, &display, &run))? else {
        console.note("stopped; no image was written");
        return Ok(Outcome::Cancelled);
    };
    console::print(&summary(&request.output, &picture)?)?;
    Ok(console.outcome(args.strict))
}

/// The display settings. Options without effect are rejected.
fn display(request: &Request<'_>) -> anyhow::Result<Display> {
    let args = request.args;
    let show = args.show;
    let unused = |option: &str, of: &str| {
        hinted(format!("{option} has no effect with --show {show}"), format!("use it with --show {of}"))
    };
    if args.range.is_some() && !show.is_in_false_color() {
        return Err(unused("--range", "false-color or a coefficient"));
    }
    if args.exposure != Exposure::Auto && !show.is_exposed() {
        return Err(unused("--exposure", "radiance or irradiance"));
    }
    if args.tone != ToneMapper::default() && !show.is_exposed() {
        return Err(unused("--tone", "radiance or irradiance"));
    }
    if request.solution.is_none() && !matches!(show, Show::Albedo | Show::Normals) {
        let message = format!("--show {show} needs light");
        return Err(hinted(message, "add --solution FILE.npz, a solution from `lumel bake`"));
    }
    let false_color = FalseColor { range: args.range, ..FalseColor::default() };
    Ok(Display { exposure: args.exposure, tone: args.tone, false_color, ..Display::of(show) })
}

/// Draws and writes the image. `None` if cancelled.
fn render(request: &Request<'_>, display: &Display, run: &CommandRun) -> anyhow::Result<Option<Picture>> {
    if let Some(path) = request.solution.as_deref().filter(|path| LightmapSolution::is_file(path)) {
        let Loaded { scene, warnings, .. } = load::load_whole(&request.scene)?;
        load::warn(&warnings, &request.scene, &run.console);
        let (solution, layer) = lightmap(request, path, &scene, &run.console)?;
        let light = solution.lightmap.by_direction(layer);
        check_directions(request.args, light.kind())?;
        return draw(request, display, &scene, &*tracer_of(&scene), &light, run);
    }
    let tessellation = request.solution.as_deref().map(load::tessellation_of).unwrap_or_default();
    let loaded = load::load_and_warn(&request.scene, &tessellation, Meshes::Split, &run.console);
    // Edges of a scene that has changed may not be there to be split.
    let splits_fail = !tessellation.splits.is_empty() && request.is_remembered;
    let Loaded { scene, .. } =
        loaded.map_err(|error| if splits_fail { request.other_scene(error) } else { error })?;
    let light = light(request, &scene, &run.console)?;
    let tracer = &*tracer_of(&scene);
    let Some(Fitting { irradiance, directional, scattered, .. }) = light else {
        let dark = vec![Vec3::ZERO; scene.vertex_count()];
        return draw(request, display, &scene, tracer, &VertexLighting::new(&scene, &dark)?, run);
    };
    check_directions(request.args, directional.as_ref().map_or(Directional::Off, Coefficients::kind))?;
    if let Some(scattered) = scattered {
        let scattered = gated(scattered, &scene, tracer);
        return draw(request, display, &scene, tracer, &scattered.lighting(&scene)?, run);
    }
    let lighting = VertexLighting::new(&scene, &irradiance)?.with_incident(directional.as_ref())?;
    draw(request, display, &scene, tracer, &lighting, run)
}

/// Whether light by direction of a kind has what is to be shown.
fn check_directions(args: &RenderArgs, kind: Directional) -> anyhow::Result<()> {
    match args.show {
        Show::Moment(moment) if !moment.is_in(kind) => {
            let bands = if moment.is_in(Directional::Sh1) { "sh1" } else { "sh2" };
            let message = format!("--show {} needs light that is known by direction", args.show);
            Err(hinted(message, format!("bake all light with --directional {bands}")))
        }
        _ => Ok(()),
    }
}

/// Draws and writes the image of a lit scene. `None` if cancelled.
fn draw(
    request: &Request<'_>,
    display: &Display,
    scene: &Scene,
    tracer: &dyn RayTracer,
    lighting: &dyn Lighting,
    run: &CommandRun,
) -> anyhow::Result<Option<Picture>> {
    let args = request.args;
    let [width, height] = args.size;
    let resolution = Resolution { width, height, samples_per_pixel: args.samples };
    let camera = camera(args.camera.as_ref(), scene, tracer, resolution.aspect())?;
    let relief = Relief { maps: request.normal_maps, shading: args.shading };
    let subject = Subject { scene, tracer, lighting, camera: &camera, relief };
    let _heeding = run.interrupt.heed();
    let result = picture::write(&request.output, &subject, &resolution, display, run.interrupt.picture());
    if result.is_err() && run.interrupt.is_requested() {
        return Ok(None);
    }
    result.map(Some)
}

/// The light of the solution, if there is one.
fn light(request: &Request<'_>, scene: &Scene, console: &Console) -> anyhow::Result<Option<Fitting>> {
    let Some(path) = &request.solution else { return Ok(None) };
    let fitting = LightFile::irradiance_for(path, scene, &selection(request.args)?);
    let fitting = fitting.map_err(|error| match error {
        LightFileError::OtherScene { .. } | LightFileError::OtherPositions { .. } => {
            request.other_scene(error)
        }
        error => error.into(),
    })?;
    if !fitting.same_lighting {
        warn_of_changes(path, console);
    }
    if !fitting.complete {
        console.warning(&format!("this is the checkpoint of an unfinished bake: {}", path.display()));
    }
    Ok(Some(fitting))
}

/// A lightmap of the scene and the layer to show.
fn lightmap(
    request: &Request<'_>,
    path: &Path,
    scene: &Scene,
    console: &Console,
) -> anyhow::Result<(LightmapSolution, usize)> {
    let solution = LightmapSolution::load(path)?;
    solution.check_belongs_to(scene).map_err(|error| request.other_scene(error))?;
    if !solution.has_lighting_of(scene) {
        warn_of_changes(path, console);
    }
    let layer = solution.layer(&selection(request.args)?)?;
    Ok((solution, layer))
}

fn warn_of_changes(path: &Path, console: &Console) {
    console.warning(&format!(
        "materials or lights have changed since {} was baked; the image combines old light with new materials",
        path.display()
    ));
}

/// The part of the light to show.
fn selection(args: &RenderArgs) -> anyhow::Result<SolutionSelection> {
    let layers: Vec<&str> = args.scene.lights.iter().filter_map(LightChoice::as_layer).collect();
    match (layers.as_slice(), &args.bounce) {
        ([], bounce) => Ok(bounce.clone()),
        ([name], SolutionSelection::Sum) => Ok(SolutionSelection::Layer((*name).to_owned())),
        ([_], _) => Err(hinted("a layer has no single bounces", "leave out --bounce or --light NAME")),
        ([first, second, ..], _) => Err(hinted(
            format!("only one layer can be shown, not \"{first}\" and \"{second}\""),
            "lights that share a name make one layer",
        )),
    }
}

fn camera(
    choice: Option<&CameraChoice>,
    scene: &Scene,
    tracer: &dyn RayTracer,
    aspect: f32,
) -> anyhow::Result<Camera> {
    match choice {
        None => Ok(camera_for(scene, tracer, aspect)),
        Some(CameraChoice::Auto) => Ok(camera_chosen_for(scene, tracer, aspect)),
        Some(CameraChoice::Free(entry)) => Ok(entry.moved(-scene.origin()).camera()),
        Some(CameraChoice::Named(name)) => {
            let found = scene.cameras().iter().find(|camera| camera.name == *name).cloned();
            found.ok_or_else(|| {
                let names: Vec<&str> = scene.cameras().iter().map(|camera| camera.name.as_str()).collect();
                let hint = match names.as_slice() {
                    [] => "it has none; specify a view with --camera 'position=x,y,z target=x,y,z fov=deg'"
                        .into(),
                    names => format!("its cameras are {}", names.join(", ")),
                };
                hinted(format!("scene \"{}\" has no camera \"{name}\"", scene.name()), hint)
            })
        }
    }
}

fn summary(path: &Path, picture: &Picture) -> anyhow::Result<String> {
    let bytes = std::fs::metadata(path).with_context(|| format!("cannot find {}", path.display()))?.len();
    let (width, height) = (picture.width(), picture.height());
    let mut text = format!("wrote {}, {width}x{height}, {}", path.display(), report::bytes(bytes));
    if let Some(stops) = picture.stops() {
        text += &format!(", exposure {stops} EV");
    }
    if let Some(range) = picture.range() {
        let [lo, hi] = range.map(|e| report::significant(f64::from(e)));
        text += &format!(", colours from {lo} to {hi} W/m²");
    }
    Ok(text + "\n")
}
