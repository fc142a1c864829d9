//! Opening scenes.

use super::{Courses, Opening, Session};
use crate::document::{self, Contents, Document, OpenRequest};
use crate::history::History;
use crate::notice::Level;
use crate::task::Background;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The path, or the first one with a number that no file has.
fn unused(path: &str) -> PathBuf {
    let path = Path::new(path);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (stem, end) = name.split_once('.').unwrap_or((&name, ""));
    let numbered =
        |n: u32| if n == 1 { path.to_owned() } else { path.with_file_name(format!("{stem}-{n}.{end}")) };
    (1..).map(numbered).find(|path| !path.exists()).unwrap_or_else(|| path.to_owned())
}

impl Session {
    /// Opens a scene on another thread; a running solve stops. Ask [`Self::objection`] first.
    pub fn open(&mut self, request: OpenRequest) {
        self.stop();
        let wanted = request.clone();
        let what = format!("opening {}", request.title());
        let task = Background::start(what, Arc::clone(&self.wakes.event), move || document::open(&wanted));
        self.opening = Some(Opening { request, task });
    }

    /// Saves what opening another scene would lose, under names beside the scene that are not taken, and opens the other one
    /// once all is written. What cannot be saved stays open.
    pub fn save_and_open(&mut self, request: OpenRequest) {
        match self.save_all() {
            Ok(()) => self.waiting = Some(request),
            Err(problem) => self.notices.push(Level::Error, format!("Cannot save: {problem}")),
        }
    }

    fn save_all(&mut self) -> Result<(), String> {
        if self.has_unsaved_light() {
            let path = unused(&self.path_beside_scene("npz"));
            self.save_solution(&path)?;
        }
        if self.has_unsaved_edits() {
            let project = self.document.as_ref().and_then(|document| document.project.as_ref());
            let path = project.map(|(path, _)| path.clone());
            let path = path.unwrap_or_else(|| unused(&self.path_beside_scene("lumel.toml")));
            self.save_project(&path)?;
        }
        Ok(())
    }

    /// Opens the scene that waits for files to be written, once they are.
    pub(super) fn open_what_waits(&mut self, failed: bool) {
        if failed {
            self.waiting = None;
        }
        if self.saving.is_empty()
            && let Some(request) = self.waiting.take()
        {
            self.open(request);
        }
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
        // What is still being read was meant for the scene before.
        (self.loading, self.loading_sky) = (None, None);
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
        self.sky = document.sky.clone();
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
