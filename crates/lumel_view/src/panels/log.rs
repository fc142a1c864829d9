//! All messages.

use crate::notice::{Level, Notices};
use crate::theme;
use eframe::egui::{self, RichText, ScrollArea, Ui};

pub(super) fn show(notices: &mut Notices, ui: &mut Ui) {
    ui.horizontal(|ui| {
        if ui.button("Clear log").clicked() {
            notices.clear();
        }
        if ui.button("Copy log").clicked() {
            let lines: Vec<&str> = notices.all().iter().map(|n| n.text.as_str()).collect();
            ui.ctx().copy_text(lines.join("\n"));
        }
    });
    let height = ui.text_style_height(&egui::TextStyle::Body);
    let notices = notices.all();
    let area = ScrollArea::vertical().id_salt("log").auto_shrink([false, false]).stick_to_bottom(true);
    area.show_rows(ui, height, notices.len(), |ui, rows| {
        for notice in &notices[rows] {
            let color = match notice.level {
                Level::Info => theme::WEAK,
                Level::Warning => theme::WARNING,
                Level::Error => theme::ERROR,
            };
            let line = egui::Label::new(RichText::new(&notice.text).color(color)).truncate();
            ui.add(line).on_hover_text(&notice.text);
        }
    });
}
