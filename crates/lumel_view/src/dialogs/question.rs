//! Questions about unsaved work: about to be lost, or left by an earlier run.

use crate::document::OpenRequest;
use crate::theme;
use crate::widgets::{modal, primary_button};
use eframe::egui::{self, RichText};

/// A scene to open although work would be lost.
pub(super) struct Question {
    pub(super) objection: String,
    pub(super) request: OpenRequest,
}

impl Question {
    /// Asks; the answer, once there is one.
    pub(super) fn show(&self, ctx: &egui::Context) -> Option<Answer> {
        let mut answer = None;
        modal(ctx, "question", 420.0, |ui| {
            ui.heading(format!("Open {}?", self.request.title()));
            ui.add_space(4.0);
            ui.label(RichText::new(&self.objection).color(theme::TEXT));
            ui.label(RichText::new("Opening another scene discards it.").color(theme::WEAK));
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                let about = "Saves it beside the scene, under a name that is not taken";
                if primary_button(ui, "Save and open", 130.0).on_hover_text(about).clicked() {
                    answer = Some(Answer::SaveAndOpen);
                }
                for (text, choice) in [("Open anyway", Answer::Open), ("Cancel", Answer::Cancel)] {
                    if ui.add_sized([110.0, 30.0], egui::Button::new(text)).clicked() {
                        answer = Some(choice);
                    }
                }
            });
        });
        answer
    }
}

/// What to do with unsaved work before another scene is opened.
#[derive(Clone, Copy)]
pub(super) enum Answer {
    SaveAndOpen,
    Open,
    Cancel,
}

/// What to do with the unsaved work of an earlier run.
pub(super) enum Restore {
    Now,
    Later,
    Never,
}

/// Offers to restore the unsaved work of an earlier run.
pub(super) fn restore(summary: &str, ctx: &egui::Context) -> Option<Restore> {
    let mut answer = None;
    modal(ctx, "restore", 440.0, |ui| {
        ui.heading("Unsaved work");
        ui.add_space(4.0);
        ui.label(RichText::new(summary).color(theme::TEXT));
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            if primary_button(ui, "Restore", 110.0).clicked() {
                answer = Some(Restore::Now);
            }
            if ui.add_sized([100.0, 30.0], egui::Button::new("Not now")).clicked() {
                answer = Some(Restore::Later);
            }
            if ui.add_sized([100.0, 30.0], egui::Button::new("Discard")).clicked() {
                answer = Some(Restore::Never);
            }
        });
    });
    answer
}
