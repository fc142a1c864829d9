//! What to do where nothing shines.

use super::state::Subject;
use crate::input::Command;
use crate::theme;
use eframe::egui::{Color32, Frame, Margin, Rect, RichText, Stroke, Ui, UiBuilder, vec2};
use lumel::LightKind;

/// Stays over the picture of a scene that nothing shines in.
pub(super) fn show(subject: &mut Subject<'_>, ui: &mut Ui, rect: Rect) {
    let session = &mut *subject.session;
    let Some(document) = session.document.as_ref().filter(|document| !document.shines(&session.lights))
    else {
        return;
    };
    let is_outdoors = document.is_outdoors;
    let is_off = session.lights.iter().any(|light| !light.on);
    let area = Rect::from_min_size(rect.min + vec2(8.0, 50.0), vec2((rect.width() - 16.0).max(60.0), 80.0));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(area));
    Frame::new()
        .fill(Color32::from_rgba_unmultiplied(24, 25, 28, 235))
        .stroke(Stroke::new(1.0, theme::WARNING))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(12, 8))
        .show(&mut ui, |ui| {
            ui.label(
                RichText::new("Nothing shines in this scene, so there is nothing to solve yet.").strong(),
            );
            ui.horizontal_wrapped(|ui| {
                if is_off && ui.button("Switch the lights on").clicked() {
                    session.lights.iter_mut().for_each(|light| light.on = true);
                }
                if ui.button("Place a light here").on_hover_text(Command::PlaceLight.keys()).clicked() {
                    subject.actions.push(Command::PlaceLight);
                }
                if ui.button("Use the sky").clicked() {
                    session.use_sky();
                }
                if is_outdoors && ui.button("Use sun and sky").clicked() {
                    session.use_sky();
                    session.add_light_of(LightKind::Sun);
                }
            });
        });
}
