//! Surfaces that emit light.

use crate::session::Session;
use crate::theme;
use crate::values::significant;
use crate::widgets::{heading, hint};
use eframe::egui::{Grid, Label, RichText, Ui};

/// More materials than this are only counted.
const MAX_SHOWN: usize = 50;

/// Lists what emits, the strongest first.
pub(super) fn show(session: &Session, ui: &mut Ui) {
    let Some(document) = session.document.as_ref().filter(|document| !document.emissive.is_empty()) else {
        return;
    };
    heading(ui, "Emissive surfaces");
    Grid::new("emissive").num_columns(3).striped(true).spacing([12.0, 2.0]).show(ui, |ui| {
        for text in ["Material", "Area", "Power"] {
            ui.label(RichText::new(text).color(theme::WEAK).small());
        }
        ui.end_row();
        for surface in document.emissive.iter().take(MAX_SHOWN) {
            ui.add(Label::new(&surface.material).truncate());
            ui.label(format!("{} m²", significant(surface.area as f32)));
            let [r, g, b] = surface.power.to_array().map(significant);
            ui.label(format!("{r} {g} {b} W"));
            ui.end_row();
        }
    });
    if document.emissive.len() > MAX_SHOWN {
        hint(ui, &format!("and {} more", document.emissive.len() - MAX_SHOWN));
    }
}
