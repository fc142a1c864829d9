//! A window above everything.

use eframe::egui::{Color32, Context, Frame, Id, Margin, Modal, Ui};

/// Shows a window above everything, `width` points wide where there is room; the picture stays in sight.
pub fn modal(ctx: &Context, id: &str, width: f32, add: impl FnOnce(&mut Ui)) {
    let frame = Frame::popup(&ctx.global_style()).inner_margin(Margin::same(18));
    let backdrop = Color32::from_black_alpha(120);
    Modal::new(Id::unique(id)).frame(frame).backdrop_color(backdrop).show(ctx, |ui| {
        ui.set_width(width.min(ctx.content_rect().width() - 60.0));
        add(ui);
    });
}
