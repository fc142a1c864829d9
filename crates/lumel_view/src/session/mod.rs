//! All that is open and going on, without a window: what the panels show and the keys change.
//!
//! Nothing here waits. Scenes are opened, solves run and files are written on other threads; [`Session::poll`] takes
//! in what they have done. Changes that would lose unsaved work are asked about first: see [`Session::objection`].

mod edit;
mod files;
mod live;
mod solve;

pub use files::{LoadedLight, MESH_FORMATS, Purpose, SOLUTION_FORMATS, SavedFile, light_from};
pub use solve::Computed;

use crate::camera::FlyCamera;
use crate::document::{self, Contents, Document, OpenRequest};
use crate::history::History;
use crate::lights::EditLight;
use crate::notice::{Level, Notices};
use crate::recovery::{Note, Recovery};
use crate::selection::{Light, Selection};
use crate::slots::Slots;
use crate::solver::{BounceStats, Job, Wakes};
use crate::task::Background;
use edit::Edit;
use glam::Vec3;
use lumel::Settings;
use rayon::ThreadPool;
use solve::Running;
use std::path::PathBuf;
use std::sync::Arc;

/// Light that is kept to compare with.
#[derive(Clone, Debug)]
pub struct Kept {
    /// What it is: sampler, rays and bounces, or a file.
    pub name: String,
    /// The light.
    pub light: Light,
    /// Tells it from others that had its place in the list.
    pub id: u64,
}

/// Whether something is being changed right now, such as a slider that is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// Changes are not complete.
    Busy,
    /// Changes are complete.
    Free,
}

/// A scene and everything that is done with it.
pub struct Session {
    /// The open scene.
    pub document: Option<Document>,
    /// Changes with the document.
    pub document_generation: u64,
    /// Rectangle lights.
    pub lights: Vec<EditLight>,
    /// The albedo of each material.
    pub albedos: Vec<Vec3>,
    /// Changes with the albedos that are shown.
    pub paint_generation: u64,
    /// The active light, an index into `lights`.
    pub active: usize,
    /// Settings of the next solve.
    pub settings: Settings,
    /// Whether the light follows changes of the lights at once, where all rays are stored.
    pub live: bool,
    /// Numbered states.
    pub slots: Slots,
    /// The view.
    pub camera: FlyCamera,
    /// Light on the surfaces, as far as it is known.
    pub light: Light,
    /// Changes with the light.
    pub light_generation: u64,
    /// What each bounce brought.
    pub stats: Vec<BounceStats>,
    /// Light to compare with.
    pub kept: Vec<Kept>,
    /// What there is to tell.
    pub notices: Notices,
    /// Unsaved work that an earlier session left behind and that one may go on with.
    pub left_behind: Option<(Recovery, Note)>,
    computed: Option<Computed>,
    history: History<Edit>,
    saved_edit: Edit,
    running: Option<Running>,
    opening: Option<(OpenRequest, Background<(Document, Contents)>)>,
    restoring: Option<(Recovery, Note)>,
    loading: Option<Background<LoadedLight>>,
    saving: Vec<Background<SavedFile>>,
    next_kept: u64,
    recovery: Option<Recovery>,
    pool: Arc<ThreadPool>,
    wakes: Wakes,
}

/// Where a session keeps unsaved work, and how it is woken.
pub struct Surroundings {
    /// Folder for unsaved work; `None` to keep none.
    pub data_folder: Option<PathBuf>,
    /// Threads of solves; 0 for all.
    pub threads: usize,
    /// Called when something has changed that is to be seen.
    pub wakes: Wakes,
}

impl Session {
    /// A session with nothing open.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(surroundings: Surroundings) -> Result<Self, String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(surroundings.threads)
            .thread_name(|i| format!("solve {i}"))
            .build()
            .map_err(|e| format!("cannot start the threads: {e}"))?;
        let folder = surroundings.data_folder.as_deref();
        Ok(Self {
            document: None,
            document_generation: 0,
            lights: Vec::new(),
            albedos: Vec::new(),
            paint_generation: 0,
            active: 0,
            settings: Settings::default(),
            live: true,
            slots: Slots::default(),
            camera: FlyCamera::default(),
            light: Light::default(),
            light_generation: 0,
            stats: Vec::new(),
            kept: Vec::new(),
            notices: Notices::default(),
            left_behind: folder.and_then(|folder| Recovery::left_behind(folder).into_iter().next()),
            computed: None,
            history: History::new(Edit::default()),
            saved_edit: Edit::default(),
            running: None,
            opening: None,
            restoring: None,
            loading: None,
            saving: Vec::new(),
            next_kept: 0,
            recovery: folder.map(Recovery::of_this_process),
            pool: Arc::new(pool),
            wakes: surroundings.wakes,
        })
    }

    /// Opens a scene on another thread; a running solve stops. Ask [`Self::objection`] first.
    pub fn open(&mut self, request: OpenRequest) {
        self.stop();
        let wanted = request.clone();
        let what = format!("opening {}", request.title());
        let task = Background::start(what, Arc::clone(&self.wakes.event), move || document::open(&wanted));
        self.opening = Some((request, task));
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
            return Some(format!("The solve of {name} is not done."));
        }
        if self.has_unsaved_light() {
            return Some(format!("The solution of {name} is not saved."));
        }
        self.has_unsaved_edits().then(|| format!("Lights or views of {name} have changed and are not saved."))
    }

    /// Takes in what other threads have done. To be called before each frame is drawn.
    pub fn poll(&mut self, hand: Hand) {
        self.poll_opening();
        self.poll_files();
        self.paint();
        self.poll_solve(hand);
        self.follow_changes(hand);
        if hand == Hand::Free {
            self.history.commit(&Edit::of(self));
        }
    }

    fn poll_opening(&mut self) {
        let Some(result) = self.opening.as_ref().and_then(|(_, task)| task.poll()) else { return };
        let Some((request, _)) = self.opening.take() else { return };
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
        }
        if let Some(settings) = contents.settings {
            self.settings = settings;
        }
        (self.lights, self.slots, self.active) = (contents.lights, contents.slots, 0);
        self.albedos.clone_from(&document.albedos);
        self.document = Some(document);
        self.document_generation += 1;
        self.forget_light();
        self.kept.clear();
        if let Some(recovery) = &self.recovery {
            recovery.remove();
        }
        self.saved_edit = Edit::of(self);
        self.history = History::new(self.saved_edit.clone());
        if let Some((recovery, note)) = self.restoring.take() {
            self.restore_into_document(recovery, note);
        }
    }

    /// Gives the materials of the scene the albedos that they are to have.
    pub(super) fn paint(&mut self) {
        let Some(document) = &mut self.document else { return };
        if !document::albedos_of(&document.scene).eq(self.albedos.iter().copied()) {
            document.scene = Arc::new(document.scene.repainted(&self.albedos));
            self.paint_generation += 1;
        }
    }

    /// What other threads are doing, for the status bar; solves apart.
    pub fn background_work(&self) -> Option<String> {
        let opening = self.opening.as_ref().map(|(_, task)| task.what());
        let loading = self.loading.as_ref().map(Background::what);
        let saving = self.saving.first().map(Background::what);
        opening.or(loading).or(saving).map(str::to_owned)
    }

    /// Whether a scene is being opened.
    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    /// The running or ended job.
    pub fn job(&self) -> Option<&Job> {
        self.running.as_ref().map(|running| &running.job)
    }

    /// Keeps the light to compare with.
    pub fn keep_light(&mut self) {
        if self.light.is_empty() {
            self.notices.push(Level::Warning, "There is no light to keep yet: solve first");
            return;
        }
        let name = self.computed.as_ref().map_or_else(|| "unfinished".to_owned(), |c| c.label(&self.light));
        self.notices.push(Level::Info, format!("Kept for comparison: {name}"));
        self.kept.push(Kept { name, light: self.light.clone(), id: self.next_kept });
        self.next_kept += 1;
    }

    /// The chosen part of the light at all vertices.
    pub fn selected_light(&self, selection: Selection) -> Vec<glam::Vec3> {
        let n = self.document.as_ref().map_or(0, |d| d.scene.vertex_count());
        self.light.select(selection, n)
    }

    fn forget_light(&mut self) {
        self.light = Light::default();
        self.light_generation += 1;
        self.stats.clear();
        self.computed = None;
    }

    /// Ends the session: stops what runs and leaves unsaved work where the next start finds it.
    pub fn close(&mut self) {
        self.end_solve();
        for task in self.saving.drain(..) {
            // The window is gone; a failure leaves the work to be recovered.
            let _ = task.wait();
        }
        let Some(recovery) = &self.recovery else { return };
        if !(self.has_unsaved_light() || self.has_unsaved_edits()) {
            recovery.remove();
            return;
        }
        let Some(note) = self.note() else { return };
        let solution = self.has_unsaved_light().then(|| self.solution()).flatten();
        // There is nobody left to tell; the checkpoint of the last bounce is still there.
        let _ = recovery.write(&note, solution.as_ref());
    }

    /// Opens the scene of unsaved work that was left behind, and goes on with it.
    pub fn restore(&mut self) {
        if let Some((recovery, note)) = self.left_behind.take() {
            self.open(note.request());
            self.restoring = Some((recovery, note));
        }
    }

    /// Gives up unsaved work that was left behind.
    pub fn discard_left_behind(&mut self) {
        if let Some((recovery, _)) = self.left_behind.take() {
            recovery.remove();
        }
    }
}
