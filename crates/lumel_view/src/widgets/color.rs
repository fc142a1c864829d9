//! A colour by hue and saturation, and where nothing else says how bright it is, by brightness.
//!
//! egui's own picker has a button whose glyph its usual fonts lack.

use super::slider;
use crate::theme;
use eframe::egui::accesskit::Role;
use eframe::egui::ecolor::{hsv_from_rgb, rgb_from_hsv};
use eframe::egui::{
    Color32, CornerRadius, Popup, PopupCloseBehavior, Response, Rgba, Sense, Slider, Stroke, StrokeKind, Ui,
    WidgetInfo,
};
use lumel_scene::MAX_ALBEDO;

/// Width of the popup with the sliders.
const WIDTH: f32 = 300.0;

/// A field of a colour that opens sliders for its hue and saturation.
///
/// `rgb` is linear; its largest channel becomes 1 when it is changed.
pub fn color_button(ui: &mut Ui, rgb: &mut [f32; 3]) -> Response {
    button(ui, "Colour", rgb, None)
}

/// A field of an albedo that opens sliders for its hue, saturation and brightness. `rgb` is linear.
pub fn albedo_button(ui: &mut Ui, label: &str, rgb: &mut [f32; 3]) -> Response {
    button(ui, label, rgb, Some(MAX_ALBEDO))
}

/// A field of a colour whose brightness counts, up to 1, that opens sliders as that of an albedo does.
pub fn share_button(ui: &mut Ui, label: &str, rgb: &mut [f32; 3]) -> Response {
    button(ui, label, rgb, Some(1.0))
}

fn button(ui: &mut Ui, label: &str, rgb: &mut [f32; 3], brightest: Option<f32>) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(ui.spacing().interact_size, Sense::click());
    let fill: Color32 = Rgba::from_rgb(rgb[0], rgb[1], rgb[2]).into();
    response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, label));
    let stroke = Stroke::new(1.0, if response.hovered() { theme::TEXT } else { theme::LINE });
    ui.painter().rect(rect, CornerRadius::same(4), fill, stroke, StrokeKind::Inside);
    let menu = Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    if menu.show(|ui| sliders(ui, &response, rgb, brightest)).is_some_and(|shown| shown.inner) {
        response.mark_changed();
    }
    response
}

/// Returns whether the colour was changed. Its largest channel is up to `brightest`, or 1 if there is no such limit.
fn sliders(ui: &mut Ui, of: &Response, rgb: &mut [f32; 3], brightest: Option<f32>) -> bool {
    ui.set_width(WIDTH);
    let (hue, saturation, value) = hsv_from_rgb(*rgb);
    // Grey has no hue and black no saturation, but those that were chosen are not forgotten on the way.
    let memory = of.id.with("hue and saturation");
    let kept: (f32, f32) = ui.data(|data| data.get_temp(memory)).unwrap_or_default();
    let mut degrees = if saturation > 0.0 { 360.0 * hue } else { kept.0 };
    let mut saturation = if value > 0.0 { saturation } else { kept.1 };
    let mut value = if brightest.is_some() { value } else { 1.0 };
    let before = (degrees, saturation, value);
    slider(ui, "Hue", "Degrees", Slider::new(&mut degrees, 0.0..=360.0).suffix("°").max_decimals(0));
    slider(ui, "Saturation", "0 is white", Slider::new(&mut saturation, 0.0..=1.0).max_decimals(3));
    if let Some(brightest) = brightest {
        let brightness = Slider::new(&mut value, 0.0..=brightest).max_decimals(3);
        slider(ui, "Brightness", "Of the brightest channel, as a share of 1", brightness);
    }
    ui.data_mut(|data| data.insert_temp(memory, (degrees, saturation)));
    let changed = (degrees, saturation, value) != before;
    if changed {
        *rgb = rgb_from_hsv((degrees / 360.0, saturation, value));
    }
    changed
}
