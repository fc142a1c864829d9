//! The atlas of a scene, as the command line asks for it.

use crate::args::AtlasArgs;
use crate::command_run::CommandRun;
use crate::console::Console;
use crate::failure::{hinted, with_hint};
use lumel::Scene;
use lumel_uv::{Density, Finding, Pace, UnwrapSettings, Unwrapped, UvError, unwrap};

/// Further findings are only counted: when time is up, every object can have one.
const MAX_FINDINGS: usize = 20;

/// Unwraps a scene that the command line calls `name`, into about so many lumels if nothing else is asked for, and warns of
/// what could not be as asked. `None` if it was stopped.
pub(crate) fn of(
    scene: &Scene,
    args: &AtlasArgs,
    (name, usual_lumels): (&str, u32),
    run: &CommandRun,
) -> anyhow::Result<Option<Unwrapped>> {
    let settings = settings(args, scene, name, usual_lumels)?;
    let unwrapped = in_time(args, scene, &settings, run)?;
    if let Some(unwrapped) = &unwrapped {
        warn(&unwrapped.report.findings, &run.console);
    }
    Ok(unwrapped)
}

fn settings(
    args: &AtlasArgs,
    scene: &Scene,
    scene_name: &str,
    usual_lumels: u32,
) -> anyhow::Result<UnwrapSettings> {
    let budget = Density::Budget(args.lumels.unwrap_or(usual_lumels));
    let mut factors = Vec::new();
    for (name, factor) in &args.density_factor {
        factors.resize(scene.object_names().len(), 1.0);
        let named = || scene.object_names().iter().enumerate().filter(|(_, object)| *object == name);
        if named().next().is_none() {
            return Err(hinted(
                format!("scene \"{}\" has no object \"{name}\"", scene.name()),
                format!("`lumel unwrap {scene_name} --json` lists its objects"),
            ));
        }
        named().for_each(|(object, _)| factors[object] = *factor);
    }
    Ok(UnwrapSettings {
        density: args.density.map_or(budget, Density::PerMetre),
        factors,
        page_size: args.atlas_size,
        gutter: args.gutter,
        // The parser lets nothing else pass.
        align: args.align.parse()?,
        given: args.uv.into(),
    })
}

fn in_time(
    args: &AtlasArgs,
    scene: &Scene,
    settings: &UnwrapSettings,
    run: &CommandRun,
) -> anyhow::Result<Option<Unwrapped>> {
    let ends = run.clock.seconds() + f64::from(args.time_limit);
    let pace = || {
        if run.interrupt.is_requested() {
            Pace::Stop
        } else if run.clock.seconds() >= ends {
            Pace::Hurry
        } else {
            Pace::Go
        }
    };
    let _heeding = run.interrupt.heed();
    match unwrap(scene, settings, &pace) {
        Ok(unwrapped) => Ok(Some(unwrapped)),
        Err(UvError::Stopped) => Ok(None),
        Err(error @ UvError::TooLarge { .. }) => Err(with_hint(error, "choose a smaller --density")),
        Err(error @ UvError::Setting { .. }) => Err(with_hint(error, "see `lumel unwrap --help`")),
    }
}

/// Reports findings, up to some number.
fn warn(findings: &[Finding], console: &Console) {
    findings.iter().take(MAX_FINDINGS).for_each(|finding| console.warning(&finding.to_string()));
    if let Some(more) = findings.len().checked_sub(MAX_FINDINGS).filter(|&n| n > 0) {
        console.warning(&format!("{more} more objects or faults; `lumel unwrap --json` lists all"));
    }
}
