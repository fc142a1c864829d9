//! Opening scenes.

use super::{Courses, Opening, Session};
use crate::document::{self, Contents, Document, OpenRequest};
use crate::history::History;
use crate::notice::Level;
use crate::task::Background;
use std::sync::Arc;

impl Session {
    /// Opens a scene on another thread; a running solve stops. Ask [`Self::objection`] first.
    pub fn open(&mut self, request: OpenRequest) {
        self.stop();
        let wanted = request.clone();
        let what = format!("opening {}", request.title());
        let task = Background::start(what, Arc::clone(&self.wakes.event), move || document::open(&wanted));
        self.opening = Some(Opening { request, task });
    }

    /// Opens the scene again, as it is on disk now.
    pub fn reload(&mut self) {
        if let Some(document) = &self.document {
            self.open(document.request.clone());
        }
    }

    /// What would be lost by opening another scene; `None` when nothing would.
    pub fn objection(&self) -> Option<String> {
        let name = &self.document.as_ref()?.request.title();
        if self.is_solving() {
            return Some(format!("The solve of {name} has not finished."));
        }
        if self.has_unsaved_light() {
            return Some(format!("The solution of {name} is not saved."));
        }
        self.has_unsaved_edits()
            .then(|| format!("Lights, materials or slots of {name} have unsaved changes."))
    }

    /// Whether a scene is being opened.
    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    pub(super) fn poll_opening(&mut self) {
        let Some(result) = self.opening.as_ref().and_then(|opening| opening.task.poll()) else { return };
        let Some(Opening { request, .. }) = self.opening.take() else { return };
        match result {
            Ok((document, contents)) => self.install(document, contents),
            Err(problem) => {
                self.restoring = None;
                self.notices.push(Level::Error, format!("Cannot open {}: {problem}", request.title()));
            }
        }
    }

    /// Makes a scene the one that is open.
    fn install(&mut self, document: Document, contents: Contents) {
        let reloaded = self.document.as_ref().is_some_and(|old| old.request.name == document.request.name);
        self.end_solve();
        for warning in &document.warnings {
            self.notices.log(Level::Warning, warning.clone());
        }
        let n = document.warnings.len();
        let more = if n > 0 { format!(", {n} warnings in the log") } else { String::new() };
        self.notices.push(Level::Info, format!("Opened {}{more}", document.request.title()));
        if !reloaded {
            self.camera = document.home;
            self.rippled.clear();
        }
        if let Some(settings) = contents.settings {
            self.settings = settings;
        }
        (self.lights, self.slots, self.active) = (contents.lights, contents.slots, 0);
        self.albedos.clone_from(&document.albedos);
        self.document = Some(document);
        self.document_generation += 1;
        self.mesh_generation += 1;
        self.refined_for = None;
        self.forget_light();
        self.courses = Courses::default();
        self.kept.clear();
        if let Some(recovery) = &self.recovery {
            recovery.remove();
        }
        self.saved_edit = self.edit();
        self.history = History::new(self.saved_edit.clone());
        if let Some(left) = self.restoring.take() {
            self.restore_into_document(left);
        }
    }
}
