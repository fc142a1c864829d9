//! Handles to move and resize a light in the picture.

use crate::lights::EditLight;
use crate::theme;
use eframe::egui::{self, Color32, CursorIcon, PointerButton, Pos2, Rect, Response, Shape, Stroke, Ui, pos2};
use glam::{Vec2, Vec3};
use lumel::Camera;
use lumel_render_cpu::Lens;

/// Length of the arrows, as a share of the distance to the eye: they look equally long everywhere.
const ARROW: f32 = 0.12;

/// How near the pointer must be to a handle, points.
const REACH: f32 = 9.0;

/// A part of the light that can be dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handle {
    /// Moves in the plane of the picture.
    Center,
    /// Moves along an axis of the world.
    Axis(usize),
    /// Changes the size.
    Corner(usize),
}

const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];
const AXIS_COLORS: [Color32; 3] =
    [Color32::from_rgb(235, 90, 80), Color32::from_rgb(120, 205, 90), Color32::from_rgb(90, 150, 245)];

/// What is being dragged.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gizmo {
    held: Option<Handle>,
}

/// The light on the picture.
struct Projection {
    lens: Lens,
    rect: Rect,
}

impl Projection {
    fn new(camera: &Camera, rect: Rect) -> Option<Self> {
        let lens = Lens::new(camera, rect.width() / rect.height().max(1.0)).ok()?;
        Some(Self { lens, rect })
    }

    fn point(&self, p: Vec3) -> Option<Pos2> {
        let at = self.lens.project(p)?;
        // Far outside, lines would be drawn with numbers that have no meaning.
        (at.abs().max_element() < 50.0).then(|| {
            pos2(self.rect.left() + at.x * self.rect.width(), self.rect.top() + at.y * self.rect.height())
        })
    }

    /// Origin and direction of the ray through a point of the window.
    fn ray(&self, p: Pos2) -> (Vec3, Vec3) {
        let size = self.rect.size();
        let at = Vec2::new((p.x - self.rect.left()) / size.x, (p.y - self.rect.top()) / size.y);
        let ray = self.lens.ray(at);
        (ray.origin, ray.direction)
    }
}

fn arrow_length(camera: &Camera, light: &EditLight) -> f32 {
    ARROW * camera.position.distance(light.rect.center).max(1e-6)
}

/// All handles with their places.
fn handles(projection: &Projection, camera: &Camera, light: &EditLight) -> Vec<(Handle, Pos2)> {
    let length = arrow_length(camera, light);
    let mut all = Vec::new();
    // With the eye in the light, its axes would be strewn over the picture.
    if projection.point(light.rect.center).is_none() {
        return all;
    }
    let mut add = |handle, p| all.extend(projection.point(p).map(|at| (handle, at)));
    add(Handle::Center, light.rect.center);
    for (k, axis) in AXES.into_iter().enumerate() {
        add(Handle::Axis(k), light.rect.center + axis * length);
    }
    for (k, corner) in light.rect.corners().into_iter().enumerate() {
        add(Handle::Corner(k), corner);
    }
    all
}

fn nearest(handles: &[(Handle, Pos2)], p: Pos2) -> Option<Handle> {
    let within = handles.iter().map(|(handle, at)| (*handle, at.distance(p))).filter(|(_, d)| *d < REACH);
    within.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(handle, _)| handle)
}

impl Gizmo {
    /// Moves or resizes the light by what the pointer does; true while a handle is held.
    pub fn drag(&mut self, ui: &Ui, response: &Response, camera: &Camera, light: &mut EditLight) -> bool {
        let Some(projection) = Projection::new(camera, response.rect).filter(|_| light.on) else {
            return false;
        };
        let hover = response.hover_pos().and_then(|p| nearest(&handles(&projection, camera, light), p));
        if hover.is_some() || self.held.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        }
        if response.drag_started_by(PointerButton::Primary) {
            let from = ui.input(|i| i.pointer.press_origin());
            self.held = from.and_then(|p| nearest(&handles(&projection, camera, light), p));
        }
        if !response.dragged_by(PointerButton::Primary) {
            self.held = None;
        }
        let (Some(handle), Some(to)) = (self.held, response.interact_pointer_pos()) else {
            return self.held.is_some();
        };
        let from = to - response.drag_delta();
        if from != to {
            apply(handle, &projection, camera, light, from, to);
        }
        true
    }

    /// Draws a light's outline; with its handles if it is the active one, whose pointer is given.
    pub fn paint(
        &self,
        ui: &Ui,
        rect: Rect,
        camera: &Camera,
        light: &EditLight,
        active: Option<Option<Pos2>>,
    ) {
        let Some(projection) = Projection::new(camera, rect).filter(|_| light.on) else { return };
        let painter = ui.painter().with_clip_rect(rect);
        let corners: Vec<Pos2> =
            light.rect.corners().into_iter().filter_map(|p| projection.point(p)).collect();
        let color = if active.is_some() { theme::ACCENT } else { Color32::from_white_alpha(90) };
        if corners.len() == 4 {
            painter.add(Shape::closed_line(corners.clone(), Stroke::new(1.5, color)));
        }
        let Some(hover) = active else { return };
        let center = projection.point(light.rect.center);
        let normal = light.rect.normal().unwrap_or(Vec3::NEG_Y);
        let length = arrow_length(camera, light);
        let line = |painter: &egui::Painter, to: Vec3, stroke: Stroke| {
            if let (Some(a), Some(b)) = (center, projection.point(to)) {
                painter.line_segment([a, b], stroke);
            }
        };
        line(&painter, light.rect.center + normal * 0.7 * length, Stroke::new(2.0, theme::ACCENT));
        let all = handles(&projection, camera, light);
        let hot = self.held.or_else(|| hover.and_then(|p| nearest(&all, p)));
        for (handle, at) in all {
            let is_hot = hot == Some(handle);
            match handle {
                Handle::Axis(k) => {
                    let stroke = Stroke::new(if is_hot { 3.0 } else { 2.0 }, AXIS_COLORS[k]);
                    line(&painter, light.rect.center + AXES[k] * length, stroke);
                    painter.circle_filled(at, if is_hot { 6.0 } else { 4.5 }, AXIS_COLORS[k]);
                }
                Handle::Center => {
                    painter.circle_filled(at, if is_hot { 6.5 } else { 5.0 }, theme::ACCENT);
                }
                Handle::Corner(_) => {
                    let size = if is_hot { 11.0 } else { 8.0 };
                    let square = Rect::from_center_size(at, egui::Vec2::splat(size));
                    painter.rect_filled(square, 1.5, theme::ACCENT);
                    painter.rect_stroke(
                        square,
                        1.5,
                        Stroke::new(1.0, Color32::BLACK),
                        egui::StrokeKind::Inside,
                    );
                }
            }
        }
    }
}

/// What dragging a handle from one point of the window to another does.
fn apply(
    handle: Handle,
    projection: &Projection,
    camera: &Camera,
    light: &mut EditLight,
    from: Pos2,
    to: Pos2,
) {
    let center = light.rect.center;
    let [before, after] = [from, to].map(|p| projection.ray(p));
    match handle {
        Handle::Center => {
            let Some([_, _, forward]) = camera.axes() else { return };
            let meet = |ray| meet_plane(ray, center, forward);
            if let (Some(a), Some(b)) = (meet(before), meet(after)) {
                light.rect.center += b - a;
            }
        }
        Handle::Axis(k) => {
            let along = |ray| nearest_on_line(ray, center, AXES[k]);
            if let (Some(a), Some(b)) = (along(before), along(after)) {
                light.rect.center += AXES[k] * (b - a);
            }
        }
        Handle::Corner(_) => {
            let Some(normal) = light.rect.normal() else { return };
            let meet = |ray| meet_plane(ray, center, normal);
            let (Some(a), Some(b)) = (meet(before), meet(after)) else { return };
            let half = light.half_edges();
            let [u, v] = [light.rect.u / half.x, light.rect.v / half.y];
            let grown = |p: Vec3| Vec2::new((p - center).dot(u).abs(), (p - center).dot(v).abs());
            let factor =
                (grown(b) / grown(a).max(Vec2::splat(1e-6))).clamp(Vec2::splat(0.2), Vec2::splat(5.0));
            let factor =
                if light.square { Vec2::splat(factor.length() / Vec2::ONE.length()) } else { factor };
            light.set_half_edges(half * factor);
        }
    }
}

/// Where a ray meets a plane, unless it runs along it or away from it.
fn meet_plane((origin, direction): (Vec3, Vec3), point: Vec3, normal: Vec3) -> Option<Vec3> {
    let cosine = direction.dot(normal);
    let t = (point - origin).dot(normal) / cosine;
    (cosine.abs() > 1e-4 * direction.length() && t > 0.0).then(|| origin + direction * t)
}

/// How far along a line its point nearest to a ray is; none where they are parallel.
fn nearest_on_line((origin, direction): (Vec3, Vec3), point: Vec3, axis: Vec3) -> Option<f32> {
    let direction = direction.try_normalize()?;
    let between = point - origin;
    let b = axis.dot(direction);
    let denominator = 1.0 - b * b;
    (denominator > 1e-4).then(|| (b * direction.dot(between) - axis.dot(between)) / denominator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel::RectLight;
    use lumel_scene::Radiance;

    fn light() -> EditLight {
        let rect = RectLight {
            center: Vec3::ZERO,
            u: Vec3::X,
            v: Vec3::Y,
            radiance: Radiance::splat(1.0),
            texture: None,
        };
        EditLight::new("lamp".into(), rect)
    }

    fn projection() -> (Camera, Projection) {
        let camera = Camera::looking_at("c", Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO, 60_f32.to_radians());
        let rect = Rect::from_min_size(pos2(20.0, 10.0), egui::vec2(400.0, 300.0));
        let projection = Projection::new(&camera, rect).unwrap();
        (camera, projection)
    }

    #[test]
    fn a_dragged_light_follows_the_pointer() {
        let (camera, projection) = projection();
        for (handle, way) in [
            (Handle::Center, Vec3::new(1.0, -0.5, 0.0)),
            (Handle::Axis(0), Vec3::new(1.3, 0.0, 0.0)),
            (Handle::Axis(1), Vec3::new(0.0, 0.7, 0.0)),
        ] {
            let mut lamp = light();
            let [from, to] = [Vec3::ZERO, way].map(|p| projection.point(p).unwrap());
            apply(handle, &projection, &camera, &mut lamp, from, to);
            assert!((lamp.rect.center - way).length() < 1e-3, "{handle:?}: {}", lamp.rect.center);
        }
    }

    #[test]
    fn a_dragged_corner_resizes_the_light() {
        let (camera, projection) = projection();
        let [from, to] =
            [Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 0.0)].map(|p| projection.point(p).unwrap());
        let mut lamp = light();
        apply(Handle::Corner(2), &projection, &camera, &mut lamp, from, to);
        assert!((lamp.half_edges() - Vec2::splat(2.0)).length() < 1e-3);
        let mut lamp = EditLight { square: false, ..light() };
        let to = projection.point(Vec3::new(2.0, 1.0, 0.0)).unwrap();
        apply(Handle::Corner(2), &projection, &camera, &mut lamp, from, to);
        assert!((lamp.half_edges() - Vec2::new(2.0, 1.0)).length() < 1e-3, "{}", lamp.half_edges());
    }

    #[test]
    fn an_axis_along_the_line_of_sight_does_not_throw_the_light_away() {
        let (camera, projection) = projection();
        let mut lamp = light();
        let at = projection.point(Vec3::ZERO).unwrap();
        apply(Handle::Axis(2), &projection, &camera, &mut lamp, at, at + egui::vec2(0.0, 3.0));
        assert!(lamp.rect.center.length() < 10.0);
    }

    #[test]
    fn the_nearest_handle_within_reach_is_taken() {
        let (camera, projection) = projection();
        let lamp = light();
        let all = handles(&projection, &camera, &lamp);
        assert_eq!(all.len(), 7 + 1, "the center, three axes, four corners");
        let corner = projection.point(Vec3::new(1.0, 1.0, 0.0)).unwrap();
        assert_eq!(nearest(&all, corner + egui::vec2(3.0, -2.0)), Some(Handle::Corner(2)));
        assert_eq!(nearest(&all, corner + egui::vec2(100.0, 100.0)), None);
    }
}
