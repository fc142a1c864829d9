//! A name on the left, a widget on the right, so that panels line up.

use crate::theme::{ACCENT, LABEL_WIDTH, ON_ACCENT, TEXT, WEAK};
use eframe::egui::{
    self, Align, Button, Checkbox, ComboBox, DragValue, Layout, Response, RichText, Slider, SliderClamping,
    TextStyle, Ui, Vec2,
};
use glam::{DVec3, Vec3};

/// Room for the number right of a slider.
const NUMBER_WIDTH: f32 = 68.0;

/// The heading of a part of a panel.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(text).strong().color(TEXT));
}

/// Tells that something has to be done first.
pub fn hint(ui: &mut Ui, text: &str) {
    ui.add_space(4.0);
    ui.add(egui::Label::new(RichText::new(text).color(WEAK)).wrap());
}

/// A named widget; the name is what assistive technology and tests know it by.
pub fn row(ui: &mut Ui, name: &str, hint: &str, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y;
        let label = ui
            .allocate_ui_with_layout(
                Vec2::new(LABEL_WIDTH, height),
                Layout::left_to_right(Align::Center),
                |ui| {
                    ui.set_min_width(LABEL_WIDTH);
                    ui.label(RichText::new(name).color(WEAK))
                },
            )
            .inner;
        let response = add(ui).labelled_by(label.id);
        if hint.is_empty() { response } else { response.on_hover_text(hint) }
    })
    .inner
}

/// A slider with its name.
pub fn slider<'a>(ui: &mut Ui, name: &str, hint: &str, slider: Slider<'a>) -> Response {
    row(ui, name, hint, |ui| {
        let gap = ui.spacing().item_spacing.x;
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH - gap).max(40.0);
        ui.spacing_mut().interact_size.x = NUMBER_WIDTH;
        // What is there already may lie outside: looking at it must not change it.
        ui.add(slider.clamping(SliderClamping::Edits))
    })
}

/// A number to drag or type, with its name.
pub fn number<'a>(ui: &mut Ui, name: &str, hint: &str, value: DragValue<'a>) -> Response {
    row(ui, name, hint, |ui| {
        ui.add_sized([NUMBER_WIDTH, ui.spacing().interact_size.y], value.clamp_existing_to_range(false))
    })
}

/// A box to check, in line with the widgets of other rows where there is room for that.
pub fn check(ui: &mut Ui, name: &str, hint: &str, value: &mut bool) -> Response {
    let font = TextStyle::Button.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, TEXT).size().x;
    let width = text + ui.spacing().icon_width + ui.spacing().icon_spacing;
    let indent = LABEL_WIDTH + ui.spacing().item_spacing.x;
    let response = ui
        .horizontal(|ui| {
            ui.add_space(indent.min(ui.available_width() - width).max(0.0));
            ui.add(Checkbox::new(value, name))
        })
        .inner;
    if hint.is_empty() { response } else { response.on_hover_text(hint) }
}

/// One of several values from a list.
pub fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    value: &mut T,
    all: &[T],
    text: impl Fn(T) -> String,
) -> Response {
    row(ui, name, hint, |ui| {
        let width = ui.available_width().min(190.0);
        ComboBox::from_id_salt(name)
            .width(width)
            .height(400.0)
            .selected_text(text(*value))
            .show_ui(ui, |ui| {
                for &option in all {
                    ui.selectable_value(value, option, text(option));
                }
            })
            .response
    })
}

/// Three coordinates of a place, shown in world space, where `origin` is, and changed at some `speed` by dragging. Each has a
/// name of its own for assistive technology.
pub fn place(ui: &mut Ui, name: &str, hint: &str, value: &mut Vec3, (origin, speed): (DVec3, f32)) {
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y;
        ui.allocate_ui_with_layout(
            Vec2::new(LABEL_WIDTH, height),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.label(RichText::new(name).color(WEAK)).on_hover_text(hint);
            },
        );
        let gap = 4.0;
        ui.spacing_mut().item_spacing.x = gap;
        ui.spacing_mut().button_padding.x = 2.0;
        let width = ((ui.available_width() - 2.0 * gap) / 3.0).clamp(30.0, 74.0);
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let mut coordinate = origin[k] + f64::from(value[k]);
            let drag = DragValue::new(&mut coordinate).speed(speed).max_decimals(3);
            let response = ui.add_sized([width, height], drag);
            if response.changed() {
                value[k] = (coordinate - origin[k]) as f32;
            }
            let text = format!("{name} {axis}");
            response
                .widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::SpinButton, true, &text));
            response.on_hover_text(text);
        }
    });
}

/// A name and a text that cannot be changed.
pub fn value(ui: &mut Ui, name: &str, text: impl Into<String>) {
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y * 0.8;
        ui.allocate_ui_with_layout(
            Vec2::new(LABEL_WIDTH, height),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.label(RichText::new(name).color(WEAK));
            },
        );
        ui.add(egui::Label::new(RichText::new(text.into()).color(TEXT)).truncate());
    });
}

/// The button that one is most likely looking for.
pub fn primary_button(ui: &mut Ui, text: &str, width: f32) -> Response {
    let button = Button::new(RichText::new(text).strong().color(ON_ACCENT)).fill(ACCENT);
    ui.add_sized([width, 30.0], button)
}
