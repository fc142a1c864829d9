//! `lumel render`

use crate::args::{Basis, ProgressMode, RenderArgs};
use crate::command_run::{CommandRun, thread_pool};
use crate::console::{self, Console};
use crate::failure::hinted;
use crate::load::{self, Loaded, Meshes};
use crate::outcome::Outcome;
use crate::outputs::{self, Output};
use crate::parse::{CameraChoice, LightChoice};
use crate::picture::{self, Subject};
use crate::report;
use anyhow::Context;
use glam::Vec3;
use lumel::{
    Camera, Coefficients, Directional, Fitting, LightFile, Lighting, LightmapSolution, RayTracer, Scene,
    SolutionSelection, VertexLighting, tracer_of,
};
use lumel_render_cpu::{
    Display, Exposure, FalseColor, Picture, Relief, Resolution, Show, ToneMapper, camera_for,
};
use std::path::Path;
use std::sync::Arc;

/// Draws.
pub(crate) fn run(args: &RenderArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let display = display(args)?;
    if !Output::new(&args.output, Basis::Vertex).is_ok_and(|output| output.is_picture()) {
        let message = format!("images can only be written as .png: {}", args.output.display());
        return Err(hinted(message, "use a file name that ends in .png"));
    }
    outputs::check(&[&args.output], &load::source_files(&args.scene.scene))?;
    let pool = thread_pool(&args.threads)?;
    let run = CommandRun::start(ProgressMode::None, console)?;
    let Some(picture) = pool.install(|| render(args, &display, &run))? else {
        console.note("stopped; no image was written");
        return Ok(Outcome::Cancelled);
    };
    console::print(&summary(args, &picture)?)?;
    Ok(console.outcome(args.strict))
}

/// The display settings. Options without effect are rejected.
fn display(args: &RenderArgs) -> anyhow::Result<Display> {
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
    if args.solution.is_none() && !matches!(show, Show::Albedo | Show::Normals) {
        let message = format!("--show {show} needs light");
        return Err(hinted(message, "add --solution FILE.npz, a solution from `lumel bake`"));
    }
    let false_color = FalseColor { range: args.range, ..FalseColor::default() };
    Ok(Display { exposure: args.exposure, tone: args.tone, false_color, ..Display::of(show) })
}

/// Draws and writes the image. `None` if cancelled.
fn render(args: &RenderArgs, display: &Display, run: &CommandRun) -> anyhow::Result<Option<Picture>> {
    if let Some(path) = args.solution.as_deref().filter(|path| LightmapSolution::is_file(path)) {
        let Loaded { scene, warnings, .. } = load::load_whole(&args.scene)?;
        load::warn(&warnings, &args.scene, &run.console);
        let (solution, layer) = lightmap(args, path, &scene, &run.console)?;
        let light = solution.lightmap.by_direction(layer);
        check_directions(args, light.kind())?;
        return draw(args, display, &scene, &light, run);
    }
    let tessellation = args.solution.as_deref().map(load::tessellation_of).unwrap_or_default();
    let Loaded { scene, .. } = load::load_and_warn(&args.scene, &tessellation, Meshes::Split, &run.console)?;
    let Some(Fitting { irradiance, directional, scattered, .. }) = light(args, &scene, &run.console)? else {
        let dark = vec![Vec3::ZERO; scene.vertex_count()];
        return draw(args, display, &scene, &VertexLighting::new(&scene, &dark)?, run);
    };
    check_directions(args, directional.as_ref().map_or(Directional::Off, Coefficients::kind))?;
    if let Some(scattered) = scattered {
        return draw(args, display, &scene, &scattered.lighting(&scene)?, run);
    }
    let lighting = VertexLighting::new(&scene, &irradiance)?.with_incident(directional.as_ref())?;
    draw(args, display, &scene, &lighting, run)
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
    args: &RenderArgs,
    display: &Display,
    scene: &Scene,
    lighting: &dyn Lighting,
    run: &CommandRun,
) -> anyhow::Result<Option<Picture>> {
    let tracer = tracer_of(scene);
    let camera = camera(args.camera.as_ref(), scene, &*tracer)?;
    let [width, height] = args.size;
    let resolution = Resolution { width, height, samples_per_pixel: args.samples };
    let relief = Relief { maps: args.normal_maps, shading: args.shading };
    let subject = Subject { scene, tracer: &*tracer, lighting, camera: &camera, relief };
    let _heeding = run.interrupt.heed();
    let result = picture::write(&args.output, &subject, &resolution, display, run.interrupt.picture());
    if result.is_err() && run.interrupt.is_requested() {
        return Ok(None);
    }
    result.map(Some)
}

/// The light of the solution, if there is one.
fn light(args: &RenderArgs, scene: &Scene, console: &Console) -> anyhow::Result<Option<Fitting>> {
    let Some(path) = &args.solution else { return Ok(None) };
    let fitting = LightFile::irradiance_for(path, scene, &selection(args)?).map_err(load::light_hint)?;
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
    args: &RenderArgs,
    path: &Path,
    scene: &Scene,
    console: &Console,
) -> anyhow::Result<(LightmapSolution, usize)> {
    let solution = LightmapSolution::load(path)?;
    solution.check_belongs_to(scene).map_err(load::belongs_hint)?;
    if !solution.has_lighting_of(scene) {
        warn_of_changes(path, console);
    }
    let layer = solution.layer(&selection(args)?)?;
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

fn camera(choice: Option<&CameraChoice>, scene: &Scene, tracer: &dyn RayTracer) -> anyhow::Result<Camera> {
    match choice {
        None => Ok(camera_for(scene, tracer)),
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

fn summary(args: &RenderArgs, picture: &Picture) -> anyhow::Result<String> {
    let path = &args.output;
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
