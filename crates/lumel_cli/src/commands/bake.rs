//! `lumel bake`

use super::lightmap::{self, LightmapWanted, Lightmapped, Solved};
use super::summary::{MemoryReport, Step, Summary, Written};
use crate::args::{BakeArgs, Basis};
use crate::checkpoint::{self, Checkpoint};
use crate::command_run::{CommandRun, SolveLog, thread_pool, unless_stopped};
use crate::console::{self, Console};
use crate::failure::{hinted, with_hint};
use crate::load::{self, Loaded, Meshes};
use crate::memory;
use crate::outcome::Outcome;
use crate::outputs::{self, Claim, Light, Output};
use crate::source::SceneSource;
use anyhow::bail;
use lumel::{
    AmbientOcclusion, Baker, Control, Ended, LightmapEntry, LightmapTarget, Preset, RefinementState,
    ResumeError, Saved, Settings, Solution, SolveState,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bakes.
pub(crate) fn run(args: &BakeArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let wanted = Wanted::new(args)?;
    let pool = thread_pool(&args.run.threads)?;
    let mut run = CommandRun::start(args.run.progress, console)?;
    let result = pool.install(|| bake(args, &wanted, &run));
    run.progress.finish();
    match result? {
        Baked::Done(mut summary) => {
            summary.seconds.total = run.clock.seconds();
            console::print(&if args.json { summary.json()? } else { summary.text() })?;
            Ok(console.outcome(args.run.strict))
        }
        Baked::Stopped(message) => {
            console.note(&message);
            Ok(Outcome::Cancelled)
        }
    }
}

/// How a bake ended.
enum Baked {
    Done(Box<Summary>),
    /// Stopped by the user; the message says how to continue.
    Stopped(String),
}

/// What the command line and the project want besides settings.
struct Wanted {
    basis: Basis,
    lightmap: LightmapEntry,
    occlusion: Option<AmbientOcclusion>,
    outputs: Vec<Output>,
    checkpoint: PathBuf,
    /// The right to write them.
    _claim: Claim,
}

impl Wanted {
    /// Checks everything that can be checked in advance.
    fn new(args: &BakeArgs) -> anyhow::Result<Self> {
        // What is wrong with it is told when the scene is opened.
        let project = load::project(&args.scene.scene).unwrap_or_default();
        let basis = args.basis.or(project.basis.map(Basis::from)).unwrap_or(Basis::Vertex);
        let lightmap = project.lightmap.overridden_by(args.lightmap());
        let occlusion = project.ambient_occlusion.overridden_by(args.occlusion());
        let outputs = args.outputs.iter().map(|path| Output::new(path, basis));
        let mut outputs = outputs.collect::<anyhow::Result<Vec<_>>>()?;
        if outputs.is_empty() {
            let extension = if basis == Basis::Lightmap { "exr" } else { "npz" };
            let mut name = load::file_stem(&args.scene.scene);
            name.push(format!(".{extension}"));
            outputs.push(Output::new(Path::new(&name), basis)?);
        }
        let checkpoint = checkpoint::path_for(&outputs[0].path);
        let mut paths: Vec<&Path> = outputs.iter().map(|output| output.path.as_path()).collect();
        if paths.contains(&checkpoint.as_path()) {
            bail!("this name is reserved for the checkpoint; choose another: {}", checkpoint.display());
        }
        paths.push(&checkpoint);
        args.gltf.check((basis == Basis::Lightmap).then(|| lightmap.target.unwrap_or_default()))?;
        let needs_occlusion = match lightmap.target {
            Some(LightmapTarget::Occlusion) => Some("--target occlusion"),
            _ => occlusion.falloff.map(|_| "--ao-falloff"),
        };
        if let (Some(option), None) = (needs_occlusion, occlusion.distance) {
            return Err(hinted(format!("{option} needs ambient occlusion"), "add --ao METRES"));
        }
        let claim = outputs::claim(&paths, &load::source_files(&args.scene.scene))?;
        outputs.iter().try_for_each(Output::check_company)?;
        let occlusion = occlusion.occlusion();
        Ok(Self { basis, lightmap, occlusion, outputs, checkpoint, _claim: claim })
    }
}

/// The bake on the threads of the pool.
fn bake(args: &BakeArgs, wanted: &Wanted, run: &CommandRun) -> anyhow::Result<Baked> {
    let meshes = if wanted.basis == Basis::Lightmap { Meshes::SplitAndWhole } else { Meshes::Split };
    let tessellation = args.settings.tessellation().on(args.basis);
    let load = || load::load_and_warn(&args.scene, &tessellation, meshes, &run.console);
    let (loaded, load_seconds) = run.timed("load", load);
    let Loaded { scene, whole, patch, auto_edge, .. } = loaded?;
    let preset = args.settings.patch.preset.or(patch.preset).unwrap_or_default();
    let patch = load::with_basis(patch, args.basis, &args.settings)?;
    let settings = load::settings(patch, &args.settings, &args.scene)?;
    load::check_shines(&scene, settings.emitters)?;
    load::announce_points(&scene, &settings, &run.console)?;
    let prepared = match whole {
        None => None,
        Some(whole) => match lightmap::prepare(whole, args, (wanted.lightmap, preset), run)? {
            Some(prepared) => Some(prepared),
            None => return Ok(Baked::Stopped("stopped; nothing was computed".to_owned())),
        },
    };
    // What lumels gather is a mean over many vertices: the target is theirs.
    let of_lumels = prepared.is_some().then(|| settings.clone());
    let settings = of_lumels.as_ref().map_or(settings, Settings::carrying);
    let splits = args.resume.as_deref().map(Saved::load_splits).transpose()?.unwrap_or_default();
    let scene = load::refined(scene, &splits)?;
    let (baker, build_seconds) = run.timed("build", || Baker::new(scene, settings));
    let has_lost_light = load::warn_of_lost_light(&baker, &run.console);
    let checkpoint = Checkpoint::new(wanted.checkpoint.clone(), &run.console);
    match &args.resume {
        Some(file) => checkpoint.resumed_from(file),
        None => tell_of_old_checkpoint(checkpoint.path(), run),
    }
    let resumed = args.resume.as_deref().map(|file| load_resumed(&baker, file)).transpose()?;
    let (baker, adaptive, mut state) = match resumed {
        Some(Resumed::Light(state)) => (baker, None, *state),
        refinement => {
            let refinement = match &refinement {
                Some(Resumed::Refinement(state)) => Some(state),
                _ => None,
            };
            match run.adapt(baker, refinement, Some(&checkpoint))? {
                Some((baker, adaptive)) => (baker, adaptive, SolveState::new()),
                None => return Ok(Baked::Stopped(after_cancel_in_refinement(&checkpoint))),
            }
        }
    };
    let (first_bounce, begun) = (state.bounces.len(), steps_of(&state));
    let lumels = prepared.as_ref().map(|prepared| &prepared.lumels);
    let draws = wanted.outputs.iter().any(Output::is_picture);
    let announced = memory::announce(&baker, lumels, draws, &run.console);
    let log = run.solve(&baker, &mut state, Some(&checkpoint))?;
    if steps_of(&state) > begun {
        checkpoint.update(&baker, &state);
    }
    let Some(log) = log else {
        return Ok(Baked::Stopped(after_cancel(args, &checkpoint, &state, begun)));
    };
    if !has_lost_light {
        load::warn_of_darkness(&baker, &state, &run.console);
    }
    warn_of_dark_faces(&baker, &state, run);
    warn_of_error(&state, run);
    let denoises = wanted.lightmap.denoise.unwrap_or(preset != Preset::Production);
    let lightmapped = match prepared {
        None => None,
        Some(prepared) => {
            let settings = of_lumels.unwrap_or_else(|| baker.settings().clone());
            let solved = Solved { baker: &baker, state: &state, checkpoint: &checkpoint, settings };
            let of_lumels =
                LightmapWanted { resumed: args.resume.as_deref(), denoises, occlusion: wanted.occlusion };
            match lightmap::measure(prepared, solved, &of_lumels, run)? {
                Some(lightmapped) => Some(lightmapped),
                None => return Ok(Baked::Stopped(after_cancel_in_lumels(&checkpoint))),
            }
        }
    };
    let openness = match wanted.occlusion.filter(|_| lightmapped.is_none()) {
        None => None,
        Some(occlusion) => {
            let measured = run.timed("ambient occlusion", || {
                let _heeding = run.interrupt.heed();
                baker.openness_at_vertices(occlusion, &state, run.interrupt.control())
            });
            match unless_stopped(measured.0)? {
                Some(openness) => Some(openness),
                None => return Ok(Baked::Stopped(after_cancel(args, &checkpoint, &state, begun))),
            }
        }
    };
    let mut solution = Solution { occlusion: openness, ..solution(&baker, &state, run, &log) };
    solution.meta.vertex_budget = auto_edge.map(|auto| auto.vertex_budget);
    let kept = if checkpoint.is_current() { Some(checkpoint.path()) } else { args.resume.as_deref() };
    let kept = kept.filter(|_| checkpoint.is_current() || steps_of(&state) == begun);
    let (written, write_seconds) = run.timed("write", || {
        let light = Light {
            baker: &baker,
            solution: &solution,
            lightmapped: lightmapped.as_ref(),
            target: wanted.lightmap.target.unwrap_or_default(),
            glb: args.gltf.options(),
            source: SceneSource::of(&args.scene, args.normal_maps),
            png: args.png,
            green: args.normal_maps,
        };
        write(&wanted.outputs, &light, kept, run)
    });
    let Some(written) = written? else {
        return Ok(Baked::Stopped(after_cancel(args, &checkpoint, &state, begun)));
    };
    checkpoint.remove();
    let mut summary = Summary::new(&baker, &state, &solution, run.interrupt.control().rays(), &log);
    summary.adaptive = adaptive;
    summary.auto_edge = auto_edge.and_then(|auto| auto.length);
    summary.resumed_bounces = first_bounce;
    summary.files = written;
    if let Some(Lightmapped { report, .. }) = lightmapped {
        summary.add_lightmap(report);
    }
    summary.memory = MemoryReport { announced, peak: memory::peak() };
    summary.seconds.load = load_seconds;
    summary.seconds.build = build_seconds;
    summary.seconds.write = write_seconds;
    summary.warnings = run.console.warning_count();
    Ok(Baked::Done(Box::new(summary)))
}

/// What a bake goes on with.
enum Resumed {
    /// A mesh that is being refined.
    Refinement(RefinementState),
    /// Bounces.
    Light(Box<SolveState>),
}

/// Reads what is to be resumed.
fn load_resumed(baker: &Baker, file: &Path) -> anyhow::Result<Resumed> {
    let saved = Saved::load_for(file, baker.scene()).map_err(|error| match error {
        error @ lumel_export::SolutionError::OtherScene { .. } => load::belongs_hint(error),
        error => error.into(),
    })?;
    let resumed = baker.resume_refinement(&saved).and_then(|refinement| match refinement {
        Some(refinement) => Ok(Resumed::Refinement(refinement)),
        None => baker.resume(&saved).map(|state| Resumed::Light(Box::new(state))),
    });
    resumed.map_err(|error| {
        let hint = match error {
            ResumeError::Settings { .. } => {
                "only --bounces, --remainder, --tail, --layers and --directional may differ"
            }
            ResumeError::TargetError | ResumeError::Basis => "leave out --resume",
            ResumeError::Scene(_) | ResumeError::Lighting => "use the scene and lights it was baked with",
        };
        with_hint(anyhow::Error::new(error).context(format!("cannot resume from {}", file.display())), hint)
    })
}

fn warn_of_dark_faces(baker: &Baker, state: &SolveState, run: &CommandRun) {
    // Nothing cancels it: it takes a moment.
    let n = baker.dark_faces(state, &Control::default()).unwrap_or(0);
    if n > 0 {
        let faces = crate::report::counted(n, "visible triangle stays", "visible triangles stay");
        run.console.warning(&format!(
            "{faces} dark because all vertices lie inside geometry; use --projection least-squares, or split edges with a \
             smaller --max-edge"
        ));
    }
}

/// Warns of a missed target error.
fn warn_of_error(state: &SolveState, run: &CommandRun) {
    let Some(ended) = state.errors.as_ref().and_then(|errors| errors.accuracy.ended) else { return };
    let why = match ended {
        Ended::Reached => return,
        Ended::Memory => "more rays do not fit into memory; raise --memory",
        Ended::Samples => "some vertices have 64 times the initial samples; start with more samples",
    };
    run.console.warning(&format!("the target error was not reached: {why}"));
}

fn tell_of_old_checkpoint(path: &Path, run: &CommandRun) {
    if path.exists() {
        let name = path.display();
        run.console.note(&format!(
            "this bake will replace the checkpoint of an earlier one; to continue that one, use --resume {name}"
        ));
    }
}

/// How many steps a state has behind it.
fn steps_of(state: &SolveState) -> usize {
    state.bounces.len() + state.shot.as_ref().map_or(0, |shot| shot.shots as usize)
}

/// What to tell a user who stopped a bake while its mesh was refined.
fn after_cancel_in_refinement(checkpoint: &Checkpoint) -> String {
    if checkpoint.is_current() {
        return after_cancel_with_refined_mesh(checkpoint);
    }
    "stopped before the mesh was fine enough; the same command starts again".to_owned()
}

fn after_cancel_with_refined_mesh(checkpoint: &Checkpoint) -> String {
    let file = checkpoint.path().display();
    format!(
        "stopped; the mesh as far as it is refined is in the checkpoint; continue with the same command and --resume {file}"
    )
}

/// What to tell a user who stopped a bake.
fn after_cancel(args: &BakeArgs, checkpoint: &Checkpoint, state: &SolveState, begun: usize) -> String {
    let n = state.bounces.len();
    if let Some(errors) = &state.errors
        && checkpoint.is_current()
    {
        let rounds = crate::report::counted(errors.accuracy.rounds as usize, "round", "rounds");
        let file = checkpoint.path().display();
        return format!(
            "stopped; {rounds} of samples are in the checkpoint; continue with the same command and --resume {file}"
        );
    }
    if let Some(file) = args.resume.as_ref().filter(|_| steps_of(state) == begun) {
        return format!(
            "stopped; no further step was finished; continue with the same command and --resume {}",
            file.display()
        );
    }
    match n {
        0 if checkpoint.is_current() => after_cancel_with_refined_mesh(checkpoint),
        0 => "stopped before direct light was finished; the same command starts again".to_owned(),
        _ if !checkpoint.is_current() => {
            "stopped; there is no checkpoint because it could not be written".to_owned()
        }
        _ => {
            let done = match (n, &state.shot) {
                (_, Some(shot)) if shot.shots > 0 => {
                    let shots = crate::report::counted(shot.shots as usize, "shot", "shots");
                    format!("direct light and {shots} are")
                }
                (1, _) => "direct light is".into(),
                _ => format!("direct light and {} are", bounces(n - 1)),
            };
            let file = checkpoint.path().display();
            format!("stopped; {done} in the checkpoint; continue with the same command and --resume {file}")
        }
    }
}

/// What to tell a user who stopped a bake while lumels were measured.
fn after_cancel_in_lumels(checkpoint: &Checkpoint) -> String {
    if !checkpoint.is_current() {
        return "stopped; there is no checkpoint because it could not be written".to_owned();
    }
    let file = checkpoint.path().display();
    format!(
        "stopped; all bounces and a part of the lumels are in the checkpoint; continue with the same command and --resume {file}"
    )
}

fn bounces(n: usize) -> String {
    crate::report::counted(n, "bounce", "bounces")
}

/// The solution, with its statistics.
fn solution(baker: &Baker, state: &SolveState, run: &CommandRun, log: &SolveLog) -> Solution {
    let mut solution = baker.solution(state);
    solution.meta.statistics = serde_json::json!({
        "seconds_solve": log.seconds,
        "seconds_steps": log.steps.iter().map(|(step, seconds)| (Step::from(*step).key(), seconds)).collect::<Vec<_>>(),
        "rays": run.interrupt.control().rays(),
        "threads": rayon::current_num_threads(),
        "remainder": baker.remainder(state),
    });
    solution
}

/// Writes all outputs in order. `None` if cancelled. The file `kept` also contains all light.
fn write(
    outputs: &[Output],
    light: &Light<'_>,
    kept: Option<&Path>,
    run: &CommandRun,
) -> anyhow::Result<Option<Vec<Written>>> {
    let _heeding = run.interrupt.heed();
    let mut written = Vec::new();
    for output in outputs {
        if run.interrupt.is_requested() {
            return Ok(None);
        }
        let result = output.write(light, run.interrupt.picture());
        if result.is_err() && output.is_picture() && run.interrupt.is_requested() {
            return Ok(None);
        }
        let files = result.map_err(|error| match kept {
            Some(file) => {
                let hint =
                    format!("the bake itself is done; to write the files, use --resume {}", file.display());
                with_hint(error, hint)
            }
            None => error,
        })?;
        written.extend(files.into_iter().map(|(path, bytes)| Written { path, bytes }));
    }
    Ok(Some(written))
}
