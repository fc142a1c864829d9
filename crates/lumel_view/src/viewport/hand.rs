//! The mouse in the viewport: look, pan, pick, the divider and the light handles.

use super::state::{Subject, Viewport};
use crate::document::Document;
use crate::pick::{self, Pick};
use crate::prefs::SPEED;
use eframe::egui::{self, CursorIcon, PointerButton, Response, Ui};
use glam::Vec2;

/// Looks, moves and dollies by dragging.
pub(super) fn drag(subject: &mut Subject<'_>, response: &Response) {
    let delta = response.drag_delta();
    if delta == egui::Vec2::ZERO {
        return;
    }
    let diagonal = subject.session.document.as_ref().map_or(1.0, Document::diagonal);
    let camera = &mut subject.session.camera;
    // A drag across the picture moves by about the size of what is seen from the middle of the scene.
    let metres = diagonal / response.rect.height().max(1.0);
    if response.dragged_by(PointerButton::Primary) {
        camera.look(Vec2::new(delta.x, -delta.y) * subject.prefs.look_speed);
    } else if response.dragged_by(PointerButton::Middle) {
        camera.pan(Vec2::new(-delta.x, delta.y) * metres * 0.7);
    } else if response.dragged_by(PointerButton::Secondary) {
        camera.fly([0.0, 0.0, -delta.y * metres]);
    }
}

/// Reads the light at the spot that was clicked.
pub(super) fn click(subject: &mut Subject<'_>, response: &Response) {
    let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) else { return };
    let Some(document) = &subject.session.document else { return };
    let rect = response.rect;
    let at = Vec2::new((at.x - rect.left()) / rect.width(), (at.y - rect.top()) / rect.height());
    let camera = subject.session.camera.camera();
    let aspect = rect.width() / rect.height().max(1.0);
    let spot = pick::spot(&document.scene, &*document.tracer, &camera, aspect, at);
    *subject.pick = spot.map(Pick::new);
}

pub(super) fn wheel(subject: &mut Subject<'_>, ui: &Ui, response: &Response) {
    if !response.hovered() {
        return;
    }
    let turned = ui.input(|i| i.smooth_scroll_delta().y);
    if turned != 0.0 {
        subject.prefs.speed = (subject.prefs.speed * (turned * 0.004).exp()).clamp(SPEED[0], SPEED[1]);
    }
}

/// The divider between two lights; true while it is dragged.
pub(super) fn divide(
    viewport: &mut Viewport,
    subject: &mut Subject<'_>,
    ui: &Ui,
    response: &Response,
) -> bool {
    let Some(split) = subject.comparison.split() else {
        viewport.dividing = false;
        return false;
    };
    let rect = response.rect;
    let x = rect.left() + split.at * rect.width();
    let near = |p: egui::Pos2| (p.x - x).abs() < 8.0;
    if response.hover_pos().is_some_and(near) || viewport.dividing {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let pressed_at = ui.input(|i| i.pointer.press_origin());
    if response.drag_started_by(PointerButton::Primary) && pressed_at.is_some_and(near) {
        viewport.dividing = true;
    }
    if !response.dragged_by(PointerButton::Primary) {
        viewport.dividing = false;
    }
    if let (true, Some(p)) = (viewport.dividing, response.interact_pointer_pos()) {
        subject.comparison.set_divider((p.x - rect.left()) / rect.width());
    }
    viewport.dividing
}

/// The handles of the active light; true while one is held.
pub(super) fn handles(
    viewport: &mut Viewport,
    subject: &mut Subject<'_>,
    ui: &Ui,
    response: &Response,
) -> bool {
    if !subject.prefs.view.gizmo {
        return false;
    }
    let camera = subject.session.camera.camera();
    let gizmo = &mut viewport.gizmo;
    subject.session.active_light().is_some_and(|light| gizmo.drag(ui, response, &camera, light))
}
