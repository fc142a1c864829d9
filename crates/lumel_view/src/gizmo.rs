//! Handles to move, turn and resize a light in the picture.

use crate::lights::EditLight;
use crate::theme;
use eframe::egui::{self, Color32, CursorIcon, PointerButton, Pos2, Rect, Response, Shape, Stroke, Ui, pos2};
use glam::{DVec3, Quat, Vec2, Vec3};
use lumel::{Camera, Light, LightKind};
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
    /// Turns the direction.
    Direction,
    /// Turns a rectangle about its direction.
    Roll,
}

/// Length of the line in the direction of the light, and of that to the handle that rolls it, relative to the arrows.
const DIRECTION: f32 = 1.35;
const ROLL: f32 = 0.45;

/// Corners of what stands for a circle.
const CIRCLE: u16 = 32;

/// Turns snap to multiples of this, degrees.
const SNAP_DEG: f32 = 15.0;

/// Moves snap to a grid of about this share of the arrows.
const SNAP_SHARE: f32 = 0.2;

/// What a drag snaps to.
#[derive(Clone, Copy)]
pub enum Snap<'a> {
    /// Nothing.
    Off,
    /// A grid whose zero is the world's, turns of 15°, and for the middle the surface under a point of the window: its
    /// position and normal.
    On {
        /// Where the coordinates of the scene have their zero.
        origin: DVec3,
        /// Finds the surface.
        surface: &'a dyn Fn(Pos2) -> Option<(Vec3, Vec3)>,
    },
}

const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];
/// Colours of the axes of the world.
pub(crate) const AXIS_COLORS: [Color32; 3] =
    [Color32::from_rgb(235, 90, 80), Color32::from_rgb(120, 205, 90), Color32::from_rgb(90, 150, 245)];

/// What is being dragged.
#[derive(Clone, Debug, Default)]
pub struct Gizmo {
    held: Option<Held>,
}

/// A handle, with where it was taken and what the light was then.
#[derive(Clone, Debug)]
struct Held {
    handle: Handle,
    from: Pos2,
    light: EditLight,
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
    if matches!(light.light(), Light::Rect(_) | Light::Disk(_) | Light::Sphere(_)) {
        for (k, corner) in light.rect.corners().into_iter().enumerate() {
            add(Handle::Corner(k), corner);
        }
    }
    if let (true, Some(normal)) = (has_direction(light), light.rect.normal()) {
        add(Handle::Direction, light.rect.center + normal * DIRECTION * length);
    }
    if let Some(roll) = roll_handle(light, length) {
        add(Handle::Roll, roll);
    }
    all
}

fn has_direction(light: &EditLight) -> bool {
    light.kind() != LightKind::Point
}

/// A rectangle, or a circle for all that is round.
fn outline(light: &EditLight) -> Vec<Vec3> {
    if light.kind() == LightKind::Rect {
        return light.rect.corners().to_vec();
    }
    let at = |i: u16| {
        let (sin, cos) = (f32::from(i) * 360.0 / f32::from(CIRCLE)).to_radians().sin_cos();
        light.rect.center + cos * light.rect.u + sin * light.rect.v
    };
    (0..CIRCLE).map(at).collect()
}

/// Where a rectangle is rolled: beyond a corner, where no axis of a level light lies.
fn roll_handle(light: &EditLight, length: f32) -> Option<Vec3> {
    let arm = light.rect.u + light.rect.v;
    let beyond = arm.try_normalize().filter(|_| light.kind() == LightKind::Rect)?;
    Some(light.rect.center + arm + beyond * ROLL * length)
}

fn nearest(handles: &[(Handle, Pos2)], p: Pos2) -> Option<Handle> {
    let within = handles.iter().map(|(handle, at)| (*handle, at.distance(p))).filter(|(_, d)| *d < REACH);
    within.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(handle, _)| handle)
}

impl Gizmo {
    /// Moves or resizes the light by what the pointer does; true while a handle is held.
    pub fn drag(
        &mut self,
        ui: &Ui,
        response: &Response,
        camera: &Camera,
        light: &mut EditLight,
        snap: Snap<'_>,
    ) -> bool {
        let Some(projection) = Projection::new(camera, response.rect).filter(|_| light.on) else {
            return false;
        };
        let hover = response.hover_pos().and_then(|p| nearest(&handles(&projection, camera, light), p));
        if hover.is_some() || self.held.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        }
        if response.drag_started_by(PointerButton::Primary) {
            let from = ui.input(|i| i.pointer.press_origin());
            self.held = from.and_then(|from| {
                let handle = nearest(&handles(&projection, camera, light), from)?;
                Some(Held { handle, from, light: light.clone() })
            });
        }
        if !response.dragged_by(PointerButton::Primary) {
            self.held = None;
        }
        let (Some(held), Some(to)) = (&self.held, response.interact_pointer_pos()) else {
            return self.held.is_some();
        };
        if response.drag_delta() != egui::Vec2::ZERO {
            *light = held.light.clone();
            let drag = Drag { projection: &projection, camera, from: held.from, to };
            drag.apply(held.handle, light);
            if let Snap::On { origin, surface } = snap {
                let step = grid_step(arrow_length(camera, light));
                drag.snap(held.handle, light, &held.light, (origin, step), surface);
            }
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
        let outline: Option<Vec<Pos2>> = outline(light).into_iter().map(|p| projection.point(p)).collect();
        let color = if active.is_some() { theme::ACCENT } else { Color32::from_white_alpha(90) };
        if let Some(outline) = outline {
            painter.add(Shape::closed_line(outline, Stroke::new(1.5, color)));
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
        if has_direction(light) {
            let tip = light.rect.center + normal * DIRECTION * length;
            line(&painter, tip, Stroke::new(2.0, theme::ACCENT));
        }
        let all = handles(&projection, camera, light);
        let held = self.held.as_ref().map(|held| held.handle);
        let hot = held.or_else(|| hover.and_then(|p| nearest(&all, p)));
        for (handle, at) in all {
            let is_hot = hot == Some(handle);
            match handle {
                Handle::Axis(k) => {
                    let stroke = Stroke::new(if is_hot { 3.0 } else { 2.0 }, AXIS_COLORS[k]);
                    line(&painter, light.rect.center + AXES[k] * length, stroke);
                    painter.circle_filled(at, if is_hot { 6.0 } else { 4.5 }, AXIS_COLORS[k]);
                }
                Handle::Direction | Handle::Roll => {
                    let radius = if is_hot { 7.0 } else { 5.5 };
                    painter.circle(
                        at,
                        radius,
                        Color32::from_black_alpha(160),
                        Stroke::new(2.0, theme::ACCENT),
                    );
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

/// A drag from one point of the window to another.
struct Drag<'a> {
    projection: &'a Projection,
    camera: &'a Camera,
    from: Pos2,
    to: Pos2,
}

impl Drag<'_> {
    /// What it does to a light by one of its handles.
    fn apply(&self, handle: Handle, light: &mut EditLight) {
        let center = light.rect.center;
        let [before, after] = [self.from, self.to].map(|p| self.projection.ray(p));
        match handle {
            Handle::Center => {
                let Some([_, _, forward]) = self.camera.axes() else { return };
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
            Handle::Corner(_) => self.resize(light, before, after),
            Handle::Direction => {
                let radius = DIRECTION * arrow_length(self.camera, light);
                if let Some(direction) = on_sphere(after, center, radius, light.rect.normal()) {
                    turn(light, direction);
                }
            }
            Handle::Roll => {
                let Some(normal) = light.rect.normal() else { return };
                let angle = |ray| {
                    let way = meet_plane(ray, center, normal)? - center;
                    Some(way.dot(light.rect.v.try_normalize()?).atan2(way.dot(light.rect.u.try_normalize()?)))
                };
                if let (Some(a), Some(b)) = (angle(before), angle(after)) {
                    roll(light, normal, b - a);
                }
            }
        }
    }

    fn resize(&self, light: &mut EditLight, before: (Vec3, Vec3), after: (Vec3, Vec3)) {
        let (Some(normal), center) = (light.rect.normal(), light.rect.center) else { return };
        let meet = |ray| meet_plane(ray, center, normal);
        let (Some(a), Some(b)) = (meet(before), meet(after)) else { return };
        let half = light.half_edges();
        let [u, v] = [light.rect.u / half.x, light.rect.v / half.y];
        let grown = |p: Vec3| Vec2::new((p - center).dot(u).abs(), (p - center).dot(v).abs());
        let factor =
            (grown(b) / grown(a).max(Vec2::splat(1e-6))).clamp(Vec2::splat(0.01), Vec2::splat(100.0));
        let factor = if light.square { Vec2::splat(factor.length() / Vec2::ONE.length()) } else { factor };
        light.set_half_edges(half * factor);
    }

    /// Moves what was dragged to where it snaps; `before` is the light before the drag.
    fn snap(
        &self,
        handle: Handle,
        light: &mut EditLight,
        before: &EditLight,
        (origin, step): (DVec3, f64),
        surface: &dyn Fn(Pos2) -> Option<(Vec3, Vec3)>,
    ) {
        match handle {
            Handle::Center => {
                // Just above the surface, so that it lights its surroundings and not the inside of a wall.
                let Some((position, normal)) = surface(self.to) else { return };
                let gap = 0.01 * arrow_length(self.camera, light);
                light.rect.center = position + normal * gap;
                if has_direction(light) {
                    turn(light, normal);
                }
            }
            Handle::Axis(k) => {
                let world = origin[k] + f64::from(light.rect.center[k]);
                light.rect.center[k] = ((world / step).round() * step - origin[k]) as f32;
            }
            Handle::Corner(_) => {
                let snapped = |half: f32| ((f64::from(half) / step).round().max(1.0) * step) as f32;
                let half = light.half_edges();
                light.set_half_edges(Vec2::new(snapped(half.x), snapped(half.y)));
            }
            Handle::Direction => {
                let snapped = (light.direction_deg() / SNAP_DEG).round() * SNAP_DEG;
                light.set_direction_deg(snapped);
            }
            Handle::Roll => {
                let (Some(normal), Some(u)) = (before.rect.normal(), before.rect.u.try_normalize()) else {
                    return;
                };
                let way = light.rect.u;
                let turned = way.dot(normal.cross(u)).atan2(way.dot(u)).to_degrees();
                *light = before.clone();
                roll(light, normal, ((turned / SNAP_DEG).round() * SNAP_DEG).to_radians());
            }
        }
    }
}

/// Turns a light by the shortest way to another direction, unit length.
fn turn(light: &mut EditLight, direction: Vec3) {
    let Some(normal) = light.rect.normal() else { return };
    let rotation = Quat::from_rotation_arc(normal, direction);
    (light.rect.u, light.rect.v) = (rotation * light.rect.u, rotation * light.rect.v);
}

/// Turns a light about its direction, radians.
fn roll(light: &mut EditLight, normal: Vec3, angle: f32) {
    let rotation = Quat::from_axis_angle(normal, angle);
    (light.rect.u, light.rect.v) = (rotation * light.rect.u, rotation * light.rect.v);
}

/// The step of the grid that suits arrows of some length: 1, 2 or 5 times a power of ten, metres.
fn grid_step(arrow: f32) -> f64 {
    let about = f64::from(arrow * SNAP_SHARE);
    let decade = 10_f64.powf(about.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade);
    steps.into_iter().find(|step| *step >= about).unwrap_or(about)
}

/// The direction from the middle of a sphere to where a ray meets it, or passes it nearest: on the far side where the
/// direction was there before.
fn on_sphere(
    (origin, direction): (Vec3, Vec3),
    center: Vec3,
    radius: f32,
    before: Option<Vec3>,
) -> Option<Vec3> {
    let direction = direction.try_normalize()?;
    let to_center = center - origin;
    let nearest = direction * to_center.dot(direction) - to_center;
    let depth = (radius * radius - nearest.length_squared()).max(0.0).sqrt();
    let is_far = before.is_some_and(|before| before.dot(direction) > 0.0);
    (nearest + direction * if is_far { depth } else { -depth }).try_normalize()
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
            Drag { projection: &projection, camera: &camera, from, to }.apply(handle, &mut lamp);
            assert!((lamp.rect.center - way).length() < 1e-3, "{handle:?}: {}", lamp.rect.center);
        }
    }

    #[test]
    fn a_dragged_corner_resizes_the_light() {
        let (camera, projection) = projection();
        let [from, to] =
            [Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 0.0)].map(|p| projection.point(p).unwrap());
        let mut lamp = light();
        Drag { projection: &projection, camera: &camera, from, to }.apply(Handle::Corner(2), &mut lamp);
        assert!((lamp.half_edges() - Vec2::splat(2.0)).length() < 1e-3);
        let mut lamp = EditLight { square: false, ..light() };
        let to = projection.point(Vec3::new(2.0, 1.0, 0.0)).unwrap();
        Drag { projection: &projection, camera: &camera, from, to }.apply(Handle::Corner(2), &mut lamp);
        assert!((lamp.half_edges() - Vec2::new(2.0, 1.0)).length() < 1e-3, "{}", lamp.half_edges());
    }

    #[test]
    fn the_direction_follows_the_pointer_and_the_size_stays() {
        let (camera, projection) = projection();
        let mut lamp = light();
        let from = projection.point(Vec3::Z * DIRECTION * arrow_length(&camera, &lamp)).unwrap();
        let radius = DIRECTION * arrow_length(&camera, &lamp);
        let wanted = Vec3::new(0.6, 0.0, 0.8);
        let to = projection.point(wanted * radius).unwrap();
        Drag { projection: &projection, camera: &camera, from, to }.apply(Handle::Direction, &mut lamp);
        assert!((lamp.rect.normal().unwrap() - wanted).length() < 1e-3, "{:?}", lamp.rect.normal());
        assert!((lamp.half_edges() - Vec2::ONE).length() < 1e-5);
    }

    #[test]
    fn rolling_turns_about_the_direction_and_snaps_to_fifteen_degrees() {
        let (camera, projection) = projection();
        let mut lamp = light();
        let arm = roll_handle(&lamp, arrow_length(&camera, &lamp)).unwrap();
        let turned = Quat::from_axis_angle(Vec3::Z, 37_f32.to_radians()) * arm;
        let [from, to] = [arm, turned].map(|p| projection.point(p).unwrap());
        let drag = Drag { projection: &projection, camera: &camera, from, to };
        drag.apply(Handle::Roll, &mut lamp);
        let angle = |lamp: &EditLight| lamp.rect.u.y.atan2(lamp.rect.u.x).to_degrees();
        assert!((angle(&lamp) - 37.0).abs() < 0.1 && lamp.rect.normal().unwrap().dot(Vec3::Z) > 0.9999);
        drag.snap(Handle::Roll, &mut lamp, &light(), (DVec3::ZERO, 1.0), &|_| None);
        assert!((angle(&lamp) - 30.0).abs() < 1e-2, "{}", angle(&lamp));
    }

    #[test]
    fn moves_snap_to_the_grid_of_the_world_and_to_surfaces() {
        let (camera, projection) = projection();
        let drag = Drag { projection: &projection, camera: &camera, from: Pos2::ZERO, to: Pos2::ZERO };
        let mut lamp = light();
        lamp.rect.center.x = 1.26;
        drag.snap(Handle::Axis(0), &mut lamp, &light(), (DVec3::X * 0.3, 0.5), &|_| None);
        assert!((lamp.rect.center.x - 1.2).abs() < 1e-6, "1.5 in the world: {}", lamp.rect.center.x);
        let wall = Some((Vec3::new(2.0, 1.0, 0.0), Vec3::NEG_X));
        drag.snap(Handle::Center, &mut lamp, &light(), (DVec3::ZERO, 0.5), &|_| wall);
        assert!((lamp.rect.center - Vec3::new(2.0, 1.0, 0.0)).length() < 0.05);
        assert!(lamp.rect.normal().unwrap().dot(Vec3::NEG_X) > 0.999);
        assert_eq!([0.07, 0.4, 9.0].map(|arrow| (grid_step(arrow) * 1e6).round() / 1e6), [0.02, 0.1, 2.0]);
    }

    #[test]
    fn an_axis_along_the_line_of_sight_does_not_throw_the_light_away() {
        let (camera, projection) = projection();
        let mut lamp = light();
        let at = projection.point(Vec3::ZERO).unwrap();
        let drag = Drag { projection: &projection, camera: &camera, from: at, to: at + egui::vec2(0.0, 3.0) };
        drag.apply(Handle::Axis(2), &mut lamp);
        assert!(lamp.rect.center.length() < 10.0);
    }

    #[test]
    fn the_nearest_handle_within_reach_is_taken() {
        let (camera, projection) = projection();
        let lamp = light();
        let all = handles(&projection, &camera, &lamp);
        let all_of_a_rectangle = "the center, three axes, four corners, the direction and the roll";
        assert_eq!(all.len(), 1 + 3 + 4 + 2, "{all_of_a_rectangle}");
        let corner = projection.point(Vec3::new(1.0, 1.0, 0.0)).unwrap();
        assert_eq!(nearest(&all, corner + egui::vec2(3.0, -2.0)), Some(Handle::Corner(2)));
        assert_eq!(nearest(&all, corner + egui::vec2(100.0, 100.0)), None);
    }
}
