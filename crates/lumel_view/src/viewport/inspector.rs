//! The light on the surface that was clicked.

use crate::document::Document;
use crate::pick::Pick;
use crate::selection::Selection;
use crate::session::Session;
use crate::theme;
use crate::values::significant;
use eframe::egui::{self, Color32, Frame, Grid, Margin, Rect, RichText, ScrollArea, Ui, vec2};
use glam::{DVec3, Vec3};
use lumel_render_cpu::srgb_byte;

pub(super) fn show(session: &Session, pick: &mut Option<Pick>, ui: &mut Ui, rect: Rect) {
    let Some(picked) = pick.as_ref().filter(|_| rect.width() >= 330.0) else { return };
    let size = vec2(310.0, (rect.height() - 110.0).min(430.0));
    let area = Rect::from_min_size(rect.min + vec2(8.0, 50.0), size);
    let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(area));
    let mut close = false;
    Frame::new()
        .fill(Color32::from_rgba_unmultiplied(24, 25, 28, 232))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(12, 8))
        .show(&mut ui, |ui| {
            ui.set_width(size.x - 24.0);
            ui.horizontal(|ui| {
                ui.label(RichText::new("Surface").strong());
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    close = ui.small_button("Close").clicked();
                });
            });
            content(session, picked, ui, size.y - 46.0);
        });
    if close {
        *pick = None;
    }
}

fn content(session: &Session, pick: &Pick, ui: &mut Ui, height: f32) {
    let Some(document) = &session.document else { return };
    let spot = &pick.spot;
    let point = |v: DVec3| format!("{:.3}  {:.3}  {:.3}", v.x, v.y, v.z);
    let rgb = |v: Vec3| format!("{}  {}  {}", significant(v.x), significant(v.y), significant(v.z));
    ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("spot").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
            let mut line = |name: &str, text: String| {
                ui.label(RichText::new(name).color(theme::WEAK));
                ui.add(egui::Label::new(text).truncate());
                ui.end_row();
            };
            line("Position", format!("{} m", point(document.scene.to_world(spot.position))));
            line("Normal", point(spot.normal.as_dvec3()));
            line("Triangle", format!("{} of {}", spot.triangle().0, spot.object));
            line("Material", spot.material.clone());
            line("Albedo", rgb(spot.albedo));
            if spot.emission != Vec3::ZERO {
                line("Emits", format!("{} W/(m² sr)", rgb(spot.emission)));
            }
            if let Some(light) = session.lumel_light().and_then(|light| light.at(spot.at)) {
                line("On lumels", format!("{} W/m²", rgb(light.0)));
            }
        });
        swatch(ui, spot.albedo);
        ui.add_space(4.0);
        light(session, pick, document, ui);
    });
}

fn swatch(ui: &mut Ui, albedo: Vec3) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 6.0), egui::Sense::hover());
    let [r, g, b] = albedo.to_array().map(srgb_byte);
    ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
}

/// Stored light at the spot, and a fresh measurement with its standard error.
fn light(session: &Session, pick: &Pick, document: &Document, ui: &mut Ui) {
    let light = &session.light;
    if light.is_empty() {
        ui.label(RichText::new("Not solved: press Enter.").color(theme::WEAK));
        return;
    }
    let stored = pick.spot.bounces(&document.scene, light);
    let sum = session.selected_light(Selection::All);
    let total = pick.spot.value(&document.scene, &sum);
    let measured = pick.measured.as_ref();
    ui.label(RichText::new("Irradiance, W/m²").strong());
    Grid::new("light").num_columns(3).striped(true).spacing([12.0, 2.0]).show(ui, |ui| {
        for text in ["Bounce", "Stored  r g b", "Measured here"] {
            ui.label(RichText::new(text).color(theme::WEAK).small());
        }
        ui.end_row();
        for (k, value) in stored.iter().enumerate() {
            let fresh =
                measured.and_then(|m| Some((*m.bounces.get(k)?.first()?, *m.bounce_errors.get(k)?.first()?)));
            line(ui, &k.to_string(), *value, fresh);
        }
        let fresh = measured.and_then(|m| Some((*m.irradiance.first()?, *m.standard_error.first()?)));
        line(ui, "All", total, fresh);
    });
    let note = if pick.is_measuring() {
        "Measuring..."
    } else if measured.is_some() {
        "Measured here: green channel ± standard error."
    } else {
        "Measured here when the solve has finished."
    };
    ui.label(RichText::new(note).color(theme::WEAK).small());
}

fn line(ui: &mut Ui, name: &str, stored: Vec3, measured: Option<(Vec3, Vec3)>) {
    ui.label(name);
    ui.label(format!("{}  {}  {}", significant(stored.x), significant(stored.y), significant(stored.z)));
    match measured {
        Some((value, error)) => ui.label(format!("{} ± {}", significant(value.y), significant(error.y))),
        None => ui.label(RichText::new("-").color(theme::WEAK)),
    };
    ui.end_row();
}
