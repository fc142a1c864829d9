//! Colours and distances of the window, in one place.

use eframe::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Frame, Margin, Stroke, TextStyle, Theme, Vec2,
};

/// What is active or asks for the next step.
pub const ACCENT: Color32 = Color32::from_rgb(240, 170, 60);
/// Behind text on [`ACCENT`].
pub const ON_ACCENT: Color32 = Color32::from_rgb(30, 22, 8);
/// Panels.
pub const PANEL: Color32 = Color32::from_rgb(32, 34, 38);
/// Behind panels, and lists in them.
pub const DEEP: Color32 = Color32::from_rgb(23, 24, 27);
/// Widgets at rest.
pub const WIDGET: Color32 = Color32::from_rgb(50, 53, 59);
/// Lines between things.
pub const LINE: Color32 = Color32::from_rgb(54, 57, 63);
/// Text.
pub const TEXT: Color32 = Color32::from_rgb(222, 224, 228);
/// Text that explains.
pub const WEAK: Color32 = Color32::from_rgb(150, 154, 162);
/// Something failed.
pub const ERROR: Color32 = Color32::from_rgb(240, 100, 90);
/// Something was left out.
pub const WARNING: Color32 = Color32::from_rgb(236, 190, 90);
/// All is well.
pub const GOOD: Color32 = Color32::from_rgb(110, 200, 140);

/// Width of the names left of widgets.
pub const LABEL_WIDTH: f32 = 104.0;

/// Lines of plots.
pub const SERIES: [Color32; 3] = [ACCENT, Color32::from_rgb(100, 180, 240), Color32::from_rgb(140, 210, 130)];

/// What paints the background of the panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ground {
    /// The panels themselves.
    #[default]
    Panels,
    /// The window, which is cleared in the colour of the panels: a software renderer pays for every pixel it
    /// paints twice.
    Window,
}

impl Ground {
    /// The frame of a panel.
    pub fn frame(self) -> Frame {
        match self {
            Self::Panels => Frame::new().fill(PANEL),
            Self::Window => Frame::new(),
        }
    }
}

/// Gives a window its look: dark, so that what is judged by eye is the picture.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    ctx.all_styles_mut(|style| {
        let v = &mut style.visuals;
        v.panel_fill = PANEL;
        v.window_fill = PANEL;
        v.extreme_bg_color = DEEP;
        v.faint_bg_color = Color32::from_rgb(38, 40, 45);
        v.window_stroke = Stroke::new(1.0, LINE);
        v.window_corner_radius = CornerRadius::same(8);
        v.menu_corner_radius = CornerRadius::same(6);
        v.override_text_color = None;
        v.selection.bg_fill = Color32::from_rgb(112, 78, 26);
        v.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 226, 176));
        v.hyperlink_color = ACCENT;
        v.slider_trailing_fill = true;
        let radius = CornerRadius::same(4);
        for (widget, fill, text) in [
            (&mut v.widgets.noninteractive, PANEL, TEXT),
            (&mut v.widgets.inactive, WIDGET, TEXT),
            (&mut v.widgets.hovered, Color32::from_rgb(64, 68, 76), Color32::WHITE),
            (&mut v.widgets.active, Color32::from_rgb(78, 82, 92), Color32::WHITE),
            (&mut v.widgets.open, Color32::from_rgb(58, 61, 68), Color32::WHITE),
        ] {
            widget.bg_fill = fill;
            widget.weak_bg_fill = fill;
            widget.fg_stroke = Stroke::new(1.0, text);
            widget.corner_radius = radius;
        }
        v.widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
        v.widgets.inactive.bg_stroke = Stroke::NONE;
        let s = &mut style.spacing;
        s.item_spacing = Vec2::new(8.0, 6.0);
        s.button_padding = Vec2::new(8.0, 3.0);
        s.interact_size = Vec2::new(40.0, 22.0);
        s.window_margin = Margin::same(14);
        s.menu_margin = Margin::same(6);
        s.combo_width = 120.0;
        style.text_styles = [
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
    });
}
