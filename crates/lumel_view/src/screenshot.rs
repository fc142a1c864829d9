//! Pictures of the view as PNG files, from the window and without one.

use crate::cli::ScreenshotArgs;
use crate::document::{self, error_text};
use crate::lights::drawn;
use crate::notice::Level;
use crate::prefs::ViewPrefs;
use crate::selection::{Illumination, Selection};
use crate::session::{Session, load_light};
use crate::stage::Stage;
use anyhow::Context;
use glam::DVec3;
use lumel::VertexLighting;
use lumel_export::write_png;
use lumel_render_cpu::{Picture, Relief, View, meter};
use lumel_render_gpu::{Frame, Gpu, Lit, Look, Renderer, Samples};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

/// Saves the picture of the window, named by the scene and the time, with its settings inside.
pub(crate) fn from_window(session: &mut Session, stage: Option<&Stage>, view: &ViewPrefs, folder: &Path) {
    let Some(document) = &session.document else {
        session.notices.push(Level::Warning, "Open a scene first");
        return;
    };
    let picture = stage.map_or_else(|| Err("no graphics device".to_owned()), Stage::picture);
    let picture = match picture {
        Ok(picture) => picture,
        Err(problem) => {
            session.notices.push(Level::Error, format!("The screenshot was not saved: {problem}"));
            return;
        }
    };
    let title = document.request.title();
    let stem = title.split('.').next().unwrap_or("scene").to_owned();
    let path = folder.join(format!("{stem}-{}.png", time_stamp(SystemTime::now())));
    let texts = texts(session, view, stage.map_or(0.0, |stage| stage.stops(view)));
    session.write(&path, "the screenshot", None, move |path| save(path, &picture, &texts));
}

fn texts(session: &Session, view: &ViewPrefs, stops: f32) -> Vec<(&'static str, String)> {
    let camera = session.camera;
    let settings = serde_json::to_string(&session.settings).unwrap_or_default();
    let view_text = serde_json::to_string(view).unwrap_or_default();
    let origin = session.document.as_ref().map_or(DVec3::ZERO, |document| document.scene.origin());
    let position = origin + lumel::decimal(camera.position);
    vec![
        ("Title", session.document.as_ref().map_or_else(String::new, |d| d.scene.name().to_owned())),
        ("Software", concat!("lumel-view ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("Creation Time", time_stamp(SystemTime::now())),
        (
            "Comment",
            format!(
                "{}, {}, exposure {stops} EV, tone {}; camera position={},{},{} yaw={} pitch={} roll={} fov={}",
                view.mode.name(),
                view.selection,
                view.tone,
                position.x,
                position.y,
                position.z,
                camera.yaw_deg,
                camera.pitch_deg,
                camera.roll_deg,
                camera.fov_deg
            ),
        ),
        ("Settings", settings),
        ("View", view_text),
    ]
}

pub(crate) fn save(path: &Path, picture: &Picture, texts: &[(&str, String)]) -> Result<(), String> {
    // A PNG text ends at a zero.
    let texts: Vec<(&str, String)> =
        texts.iter().map(|(key, text)| (*key, text.replace('\0', " "))).collect();
    let texts: Vec<(&str, &str)> = texts.iter().map(|(key, text)| (*key, text.as_str())).collect();
    write_png(path, picture.width(), picture.height(), picture.pixels(), &texts).map_err(|e| error_text(&e))
}

/// A time as text that sorts, UTC: 20261125-221530.
fn time_stamp(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let [year, month, day] = civil(days as i64);
    format!("{year:04}{month:02}{day:02}-{:02}{:02}{:02}", second / 3600, second % 3600 / 60, second % 60)
}

/// The date so many days after 1970-01-01; Hinnant, *chrono-Compatible Low-Level Date Algorithms*, 2013.
fn civil(days: i64) -> [i64; 3] {
    let z = days + 719_468;
    let era = z.div_euclid(146_097);
    let day_of_era = z.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    [year_of_era + era * 400 + i64::from(month <= 2), month, day_of_year - (153 * shifted + 2) / 5 + 1]
}

/// Draws a scene without a window, with the renderer of the window.
///
/// # Errors
/// A scene or solution that cannot be read, no graphics device, or a file that cannot be written.
pub fn without_window(
    scene: &crate::document::OpenRequest,
    args: &ScreenshotArgs,
    path: &Path,
) -> anyhow::Result<()> {
    let (mut document, contents) = document::open(scene).map_err(anyhow::Error::msg)?;
    let light = match &args.solution {
        Some(file) => {
            let (mesh, light) = load_light(file, &document.scene, &document.opened, &document.given)
                .map_err(anyhow::Error::msg)?;
            document.show(&mesh);
            crate::session::light_from(&light)
        }
        None => Illumination::default(),
    };
    let selection = args.bounce.map_or(Selection::All, Selection::bounce);
    if let Some(bounce) = args.bounce.filter(|b| *b as usize >= light.bounce_count()) {
        anyhow::bail!(
            "there is no bounce {bounce}: the solution has {} with direct light",
            light.bounce_count()
        );
    }
    let values = light.select(selection, document.scene.vertex_count());
    let camera = match &args.camera {
        Some(name) => {
            document.scene.cameras().iter().find(|c| c.name == *name).cloned().with_context(|| {
                let names: Vec<&str> = document.scene.cameras().iter().map(|c| c.name.as_str()).collect();
                format!(
                    "scene \"{}\" has no camera \"{name}\"; it has: {}",
                    document.scene.name(),
                    names.join(", ")
                )
            })?
        }
        None => document.home.camera(),
    };
    let [width, height] = args.size;
    let gpu = Arc::new(Gpu::headless()?);
    let renderer = Renderer::new(gpu);
    let model = renderer.upload(&document.scene)?;
    let buffer = renderer.light(&model);
    let directional = light.select_directional(selection, values.len()).map(|known| &**known);
    let lighting = VertexLighting::new(&document.scene, &values)?.with_incident(directional)?;
    renderer.set_light(&buffer, &document.scene, &lighting)?;
    let view = View::new(&document.scene, &*document.tracer, &lighting);
    let stops = match args.exposure {
        Some(stops) => stops,
        None => meter(&view, &camera, width as f32 / height as f32)?,
    };
    let prefs = ViewPrefs::default();
    let lamps = drawn(&contents.lights);
    let backdrop = renderer.backdrop(document.scene.sky(), None)?;
    let target = renderer.target([width, height], Samples::Four)?;
    renderer.draw(
        &target,
        &Frame {
            model: &model,
            camera: &camera,
            light: Lit::One((&buffer).into()),
            rect_lights: &lamps,
            look: Look::Radiance { stops, tone: prefs.tone(), white: prefs.white },
            relief: Relief::default(),
            ripple: None,
            wireframe: false,
            grid: false,
            overlay: None,
            sky: document.scene.sky().mean(),
            backdrop: backdrop.as_ref(),
        },
    );
    let picture = renderer.read(&target)?;
    let texts = [
        ("Title", document.scene.name().to_owned()),
        ("Software", concat!("lumel-view ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("Comment", format!("{selection}, exposure {stops} EV, tone {}", prefs.tone)),
    ];
    save(path, &picture, &texts).map_err(anyhow::Error::msg)
}

/// Where screenshots go: the system's folder for pictures, else the current one.
pub fn default_folder() -> PathBuf {
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE")).map(PathBuf::from);
    let pictures = home.map(|home| home.join("Pictures")).filter(|folder| folder.is_dir());
    pictures.unwrap_or_else(|| PathBuf::from("."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn time_stamps_are_dates() {
        let stamp = |seconds| time_stamp(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(stamp(0), "19700101-000000");
        assert_eq!(stamp(951_782_399), "20000228-235959");
        assert_eq!(stamp(951_782_400), "20000229-000000");
        assert_eq!(stamp(1_795_644_930), "20261125-221530");
    }
}
