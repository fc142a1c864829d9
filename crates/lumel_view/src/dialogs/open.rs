//! What there is to open: built-in scenes and those opened last.

use crate::document::Document;
use crate::theme;
use crate::values::{grouped, significant};
use eframe::egui::{self, Button, DragValue, RichText};
use lumel::MaxEdge;
use std::path::Path;

/// Lists scenes; returns the one that is chosen.
pub(super) fn choices(
    ui: &mut egui::Ui,
    recent: &[String],
    max_edge: &mut Option<MaxEdge>,
    document: Option<&Document>,
) -> Option<String> {
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
    longest_edge(ui, max_edge);
    if let Some(document) = document {
        ui.label(RichText::new(fineness(document)).color(theme::WEAK));
    }
    chosen
}

/// The length that the drag value starts from, metres.
const FIRST_LENGTH: f32 = 0.1;

/// Chooses how finely a scene is tessellated when it is opened.
fn longest_edge(ui: &mut egui::Ui, max_edge: &mut Option<MaxEdge>) {
    let hint = "Longer edges are split when the scene is opened: light is stored at vertices. Automatic suits the size of \
                the scene and leaves built-in scenes alone.";
    let length = match max_edge {
        Some(MaxEdge::Length(length)) => *length,
        _ => FIRST_LENGTH,
    };
    let choices = [
        ("Automatic", None),
        ("As in the file", Some(MaxEdge::Off)),
        ("At most", Some(MaxEdge::Length(length))),
    ];
    ui.horizontal(|ui| {
        let name = ui.label("Longest edge").on_hover_text(hint);
        for (label, choice) in choices {
            ui.radio_value(max_edge, choice, label).on_hover_text(hint);
        }
        if let Some(MaxEdge::Length(length)) = max_edge {
            let value = DragValue::new(length).speed(0.005).range(1e-4..=1e4).max_decimals(4).suffix(" m");
            ui.add(value).labelled_by(name.id);
        }
    });
}

/// How fine the scene is that is open.
fn fineness(document: &Document) -> String {
    let title = document.request.title();
    let vertices = grouped(document.scene.vertex_count());
    match document.auto_edge {
        Some(edge) => {
            format!(
                "{title} has {vertices} vertices: Automatic split edges to at most {} m.",
                significant(edge)
            )
        }
        None => format!("{title} has {vertices} vertices."),
    }
}

fn entry(ui: &mut egui::Ui, name: &str, hint: &str) -> egui::Response {
    let button = Button::new(name).truncate().min_size(egui::vec2(ui.available_width(), 26.0));
    ui.add(button).on_hover_text(hint)
}
