//! Dialogs.

mod export;
mod files;
mod help;
mod open;
mod question;

pub use files::{FileDialog, FilePurpose};

use crate::actions::Actions;
use crate::document::OpenRequest;
use crate::prefs::Prefs;
use crate::session::Session;
use eframe::egui;
use question::{Answer, Question, Restore};

/// All that may be open.
#[derive(Default)]
pub struct Dialogs {
    file: Option<FileDialog>,
    question: Option<Question>,
    help: bool,
    /// Whether the offer to restore unsaved work was put off.
    restore_put_off: bool,
    restore_shown: bool,
}

impl Dialogs {
    /// Asks for a file.
    pub fn open(&mut self, dialog: FileDialog) {
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

    /// Whether a dialog is open that takes the keys.
    pub fn is_any_open(&self) -> bool {
        self.file.is_some() || self.question.is_some() || self.help || self.restore_shown
    }

    /// Closes the topmost dialog; false when none is open.
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

    /// Draws the open dialogs but the question, which may only now be asked, and acts on the answers.
    pub fn show(&mut self, session: &mut Session, prefs: &Prefs, actions: &mut Actions, ctx: &egui::Context) {
        self.restore(session, ctx);
        if let Some(dialog) = self.file.take() {
            self.file = dialog.show(session, prefs, actions, ctx);
        }
        if self.help && help::show(ctx) {
            self.help = false;
        }
    }

    /// Draws the question whether to open a scene although work would be lost, and does what is answered.
    pub fn show_question(&mut self, session: &mut Session, ctx: &egui::Context) {
        let Some(answer) = self.question.as_ref().and_then(|question| question.show(ctx)) else { return };
        let Some(Question { request, .. }) = self.question.take() else { return };
        match answer {
            Answer::SaveAndOpen => session.save_and_open(request),
            Answer::Open => session.open(request),
            Answer::Cancel => {}
        }
    }

    fn restore(&mut self, session: &mut Session, ctx: &egui::Context) {
        let left = session.left_behind.as_ref().filter(|_| !self.restore_put_off);
        self.restore_shown = left.is_some();
        match left.and_then(|left| question::restore(&left.note.summary(), ctx)) {
            Some(Restore::Now) => session.restore(),
            Some(Restore::Never) => session.discard_left_behind(),
            Some(Restore::Later) => self.restore_put_off = true,
            None => {}
        }
    }
}
