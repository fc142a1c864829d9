//! The lights.

use crate::actions::Actions;
use crate::document::Document;
use crate::input::Command;
use crate::lights::{EditLight, Resize, half_edge_range};
use crate::session::Session;
use crate::theme;
use crate::values::significant;
use crate::widgets::{check, choice, color_button, heading, hint, place, row, slider, value};
use eframe::egui::{Checkbox, DragValue, RichText, Slider, TextEdit, Ui};
use glam::{DVec3, Vec2, Vec3};
use lumel::{Light, LightKind, PointLight, SphereLight, SpotLight, SunLight};

pub(super) fn show(session: &mut Session, actions: &mut Actions, ui: &mut Ui) {
    let size = |document: &Document| (document.scene.origin(), document.diagonal());
    let Some((origin, diagonal)) = session.document.as_ref().map(size) else {
        hint(ui, "Open a scene first.");
        return;
    };
    ui.horizontal_wrapped(|ui| {
        for (command, text) in [
            (Command::PlaceLight, "Place here"),
            (Command::AddLight, "Add"),
            (Command::RemoveLight, "Remove"),
            (Command::AimLight, "Aim here"),
        ] {
            let keys = format!("{} ({})", command.text(), command.keys());
            if ui.button(text).on_hover_text(keys).clicked() {
                actions.push(command);
            }
        }
    });
    list(session, ui);
    layers(session, ui);
    match session.active_light() {
        Some(light) => properties(ui, light, (origin, diagonal)),
        None => hint(ui, "No lights. Press Space to add one at the camera."),
    }
    super::sky::show(session, actions, ui);
    super::emissive::show(session, ui);
}

fn list(session: &mut Session, ui: &mut Ui) {
    let active = session.active;
    let mut chosen = None;
    for (i, light) in session.lights.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let shines = ui.add(Checkbox::without_text(&mut light.on));
            let name = format!("{} on", light.name);
            shines.widget_info(|| {
                eframe::egui::WidgetInfo::selected(
                    eframe::egui::accesskit::Role::CheckBox,
                    true,
                    light.on,
                    &name,
                )
            });
            shines.on_hover_text("Turns the light on or off; a light that is off is not drawn");
            let text = if light.on { RichText::new(&light.name) } else { RichText::new(&light.name).weak() };
            if ui.selectable_label(i == active, text).clicked() {
                chosen = Some(i);
            }
        });
    }
    if let Some(i) = chosen {
        session.active = i;
    }
}

/// Dims the layers of the light on the surfaces, if a solve has told them apart.
fn layers(session: &mut Session, ui: &mut Ui) {
    if session.light.layers.is_empty() {
        return;
    }
    heading(ui, "Layers");
    let mut changed = false;
    for layer in &mut session.light.layers {
        let text =
            "What all light is shown with of this layer: 1 as solved. Needs no solve, and files keep 1";
        changed |= slider(ui, &layer.name, text, Slider::new(&mut layer.share, 0.0..=2.0)).changed();
    }
    if session.light.is_mixed() && ui.button("Reset layers").clicked() {
        session.light.layers.iter_mut().for_each(|layer| layer.share = 1.0);
        changed = true;
    }
    if changed {
        session.light_generation += 1;
    }
}

fn properties(ui: &mut Ui, light: &mut EditLight, (origin, diagonal): (DVec3, f32)) {
    heading(ui, "Active light");
    row(ui, "Name", "", |ui| ui.add(TextEdit::singleline(&mut light.name).desired_width(150.0)));
    kind(ui, light);
    shape(ui, light, diagonal);
    let (mut intensity, mut color) = light.intensity_and_color();
    let hint = match light.kind() {
        LightKind::Rect | LightKind::Disk => "Radiance of the brightest channel, W/(m² sr)",
        LightKind::Point | LightKind::Spot => "Radiant intensity of the brightest channel, W/sr",
        LightKind::Sun => "Irradiance of the brightest channel on a surface that faces the sun, W/m²",
    };
    let changed =
        slider(ui, "Intensity", hint, Slider::new(&mut intensity, 0.0..=100_000.0).logarithmic(true))
            .changed();
    let mut rgb = color.to_array();
    let recolored = row(ui, "Colour", "Hue and saturation", |ui| color_button(ui, &mut rgb)).changed();
    if changed || recolored {
        color = if recolored { Vec3::from_array(rgb) } else { color };
        light.set_intensity_and_color(intensity, color);
    }
    if light.kind() == LightKind::Rect {
        power(ui, light);
    }
    if light.kind() != LightKind::Sun {
        place(ui, "Position", "Metres", &mut light.rect.center, (origin, 0.003 * diagonal));
    }
    if light.kind() != LightKind::Point {
        direction(ui, light);
    }
    let text = "Drag the handles in the picture to move, turn or resize it; with Ctrl they snap.";
    ui.label(RichText::new(text).color(theme::WEAK).small());
}

/// What a kind of light is called.
pub(super) fn kind_name(kind: LightKind) -> &'static str {
    match kind {
        LightKind::Rect => "Rectangle",
        LightKind::Disk => "Disk",
        LightKind::Point => "Point",
        LightKind::Spot => "Spot",
        LightKind::Sun => "Sun",
    }
}

/// What the light is.
fn kind(ui: &mut Ui, light: &mut EditLight) {
    let mut kind = light.kind();
    choice(ui, "Kind", "What shines", &mut kind, &LightKind::ALL, |kind| kind_name(kind).to_owned());
    light.set_kind(kind);
}

/// The size of the light, or the angles that it has instead.
fn shape(ui: &mut Ui, light: &mut EditLight, diagonal: f32) {
    match light.light() {
        Light::Rect(_) => size(ui, light, diagonal),
        Light::Disk(_) => radius(ui, light, diagonal),
        Light::Sphere(_) | Light::Point(_) => sphere(ui, light, diagonal),
        Light::Spot(spot) => cones(ui, light, spot),
        Light::Directional(parallel) => angle(ui, light, SunLight { parallel, sin_half_angle: 0.0 }),
        Light::Sun(sun) => angle(ui, light, sun),
    }
}

fn radius(ui: &mut Ui, light: &mut EditLight, diagonal: f32) {
    let mut radius = light.half_edges().x;
    let range = half_edge_range(diagonal);
    let slide = Slider::new(&mut radius, range).logarithmic(true).suffix(" m").max_decimals(3);
    if slider(ui, "Radius", "Metres", slide).changed() {
        light.set_half_edges(Vec2::splat(radius));
    }
}

/// A point may be a sphere.
fn sphere(ui: &mut Ui, light: &mut EditLight, diagonal: f32) {
    let mut is_sphere = matches!(light.light(), Light::Sphere(_));
    if check(ui, "Sphere", "A point with a radius, whose shadows are soft", &mut is_sphere).changed() {
        let (center, strength) = (light.rect.center, light.rect.radiance.0);
        light.set_light(if is_sphere {
            let radius = *half_edge_range(diagonal).start() * 100.0;
            Light::Sphere(SphereLight::of_intensity(center, radius, strength))
        } else {
            Light::Point(PointLight { position: center, intensity: strength, range: f32::INFINITY })
        });
    }
    if is_sphere {
        radius(ui, light, diagonal);
    }
}

fn cones(ui: &mut Ui, light: &mut EditLight, spot: SpotLight) {
    let [mut inner, mut outer] = [spot.cos_inner, spot.cos_outer].map(|cos| cos.acos().to_degrees());
    let text = "The angle from the axis at which the light begins to fade, degrees";
    let mut changed =
        slider(ui, "Inner cone", text, Slider::new(&mut inner, 0.0..=89.0).suffix("°")).changed();
    let text = "The angle from the axis at which it is dark, degrees";
    changed |= slider(ui, "Outer cone", text, Slider::new(&mut outer, 1.0..=90.0).suffix("°")).changed();
    if changed {
        let outer = outer.max(1.0);
        let [cos_inner, cos_outer] = [inner.min(outer - 0.1), outer].map(|angle| angle.to_radians().cos());
        light.set_light(Light::Spot(SpotLight { cos_inner, cos_outer, ..spot }));
    }
}

fn angle(ui: &mut Ui, light: &mut EditLight, sun: SunLight) {
    let mut angle = 2.0 * sun.sin_half_angle.asin().to_degrees();
    let text = "Angular diameter, degrees: 0.53 for the sun, 0 for sharp shadows";
    if slider(ui, "Diameter", text, Slider::new(&mut angle, 0.0..=30.0).suffix("°")).changed() {
        let sin_half_angle = (0.5 * angle).to_radians().sin();
        let sharp = sin_half_angle <= 0.0;
        light.set_light(if sharp {
            Light::Directional(sun.parallel)
        } else {
            Light::Sun(SunLight { sin_half_angle, ..sun })
        });
    }
}

fn power(ui: &mut Ui, light: &mut EditLight) {
    let mut constant = light.resize == Resize::KeepPower;
    if check(ui, "Constant power", "Resizing keeps the power instead of the radiance", &mut constant)
        .changed()
    {
        light.resize = if constant { Resize::KeepPower } else { Resize::KeepRadiance };
    }
    let power = light.power();
    value(
        ui,
        "Power",
        format!("{} {} {} W", significant(power.x), significant(power.y), significant(power.z)),
    );
}

fn size(ui: &mut Ui, light: &mut EditLight, diagonal: f32) {
    let range = half_edge_range(diagonal);
    let before = light.half_edges();
    let mut half = before;
    let one = |ui: &mut Ui, name: &str, value: &mut f32| {
        let slide = Slider::new(value, range.clone()).logarithmic(true).suffix(" m").max_decimals(3);
        slider(ui, name, "Half of an edge, metres", slide).changed()
    };
    let changed = if light.square {
        let changed = one(ui, "Size", &mut half.x);
        half.y = half.x;
        changed
    } else {
        one(ui, "Size u", &mut half.x) | one(ui, "Size v", &mut half.y)
    };
    if changed {
        light.set_half_edges(half);
    }
    if check(ui, "Square", "Keeps both edges the same length", &mut light.square).changed() && light.square {
        light.set_half_edges(Vec2::splat((before.x * before.y).sqrt()));
    }
}

fn direction(ui: &mut Ui, light: &mut EditLight) {
    let before = light.direction_deg();
    let mut to = before;
    row(ui, "Azimuth", "Direction: degrees counterclockwise about +Y, from -Z", |ui| {
        ui.add(
            DragValue::new(&mut to.x)
                .clamp_existing_to_range(false)
                .speed(0.5)
                .range(-180.0..=180.0)
                .suffix("°")
                .max_decimals(1),
        )
    });
    row(ui, "Elevation", "Direction: degrees above the horizon; -90 is straight down", |ui| {
        ui.add(
            DragValue::new(&mut to.y)
                .clamp_existing_to_range(false)
                .speed(0.5)
                .range(-90.0..=90.0)
                .suffix("°")
                .max_decimals(1),
        )
    });
    if to != before {
        light.set_direction_deg(to);
    }
}
