//! The lightmap of a bake.

use super::atlas;
use super::summary::LightmapReport;
use crate::args::BakeArgs;
use crate::command_run::CommandRun;
use crate::load;
use glam::Vec3;
use lumel::{Baker, LumelLight, Lumels, Preset, Scene, SolveState, TransportError};
use lumel_lightmap::{Lightmap, LightmapLayer};
use lumel_uv::{Coverage, Report, Unwrapped};
use std::sync::Arc;

/// A scene as it was given and its light.
pub(crate) struct Lightmapped {
    pub(crate) scene: Arc<Scene>,
    /// Finished: seams are closed, and all lumels have light.
    pub(crate) lightmap: Lightmap,
    pub(crate) report: LightmapReport,
}

/// Where light is to be measured.
pub(crate) struct Prepared {
    lumels: Lumels,
    report: Report,
    seconds: f64,
}

/// Unwraps the scene as it is in its files. `None` if it was stopped.
pub(crate) fn prepare(args: &BakeArgs, preset: Preset, run: &CommandRun) -> anyhow::Result<Option<Prepared>> {
    let (scene, _) = run.timed("load", || load::load_whole(&args.scene));
    let scene = scene?;
    let named = (&*args.scene.scene, preset.lumel_budget());
    let (unwrapped, seconds) = run.timed("unwrap", || atlas::of(&scene, &args.atlas, named, run));
    Ok(unwrapped?.map(|Unwrapped { atlas, report }| Prepared {
        lumels: Lumels::new(scene, atlas),
        report,
        seconds,
    }))
}

/// Measures the light of a solve in all lumels. `None` if it was stopped.
pub(crate) fn measure(
    Prepared { lumels, report, seconds: unwrap_seconds }: Prepared,
    baker: &Baker,
    state: &SolveState,
    denoises: bool,
    run: &CommandRun,
) -> anyhow::Result<Option<Lightmapped>> {
    let measured = || {
        let _heeding = run.interrupt.heed();
        baker.light_at_lumels(state, &lumels, run.interrupt.control())
    };
    let (light, seconds) = run.timed("lumels", measured);
    let light = match light {
        Ok(light) => light,
        Err(TransportError::Cancelled) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let (lightmap, finish_seconds) = run.timed("finish", || finished(&lumels, &light, denoises));
    let report = LightmapReport {
        pages: lumels.atlas.pages().to_vec(),
        lumels: lumels.coverage.len(),
        invalid_lumels: light.valid.iter().filter(|valid| !**valid).count(),
        density: lumels.atlas.density(),
        charts: report.chart_count(),
        utilization: report.utilization,
        unwrap_seconds,
        seconds,
        finish_seconds,
    };
    Ok(Some(Lightmapped { scene: Arc::clone(&lumels.scene), lightmap, report }))
}

/// All pages: what was measured, less its noise if that is wanted, with seams closed and the light of lumels that were not
/// measured taken from their neighbours. The last layers are all light with its noise, and its standard error.
fn finished(lumels: &Lumels, light: &LumelLight, denoises: bool) -> Lightmap {
    let Lumels { scene, atlas, coverage } = lumels;
    let n_lumels = atlas.lumel_count();
    let valid = on_pages(coverage, &light.valid, n_lumels);
    let bounces = light.bounces.iter().enumerate();
    let names = bounces.map(|(bounce, values)| match bounce {
        0 => ("direct".to_owned(), values),
        _ => (format!("bounce {bounce}"), values),
    });
    let tail = light.tail.iter().map(|values| ("tail".to_owned(), values));
    let irradiance = light.irradiance();
    let all = std::iter::once(("irradiance".to_owned(), &irradiance)).chain(names).chain(tail);
    let layer = |(name, values): (String, &Vec<Vec3>)| LightmapLayer {
        name,
        values: on_pages(coverage, values, n_lumels),
    };
    let layers = all.map(layer).collect();
    let mut lightmap = Lightmap { atlas: Arc::clone(atlas), valid, layers };
    let errors = on_pages(coverage, &light.errors, n_lumels);
    let errors = lightmap.pooled(coverage, &errors);
    if denoises {
        let raw = lightmap.layers[0].values.clone();
        lightmap.denoise(coverage, &errors);
        lightmap.layers.push(LightmapLayer { name: "noisy".to_owned(), values: raw });
    }
    let errors = errors.into_iter().map(Vec3::splat).collect();
    lightmap.layers.push(LightmapLayer { name: "error".to_owned(), values: errors });
    lightmap.finish(scene, coverage);
    lightmap
}

/// Values of the lumels of a coverage among all lumels of the pages; zero elsewhere.
fn on_pages<T: Copy + Default>(coverage: &Coverage, values: &[T], n_lumels: usize) -> Vec<T> {
    let mut all = vec![T::default(); n_lumels];
    for (&lumel, &value) in coverage.lumels().iter().zip(values) {
        all[lumel as usize] = value;
    }
    all
}
