//! `lumel unwrap`

use super::atlas::{self, ToUnwrap};
use super::summary::Written;
use crate::args::{ProgressMode, UnwrapArgs};
use crate::command_run::{CommandRun, thread_pool};
use crate::console::{self, Console};
use crate::failure::hinted;
use crate::load::{self, Loaded};
use crate::outcome::Outcome;
use crate::outputs::{self, sized, with_green_up};
use crate::report::{bytes, counted, duration, percent, significant};
use lumel::Scene;
use lumel_export::{write_atlas_png, write_pages, write_unwrapped_glb};
use lumel_uv::Unwrapped;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Lumels on all pages, if nothing else is asked for.
const LUMELS: u32 = 1 << 20;

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// The scene with its places.
    Glb,
    /// A picture of each page.
    Png,
}

/// Unwraps and writes.
pub(crate) fn run(args: &UnwrapArgs, console: &Arc<Console>) -> anyhow::Result<Outcome> {
    let formats = args.outputs.iter().map(|path| format_of(path)).collect::<anyhow::Result<Vec<_>>>()?;
    let paths: Vec<&Path> = args.outputs.iter().map(PathBuf::as_path).collect();
    let _claim = outputs::claim(&paths, &load::source_files(&args.scene.scene))?;
    let pool = thread_pool(&args.threads)?;
    let run = CommandRun::start(ProgressMode::None, console)?;
    let (Loaded { scene, warnings, lightmap, .. }, _) = load::load_as_it_is(&args.scene)?;
    load::warn(&warnings, &args.scene, console);
    let begun = run.clock.seconds();
    let entry = lightmap.overridden_by(args.atlas.entry());
    let to_unwrap =
        ToUnwrap { scene: &scene, name: &args.scene.scene.to_string_lossy(), entry, usual_lumels: LUMELS };
    let unwrapped = pool.install(|| atlas::of(&to_unwrap, &args.atlas, &run))?;
    let Some(unwrapped) = unwrapped else {
        console.note("stopped; no file was written");
        return Ok(Outcome::Cancelled);
    };
    let seconds = run.clock.seconds() - begun;
    let mut written = Vec::new();
    let shown = with_green_up(&scene, args.normal_maps);
    for (path, format) in paths.iter().zip(formats) {
        written.extend(write(path, format, &shown, &unwrapped)?);
    }
    if args.json {
        console::print(&(report(&scene, &unwrapped, seconds, &written).to_string() + "\n"))?;
    } else {
        console::print(&summary(&scene, &unwrapped, seconds, &written))?;
    }
    Ok(console.outcome(args.strict))
}

fn format_of(path: &Path) -> anyhow::Result<Format> {
    match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
        "glb" => Ok(Format::Glb),
        "png" => Ok(Format::Png),
        _ => Err(hinted(
            format!("an unwrapped scene cannot be written as this: {}", path.display()),
            "use a file name that ends in .glb, or in .png for a picture of the atlas",
        )),
    }
}

/// Writes a file, or one for each page.
fn write(path: &Path, format: Format, scene: &Scene, unwrapped: &Unwrapped) -> anyhow::Result<Vec<Written>> {
    let atlas = &unwrapped.atlas;
    let paths = match format {
        Format::Glb => {
            write_unwrapped_glb(path, scene, atlas)?;
            vec![path.to_owned()]
        }
        Format::Png => {
            write_pages(path, atlas.pages().len(), |page, path| write_atlas_png(path, atlas, page))?
        }
    };
    paths.into_iter().map(|path| sized(path).map(|(path, bytes)| Written { path, bytes })).collect()
}

fn summary(
    scene: &Scene,
    Unwrapped { atlas, report }: &Unwrapped,
    seconds: f64,
    written: &[Written],
) -> String {
    let size = |&[width, height]: &[u32; 2]| format!("{width} x {height}");
    let sizes: Vec<String> = atlas.pages().iter().map(size).collect();
    let [p1, p50, p99] = report.stretch.map(|stretch| significant(f64::from(stretch)));
    let mut rows = vec![
        ("scene", scene.name().to_owned()),
        (
            "objects",
            format!("{}, {}", report.objects.len(), counted(scene.triangle_count(), "triangle", "triangles")),
        ),
        ("charts", format!("{} in {}", report.chart_count(), duration(seconds))),
        (
            "atlas",
            format!(
                "{} of {} lumels, {} used",
                counted(sizes.len(), "page", "pages"),
                sizes.join(", "),
                percent(report.utilization)
            ),
        ),
        ("density", format!("{} lumels per metre", significant(f64::from(atlas.density())))),
        ("stretch", format!("1% {p1}, median {p50}, 99% {p99} of the area")),
    ];
    if report.is_shared {
        rows.push((
            "kept",
            "the lightmap coordinates of all objects, on the square that they share".to_owned(),
        ));
    } else if report.kept_count() > 0 {
        let kept = format!("the lightmap coordinates of {} of them", report.kept_count());
        rows.insert(2, ("kept", kept));
    }
    let mut text: String = rows.iter().map(|(label, row)| format!("{label:12}{row}\n")).collect();
    for Written { path, bytes: size } in written {
        text += &format!("wrote {}, {}\n", path.display(), bytes(*size));
    }
    text
}

fn report(
    scene: &Scene,
    Unwrapped { atlas, report }: &Unwrapped,
    seconds: f64,
    written: &[Written],
) -> Value {
    let objects = report.objects.iter().map(|object| {
        json!({
            "name": scene.object_names()[object.object.index()],
            "method": object.method.name(),
            "charts": object.charts,
            "triangles": object.triangles,
            "density": object.density,
            "stretch": object.stretch,
            "lumels": object.lumels,
        })
    });
    let findings = report.findings.iter();
    json!({
        "scene": scene.name(),
        "triangles": scene.triangle_count(),
        "charts": report.chart_count(),
        "pages": atlas.pages(),
        "utilization": report.utilization,
        "density": atlas.density(),
        "gutter": atlas.gutter(),
        "stretch": report.stretch,
        "kept": report.kept_count(),
        "shared": report.is_shared,
        "hash": atlas.identity().to_hex().as_str(),
        "seconds": seconds,
        "objects": objects.collect::<Vec<_>>(),
        "findings": findings.map(|f| json!({ "object": f.object, "message": f.message })).collect::<Vec<_>>(),
        "outputs": written.iter().map(|w| w.path.display().to_string()).collect::<Vec<_>>(),
    })
}
