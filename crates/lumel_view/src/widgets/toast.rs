//! Messages that appear over the picture and go by themselves.

use crate::notice::{Level, Notice};
use crate::theme;
use eframe::egui::{self, Align2, Color32, Frame, Margin, RichText, Stroke, Vec2};
use std::time::{Duration, Instant};

/// More messages than this are not shown at once; all are in the log.
const MAX_SHOWN: usize = 4;

struct Toast {
    notice: Notice,
    until: Instant,
}

/// The messages that are shown now.
#[derive(Default)]
pub struct Toasts {
    shown: Vec<Toast>,
}

impl Toasts {
    /// Shows more messages.
    pub fn add(&mut self, notices: Vec<Notice>) {
        for notice in notices {
            // What is said again is not shown twice.
            self.shown.retain(|toast| toast.notice.text != notice.text);
            let time = match notice.level {
                Level::Info => Duration::from_secs(4),
                Level::Warning => Duration::from_secs(8),
                Level::Error => Duration::from_secs(20),
            };
            self.shown.push(Toast { notice, until: Instant::now() + time });
        }
        let excess = self.shown.len().saturating_sub(MAX_SHOWN);
        self.shown.drain(..excess);
    }

    /// Draws them at the bottom of an area.
    pub fn show(&mut self, ctx: &egui::Context, area: egui::Rect) {
        let now = Instant::now();
        self.shown.retain(|toast| toast.until > now);
        let Some(next) = self.shown.iter().map(|toast| toast.until).min() else { return };
        ctx.request_repaint_after(next - now);
        let width = (area.width() - 24.0).clamp(80.0, 460.0);
        egui::Area::new(egui::Id::unique("toasts"))
            .order(egui::Order::Foreground)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(area.left_bottom() + Vec2::new(12.0, -12.0))
            .show(ctx, |ui| {
                ui.set_max_width(width);
                let mut closed = None;
                for (i, toast) in self.shown.iter().enumerate() {
                    if one(ui, &toast.notice) {
                        closed = Some(i);
                    }
                }
                if let Some(i) = closed {
                    self.shown.remove(i);
                }
            });
    }
}

/// Draws a message; true when it is clicked away.
fn one(ui: &mut egui::Ui, notice: &Notice) -> bool {
    let color = match notice.level {
        Level::Info => theme::GOOD,
        Level::Warning => theme::WARNING,
        Level::Error => theme::ERROR,
    };
    Frame::new()
        .fill(Color32::from_rgba_unmultiplied(18, 19, 22, 235))
        .stroke(Stroke::new(1.0, color.gamma_multiply(0.6)))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(12, 7))
        .show(ui, |ui| {
            let text = RichText::new(&notice.text).color(theme::TEXT);
            ui.add(egui::Label::new(text).wrap().sense(egui::Sense::click())).clicked()
        })
        .inner
}
