//! All keys, from the table that handles them.

use crate::input::{Group, help};
use crate::theme;
use crate::widgets::modal;
use eframe::egui::{self, Grid, RichText, ScrollArea};

/// Shows the keys; true when they are to be closed.
pub(super) fn show(ctx: &egui::Context) -> bool {
    let mut close = false;
    modal(ctx, "help", 860.0, |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keys");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                close = ui.button("Close").clicked();
            });
        });
        ui.add_space(4.0);
        let height = ctx.content_rect().height() - 140.0;
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.columns(3, |columns| {
                let [left, middle, right] = columns else { return };
                group(left, Group::Camera);
                group(middle, Group::Files);
                group(middle, Group::Lights);
                group(right, Group::Solve);
                group(right, Group::View);
            });
        });
    });
    close
}

fn group(ui: &mut egui::Ui, group: Group) {
    ui.label(RichText::new(group.title()).strong().color(theme::ACCENT));
    Grid::new(group.title()).num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (keys, text) in help(group) {
            ui.label(RichText::new(keys).strong());
            ui.add(egui::Label::new(RichText::new(text).color(theme::WEAK)).wrap());
            ui.end_row();
        }
    });
    ui.add_space(8.0);
}
