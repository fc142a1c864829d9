//! The picture in the window: flying, picking, the divider and the handles of the light.

use crate::app::App;
use crate::gizmo::Gizmo;
use crate::input::{MOTIONS, Motion};
use crate::pick::{self, Pick};
use crate::prefs::SPEED;
use crate::stage::{Marks, Quality, Showing};
use crate::theme;
use eframe::egui::{
    self, Color32, CursorIcon, FontId, Id, PointerButton, Rect, Response, Sense, Stroke, Ui, pos2, vec2,
};
use glam::Vec2;
use std::time::{Duration, Instant};

/// Scene diagonals per second at a speed of 1.
const FLIGHT: f32 = 0.2;

/// Degrees per second of looking and rolling by keys.
const TURN_DEG: f32 = 60.0;

/// How much faster Shift is, and how much slower Ctrl.
const FAST: f32 = 4.0;
const SLOW: f32 = 0.2;

/// How long after the last movement the picture counts as still.
const SETTLE: Duration = Duration::from_millis(220);

/// Longest time that one frame flies for: after a pause one does not jump.
const MAX_STEP: f32 = 0.25;

/// What the viewport remembers from frame to frame.
#[derive(Default)]
pub struct Viewport {
    id: Option<Id>,
    area: Option<Rect>,
    moved: Option<Instant>,
    /// Whether a key flew in the last frame: the first frame of a flight has no sensible duration.
    flying: bool,
    gizmo: Gizmo,
    dividing: bool,
    pub(crate) marks: Marks,
    pub(crate) marks_key: Option<crate::panels::MarksKey>,
    problem: Option<String>,
}

impl Viewport {
    /// The viewport's widget, once it was shown.
    pub fn id(&self) -> Option<Id> {
        self.id
    }

    /// Where it is in the window.
    pub fn area(&self) -> Rect {
        self.area.unwrap_or(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 480.0)))
    }

    /// Whether something moves.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// Whether keys that fly are held.
    pub fn is_flying(&self) -> bool {
        self.flying
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        let size = self.area().size();
        size.x / size.y.max(1.0)
    }
}

/// Shows the picture and takes what is done to it.
pub fn show(app: &mut App, ui: &mut Ui) {
    let size = ui.available_size().max(vec2(16.0, 16.0));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, "Scene"));
    (app.viewport.id, app.viewport.area) = (Some(response.id), Some(rect));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let before = app.session.camera;
    let taken = divide(app, ui, &response) || handles(app, ui, &response);
    if !taken {
        drag(app, &response);
        click(app, &response);
    }
    wheel(app, ui, &response);
    fly(app, ui, &response);
    if app.session.camera != before {
        app.viewport.moved = Some(Instant::now());
    }
    if app.viewport.is_moving() {
        // One more picture, as good as it gets, when all is still.
        ui.ctx().request_repaint_after(SETTLE);
    }
    picture(app, ui, rect);
    crate::panels::over_picture(app, ui, rect);
}

fn picture(app: &mut App, ui: &mut Ui, rect: Rect) {
    let scale = ui.ctx().pixels_per_point();
    let pixels = [rect.width(), rect.height()].map(|x| (x * scale).round().max(1.0) as u32);
    let live = app.viewport.is_moving() || app.session.is_solving() || app.session.is_light_in_motion();
    let marks = crate::panels::marks(app);
    let showing = Showing {
        session: &app.session,
        view: &app.prefs.view,
        split: app.comparison.split(),
        marks: marks.then_some(&app.viewport.marks),
        quality: if live { Quality::Live } else { Quality::Still },
    };
    let Some(stage) = &mut app.stage else {
        message(
            ui,
            rect,
            "There is no graphics device.\nInstall a Vulkan driver; on Debian: mesa-vulkan-drivers",
        );
        return;
    };
    match stage.show(&showing, pixels) {
        Ok(Some(shown)) => {
            ui.painter().add(shown.shape(rect));
            app.viewport.problem = None;
        }
        Ok(None) => welcome(app, ui, rect),
        Err(error) => {
            let text = crate::document::error_text(&error);
            message(ui, rect, &format!("This scene cannot be shown:\n{text}"));
            if app.viewport.problem.as_ref() != Some(&text) {
                app.session
                    .notices
                    .push(crate::notice::Level::Error, format!("Cannot show the scene: {text}"));
                app.viewport.problem = Some(text);
            }
        }
    }
}

fn message(ui: &Ui, rect: Rect, text: &str) {
    ui.painter().rect_filled(rect, 0.0, theme::DEEP);
    let mut job = egui::text::LayoutJob::simple(
        text.to_owned(),
        FontId::proportional(15.0),
        theme::WEAK,
        (rect.width() - 40.0).max(40.0),
    );
    job.halign = egui::Align::Center;
    let galley = ui.painter().layout_job(job);
    let top = rect.center() - vec2(0.0, 0.5 * galley.size().y);
    ui.painter().galley(top, galley, theme::WEAK);
}

fn welcome(app: &App, ui: &Ui, rect: Rect) {
    let text = if app.session.is_opening() {
        "Opening...".to_owned()
    } else {
        "Press M to open a mesh or a built-in scene, or drop a file here.\nF1 shows all keys.".to_owned()
    };
    message(ui, rect, &text);
}

/// Looks, moves and dollies by dragging.
fn drag(app: &mut App, response: &Response) {
    let delta = response.drag_delta();
    if delta == egui::Vec2::ZERO {
        return;
    }
    let diagonal = app.session.document.as_ref().map_or(1.0, crate::document::Document::diagonal);
    let camera = &mut app.session.camera;
    // A drag across the picture moves by about the size of what is seen from the middle of the scene.
    let metres = diagonal / response.rect.height().max(1.0);
    if response.dragged_by(PointerButton::Primary) {
        camera.look(Vec2::new(delta.x, -delta.y) * app.prefs.look_speed);
    } else if response.dragged_by(PointerButton::Middle) {
        camera.pan(Vec2::new(-delta.x, delta.y) * metres * 0.7);
    } else if response.dragged_by(PointerButton::Secondary) {
        camera.fly([0.0, 0.0, -delta.y * metres]);
    }
}

/// Reads the light at the spot that was clicked.
fn click(app: &mut App, response: &Response) {
    let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) else { return };
    let Some(document) = &app.session.document else { return };
    let rect = response.rect;
    let at = Vec2::new((at.x - rect.left()) / rect.width(), (at.y - rect.top()) / rect.height());
    let camera = app.session.camera.camera();
    let aspect = rect.width() / rect.height().max(1.0);
    let spot = pick::spot(&document.scene, &*document.tracer, &camera, aspect, at);
    app.pick = spot.map(Pick::new);
}

fn wheel(app: &mut App, ui: &Ui, response: &Response) {
    if !response.hovered() {
        return;
    }
    let turned = ui.input(|i| i.smooth_scroll_delta().y);
    if turned != 0.0 {
        app.prefs.speed = (app.prefs.speed * (turned * 0.004).exp()).clamp(SPEED[0], SPEED[1]);
    }
}

/// Flies by the keys that are held.
fn fly(app: &mut App, ui: &Ui, response: &Response) {
    let focused = ui.memory(|memory| memory.focused());
    let ours = focused.is_none_or(|id| id == response.id);
    let filter =
        egui::EventFilter { tab: false, horizontal_arrows: true, vertical_arrows: true, escape: true };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    if ui.ctx().text_edit_focused() || app.dialogs.is_any_open() {
        app.viewport.flying = false;
        return;
    }
    let held = |motion: Motion| {
        MOTIONS.iter().any(|(m, key, _)| {
            // Arrow keys belong to the slider that has the focus.
            let allowed = ours || !is_arrow(*key);
            *m == motion && allowed && !app.spent_keys.contains(key) && ui.input(|i| i.key_down(*key))
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
    if way == [0.0; 3] && look == Vec2::ZERO && roll == 0.0 {
        app.viewport.flying = false;
        return;
    }
    let (dt, modifiers) = ui.input(|i| (i.stable_dt.min(MAX_STEP), i.modifiers));
    let dt = if app.viewport.flying { dt } else { dt.min(1.0 / 60.0) };
    app.viewport.flying = true;
    let factor = if modifiers.shift {
        FAST
    } else if modifiers.ctrl {
        SLOW
    } else {
        1.0
    };
    let diagonal = app.session.document.as_ref().map_or(1.0, crate::document::Document::diagonal);
    let step = app.prefs.speed * FLIGHT * diagonal * factor * dt;
    let turn = TURN_DEG * factor.min(2.0) * dt;
    let camera = &mut app.session.camera;
    camera.fly(way.map(|x| x * step));
    camera.look(look * turn);
    camera.roll(roll * turn);
    ui.ctx().request_repaint();
}

fn is_arrow(key: egui::Key) -> bool {
    use egui::Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp};
    matches!(key, ArrowDown | ArrowLeft | ArrowRight | ArrowUp)
}

/// The divider between two lights; true while it is dragged.
fn divide(app: &mut App, ui: &Ui, response: &Response) -> bool {
    let Some(split) = app.comparison.split() else {
        app.viewport.dividing = false;
        return false;
    };
    let rect = response.rect;
    let x = rect.left() + split.at * rect.width();
    let near = |p: egui::Pos2| (p.x - x).abs() < 8.0;
    if response.hover_pos().is_some_and(near) || app.viewport.dividing {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let pressed_at = ui.input(|i| i.pointer.press_origin());
    if response.drag_started_by(PointerButton::Primary) && pressed_at.is_some_and(near) {
        app.viewport.dividing = true;
    }
    if !response.dragged_by(PointerButton::Primary) {
        app.viewport.dividing = false;
    }
    if let (true, Some(p)) = (app.viewport.dividing, response.interact_pointer_pos()) {
        app.comparison.set_divider((p.x - rect.left()) / rect.width());
    }
    app.viewport.dividing
}

/// The handles of the active light; true while one is held.
fn handles(app: &mut App, ui: &Ui, response: &Response) -> bool {
    if !app.prefs.view.gizmo {
        return false;
    }
    let camera = app.session.camera.camera();
    let mut gizmo = std::mem::take(&mut app.viewport.gizmo);
    let held = app.session.active_light().is_some_and(|light| gizmo.drag(ui, response, &camera, light));
    app.viewport.gizmo = gizmo;
    held
}

/// Draws the handles of the active light and the divider over the picture.
pub fn paint_over(app: &mut App, ui: &Ui, rect: Rect) {
    let camera = app.session.camera.camera();
    if app.prefs.view.gizmo && app.session.document.is_some() {
        let hover = ui.input(|i| i.pointer.hover_pos()).filter(|p| rect.contains(*p));
        let active = app.session.active;
        for (i, light) in app.session.lights.iter().enumerate() {
            app.viewport.gizmo.paint(ui, rect, &camera, light, (i == active).then_some(hover));
        }
    }
    if let Some(split) = app.comparison.split() {
        let x = rect.left() + split.at * rect.width();
        let painter = ui.painter().with_clip_rect(rect);
        painter.vline(x, rect.y_range(), Stroke::new(2.0, Color32::from_white_alpha(220)));
        let knob = Rect::from_center_size(pos2(x, rect.center().y), vec2(10.0, 34.0));
        painter.rect_filled(knob, 5.0, Color32::from_white_alpha(230));
    }
}
