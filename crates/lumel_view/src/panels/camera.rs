//! The camera, the views of the scene and the slots.

use crate::actions::Actions;
use crate::camera::{FOV_DEG, FlyCamera};
use crate::input::Command;
use crate::prefs::{Prefs, SPEED};
use crate::session::Session;
use crate::theme;
use crate::widgets::{heading, hint, place, row, slider};
use eframe::egui::{Button, DragValue, RichText, Slider, Ui};

pub(super) fn show(session: &mut Session, prefs: &mut Prefs, actions: &mut Actions, ui: &mut Ui) {
    let Some(document) = &session.document else {
        hint(ui, "Open a scene first.");
        return;
    };
    let (diagonal, origin) = (document.diagonal(), document.scene.origin());
    let views: Vec<(String, Option<FlyCamera>)> =
        document.scene.cameras().iter().map(|c| (c.name.clone(), FlyCamera::from_camera(c))).collect();
    slots(session, ui);
    ui.horizontal(|ui| {
        for (command, text) in [(Command::ResetCamera, "Reset camera"), (Command::AlignUp, "Align up")] {
            let keys = format!("{} ({})", command.text(), command.keys());
            if ui.button(text).on_hover_text(keys).clicked() {
                actions.push(command);
            }
        }
    });
    let camera = &mut session.camera;
    place(ui, "Camera", "Position, metres", &mut camera.position, (origin, 0.002 * diagonal));
    angle(ui, "Yaw", "Counterclockwise about +Y, from -Z", &mut camera.yaw_deg, 180.0);
    angle(ui, "Pitch", "Above the horizon", &mut camera.pitch_deg, 89.9);
    angle(ui, "Roll", "Clockwise", &mut camera.roll_deg, 180.0);
    let fov = Slider::new(&mut camera.fov_deg, FOV_DEG[0]..=FOV_DEG[1]).suffix("°").max_decimals(1);
    slider(ui, "Field of view", "Vertical", fov);
    let speed = Slider::new(&mut prefs.speed, SPEED[0]..=SPEED[1]).logarithmic(true).max_decimals(2);
    slider(ui, "Flying speed", "Relative to the size of the scene; also set by the wheel", speed);
    let look = Slider::new(&mut prefs.look_speed, 0.02..=1.0).max_decimals(2);
    slider(ui, "Look speed", "Degrees per point of drag", look);
    if !views.is_empty() {
        heading(ui, "Views of the scene");
        ui.horizontal_wrapped(|ui| {
            for (name, view) in views {
                if let (true, Some(view)) = (ui.button(name).clicked(), view) {
                    session.camera = view;
                }
            }
        });
    }
}

fn angle(ui: &mut Ui, name: &str, hint: &str, value: &mut f32, limit: f32) {
    let drag = DragValue::new(value)
        .clamp_existing_to_range(false)
        .speed(0.5)
        .range(-limit..=limit)
        .suffix("°")
        .max_decimals(1);
    row(ui, name, hint, |ui| ui.add(drag));
}

/// Ten digits: click recalls, with Alt keeps.
fn slots(session: &mut Session, ui: &mut Ui) {
    ui.label(
        RichText::new("Slots: Alt+digit saves camera, lights and settings; the digit recalls them")
            .color(theme::WEAK)
            .small(),
    );
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 2.0;
        let width = ((ui.available_width() - 36.0) / 10.0).floor().clamp(16.0, 30.0);
        for digit in [1, 2, 3, 4, 5, 6, 7, 8, 9, 0] {
            let kept = session.slots.get(digit).is_some();
            let text = RichText::new(digit.to_string());
            let text = if kept { text.strong().color(theme::ON_ACCENT) } else { text.color(theme::WEAK) };
            let button = Button::new(text).min_size(eframe::egui::vec2(width, 22.0));
            let button = if kept { button.fill(theme::ACCENT) } else { button };
            let response = ui.add_sized([width, 22.0], button);
            let name = format!("Slot {digit}");
            response.widget_info(|| {
                eframe::egui::WidgetInfo::labeled(eframe::egui::accesskit::Role::Button, true, &name)
            });
            let hint = if kept {
                "Click to recall, Alt+click to overwrite"
            } else {
                "Click to save camera, lights and settings"
            };
            if response.on_hover_text(hint).clicked() {
                let alt = ui.input(|i| i.modifiers.alt);
                if kept && !alt { session.recall_slot(digit) } else { session.save_slot(digit) }
            }
        }
    });
}
