//! Starting a solve, its settings and its files.

use crate::app::App;
use crate::dialogs::Dialog;
use crate::input::Command;
use crate::session::Computed;
use crate::theme;
use crate::widgets::primary_button;
use eframe::egui::{Button, RichText, Ui};

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    buttons(app, ui);
    super::settings::show(ui, &mut app.session.settings);
    live(app, ui);
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Save solution...").clicked() {
            app.dialogs.open(Dialog::save_solution(&app.session));
        }
        if ui.button("Load solution...").clicked() {
            app.dialogs.open(Dialog::load_solution(&app.session));
        }
        let unknown = |c: &Computed| c.complete && c.solved.is_some() && c.accuracy().is_none();
        let ready = app.session.computed().is_some_and(unknown);
        let button = ui.add_enabled(ready && !app.session.is_solving(), Button::new("Measure standard error"));
        let hint = "Measures the light at every vertex again with eight independent sets of samples; takes about as \
                    long as the solve. It is the error of sampling there, not of the light that is gathered.";
        if button.on_hover_text(hint).clicked() {
            app.session.measure_standard_error();
        }
    });
}

/// Whether the light follows the hand.
fn live(app: &mut App, ui: &mut Ui) {
    let obstacle = app.session.obstacle_to_live();
    ui.horizontal_wrapped(|ui| {
        let hint = "While lights are moved, sized or coloured and materials painted, light and all bounces of it follow \
                    at once. The stored hemisphere rays are used again.";
        ui.checkbox(&mut app.session.live, "Light follows changes").on_hover_text(hint);
        if let Some(obstacle) = obstacle.filter(|_| app.session.live) {
            ui.label(RichText::new(obstacle).color(theme::WEAK));
        }
    });
}

fn buttons(app: &mut App, ui: &mut Ui) {
    let ctx = ui.ctx().clone();
    ui.horizontal(|ui| {
        let width = ui.available_width();
        if app.session.phase().is_some() {
            if ui.add_sized([width, 30.0], Button::new(RichText::new("Stop").strong())).clicked() {
                app.run(Command::Stop, &ctx);
            }
            return;
        }
        let text = if app.session.can_go_on() { "Go on" } else { "Solve" };
        if primary_button(ui, text, width).on_hover_text("Enter").clicked() {
            app.run(Command::Solve, &ctx);
        }
    });
}
