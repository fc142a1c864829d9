//! The atlas of a scene, as the command line asks for it.

use crate::args::AtlasArgs;
use crate::command_run::CommandRun;
use crate::failure::{hinted, with_hint};
use lumel::{LightmapEntry, Scene};
use lumel_uv::{Pace, UnwrapSettings, Unwrapped, UvError, unwrap};

/// Seconds after which objects that are left get simple charts.
const TIME_LIMIT: u32 = 300;

/// A scene to unwrap.
pub(crate) struct ToUnwrap<'a> {
    pub(crate) scene: &'a Scene,
    /// What the command line calls it.
    pub(crate) name: &'a str,
    /// What its project and the command line say about lightmaps.
    pub(crate) entry: LightmapEntry,
    /// How many lumels it gets if nothing else is asked for.
    pub(crate) usual_lumels: u32,
}

/// Unwraps a scene, and warns of what could not be as asked. `None` if it was stopped.
pub(crate) fn of(
    to_unwrap: &ToUnwrap<'_>,
    args: &AtlasArgs,
    run: &CommandRun,
) -> anyhow::Result<Option<Unwrapped>> {
    let settings = settings(args, to_unwrap)?;
    let unwrapped = in_time(to_unwrap, &settings, run)?;
    if let Some(unwrapped) = &unwrapped {
        let more = |n| format!("{n} more objects or faults; `lumel unwrap --json` lists all");
        run.console.warnings(unwrapped.report.findings.iter(), more);
    }
    Ok(unwrapped)
}

fn settings(args: &AtlasArgs, to_unwrap: &ToUnwrap<'_>) -> anyhow::Result<UnwrapSettings> {
    let ToUnwrap { scene, name: scene_name, entry, usual_lumels } = *to_unwrap;
    let mut factors = scene.density_factors().to_vec();
    for (name, factor) in &args.density_factor {
        let named = || scene.object_names().iter().enumerate().filter(|(_, object)| *object == name);
        if named().next().is_none() {
            return Err(hinted(
                format!("scene \"{}\" has no object \"{name}\"", scene.name()),
                format!("`lumel unwrap {scene_name} --json` lists its objects"),
            ));
        }
        named().for_each(|(object, _)| factors[object] = *factor);
    }
    Ok(UnwrapSettings { factors, ..entry.settings(usual_lumels) })
}

fn in_time(
    to_unwrap: &ToUnwrap<'_>,
    settings: &UnwrapSettings,
    run: &CommandRun,
) -> anyhow::Result<Option<Unwrapped>> {
    let ends = run.clock.seconds() + f64::from(to_unwrap.entry.time_limit.unwrap_or(TIME_LIMIT));
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
    match unwrap(to_unwrap.scene, settings, &pace) {
        Ok(unwrapped) => Ok(Some(unwrapped)),
        Err(UvError::Stopped) => Ok(None),
        Err(error @ UvError::TooLarge { .. }) => Err(with_hint(error, "choose a smaller --density")),
        Err(error @ UvError::Setting { .. }) => Err(with_hint(error, "see `lumel unwrap --help`")),
    }
}
