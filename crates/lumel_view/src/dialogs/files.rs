//! The file dialog: a path to type, a button for the system's dialog, and a list of scenes.

use super::export::{self, ExportChoice};
use super::open;
use crate::actions::{Action, Actions};
use crate::document::OpenRequest;
use crate::notice::Level;
use crate::prefs::Prefs;
use crate::selection::Selection;
use crate::session::{LIGHTMAP_FORMATS, LightUse, MESH_FORMATS, SOLUTION_FORMATS, Session};
use crate::sky::SKY_FORMATS;
use crate::task::Background;
use crate::theme;
use crate::wake::Wake;
use crate::widgets::{modal, primary_button};
use eframe::egui::{self, Button, RichText, TextEdit};
use lumel::MaxEdge;
use std::path::{Path, PathBuf};

/// What a file is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePurpose {
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
    /// Where to save the lightmap.
    SaveLightmap,
    /// An image of the sky.
    LoadSky,
}

/// A question for a file.
pub struct FileDialog {
    /// What for.
    pub purpose: FilePurpose,
    /// The path as it stands in the dialog.
    pub path: String,
    /// Longest edge after tessellation; `None` for what is usual.
    pub max_edge: Option<MaxEdge>,
    /// How a mesh is saved.
    export: Option<ExportChoice>,
    note: String,
    problem: Option<String>,
    browsing: Option<Background<Option<PathBuf>>>,
    focus: bool,
}

impl FileDialog {
    fn new(purpose: FilePurpose, path: String) -> Self {
        let (note, max_edge) = (String::new(), None);
        Self { purpose, path, max_edge, export: None, note, problem: None, browsing: None, focus: true }
    }

    /// Asks for a scene.
    pub fn open_scene(session: &Session) -> Self {
        let max_edge = session.document.as_ref().and_then(|d| d.request.options.max_edge);
        Self { max_edge, ..Self::new(FilePurpose::OpenScene, String::new()) }
    }

    /// Asks where to save the lit mesh.
    ///
    /// `stops` is the exposure of the picture.
    pub fn save_mesh(session: &Session, selection: Selection, stops: f32) -> Self {
        let (note, export) = if session.light.is_empty() {
            ("There is no solution yet: the mesh is saved without light.".to_owned(), None)
        } else {
            (String::new(), Some(ExportChoice::new(selection, stops)))
        };
        Self { note, export, ..Self::new(FilePurpose::SaveMesh, session.path_beside_scene("lit.glb")) }
    }

    /// Asks where to save the project.
    pub fn save_project(session: &Session) -> Self {
        let note =
            "Saves lights, view, settings and slots. Save it next to the mesh, or in a folder above it."
                .to_owned();
        Self { note, ..Self::new(FilePurpose::SaveProject, session.path_beside_scene("lumel.toml")) }
    }

    /// Asks for a solution.
    pub fn load_solution(session: &Session) -> Self {
        Self::new(FilePurpose::LoadSolution, session.path_beside_scene("npz"))
    }

    /// Asks for a solution to compare with.
    pub fn compare_solution(session: &Session) -> Self {
        Self::new(FilePurpose::CompareSolution, session.path_beside_scene("npz"))
    }

    /// Asks where to save the solution.
    pub fn save_solution(session: &Session) -> Self {
        let note = ".npz holds every bounce; .rad holds their sum divided by pi.".to_owned();
        Self { note, ..Self::new(FilePurpose::SaveSolution, session.path_beside_scene("npz")) }
    }

    /// Asks where to save the lightmap.
    pub fn save_lightmap(session: &Session) -> Self {
        let note = if session.has_whole_lightmap() {
            ".exr has the pages with all light, direct light and each bounce; .glb is the mesh with its lightmap, which \
             any viewer shows; .png is a picture of this view."
        } else {
            "There is no lightmap yet: choose it as the basis under Solve, and solve."
        };
        Self {
            note: note.to_owned(),
            ..Self::new(FilePurpose::SaveLightmap, session.path_beside_scene("exr"))
        }
    }

    /// Asks for an image of the sky.
    pub fn load_sky(session: &Session) -> Self {
        let file = session.sky.file.as_ref().map(|file| file.to_string_lossy().into_owned());
        let note = "An equirectangular image: .hdr and .exr hold radiance, others colours up to 1. A project can only refer to \
                    images in its folder or below."
            .to_owned();
        let path = file.unwrap_or_else(|| session.path_beside_scene("hdr"));
        Self { note, ..Self::new(FilePurpose::LoadSky, path) }
    }

    fn title(&self) -> &'static str {
        match self.purpose {
            FilePurpose::OpenScene => "Open a scene",
            FilePurpose::SaveMesh => "Save the lit mesh",
            FilePurpose::SaveProject => "Save the project",
            FilePurpose::LoadSolution => "Load a solution",
            FilePurpose::CompareSolution => "Compare with a solution",
            FilePurpose::SaveSolution => "Save the solution",
            FilePurpose::SaveLightmap => "Save the lightmap",
            FilePurpose::LoadSky => "Light from an image of the sky",
        }
    }

    /// The text on the button that does it.
    fn verb(&self) -> &'static str {
        match self.purpose {
            FilePurpose::OpenScene => "Open",
            FilePurpose::LoadSolution | FilePurpose::CompareSolution | FilePurpose::LoadSky => "Load",
            FilePurpose::SaveMesh
            | FilePurpose::SaveProject
            | FilePurpose::SaveSolution
            | FilePurpose::SaveLightmap => "Save",
        }
    }

    fn is_saving(&self) -> bool {
        self.verb() == "Save"
    }

    fn extensions(&self) -> &'static [&'static str] {
        match self.purpose {
            FilePurpose::OpenScene => &["obj", "gltf", "glb", "ply", "toml"],
            FilePurpose::SaveMesh => &MESH_FORMATS,
            FilePurpose::SaveProject => &["toml"],
            FilePurpose::SaveLightmap => &LIGHTMAP_FORMATS,
            FilePurpose::LoadSky => &SKY_FORMATS,
            _ => &SOLUTION_FORMATS,
        }
    }

    /// Opens the system's own dialog on a thread of its own; it may not be there.
    fn browse(&mut self, wake: &Wake) {
        let (title, extensions, saving) = (self.title(), self.extensions(), self.is_saving());
        let path = PathBuf::from(&self.path);
        self.browsing = Some(Background::start("choosing a file", std::sync::Arc::clone(wake), move || {
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

/// What was decided.
enum Decision {
    Do,
    Cancel,
}

impl FileDialog {
    /// Draws it and does what it is for; `None` once it is closed.
    pub(super) fn show(
        mut self,
        session: &mut Session,
        prefs: &Prefs,
        actions: &mut Actions,
        ctx: &egui::Context,
    ) -> Option<Self> {
        self.poll();
        let mut decision = None;
        let mut chosen = None;
        let width = if self.purpose == FilePurpose::OpenScene { 620.0 } else { 520.0 };
        modal(ctx, "file", width, |ui| {
            ui.heading(self.title());
            ui.add_space(6.0);
            if self.purpose == FilePurpose::OpenScene {
                chosen = open::choices(ui, &prefs.recent, &mut self.max_edge, session.document.as_ref());
            }
            if let Some(export) = &mut self.export {
                export::show(ui, export, &mut self.path, session);
            }
            decision = path_row(ui, &mut self, session.wake());
            if !self.note.is_empty() {
                ui.label(RichText::new(&self.note).color(theme::WEAK));
            }
            if let Some(problem) = &self.problem {
                ui.add(egui::Label::new(RichText::new(problem).color(theme::ERROR)).wrap());
            } else if self.is_saving() && Path::new(&self.path).exists() {
                ui.label(RichText::new("This file exists and will be overwritten.").color(theme::WARNING));
            }
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if primary_button(ui, self.verb(), 110.0).clicked() {
                    decision = Some(Decision::Do);
                }
                if ui.add_sized([100.0, 30.0], Button::new("Cancel")).clicked() {
                    decision = Some(Decision::Cancel);
                }
            });
        });
        if let Some(name) = chosen {
            self.path = name;
            decision = Some(Decision::Do);
        }
        match decision {
            Some(Decision::Cancel) => return None,
            Some(Decision::Do) => match act(session, prefs, actions, &self) {
                Ok(()) => return None,
                Err(problem) => self.problem = Some(problem),
            },
            None => {}
        }
        Some(self)
    }
}

fn path_row(ui: &mut egui::Ui, dialog: &mut FileDialog, wake: &Wake) -> Option<Decision> {
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
        if browse.on_hover_text("Opens the system's file dialog, if there is one").clicked() {
            dialog.browse(wake);
        }
    });
    decision
}

fn there(path: &Path) -> Result<(), String> {
    if path.exists() { Ok(()) } else { Err(format!("there is no such file: {}", path.display())) }
}

/// Does what the dialog is for.
fn act(
    session: &mut Session,
    prefs: &Prefs,
    actions: &mut Actions,
    dialog: &FileDialog,
) -> Result<(), String> {
    let name = dialog.path.trim();
    if name.is_empty() {
        return Err("enter a path".to_owned());
    }
    let path = Path::new(name);
    match dialog.purpose {
        FilePurpose::OpenScene => {
            let mut request = OpenRequest::new(name);
            request.options.max_edge = dialog.max_edge;
            actions.push(Action::Open(request));
        }
        FilePurpose::SaveMesh => {
            let export = dialog.export.unwrap_or(ExportChoice::new(prefs.view.selection, 0.0)).export();
            session.save_mesh(path, export, &prefs.view.relief)?;
        }
        FilePurpose::SaveProject => session.save_project(path)?,
        FilePurpose::SaveSolution => session.save_solution(path)?,
        FilePurpose::SaveLightmap => session.save_lightmap(path, &prefs.view)?,
        FilePurpose::LoadSky => {
            there(path)?;
            session.load_sky(path);
        }
        FilePurpose::LoadSolution | FilePurpose::CompareSolution => {
            there(path)?;
            let show = dialog.purpose == FilePurpose::LoadSolution;
            if show && session.has_unsaved_light() {
                let text = "The unsaved solution was kept for comparison";
                session.keep_light();
                session.notices.push(Level::Info, text);
            }
            let purpose = if show { LightUse::Show } else { LightUse::Compare };
            session.load_solution(path, purpose);
        }
    }
    Ok(())
}
