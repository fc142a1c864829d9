//! Flying by keys.

use super::state::{Subject, Viewport};
use crate::document::Document;
use crate::input::{Command, FRAME_KEY, MOTIONS, Motion};
use eframe::egui::{self, Response, Ui};
use glam::Vec2;

/// Scene diagonals per second at a speed of 1.
const FLIGHT: f32 = 0.2;

/// Degrees per second of looking and rolling by keys.
const TURN_DEG: f32 = 60.0;

/// How much faster Shift is, and how much slower Ctrl.
const FAST: f32 = 4.0;
const SLOW: f32 = 0.2;

/// A key that is let go within this time was tapped, seconds.
const TAP: f64 = 0.18;

/// Longest time that one frame flies for: after a pause one does not jump.
const MAX_STEP: f32 = 0.25;

/// Flies by the keys that are held.
pub(super) fn fly(viewport: &mut Viewport, subject: &mut Subject<'_>, ui: &Ui, response: &Response) {
    let focused = ui.memory(|memory| memory.focused());
    let ours = focused.is_none_or(|id| id == response.id);
    let filter =
        egui::EventFilter { tab: false, horizontal_arrows: true, vertical_arrows: true, escape: true };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    if ui.ctx().text_edit_focused() || subject.in_dialog {
        viewport.flying = false;
        return;
    }
    let held = |motion: Motion| {
        MOTIONS.iter().any(|(m, key, _)| {
            // Arrow keys belong to the slider that has the focus.
            let allowed = ours || !is_arrow(*key);
            *m == motion && allowed && !viewport.spent_keys.contains(key) && ui.input(|i| i.key_down(*key))
        })
    };
    let axis = |plus, minus| f32::from(i8::from(held(plus)) - i8::from(held(minus)));
    let way = [
        axis(Motion::Right, Motion::Left),
        axis(Motion::Up, Motion::Down),
        axis(Motion::Forward, Motion::Back),
    ];
    let look = Vec2::new(axis(Motion::LookRight, Motion::LookLeft), axis(Motion::LookUp, Motion::LookDown));
    let roll = axis(Motion::RollRight, Motion::RollLeft);
    let flies_elsewhere =
        [Motion::Right, Motion::Left, Motion::Up, Motion::Forward, Motion::Back].into_iter().any(held);
    if tapped(viewport, ui) && !flies_elsewhere {
        subject.actions.push(Command::Frame);
    }
    if way == [0.0; 3] && look == Vec2::ZERO && roll == 0.0 {
        viewport.flying = false;
        return;
    }
    let (dt, modifiers) = ui.input(|i| (i.stable_dt.min(MAX_STEP), i.modifiers));
    let dt = if viewport.flying { dt } else { dt.min(1.0 / 60.0) };
    viewport.flying = true;
    let factor = if modifiers.shift {
        FAST
    } else if modifiers.ctrl {
        SLOW
    } else {
        1.0
    };
    let diagonal = subject.session.document.as_ref().map_or(1.0, Document::diagonal);
    let step = subject.prefs.speed * FLIGHT * diagonal * factor * dt;
    let turn = TURN_DEG * factor.min(2.0) * dt;
    let camera = &mut subject.session.camera;
    camera.fly(way.map(|x| x * step));
    camera.look(look * turn);
    camera.roll(roll * turn);
    ui.ctx().request_repaint();
}

/// Whether the key that frames was pressed and let go at once: held, it flies.
fn tapped(viewport: &mut Viewport, ui: &Ui) -> bool {
    let now = ui.input(|i| i.time);
    let mut was_tapped = false;
    let events = ui.input(|i| i.events.clone());
    for event in events {
        let egui::Event::Key { key: FRAME_KEY, pressed, repeat: false, modifiers, .. } = event else {
            continue;
        };
        if pressed {
            viewport.tapped = modifiers.is_none().then_some(now);
        } else {
            was_tapped = viewport.tapped.take().is_some_and(|since| now - since < TAP);
        }
    }
    was_tapped
}

fn is_arrow(key: egui::Key) -> bool {
    use egui::Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp};
    matches!(key, ArrowDown | ArrowLeft | ArrowRight | ArrowUp)
}
