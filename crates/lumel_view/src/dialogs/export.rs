//! How a lit mesh is saved.

use crate::selection::Selection;
use crate::session::{MESH_FORMATS, MeshExport, Session};
use crate::widgets::{choice, number};
use eframe::egui::{DragValue, Ui};
use lumel_export::ColorScale;
use std::path::Path;

/// Bounces that are offered one by one.
const MAX_BOUNCES: usize = 16;

/// What is chosen for a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExportChoice {
    light: Selection,
    exposure: Exposure,
    /// The exposure of the picture, and that which is typed, stops.
    shown: f32,
    typed: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Exposure {
    Auto,
    AsShown,
    Fixed,
}

impl ExportChoice {
    /// The light that is shown, at its own exposure; `stops` is that of the picture.
    pub(super) fn new(light: Selection, stops: f32) -> Self {
        Self { light, exposure: Exposure::Auto, shown: stops, typed: stops }
    }

    /// What is saved.
    pub(super) fn export(&self) -> MeshExport {
        let factor = |stops: f32| ColorScale::Factor(stops.exp2());
        let exposure = match self.exposure {
            Exposure::Auto => ColorScale::Auto,
            Exposure::AsShown => factor(self.shown),
            Exposure::Fixed => factor(self.typed),
        };
        MeshExport { light: self.light, exposure }
    }
}

pub(super) fn show(ui: &mut Ui, export: &mut ExportChoice, path: &mut String, session: &Session) {
    let before = extension(path);
    let mut format = before.clone();
    let about = "GLB shows the light in any viewer, PLY is a plain list of vertices, OBJ is the mesh with vertex colours";
    let known = MESH_FORMATS.iter().position(|known| *known == format);
    let mut index = known.unwrap_or(MESH_FORMATS.len());
    choice(ui, "Format", about, &mut index, &[0, 1, 2], |index| {
        MESH_FORMATS.get(index).map_or_else(|| "by the name".to_owned(), |format| format.to_uppercase())
    });
    if let Some(chosen) = MESH_FORMATS.get(index) {
        format = (*chosen).to_owned();
    }
    if format != before {
        *path = Path::new(path.as_str()).with_extension(format).to_string_lossy().into_owned();
    }
    let bounces = if session.tells_bounces() { session.light.bounce_count().min(MAX_BOUNCES) } else { 0 };
    let mut lights = vec![Selection::All, Selection::DIRECT, Selection::Indirect];
    lights.extend((1..bounces as u32).map(Selection::bounce));
    choice(ui, "Light", "What of the light is saved", &mut export.light, &lights, |light| {
        capital(&light.to_string())
    });
    let all = [Exposure::Auto, Exposure::AsShown, Exposure::Fixed];
    let about = "What multiplies the colours that viewers show; irradiance is saved as it is";
    let shown = export.shown;
    choice(ui, "Exposure", about, &mut export.exposure, &all, |exposure| match exposure {
        Exposure::Auto => "Automatic".to_owned(),
        Exposure::AsShown => format!("As shown ({shown:+.1} EV)"),
        Exposure::Fixed => "Fixed".to_owned(),
    });
    if export.exposure == Exposure::Fixed {
        let stops =
            DragValue::new(&mut export.typed).range(-20.0..=20.0).speed(0.05).suffix(" EV").max_decimals(2);
        number(ui, "Stops", "Each stop doubles the light", stops);
    }
}

fn extension(path: &str) -> String {
    Path::new(path).extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
