//! What there is to begin with while nothing is open.

use super::state::Subject;
use crate::actions::Action;
use crate::document::OpenRequest;
use crate::input::Command;
use crate::theme;
use crate::widgets::primary_button;
use eframe::egui::accesskit::Role;
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{
    Button, Color32, FontId, Rect, Response, RichText, ScrollArea, Ui, UiBuilder, WidgetInfo, vec2,
};
use std::path::Path;

/// Width of all cards, points.
const WIDTH: f32 = 720.0;
/// Height of one.
const CARD: f32 = 46.0;
/// More scenes opened last are in the menu.
const MAX_RECENT: usize = 5;

/// Offers built-in scenes, those opened last, and any file.
pub(super) fn show(subject: &mut Subject<'_>, ui: &mut Ui, rect: Rect) {
    ui.painter().rect_filled(rect, 0.0, theme::DEEP);
    let width = WIDTH.min(rect.width() - 32.0);
    let area = Rect::from_center_size(rect.center(), vec2(width, rect.height() - 24.0));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(area));
    ScrollArea::vertical().id_salt("start").show(&mut ui, |ui| {
        ui.add_space(((area.height() - height(subject)) * 0.4).max(0.0));
        ui.label(RichText::new("lumel").size(26.0).strong().color(theme::ACCENT));
        ui.label(RichText::new("Open a scene, and watch light arrive in it.").color(theme::WEAK));
        ui.add_space(12.0);
        ui.columns(2, |columns| {
            let [left, right] = columns else { return };
            built_in(subject, left);
            files(subject, right);
        });
    });
}

/// About how high everything is.
fn height(subject: &Subject<'_>) -> f32 {
    let cards = lumel_builtin::NAMES.len().max(subject.prefs.recent.len().min(MAX_RECENT) + 2);
    100.0 + cards as f32 * (CARD + 6.0)
}

fn built_in(subject: &mut Subject<'_>, ui: &mut Ui) {
    ui.label(RichText::new("Built-in scenes").strong());
    for &name in lumel_builtin::NAMES {
        if card(ui, name, lumel_builtin::describe(name).unwrap_or_default()).clicked() {
            subject.actions.push(Action::Open(OpenRequest::new(name)));
        }
    }
}

fn files(subject: &mut Subject<'_>, ui: &mut Ui) {
    ui.label(RichText::new("Your files").strong());
    let width = ui.available_width();
    if primary_button(ui, "Open a file...", width).on_hover_text(Command::Open.keys()).clicked() {
        subject.actions.push(Command::Open);
    }
    let text = "or drop one here: OBJ, glTF, GLB, PLY or a lumel project. F1 shows all keys.";
    ui.add(eframe::egui::Label::new(RichText::new(text).color(theme::WEAK)).wrap());
    let is_file = |name: &&String| !lumel_builtin::NAMES.contains(&name.as_str());
    for name in subject.prefs.recent.iter().filter(is_file).take(MAX_RECENT) {
        let path = Path::new(name);
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let folder = path.parent().unwrap_or(path).to_string_lossy();
        if card(ui, &file, &end_of(&folder)).on_hover_text(name).clicked() {
            subject.actions.push(Action::Open(OpenRequest::new(name)));
        }
    }
}

/// The end of a long path.
fn end_of(folder: &str) -> String {
    const LONGEST: usize = 52;
    let excess = folder.chars().count().saturating_sub(LONGEST);
    if excess == 0 {
        folder.to_owned()
    } else {
        format!("...{}", folder.chars().skip(excess).collect::<String>())
    }
}

/// A button with a line below its name.
fn card(ui: &mut Ui, name: &str, about: &str) -> Response {
    let format = |size, color: Color32| TextFormat::simple(FontId::proportional(size), color);
    let mut text = LayoutJob::default();
    text.append(name, 0.0, format(14.0, theme::TEXT));
    text.append("\n", 0.0, format(14.0, theme::TEXT));
    text.append(about, 0.0, format(11.0, theme::WEAK));
    let size = vec2(ui.available_width(), CARD);
    let response = ui.add(Button::new(text).wrap().min_size(size));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response
}
