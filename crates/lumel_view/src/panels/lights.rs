//! The lights.

use crate::actions::Actions;
use crate::document::Document;
use crate::input::Command;
use crate::lights::{EditLight, Resize, half_edge_range};
use crate::session::Session;
use crate::theme;
use crate::values::significant;
use crate::widgets::{check, color_button, heading, hint, row, slider, value, vector};
use eframe::egui::{Checkbox, DragValue, RichText, Slider, TextEdit, Ui};
use glam::{Vec2, Vec3};

pub(super) fn show(session: &mut Session, actions: &mut Actions, ui: &mut Ui) {
    let Some(diagonal) = session.document.as_ref().map(Document::diagonal) else {
        hint(ui, "Open a scene first.");
        return;
    };
    ui.horizontal_wrapped(|ui| {
        for (command, text) in [
            (Command::PlaceLight, "Place here"),
            (Command::AddLight, "Add"),
            (Command::RemoveLight, "Remove"),
        ] {
            let keys = format!("{} ({})", command.text(), command.keys());
            if ui.button(text).on_hover_text(keys).clicked() {
                actions.push(command);
            }
        }
    });
    list(session, ui);
    layers(session, ui);
    let Some(light) = session.active_light() else {
        let others = session.document.as_ref().map_or(0, |d| d.other_lights.len());
        let text = if others > 0 {
            format!(
                "The scene has {others} point, spot or directional lights; they are used but cannot be edited here."
            )
        } else {
            "No lights. Press Space to add one at the camera.".to_owned()
        };
        hint(ui, &text);
        return;
    };
    properties(ui, light, diagonal);
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

fn properties(ui: &mut Ui, light: &mut EditLight, diagonal: f32) {
    heading(ui, "Active light");
    row(ui, "Name", "", |ui| ui.add(TextEdit::singleline(&mut light.name).desired_width(150.0)));
    size(ui, light, diagonal);
    let (mut intensity, mut color) = light.intensity_and_color();
    let hint = "Radiance of the brightest channel, W/(m² sr)";
    let changed =
        slider(ui, "Intensity", hint, Slider::new(&mut intensity, 0.0..=100_000.0).logarithmic(true))
            .changed();
    let mut rgb = color.to_array();
    let recolored = row(ui, "Colour", "Hue and saturation", |ui| color_button(ui, &mut rgb)).changed();
    if changed || recolored {
        color = if recolored { Vec3::from_array(rgb) } else { color };
        light.set_intensity_and_color(intensity, color);
    }
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
    vector(ui, "Position", "Metres", &mut light.rect.center, 0.003 * diagonal);
    direction(ui, light);
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
    ui.label(
        RichText::new("Drag the handles in the picture to move or resize it.").color(theme::WEAK).small(),
    );
}
