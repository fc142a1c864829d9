//! Starting a solve, its settings and its files.

use crate::actions::Actions;
use crate::input::Command;
use crate::session::{Computed, Session};
use crate::theme;
use crate::widgets::{hint, primary_button};
use eframe::egui::{Button, RichText, Ui};

pub(super) fn show(session: &mut Session, actions: &mut Actions, ui: &mut Ui) {
    buttons(session, actions, ui);
    super::lumels::show(session, ui);
    super::settings::show(ui, &mut session.settings);
    if session.follows_other_light() && session.phase().is_none() {
        hint(ui, "The mesh follows light as it was: Enter refines it for what it is now.");
    }
    live(session, ui);
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Save solution...").clicked() {
            actions.push(Command::SaveSolution);
        }
        if ui.button("Load solution...").clicked() {
            actions.push(Command::LoadSolution);
        }
        if session.layout().is_some() {
            let button = ui.add_enabled(session.has_whole_lightmap(), Button::new("Save lightmap..."));
            if button.clicked() {
                actions.push(Command::SaveLightmap);
            }
        }
        let unknown = |c: &Computed| c.complete && c.solved.is_some() && c.accuracy().is_none();
        let ready = session.computed().is_some_and(unknown);
        let button = ui.add_enabled(ready && !session.is_solving(), Button::new("Measure standard error"));
        let hint = "Measures every vertex again with eight independent sets of samples; takes about as long as the \
                    solve. It is the error of the final gather, without that of the light it gathers.";
        if button.on_hover_text(hint).clicked() {
            session.measure_standard_error();
        }
    });
}

/// Whether the light follows the hand.
fn live(session: &mut Session, ui: &mut Ui) {
    let obstacle = session.obstacle_to_live();
    ui.horizontal_wrapped(|ui| {
        let hint = "Updates the lighting with all bounces while you move, resize or recolour lights and change albedos. \
                    It reuses the stored hemisphere rays.";
        ui.checkbox(&mut session.live, "Live relighting").on_hover_text(hint);
        if let Some(obstacle) = obstacle.filter(|_| session.live) {
            ui.label(RichText::new(obstacle).color(theme::WEAK));
        }
    });
}

fn buttons(session: &Session, actions: &mut Actions, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let width = ui.available_width();
        if session.phase().is_some() {
            if ui.add_sized([width, 30.0], Button::new(RichText::new("Stop").strong())).clicked() {
                actions.push(Command::Stop);
            }
            return;
        }
        let text = if session.can_go_on() { "Resume" } else { "Solve" };
        let obstacle = session.obstacle_to_solve();
        ui.add_enabled_ui(obstacle.is_none(), |ui| {
            let button = primary_button(ui, text, width).on_hover_text("Enter");
            if button.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
                actions.push(Command::Solve);
            }
        });
    });
}
