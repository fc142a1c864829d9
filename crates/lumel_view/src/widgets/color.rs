//! A colour by hue and saturation; how bright it is is said elsewhere.
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

/// Width of the popup with the sliders.
const WIDTH: f32 = 300.0;

/// A field of a colour that opens sliders for its hue and saturation.
///
/// `rgb` is linear; its largest channel becomes 1 when it is changed.
pub fn color_button(ui: &mut Ui, rgb: &mut [f32; 3]) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(ui.spacing().interact_size, Sense::click());
    let fill: Color32 = Rgba::from_rgb(rgb[0], rgb[1], rgb[2]).into();
    response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, "Colour"));
    let stroke = Stroke::new(1.0, if response.hovered() { theme::TEXT } else { theme::LINE });
    ui.painter().rect(rect, CornerRadius::same(4), fill, stroke, StrokeKind::Inside);
    let menu = Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    if menu.show(|ui| sliders(ui, &response, rgb)).is_some_and(|shown| shown.inner) {
        response.mark_changed();
    }
    response
}

/// Returns whether the colour was changed.
fn sliders(ui: &mut Ui, of: &Response, rgb: &mut [f32; 3]) -> bool {
    ui.set_width(WIDTH);
    let (hue, mut saturation, _) = hsv_from_rgb(*rgb);
    // Grey has no hue, but one that was chosen is not forgotten on the way.
    let memory = of.id.with("hue");
    let kept = ui.data(|data| data.get_temp(memory)).unwrap_or(0.0);
    let mut degrees = if saturation > 0.0 { 360.0 * hue } else { kept };
    let before = (degrees, saturation);
    slider(ui, "Hue", "Degrees", Slider::new(&mut degrees, 0.0..=360.0).suffix("°").max_decimals(0));
    slider(ui, "Saturation", "0 is white", Slider::new(&mut saturation, 0.0..=1.0).max_decimals(3));
    ui.data_mut(|data| data.insert_temp(memory, degrees));
    let changed = (degrees, saturation) != before;
    if changed {
        *rgb = rgb_from_hsv((degrees / 360.0, saturation, 1.0));
    }
    changed
}
