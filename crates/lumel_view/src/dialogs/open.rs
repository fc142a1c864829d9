//! What there is to open: built-in scenes and those opened last.

use crate::theme;
use crate::widgets::number;
use eframe::egui::{self, Button, DragValue, RichText};
use std::path::Path;

/// Lists scenes; returns the one that is chosen.
pub(super) fn choices(ui: &mut egui::Ui, recent: &[String], max_edge: &mut f32) -> Option<String> {
    let mut chosen = None;
    ui.columns(2, |columns| {
        let [left, right] = columns else { return };
        left.label(RichText::new("Built-in scenes").strong());
        for &name in lumel_builtin::NAMES {
            let about = lumel_builtin::describe(name).unwrap_or_default();
            if entry(left, name, about).clicked() {
                chosen = Some(name.to_owned());
            }
        }
        right.label(RichText::new("Recent").strong());
        let files: Vec<&String> =
            recent.iter().filter(|name| !lumel_builtin::NAMES.contains(&name.as_str())).collect();
        if files.is_empty() {
            right.label(RichText::new("Files you open appear here.").color(theme::WEAK));
        }
        for name in files {
            let file = Path::new(name).file_name().unwrap_or_default().to_string_lossy();
            if entry(right, &file, name).clicked() {
                chosen = Some(name.clone());
            }
        }
    });
    ui.add_space(6.0);
    ui.separator();
    let hint = "Longer edges are split when the scene is opened: light is stored at vertices. 0 leaves the mesh \
                unchanged.";
    let drag = DragValue::new(max_edge).speed(0.005).range(0.0..=1000.0).max_decimals(3).suffix(" m");
    number(ui, "Longest edge", hint, drag);
    chosen
}

fn entry(ui: &mut egui::Ui, name: &str, hint: &str) -> egui::Response {
    let button = Button::new(name).truncate().min_size(egui::vec2(ui.available_width(), 26.0));
    ui.add(button).on_hover_text(hint)
}
