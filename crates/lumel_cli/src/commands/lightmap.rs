//! The lightmap of a bake.

use super::atlas::{self, ToUnwrap};
use super::summary::{LightmapReport, NoiseReport};
use crate::args::BakeArgs;
use crate::checkpoint::Checkpoint;
use crate::command_run::{CHECKPOINT_SHARE, CommandRun, unless_stopped};
use crate::report;
use lumel::{
    AmbientOcclusion, Baker, Lightmap, LightmapEntry, LumelAccuracy, LumelLight, LumelState, Lumels, Preset,
    Scene, Settings, SolveState,
};
use lumel_uv::{Report, Unwrapped};
use std::path::Path;
use std::sync::Arc;

/// A scene as it was given and its light.
pub(crate) struct Lightmapped {
    pub(crate) scene: Arc<Scene>,
    /// Finished: seams are closed, and all lumels have light.
    pub(crate) lightmap: Arc<Lightmap>,
    pub(crate) report: LightmapReport,
}

/// Where light is to be measured.
pub(crate) struct Prepared {
    pub(crate) lumels: Lumels,
    report: Report,
    seconds: f64,
}

/// Unwraps the scene as it is in its files. `None` if it was stopped.
pub(crate) fn prepare(
    scene: Arc<Scene>,
    args: &BakeArgs,
    (entry, preset): (LightmapEntry, Preset),
    run: &CommandRun,
) -> anyhow::Result<Option<Prepared>> {
    let name = &*args.scene.scene.to_string_lossy();
    let to_unwrap = ToUnwrap { scene: &scene, name, entry, usual_lumels: preset.lumel_budget() };
    let (unwrapped, seconds) = run.timed("unwrap", || atlas::of(&to_unwrap, &args.atlas, run));
    Ok(unwrapped?.map(|Unwrapped { atlas, report }| Prepared {
        lumels: Lumels::new(scene, atlas),
        report,
        seconds,
    }))
}

/// What is made of the light in lumels.
pub(crate) struct LightmapWanted<'a> {
    /// The checkpoint that may have lumels.
    pub(crate) resumed: Option<&'a Path>,
    pub(crate) denoises: bool,
    pub(crate) occlusion: Option<AmbientOcclusion>,
}

/// A solve that is done, and where it is kept until all files are written.
pub(crate) struct Solved<'a> {
    pub(crate) baker: &'a Baker,
    pub(crate) state: &'a SolveState,
    pub(crate) checkpoint: &'a Checkpoint,
    /// Those of the lumels.
    pub(crate) settings: Settings,
}

/// Measures the light of a solve in all lumels, continuing from what is resumed, and what else is asked for. `None` if it was stopped.
pub(crate) fn measure(
    Prepared { lumels, report, seconds: unwrap_seconds }: Prepared,
    solved: Solved<'_>,
    wanted: &LightmapWanted<'_>,
    run: &CommandRun,
) -> anyhow::Result<Option<Lightmapped>> {
    let baker = solved.baker.relit(Arc::clone(solved.baker.scene()), solved.settings.clone());
    let (measured, seconds) = run.timed("lumels", || measured(&lumels, &baker, &solved, wanted.resumed, run));
    let Some(light) = measured? else { return Ok(None) };
    let openness = wanted.occlusion.map(|occlusion| {
        let _heeding = run.interrupt.heed();
        run.timed("ambient occlusion", || {
            baker.openness_at_lumels(occlusion, &lumels, run.interrupt.control())
        })
        .0
    });
    let openness = match openness.map(unless_stopped).transpose()? {
        Some(None) => return Ok(None),
        openness => openness.flatten(),
    };
    let Lumels { scene, atlas, coverage } = &lumels;
    let accuracy = baker.accuracy_at_lumels(&lumels, &light);
    warn_of_error(&accuracy, &solved.settings, run);
    let finished = || {
        let known = wanted.denoises.then(|| baker.solved_at_lumels(solved.state, &lumels));
        Lightmap::finished(scene, atlas, coverage, &light, known.as_ref(), openness.as_ref())
    };
    let (lightmap, finish_seconds) = run.timed("finish", finished);
    let report = LightmapReport {
        pages: lumels.atlas.pages().to_vec(),
        lumels: lumels.coverage.len(),
        invalid_lumels: (0..light.len()).filter(|&lumel| !light.is_valid(lumel)).count(),
        density: lumels.atlas.density(),
        noise: NoiseReport::from(accuracy),
        charts: report.chart_count(),
        utilization: report.utilization,
        kept: report.kept_count(),
        shared: report.is_shared,
        ray_bytes: baker.memory_of_lumel_rays(&lumels),
        unwrap_seconds,
        seconds,
        finish_seconds,
    };
    Ok(Some(Lightmapped { scene: Arc::clone(&lumels.scene), lightmap: Arc::new(lightmap), report }))
}

/// Warns of a missed target error.
fn warn_of_error(accuracy: &LumelAccuracy, settings: &Settings, run: &CommandRun) {
    let wanted = f64::from(settings.target_share.get());
    if let Some(share) = accuracy.share.filter(|share| *share < wanted) {
        let [share, wanted] = [share, wanted].map(report::percent);
        run.console.warning(&format!(
            "the target error was not reached: {share} of the lumels are within it, not {wanted}, with up to 64 times the initial \
             samples; start with more samples"
        ));
    }
}

/// The light in all lumels. After each part, it is written to the checkpoint. `None` if it was stopped.
fn measured(
    lumels: &Lumels,
    baker: &Baker,
    Solved { baker: solver, state, checkpoint, .. }: &Solved<'_>,
    resumed: Option<&Path>,
    run: &CommandRun,
) -> anyhow::Result<Option<LumelLight>> {
    let identity = lumels.identity().to_string();
    let mut light = baker.no_light_at_lumels(state, lumels);
    if let Some(saved) =
        resumed.map(|file| lumel::Checkpoint::load_lumels(file, &identity)).transpose()?.flatten()
        && saved.is_like(&light)
    {
        light = saved;
    }
    let (began, mut spent) = (run.clock.seconds(), 0.0);
    let save = |light: &LumelLight| {
        checkpoint.save(solver, state, Some(LumelState { identity: &identity, light }));
    };
    run.progress.share(baker.share_at_lumels(&light));
    let mut keep = |light: &LumelLight| {
        run.progress.share(baker.share_at_lumels(light));
        let now = run.clock.seconds();
        if spent <= CHECKPOINT_SHARE * (now - began) {
            save(light);
            spent += run.clock.seconds() - now;
        } else {
            checkpoint.outdated();
        }
    };
    let measured = {
        let _heeding = run.interrupt.heed();
        baker.continue_lumels(state, lumels, &mut light, run.interrupt.control(), &mut keep)
    };
    if measured.is_err() && !checkpoint.is_current() {
        save(&light);
    }
    Ok(unless_stopped(measured)?.map(|()| light))
}
