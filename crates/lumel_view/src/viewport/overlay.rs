//! Overlays: the bar of view modes, the legend, the handles and the inspector.

use super::state::{Subject, Viewport};
use super::{axes, banner, inspector, legend};
use crate::panels::NO_BOUNCES;
use crate::prefs::{Known, ViewMode, ViewPrefs};
use crate::selection::Selection;
use crate::session::Session;
use crate::stage::Side;
use crate::theme;
use eframe::egui::{
    self, Align2, Color32, ComboBox, DragValue, FontId, Frame, Margin, Rect, RichText, Stroke, Ui, pos2, vec2,
};

/// Bounces that have a button of their own; further ones are reached by the range.
const MAX_BUTTONS: usize = 9;

pub(super) fn show(viewport: &Viewport, subject: &mut Subject<'_>, ui: &mut Ui, rect: Rect) {
    if subject.session.document.is_none() {
        return;
    }
    handles(viewport, subject, ui, rect);
    axes::show(subject, ui, rect);
    let range = subject.stage.as_ref().and_then(|stage| stage.range());
    legend::show(&subject.prefs.view, range, ui, rect);
    captions(subject, ui, rect);
    banner::show(subject, ui, rect);
    bar(subject.session, &mut subject.prefs.view, ui, rect);
    inspector::show(subject.session, subject.pick, ui, rect);
}

/// Draws the handles of the active light and the divider over the picture.
fn handles(viewport: &Viewport, subject: &Subject<'_>, ui: &Ui, rect: Rect) {
    let camera = subject.session.camera.camera();
    if subject.prefs.view.gizmo && subject.session.document.is_some() {
        let hover = ui.input(|i| i.pointer.hover_pos()).filter(|p| rect.contains(*p));
        let active = subject.session.active;
        for (i, light) in subject.session.lights.iter().enumerate() {
            viewport.gizmo.paint(ui, rect, &camera, light, (i == active).then_some(hover));
        }
    }
    if let Some(split) = subject.comparison.split() {
        let x = rect.left() + split.at * rect.width();
        let painter = ui.painter().with_clip_rect(rect);
        painter.vline(x, rect.y_range(), Stroke::new(2.0, Color32::from_white_alpha(220)));
        let knob = Rect::from_center_size(pos2(x, rect.center().y), vec2(10.0, 34.0));
        painter.rect_filled(knob, 5.0, Color32::from_white_alpha(230));
    }
}

/// The names of both halves.
fn captions(subject: &Subject<'_>, ui: &Ui, rect: Rect) {
    let Some(split) = subject.comparison.split() else { return };
    let right = match split.right {
        Side::Current if subject.session.lumel_light().is_some() => "current solution at vertices".to_owned(),
        Side::Current => "current solution".to_owned(),
        Side::Smooth => "without normal maps".to_owned(),
        Side::Kept(id) => {
            subject.session.kept.iter().find(|k| k.id == id).map_or_else(String::new, |k| k.name.clone())
        }
    };
    let x = rect.left() + split.at * rect.width();
    let painter = ui.painter().with_clip_rect(rect);
    let write = |text: String, at: egui::Pos2, align: Align2| {
        let galley = painter.layout_no_wrap(text, FontId::proportional(12.0), theme::TEXT);
        let area = align.anchor_size(at, galley.size());
        painter.rect_filled(area.expand2(vec2(6.0, 3.0)), 4.0, Color32::from_black_alpha(170));
        painter.galley(area.min, galley, theme::TEXT);
    };
    let y = rect.top() + 52.0;
    write(
        format!("current solution: {}", subject.prefs.view.selection),
        pos2(x - 14.0, y),
        Align2::RIGHT_TOP,
    );
    let selection = match split.right {
        Side::Smooth => subject.prefs.view.selection,
        Side::Current | Side::Kept(_) => split.selection,
    };
    write(format!("{right}: {selection}"), pos2(x + 14.0, y), Align2::LEFT_TOP);
}

/// What is shown, at the top of the picture.
fn bar(session: &Session, view: &mut ViewPrefs, ui: &mut Ui, rect: Rect) {
    let area = Rect::from_min_size(rect.min + vec2(8.0, 8.0), vec2((rect.width() - 16.0).max(60.0), 34.0));
    let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(area));
    Frame::new()
        .fill(Color32::from_rgba_unmultiplied(24, 25, 28, 215))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(8, 4))
        .show(&mut ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                mode(view, session.known(), ui);
                ui.add_space(6.0);
                bounces(session, &mut view.selection, ui);
            });
        });
}

fn mode(view: &mut ViewPrefs, known: Known, ui: &mut Ui) {
    let shown = &mut view.mode;
    let combo = ComboBox::from_id_salt("surfaces").width(112.0).height(600.0).selected_text(shown.name());
    let response = combo.show_ui(ui, |ui| {
        for mode in ViewMode::offered(known) {
            ui.selectable_value(shown, mode, mode.name()).on_hover_text(mode.hint());
        }
    });
    let name = "View mode";
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::ComboBox, true, name));
    response.response.on_hover_text(view.mode.hint());
}

fn bounces(session: &Session, selection: &mut Selection, ui: &mut Ui) {
    let count = session.light.bounce_count();
    let mut button = |ui: &mut Ui, text: &str, hint: String, value: Selection| {
        let chosen = *selection == value;
        if ui.selectable_label(chosen, text).on_hover_text(hint).clicked() {
            *selection = value;
        }
    };
    button(ui, "All", "All light (B)".into(), Selection::All);
    button(ui, "Direct", "Direct light: bounce 0 (G)".into(), Selection::DIRECT);
    button(ui, "Indirect", "All bounces but direct light (J)".into(), Selection::Indirect);
    if !session.tells_bounces() {
        let label = egui::Button::selectable(false, "Bounce");
        ui.add_enabled(false, label).on_disabled_hover_text(NO_BOUNCES);
        return;
    }
    if count < 2 {
        return;
    }
    ui.label(RichText::new("Bounce").color(theme::WEAK));
    for k in 1..count.min(MAX_BUTTONS + 1) {
        button(ui, &k.to_string(), format!("Bounce {k} only"), Selection::bounce(k as u32));
    }
    ui.label(RichText::new("Range").color(theme::WEAK));
    let last = count as u32 - 1;
    let (mut from, mut to) = match *selection {
        Selection::All => (0, last),
        Selection::Indirect => (1, last),
        Selection::Range(from, to) => (from, to),
    };
    let before = (from, to);
    for (name, value) in [("First bounce", &mut from), ("Last bounce", &mut to)] {
        let response = ui.add(DragValue::new(value).range(0..=last.max(before.1)).speed(0.05));
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::SpinButton, true, name));
        response.on_hover_text(name);
    }
    if (from, to) != before {
        // The end that was not touched gives way.
        *selection = if from != before.0 {
            Selection::Range(from, to.max(from))
        } else {
            Selection::Range(from.min(to), to)
        };
    }
}
