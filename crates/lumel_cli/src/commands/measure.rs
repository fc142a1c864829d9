//! `lumel measure`

use crate::args::MeasureArgs;
use crate::command_run::{CommandRun, thread_pool};
use crate::console::{self, Console};
use crate::failure::{hinted, with_hint};
use crate::load::{self, Loaded, Meshes};
use crate::outcome::Outcome;
use crate::outputs::{self, Claim};
use crate::points::Points;
use crate::report;
use anyhow::Context;
use glam::Vec3;
use lumel::{
    Baker, BounceLimit, PointMeasurement, Saved, Scene, ScheduleKind, Settings, SettingsPatch, SolveState,
    Tail, measure_points,
};
use lumel_export::{Array, ArrayData, SolutionError, write_npz};
use serde_json::json;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// Measures.
pub(crate) fn run(args: &MeasureArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let _claim = args.output.as_ref().map(|output| claim_output(args, output)).transpose()?;
    let points = Points::from_args(args)?;
    let pool = thread_pool(&args.run.threads)?;
    let mut run = CommandRun::start(args.run.progress, console)?;
    let result = pool.install(|| measure(args, &points, &run));
    run.progress.finish();
    let Some(measured) = result? else {
        console.note("stopped; nothing was measured");
        return Ok(Outcome::Cancelled);
    };
    if let Some(output) = &args.output {
        save(output, &points, &measured)?;
    }
    console::print(&match (&args.output, args.json) {
        (_, true) => json(&points, &measured),
        (Some(output), false) => written(output, &points)?,
        (None, false) => table(&points, &measured),
    })?;
    Ok(console.outcome(args.run.strict))
}

fn claim_output(args: &MeasureArgs, output: &Path) -> anyhow::Result<Claim> {
    if !output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz")) {
        let message = format!("measurements can only be written as .npz: {}", output.display());
        return Err(hinted(message, "use a file name that ends in .npz"));
    }
    let mut sources = load::source_files(&args.scene.scene);
    sources.extend(args.solution.clone());
    outputs::claim(&[output], &sources)
}

/// Measures on the threads of the pool. `None` if cancelled.
fn measure(
    args: &MeasureArgs,
    points: &Points,
    run: &CommandRun,
) -> anyhow::Result<Option<PointMeasurement>> {
    let tessellation = match &args.solution {
        Some(file) => load::tessellation_of(file),
        None => args.settings.tessellation(),
    };
    let load = || load::load_and_warn(&args.scene, &tessellation, Meshes::Split, &run.console);
    let (loaded, _) = run.timed("load", load);
    let Loaded { scene, patch, .. } = loaded?;
    let receivers = points.receivers(&scene)?;
    let light = match &args.solution {
        Some(file) => reuse(args, file, &scene, run)?,
        None => solve(args, patch, scene, run)?,
    };
    let Some((baker, state)) = light else { return Ok(None) };
    run.progress.phase("measure");
    let _heeding = run.interrupt.heed();
    Ok(measure_points(&baker, &state, &receivers, run.interrupt.control()).ok())
}

/// Solves for the light. `None` if cancelled.
fn solve(
    args: &MeasureArgs,
    patch: SettingsPatch,
    scene: Arc<Scene>,
    run: &CommandRun,
) -> anyhow::Result<Option<(Baker, SolveState)>> {
    let settings = load::settings(patch, &args.settings, &args.scene)?;
    load::check_shines(&scene, settings.emitters)?;
    load::announce_points(&scene, &settings, &run.console)?;
    let (baker, _) = run.timed("build", || Baker::new(scene, settings));
    load::warn_of_lost_light(&baker, &run.console);
    let Some((baker, _)) = run.adapt(baker, None, None)? else { return Ok(None) };
    let mut state = SolveState::new();
    Ok(run.solve(&baker, &mut state, None)?.map(|_| (baker, state)))
}

/// The light of a solution, to be gathered with the sample counts from the command line.
fn reuse(
    args: &MeasureArgs,
    file: &Path,
    scene: &Arc<Scene>,
    run: &CommandRun,
) -> anyhow::Result<Option<(Baker, SolveState)>> {
    let saved = Saved::load_for(file, scene).map_err(|error| match error {
        error @ SolutionError::OtherScene { .. } => load::belongs_hint(error),
        error => error.into(),
    })?;
    if !saved.is_complete() {
        run.console.warning(&format!("this is the checkpoint of an unfinished bake: {}", file.display()));
    }
    let settings = stored_settings(&saved)
        .with_context(|| format!("the settings of this solution are unknown: {}", file.display()))?;
    let stored = SettingsPatch::complete(&settings);
    let (baker, _) = run.timed("build", || Baker::new(Arc::clone(scene), settings));
    let is_shot = baker.settings().schedule == ScheduleKind::Shoot;
    let state = if is_shot { baker.shot_light(&saved) } else { baker.resume(&saved) };
    let mut state = state.map_err(|error| {
        let error = anyhow::Error::new(error).context(format!("cannot use {}", file.display()));
        with_hint(error, "use the scene and lights it was baked with, or omit --solution")
    })?;
    // All bounces are present: this only computes the tail.
    if !is_shot && run.solve(&baker, &mut state, None)?.is_none() {
        return Ok(None);
    }
    let wanted = load::settings(stored, &args.settings, &args.scene)?;
    if wanted == *baker.settings() {
        return Ok(Some((baker, state)));
    }
    let gather = Baker::with_tracer(Arc::clone(scene), Arc::clone(baker.tracer()), wanted);
    Ok(Some((gather, state)))
}

/// The settings of a solution, reduced to what it contains.
fn stored_settings(saved: &Saved) -> anyhow::Result<Settings> {
    let settings: Settings = serde_json::from_value(saved.settings().clone())?;
    settings.validate()?;
    if settings.schedule == ScheduleKind::Shoot {
        return Ok(settings);
    }
    let last = saved.bounce_count().checked_sub(1).context("it holds no light")?;
    let tail = if saved.has_tail() { Tail::Geometric } else { Tail::Off };
    Ok(Settings { bounces: BounceLimit::Count(last as u32), tail, ..settings })
}

fn save(path: &Path, points: &Points, measured: &PointMeasurement) -> anyhow::Result<()> {
    let by_bounce = |values: &[Vec<Vec3>]| Array {
        shape: vec![values.len(), points.positions.len(), 3],
        data: ArrayData::F32(values.iter().flatten().flat_map(|e| e.to_array()).collect()),
    };
    write_npz(path, |npz| {
        npz.array("points", &Array::from_positions(&points.positions))?;
        npz.array("normals", &Array::from_vectors(&points.normals))?;
        npz.array("irradiance", &Array::from_vectors(&measured.irradiance))?;
        npz.array("bounces", &by_bounce(&measured.bounces))?;
        npz.array("standard_error", &Array::from_vectors(&measured.standard_error))?;
        npz.array("bounce_errors", &by_bounce(&measured.bounce_errors))
    })?;
    Ok(())
}

fn written(path: &Path, points: &Points) -> anyhow::Result<String> {
    let bytes = std::fs::metadata(path).with_context(|| format!("cannot find {}", path.display()))?.len();
    let n = report::counted(points.positions.len(), "point", "points");
    Ok(format!("measured {n}\nwrote {}, {}\n", path.display(), report::bytes(bytes)))
}

fn json(points: &Points, measured: &PointMeasurement) -> String {
    let arrays = |vectors: &[Vec3]| vectors.iter().map(|v| json!(v.to_array())).collect::<Vec<_>>();
    let by_bounce = |values: &[Vec<Vec3>]| values.iter().map(|bounce| arrays(bounce)).collect::<Vec<_>>();
    let object = json!({
        "unit": "W/m^2",
        "points": points.positions.iter().map(|p| json!(p.to_array())).collect::<Vec<_>>(),
        "normals": arrays(&points.normals),
        "irradiance": arrays(&measured.irradiance),
        "bounces": by_bounce(&measured.bounces),
        "standard_error": arrays(&measured.standard_error),
        "bounce_errors": by_bounce(&measured.bounce_errors),
    });
    object.to_string() + "\n"
}

fn table(points: &Points, measured: &PointMeasurement) -> String {
    let mut text =
        format!("{:<32} {:<32} {:<32}\n", "point (m)", "irradiance r g b (W/m²)", "standard error");
    for (i, position) in points.positions.iter().enumerate() {
        let light = [measured.irradiance[i], measured.standard_error[i]];
        let [e, error] = light.map(|v| report::triple(v.to_array()));
        let at = report::place(position.to_array());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{at:<32} {e:<32} {error}");
    }
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}
