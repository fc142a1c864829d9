//! The mouse in the viewport: look, pan, pick, the divider and the light handles.

use super::orbit;
use super::state::{Subject, Viewport};
use crate::document::Document;
use crate::gizmo::Snap;
use crate::pick::{self, Pick};
use crate::prefs::SPEED;
use eframe::egui::{self, CursorIcon, Modifiers, PointerButton, Response, Ui};
use glam::Vec2;

/// How far an orbit turns, relative to looking around.
const ORBIT: f32 = 1.6;

/// What a drag of the picture does.
enum Drag {
    Look,
    Orbit,
    Pan,
    Dolly,
}

fn drag_of(response: &Response, modifiers: Modifiers) -> Option<Drag> {
    let by = |button| response.dragged_by(button);
    if by(PointerButton::Primary) {
        return Some(if modifiers.alt { Drag::Orbit } else { Drag::Look });
    }
    if by(PointerButton::Middle) {
        return Some(match modifiers {
            Modifiers { shift: true, .. } => Drag::Pan,
            Modifiers { ctrl: true, .. } => Drag::Dolly,
            _ => Drag::Orbit,
        });
    }
    by(PointerButton::Secondary).then_some(Drag::Dolly)
}

/// Looks, orbits, pans and dollies by dragging.
pub(super) fn drag(viewport: &mut Viewport, subject: &mut Subject<'_>, ui: &Ui, response: &Response) {
    let drag = drag_of(response, ui.input(|i| i.modifiers));
    if !matches!(drag, Some(Drag::Orbit)) {
        viewport.pivot = None;
    }
    let (delta, Some(drag)) = (response.drag_delta(), drag) else { return };
    if delta == egui::Vec2::ZERO {
        return;
    }
    if let (Drag::Orbit, None) = (&drag, viewport.pivot) {
        let from = ui.input(|i| i.pointer.press_origin()).unwrap_or(response.rect.center());
        viewport.pivot =
            orbit::pivot(subject.session, subject.pick.as_ref(), viewport.aspect(), place(response, from));
    }
    let diagonal = subject.session.document.as_ref().map_or(1.0, Document::diagonal);
    let camera = &mut subject.session.camera;
    // A drag across the picture moves by about the size of what is seen from the middle of the scene.
    let metres = diagonal / response.rect.height().max(1.0);
    let turn = Vec2::new(delta.x, -delta.y) * subject.prefs.look_speed;
    match drag {
        Drag::Look => camera.look(turn),
        Drag::Orbit => camera.orbit(viewport.pivot.unwrap_or(camera.position), turn * ORBIT),
        Drag::Pan => camera.pan(Vec2::new(-delta.x, delta.y) * metres * 0.7),
        Drag::Dolly => camera.fly([0.0, 0.0, -delta.y * metres]),
    }
}

/// A point of the window on the picture, 0..=1 from its top left.
fn place(response: &Response, at: egui::Pos2) -> Vec2 {
    let rect = response.rect;
    Vec2::new((at.x - rect.left()) / rect.width(), (at.y - rect.top()) / rect.height())
}

/// Reads the light at the spot that was clicked.
pub(super) fn click(subject: &mut Subject<'_>, response: &Response) {
    let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) else { return };
    let Some(document) = &subject.session.document else { return };
    let camera = subject.session.camera.camera();
    let aspect = response.rect.width() / response.rect.height().max(1.0);
    let spot = pick::spot(&document.scene, &*document.tracer, &camera, aspect, place(response, at));
    *subject.pick = spot.map(Pick::new);
}

/// Flies faster or slower by the wheel; with Ctrl, moves nearer to what is under the pointer or away from it.
pub(super) fn wheel(viewport: &Viewport, subject: &mut Subject<'_>, ui: &Ui, response: &Response) {
    let Some(at) = response.hover_pos() else { return };
    let zoom = ui.input(|i| i.zoom_delta());
    if zoom != 1.0 {
        let target = orbit::pivot(subject.session, None, viewport.aspect(), place(response, at));
        if let Some(target) = target {
            subject.session.camera.approach(target, zoom);
        }
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
    let session = &mut *subject.session;
    let camera = session.camera.camera();
    let (Some(document), Some(light)) = (&session.document, session.lights.get_mut(session.active)) else {
        return false;
    };
    let aspect = viewport.aspect();
    let surface = |at| {
        let spot = pick::spot(&document.scene, &*document.tracer, &camera, aspect, place(response, at))?;
        Some((spot.position, spot.normal))
    };
    let snap = match ui.input(|i| i.modifiers.ctrl) {
        true => Snap::On { origin: document.scene.origin(), surface: &surface },
        false => Snap::Off,
    };
    viewport.gizmo.drag(ui, response, &camera, light, snap)
}
