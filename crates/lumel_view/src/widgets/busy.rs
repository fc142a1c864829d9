//! A sign that something goes on.

use crate::theme;
use eframe::egui::{Response, Sense, Shape, Stroke, Ui, Vec2};
use std::time::Duration;

/// Time from one step of the sign to the next: egui's spinner asks for every frame there can be, and on a software renderer
/// these would take a core from what goes on.
const STEP: Duration = Duration::from_millis(500);

/// Steps of a whole turn.
const STEPS: u64 = 8;

/// The part of the circle that is drawn, degrees.
const ARC_DEG: f32 = 250.0;

/// Shows that something goes on whose end is not known.
pub fn busy(ui: &mut Ui) -> Response {
    let size = Vec2::splat(ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let steps = ui.input(|i| i.time) / STEP.as_secs_f64();
    let turned_deg = 360.0 * (steps as u64 % STEPS) as f32 / STEPS as f32;
    let radius = 0.5 * rect.height() - 5.0;
    let at = |k: u8| {
        let angle_deg = turned_deg + ARC_DEG * f32::from(k) / 16.0;
        rect.center() + radius * Vec2::angled(angle_deg.to_radians())
    };
    ui.painter().add(Shape::line((0..=16).map(at).collect(), Stroke::new(2.0, theme::TEXT)));
    ui.ctx().request_repaint_after(STEP);
    response
}
