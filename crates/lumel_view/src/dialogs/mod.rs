//! What is asked of the user, above the picture.

mod files;
mod help;
mod open;

use crate::app::App;
use crate::document::OpenRequest;
use crate::theme;
use crate::widgets::primary_button;
use eframe::egui::{self, Id, Modal, RichText};
pub use files::{Dialog, Purpose};

/// A scene to open although work would be lost.
struct Question {
    objection: String,
    request: OpenRequest,
}

/// All that may be open.
#[derive(Default)]
pub struct Dialogs {
    file: Option<Dialog>,
    question: Option<Question>,
    help: bool,
    /// Whether the offer to restore unsaved work was put off.
    restore_put_off: bool,
    restore_shown: bool,
}

impl Dialogs {
    /// Asks for a file.
    pub fn open(&mut self, dialog: Dialog) {
        self.file = Some(dialog);
    }

    /// Asks whether to open a scene although work would be lost.
    pub fn ask(&mut self, objection: String, request: OpenRequest) {
        self.question = Some(Question { objection, request });
    }

    /// Shows or hides the keys.
    pub fn toggle_help(&mut self) {
        self.help = !self.help;
    }

    /// Whether anything is open that takes the keys.
    pub fn is_any_open(&self) -> bool {
        self.file.is_some() || self.question.is_some() || self.help || self.restore_shown
    }

    /// Closes what is on top; false when there is nothing.
    pub fn close_top(&mut self) -> bool {
        if self.question.take().is_some() || self.file.take().is_some() || std::mem::take(&mut self.help) {
            return true;
        }
        if std::mem::take(&mut self.restore_shown) {
            self.restore_put_off = true;
            return true;
        }
        false
    }
}

/// A window above everything; the picture stays in sight.
fn modal(ctx: &egui::Context, id: &str, width: f32, add: impl FnOnce(&mut egui::Ui)) {
    let frame = egui::Frame::popup(&ctx.global_style()).inner_margin(egui::Margin::same(18));
    let backdrop = egui::Color32::from_black_alpha(120);
    Modal::new(Id::unique(id)).frame(frame).backdrop_color(backdrop).show(ctx, |ui| {
        ui.set_width(width.min(ctx.content_rect().width() - 60.0));
        add(ui);
    });
}

/// Draws what is open.
pub fn show(app: &mut App, ctx: &egui::Context) {
    restore(app, ctx);
    files::show(app, ctx);
    question(app, ctx);
    if app.dialogs.help {
        help::show(app, ctx);
    }
}

fn question(app: &mut App, ctx: &egui::Context) {
    let Some(question) = &app.dialogs.question else { return };
    let (objection, request) = (question.objection.clone(), question.request.clone());
    let mut answer = None;
    modal(ctx, "question", 420.0, |ui| {
        ui.heading(format!("Open {}?", request.title()));
        ui.add_space(4.0);
        ui.label(RichText::new(objection).color(theme::TEXT));
        ui.label(RichText::new("It will be lost unless you save it first.").color(theme::WEAK));
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            if primary_button(ui, "Open anyway", 130.0).clicked() {
                answer = Some(true);
            }
            if ui.add_sized([100.0, 30.0], egui::Button::new("Cancel")).clicked() {
                answer = Some(false);
            }
        });
    });
    if let Some(open) = answer {
        app.dialogs.question = None;
        if open {
            app.open_now(request);
        }
    }
}

/// Offers to go on with work that an earlier session left behind.
fn restore(app: &mut App, ctx: &egui::Context) {
    let Some((_, note)) = app.session.left_behind.as_ref().filter(|_| !app.dialogs.restore_put_off) else {
        app.dialogs.restore_shown = false;
        return;
    };
    let summary = note.summary();
    app.dialogs.restore_shown = true;
    let mut answer = None;
    modal(ctx, "restore", 440.0, |ui| {
        ui.heading("There is unsaved work");
        ui.add_space(4.0);
        ui.label(RichText::new(summary).color(theme::TEXT));
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            if primary_button(ui, "Restore", 110.0).clicked() {
                answer = Some(Answer::Restore);
            }
            if ui.add_sized([100.0, 30.0], egui::Button::new("Not now")).clicked() {
                answer = Some(Answer::Later);
            }
            if ui.add_sized([100.0, 30.0], egui::Button::new("Discard")).clicked() {
                answer = Some(Answer::Discard);
            }
        });
    });
    match answer {
        Some(Answer::Restore) => app.session.restore(),
        Some(Answer::Discard) => app.session.discard_left_behind(),
        Some(Answer::Later) => app.dialogs.restore_put_off = true,
        None => {}
    }
}

enum Answer {
    Restore,
    Later,
    Discard,
}
