//! Asking for files: a path to type, a button for the system's dialog, and for scenes what there is to choose from.

use super::{modal, open};
use crate::app::App;
use crate::notice::Level;
use crate::selection::Selection;
use crate::session::{self, MESH_FORMATS, SOLUTION_FORMATS, Session};
use crate::task::Background;
use crate::theme;
use crate::widgets::primary_button;
use eframe::egui::{self, Button, RichText, TextEdit};
use std::path::{Path, PathBuf};

/// What a file is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to open.
    OpenScene,
    /// Where to save the lit mesh.
    SaveMesh,
    /// Where to save the project.
    SaveProject,
    /// A solution to show.
    LoadSolution,
    /// A solution to compare with.
    CompareSolution,
    /// Where to save the solution.
    SaveSolution,
}

/// A question for a file.
pub struct Dialog {
    /// What for.
    pub purpose: Purpose,
    /// The path as it stands in the dialog.
    pub path: String,
    /// Longest edge after tessellation, metres; 0 to leave edges alone.
    pub max_edge: f32,
    note: String,
    problem: Option<String>,
    browsing: Option<Background<Option<PathBuf>>>,
    focus: bool,
}

impl Dialog {
    fn new(purpose: Purpose, path: String) -> Self {
        let (note, max_edge) = (String::new(), 0.0);
        Self { purpose, path, max_edge, note, problem: None, browsing: None, focus: true }
    }

    /// Asks for a scene.
    pub fn open_scene(session: &Session) -> Self {
        let max_edge = session.document.as_ref().and_then(|d| d.request.options.max_edge).unwrap_or(0.0);
        Self { max_edge, ..Self::new(Purpose::OpenScene, String::new()) }
    }

    /// Asks where to save the lit mesh.
    pub fn save_mesh(session: &Session, selection: Selection) -> Self {
        let note = if session.light.is_empty() {
            "There is no light yet: the mesh is saved without.".to_owned()
        } else {
            format!("The mesh is saved with {selection}, as it is shown.")
        };
        Self { note, ..Self::new(Purpose::SaveMesh, suggestion(session, "lit.glb")) }
    }

    /// Asks where to save the project.
    pub fn save_project(session: &Session) -> Self {
        let note =
            "Lights, view, settings and slots. Save it beside the mesh, or in a folder above it.".to_owned();
        Self { note, ..Self::new(Purpose::SaveProject, suggestion(session, "lumel.toml")) }
    }

    /// Asks for a solution.
    pub fn load_solution(session: &Session) -> Self {
        Self::new(Purpose::LoadSolution, suggestion(session, "npz"))
    }

    /// Asks for a solution to compare with.
    pub fn compare_solution(session: &Session) -> Self {
        Self::new(Purpose::CompareSolution, suggestion(session, "npz"))
    }

    /// Asks where to save the solution.
    pub fn save_solution(session: &Session) -> Self {
        let note = ".npz holds every bounce; .rad the sum only, over pi.".to_owned();
        Self { note, ..Self::new(Purpose::SaveSolution, suggestion(session, "npz")) }
    }

    fn title(&self) -> &'static str {
        match self.purpose {
            Purpose::OpenScene => "Open a scene",
            Purpose::SaveMesh => "Save the lit mesh",
            Purpose::SaveProject => "Save the project",
            Purpose::LoadSolution => "Load a solution",
            Purpose::CompareSolution => "Compare with a solution",
            Purpose::SaveSolution => "Save the solution",
        }
    }

    /// The text on the button that does it.
    fn verb(&self) -> &'static str {
        match self.purpose {
            Purpose::OpenScene => "Open",
            Purpose::LoadSolution | Purpose::CompareSolution => "Load",
            Purpose::SaveMesh | Purpose::SaveProject | Purpose::SaveSolution => "Save",
        }
    }

    fn is_saving(&self) -> bool {
        self.verb() == "Save"
    }

    fn extensions(&self) -> &'static [&'static str] {
        match self.purpose {
            Purpose::OpenScene => &["obj", "gltf", "glb", "ply", "toml"],
            Purpose::SaveMesh => &MESH_FORMATS,
            Purpose::SaveProject => &["toml"],
            _ => &SOLUTION_FORMATS,
        }
    }

    /// Opens the system's own dialog on a thread of its own; it may not be there.
    fn browse(&mut self, wake: &crate::solver::Wake) {
        let (title, extensions, saving) = (self.title(), self.extensions(), self.is_saving());
        let path = PathBuf::from(&self.path);
        self.browsing =
            Some(Background::start("asking for a file", std::sync::Arc::clone(wake), move || {
                let mut dialog = rfd::FileDialog::new().set_title(title).add_filter("files", extensions);
                if let Some(folder) = path.parent().and_then(|folder| folder.canonicalize().ok()) {
                    dialog = dialog.set_directory(folder);
                }
                if let Some(name) = path.file_name() {
                    dialog = dialog.set_file_name(name.to_string_lossy());
                }
                Ok(if saving { dialog.save_file() } else { dialog.pick_file() })
            }));
    }

    fn poll(&mut self) {
        match self.browsing.as_ref().and_then(Background::poll) {
            Some(Ok(Some(path))) => {
                self.path = path.to_string_lossy().into_owned();
                self.browsing = None;
            }
            Some(_) => self.browsing = None,
            None => {}
        }
    }
}

/// A name beside the scene, or in the current folder for built-in ones.
fn suggestion(session: &Session, extension: &str) -> String {
    let Some(document) = &session.document else { return String::new() };
    let source = Path::new(&document.request.name);
    let file = source.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = file.split('.').next().unwrap_or_default();
    let name = format!("{stem}.{extension}");
    if source.exists() { source.with_file_name(name).to_string_lossy().into_owned() } else { name }
}

/// What was decided.
enum Decision {
    Do,
    Cancel,
}

pub(super) fn show(app: &mut App, ctx: &egui::Context) {
    let Some(mut dialog) = app.dialogs.file.take() else { return };
    dialog.poll();
    let mut decision = None;
    let mut chosen = None;
    let width = if dialog.purpose == Purpose::OpenScene { 620.0 } else { 520.0 };
    modal(ctx, "file", width, |ui| {
        ui.heading(dialog.title());
        ui.add_space(6.0);
        if dialog.purpose == Purpose::OpenScene {
            chosen = open::choices(ui, &app.prefs.recent, &mut dialog.max_edge);
        }
        decision = path_row(ui, &mut dialog, &app.wake);
        if !dialog.note.is_empty() {
            ui.label(RichText::new(&dialog.note).color(theme::WEAK));
        }
        if let Some(problem) = &dialog.problem {
            ui.add(egui::Label::new(RichText::new(problem).color(theme::ERROR)).wrap());
        } else if dialog.is_saving() && Path::new(&dialog.path).exists() {
            ui.label(RichText::new("This file exists and will be replaced.").color(theme::WARNING));
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if primary_button(ui, dialog.verb(), 110.0).clicked() {
                decision = Some(Decision::Do);
            }
            if ui.add_sized([100.0, 30.0], Button::new("Cancel")).clicked() {
                decision = Some(Decision::Cancel);
            }
        });
    });
    if let Some(name) = chosen {
        dialog.path = name;
        decision = Some(Decision::Do);
    }
    match decision {
        Some(Decision::Cancel) => return,
        Some(Decision::Do) => match act(app, &dialog) {
            Ok(()) => return,
            Err(problem) => dialog.problem = Some(problem),
        },
        None => {}
    }
    app.dialogs.file = Some(dialog);
}

fn path_row(ui: &mut egui::Ui, dialog: &mut Dialog, wake: &crate::solver::Wake) -> Option<Decision> {
    let mut decision = None;
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Path").color(theme::WEAK));
        let edit = TextEdit::singleline(&mut dialog.path).desired_width(ui.available_width() - 100.0);
        let response = ui.add(edit).labelled_by(label.id);
        if std::mem::take(&mut dialog.focus) {
            response.request_focus();
        }
        if response.changed() {
            dialog.problem = None;
        }
        if response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
            decision = Some(Decision::Do);
        }
        let browse = ui.add_enabled(dialog.browsing.is_none(), Button::new("Browse..."));
        if browse.on_hover_text("The system's own dialog, where there is one").clicked() {
            dialog.browse(wake);
        }
    });
    decision
}

/// Does what the dialog is for.
fn act(app: &mut App, dialog: &Dialog) -> Result<(), String> {
    let name = dialog.path.trim();
    if name.is_empty() {
        return Err("give a path".to_owned());
    }
    let path = Path::new(name);
    match dialog.purpose {
        Purpose::OpenScene => {
            let mut request = crate::document::OpenRequest::new(name);
            request.options.max_edge = (dialog.max_edge > 0.0).then_some(dialog.max_edge);
            app.open(request);
        }
        Purpose::SaveMesh => app.session.save_mesh(path, app.prefs.view.selection)?,
        Purpose::SaveProject => app.session.save_project(path)?,
        Purpose::SaveSolution => app.session.save_solution(path)?,
        Purpose::LoadSolution | Purpose::CompareSolution => {
            if !path.exists() {
                return Err(format!("there is no such file: {name}"));
            }
            let show = dialog.purpose == Purpose::LoadSolution;
            if show && app.session.has_unsaved_light() {
                let text = "The unsaved solution was kept for comparison";
                app.session.keep_light();
                app.session.notices.push(Level::Info, text);
            }
            let purpose = if show { session::Purpose::Show } else { session::Purpose::Compare };
            app.session.load_solution(path, purpose);
        }
    }
    Ok(())
}
