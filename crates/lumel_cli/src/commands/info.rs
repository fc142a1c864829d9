//! `lumel info`

use crate::args::InfoArgs;
use crate::console::{self, Console};
use crate::load::{self, Loaded};
use crate::outcome::Outcome;
use crate::scene_report::SceneReport;
use lumel::EmitterSampling;
use std::sync::Arc;

/// Describes a scene.
pub(crate) fn run(args: &InfoArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let (Loaded { scene, warnings, .. }, auto) = load::load_as_it_is(&args.scene)?;
    let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    if let Some((problem, remedy)) = load::why_dark(&scene, EmitterSampling::default()) {
        warnings.push(format!("{problem}; {remedy}"));
    }
    let any = !warnings.is_empty();
    let report = SceneReport::new(&scene, auto.as_ref(), warnings);
    if args.json {
        console::print(&(serde_json::to_string(&report)? + "\n"))?;
    } else {
        console::print(&report.text())?;
        report.warnings().iter().for_each(|warning| console.warning(warning));
    }
    Ok(if args.strict && any { Outcome::Objected } else { Outcome::Done })
}
