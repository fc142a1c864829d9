//! Everything that is open or running, without a window: what panels show and commands change.
//!
//! Nothing here blocks. Scenes are opened, solves run and files are written on other threads; [`Session::poll`]
//! collects their results. Ask [`Session::objection`] before a change that would lose unsaved work.

mod computed;
mod courses;
mod directions;
mod edit;
mod editing;
mod file_light;
mod files;
mod kept;
mod lightmap_files;
mod live;
mod lumels;
mod meshes;
mod opening;
mod outcome;
mod outdated;
mod running;
mod skies;
mod solve;
mod unsaved;

pub use computed::Computed;
pub use courses::{Course, Courses};
pub use file_light::{LightUse, LoadedLight, SavedFile, light_from};
pub use files::{MESH_FORMATS, MeshExport, SOLUTION_FORMATS, load_light};
pub use kept::Kept;
pub use lightmap_files::LIGHTMAP_FORMATS;

use crate::camera::FlyCamera;
use crate::document::{self, Contents, Document, OpenRequest};
use crate::history::History;
use crate::inputs::Inputs;
use crate::layout::LumelSettings;
use crate::lights::EditLight;
use crate::notice::Notices;
use crate::recovery::{LeftBehind, Recovery};
use crate::selection::{Illumination, Selection};
use crate::sky::EditSky;
use crate::slots::Slots;
use crate::solver::{BounceStats, SolveJob};
use crate::task::Background;
use crate::unshot::Unshot;
use crate::wake::{Wake, Wakes};
use edit::Edit;
use glam::Vec3;
use lumel::Settings;
use lumels::Lightmapping;
use rayon::ThreadPool;
use running::Running;
use skies::LoadedSky;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// Whether an edit is in progress, such as the drag of a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// An edit is in progress.
    Busy,
    /// No edit is in progress.
    Free,
}

/// A scene and everything that is done with it.
pub struct Session {
    /// The open scene.
    pub document: Option<Document>,
    /// Changes with the document.
    pub document_generation: u64,
    /// Changes with the triangles that are shown.
    pub mesh_generation: u64,
    /// Rectangle lights.
    pub lights: Vec<EditLight>,
    /// Light from outside the scene.
    pub sky: EditSky,
    /// The albedo of each material.
    pub albedos: Vec<Vec3>,
    /// Changes with the albedos and the sky that are shown.
    pub paint_generation: u64,
    /// The active light, an index into `lights`.
    pub active: usize,
    /// Settings of the next solve.
    pub settings: Settings,
    /// Whether there is to be a lightmap, and how fine.
    pub lumels: LumelSettings,
    /// Changes with the lumels and their light.
    pub lumel_generation: u64,
    /// Whether the light follows changes of the lights at once, where all rays are stored.
    pub live: bool,
    /// The names of the materials with waves over them.
    pub rippled: BTreeSet<String>,
    /// Numbered states.
    pub slots: Slots,
    /// The view.
    pub camera: FlyCamera,
    /// Light on the surfaces, as far as it is known.
    pub light: Illumination,
    /// Changes with the light.
    pub light_generation: u64,
    /// What each bounce brought.
    pub stats: Vec<BounceStats>,
    /// How the last two solves went, by time.
    pub courses: Courses,
    unshot: Option<Arc<Unshot>>,
    /// Light to compare with.
    pub kept: Vec<Kept>,
    /// Messages to the user.
    pub notices: Notices,
    /// Unsaved work of an earlier run that can be restored.
    pub left_behind: Option<LeftBehind>,
    computed: Option<Computed>,
    /// What the triangles that are shown were refined for.
    refined_for: Option<Inputs>,
    history: History<Edit>,
    saved_edit: Edit,
    lightmapping: Lightmapping,
    running: Option<Running>,
    opening: Option<Opening>,
    /// A scene to open once what is open is saved.
    waiting: Option<OpenRequest>,
    restoring: Option<LeftBehind>,
    loading: Option<Background<LoadedLight>>,
    loading_sky: Option<Background<LoadedSky>>,
    saving: Vec<Background<SavedFile>>,
    next_kept: u64,
    recovery: Option<Recovery>,
    pool: Arc<ThreadPool>,
    wakes: Wakes,
}

/// A scene that is being opened.
struct Opening {
    request: OpenRequest,
    task: Background<(Document, Contents)>,
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
            mesh_generation: 0,
            lights: Vec::new(),
            sky: EditSky::default(),
            albedos: Vec::new(),
            paint_generation: 0,
            active: 0,
            settings: Settings::default(),
            lumels: LumelSettings::default(),
            lumel_generation: 0,
            live: true,
            rippled: BTreeSet::new(),
            slots: Slots::default(),
            camera: FlyCamera::default(),
            light: Illumination::default(),
            light_generation: 0,
            stats: Vec::new(),
            courses: Courses::default(),
            unshot: None,
            kept: Vec::new(),
            notices: Notices::default(),
            left_behind: folder.and_then(|folder| Recovery::left_behind(folder).into_iter().next()),
            computed: None,
            refined_for: None,
            history: History::new(Edit::default()),
            saved_edit: Edit::default(),
            lightmapping: Lightmapping::default(),
            running: None,
            opening: None,
            waiting: None,
            restoring: None,
            loading: None,
            loading_sky: None,
            saving: Vec::new(),
            next_kept: 0,
            recovery: folder.map(Recovery::of_this_process),
            pool: Arc::new(pool),
            wakes: surroundings.wakes,
        })
    }

    /// Collects the results of other threads. Call it before drawing each frame.
    pub fn poll(&mut self, hand: Hand) {
        self.poll_opening();
        self.poll_files();
        self.paint();
        self.poll_solve(hand);
        self.follow_reading();
        self.follow_changes(hand);
        self.follow_lumels(hand);
        if hand == Hand::Free {
            self.history.commit(&self.edit());
        }
    }

    /// Applies the edited albedos and the edited sky to the scene.
    fn paint(&mut self) {
        let Some(document) = &mut self.document else { return };
        if !document::albedos_of(&document.scene).eq(self.albedos.iter().copied()) {
            document.scene = Arc::new(document.scene.repainted(&self.albedos));
            self.paint_generation += 1;
        }
        if *document.scene.sky() != self.sky.sky
            && let Ok(scene) = document.scene.under_sky(self.sky.sky.clone())
        {
            document.scene = Arc::new(scene);
            self.paint_generation += 1;
        }
    }

    /// What the light was computed from.
    pub fn computed(&self) -> Option<&Computed> {
        self.computed.as_ref()
    }

    /// What other threads are doing, for the status bar; solves apart.
    pub fn background_work(&self) -> Option<String> {
        let opening = self.opening.as_ref().map(|opening| opening.task.what());
        let loading = self.loading.as_ref().map(Background::what);
        let loading_sky = self.loading_sky.as_ref().map(Background::what);
        let saving = self.saving.first().map(Background::what);
        opening.or(loading).or(loading_sky).or(saving).or(self.unwrapping()).map(str::to_owned)
    }

    /// What wakes the window when work on another thread is done.
    pub fn wake(&self) -> &Wake {
        &self.wakes.event
    }

    /// The running or ended job.
    pub fn job(&self) -> Option<&SolveJob> {
        self.running.as_ref().map(|running| &running.job)
    }

    /// The chosen part of the light at all vertices.
    pub fn selected_light(&self, selection: Selection) -> Vec<glam::Vec3> {
        let n = self.document.as_ref().map_or(0, |d| d.scene.vertex_count());
        self.light.select(selection, n)
    }

    /// What of the light is still to be reflected, where this session has computed it.
    pub fn unshot(&self) -> Option<&Unshot> {
        self.unshot.as_deref()
    }

    /// Whether each bounce of the light that is shown is known by itself.
    pub fn tells_bounces(&self) -> bool {
        self.computed.as_ref().and_then(Computed::settings).is_none_or(Settings::tells_bounces)
    }

    /// The same with what it would bring: the ambient term. `None` where a solve is finished.
    pub fn to_come(&self) -> Option<&Unshot> {
        let is_complete = self.computed.as_ref().is_some_and(|computed| computed.complete);
        self.unshot().filter(|_| !is_complete)
    }

    fn forget_light(&mut self) {
        self.light = Illumination::default();
        self.light_generation += 1;
        self.stats.clear();
        self.unshot = None;
        self.computed = None;
        self.forget_lumels();
    }
}
