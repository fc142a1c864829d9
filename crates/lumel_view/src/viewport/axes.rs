//! The axes of the world in a corner of the picture: a click on one looks along it.

use super::state::Subject;
use crate::camera::ViewSide;
use crate::gizmo::AXIS_COLORS;
use crate::input::Command;
use crate::theme;
use eframe::egui::accesskit::Role;
use eframe::egui::{Align2, Color32, FontId, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

/// Length of an axis, points.
const LENGTH: f32 = 28.0;
/// Radius of its head, and of that of the other direction.
const HEADS: [f32; 2] = [8.0, 5.5];
/// Distance of the middle from the corner.
const INSET: f32 = 46.0;
/// Smaller pictures have none.
const LEAST: Vec2 = vec2(240.0, 220.0);

/// Draws the axes at the lower right of the picture.
pub(super) fn show(subject: &mut Subject<'_>, ui: &Ui, rect: Rect) {
    if rect.width() < LEAST.x || rect.height() < LEAST.y {
        return;
    }
    let camera = subject.session.camera;
    let (right, up, forward) = (camera.right(), camera.up(), camera.forward());
    let middle = rect.right_bottom() - Vec2::splat(INSET);
    let mut sides = ViewSide::ALL;
    // The nearest is drawn last.
    sides.sort_by(|a, b| b.direction().dot(forward).total_cmp(&a.direction().dot(forward)));
    let painter = ui.painter().with_clip_rect(rect);
    for side in sides {
        let direction = side.direction();
        let (axis, sign) = axis_of(side);
        let head = middle + vec2(direction.dot(right), -direction.dot(up)) * LENGTH;
        let radius = HEADS[usize::from(sign < 0)];
        let area = Rect::from_center_size(head, Vec2::splat(2.0 * radius));
        let response = ui.interact(area, ui.scope_id().with(("axis", axis, sign)), Sense::click());
        let name = format!("View from {}{}", if sign < 0 { "-" } else { "+" }, ["X", "Y", "Z"][axis]);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        let color = if response.hovered() { Color32::WHITE } else { AXIS_COLORS[axis] };
        if sign < 0 {
            painter.circle(head, radius, Color32::from_black_alpha(120), Stroke::new(1.5, color));
        } else {
            painter.line_segment([middle, head], Stroke::new(2.0, color));
            painter.circle_filled(head, radius, color);
            let font = FontId::proportional(11.0);
            painter.text(head, Align2::CENTER_CENTER, ["X", "Y", "Z"][axis], font, theme::ON_ACCENT);
        }
        if response.on_hover_text(name).clicked() {
            subject.actions.push(Command::View(side));
        }
    }
}

/// The axis that a side is on, and the sign.
fn axis_of(side: ViewSide) -> (usize, i8) {
    let direction = side.direction();
    let axis = usize::from(direction.y != 0.0) + 2 * usize::from(direction.z != 0.0);
    (axis, if direction[axis] < 0.0 { -1 } else { 1 })
}
