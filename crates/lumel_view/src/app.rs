//! The window: its parts, its keys and its commands. The work is done by the [`Session`].

use crate::actions::{Action, Actions};
use crate::atlas_view::AtlasView;
use crate::compare::Comparison;
use crate::dialogs::{Dialogs, FileDialog};
use crate::dock::{self, Pane};
use crate::document::{Document, OpenRequest};
use crate::gauges::Gauges;
use crate::heap::keep_freed_memory;
use crate::input::{self, Command, Numpad};
use crate::notice::Level;
use crate::panels::Panels;
use crate::pick::Pick;
use crate::prefs::{Prefs, ViewMode, ViewPrefs};
use crate::relief::UNKNOWN;
use crate::rhythm::{AT_ONCE, Rhythm};
use crate::screenshot;
use crate::selection::Selection;
use crate::session::{Hand, LightUse, SOLUTION_FORMATS, Session, Surroundings};
use crate::sky::SKY_FORMATS;
use crate::stage::Stage;
use crate::theme::{self, Ground};
use crate::viewport::{self, Subject, Viewport};
use crate::wake::{Wake, Wakes};
use crate::widgets::Toasts;
use eframe::egui::{self, ViewportCommand};
use egui_tiles::Tree;
use lumel::{Directional, SamplerKind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The name under which settings are stored.
pub const APP_ID: &str = "lumel-view";

/// How often progress is shown when nothing else changes; new light comes sooner.
const PROGRESS_PERIOD: Duration = Duration::from_millis(700);

const PREFS_KEY: &str = "lumel_view.prefs";
const DOCK_KEY: &str = "lumel_view.dock";

/// How the program was started.
#[derive(Clone, Debug, Default)]
pub struct StartUp {
    /// The scene to open first.
    pub open: Option<OpenRequest>,
    /// Folder for unsaved work; `None` to keep none.
    pub data_folder: Option<PathBuf>,
    /// Folder for screenshots.
    pub picture_folder: PathBuf,
    /// Threads of solves; 0 for all.
    pub threads: usize,
    /// What paints the background of the panels.
    pub ground: Ground,
    /// Set from outside to close the window, keeping unsaved work: Ctrl-C, or the system going down.
    pub quit: Arc<AtomicBool>,
    /// Whether the status bar has memory and frame time.
    pub shows_gauges: bool,
    /// Keys of the number pad, where they are told from digits.
    pub numpad: Arc<Numpad>,
}

/// The program.
pub struct App {
    /// What is open and going on.
    pub session: Session,
    /// What is kept between runs.
    pub prefs: Prefs,
    /// The picture; `None` without a graphics device.
    pub stage: Option<Stage>,
    /// What is asked of the user.
    pub dialogs: Dialogs,
    /// The spot that was clicked.
    pub pick: Option<Pick>,
    /// What is compared.
    pub comparison: Comparison,
    /// Whether panels are shown.
    pub panels_visible: bool,
    actions: Actions,
    viewport: Viewport,
    atlas: AtlasView,
    toasts: Toasts,
    picture_folder: PathBuf,
    ground: Ground,
    quit: Arc<AtomicBool>,
    numpad: Arc<Numpad>,
    gauges: Option<Gauges>,
    rhythm: Arc<Rhythm>,
    dock: Tree<Pane>,
}

impl App {
    /// The program in a new window.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(cc: &eframe::CreationContext<'_>, start: StartUp) -> Result<Self, String> {
        theme::apply(&cc.egui_ctx);
        let stored = |key| cc.storage.and_then(|storage| storage.get_string(key));
        let prefs: Prefs =
            stored(PREFS_KEY).and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let prefs = prefs.checked();
        let tree = stored(DOCK_KEY).and_then(|text| serde_json::from_str(&text).ok());
        let ctx = cc.egui_ctx.clone();
        let rhythm = Arc::new(Rhythm::new());
        let (glimpsed, beat) = (ctx.clone(), Arc::clone(&rhythm));
        // Without a delay egui draws two frames, and each is expensive on a software renderer.
        let wake: Wake = Arc::new(move || ctx.request_repaint_after(AT_ONCE));
        let glimpse: Wake = Arc::new(move || glimpsed.request_repaint_after(beat.until_next()));
        let mut session = Session::new(Surroundings {
            data_folder: start.data_folder,
            threads: start.threads,
            wakes: Wakes { event: wake, glimpse },
        })?;
        (session.settings, session.live) = (prefs.settings.clone(), prefs.live);
        session.lumels = prefs.lumels;
        let stage = cc.wgpu_render_state.clone().map(Stage::new);
        match &stage {
            Some(stage) if stage.gpu().is_software() => {
                if !keep_freed_memory() {
                    log::debug!("memory of frames is given back to the system each time");
                }
                let text =
                    format!("Software renderer: {}. A graphics driver would be faster.", stage.gpu().name());
                session.notices.log(Level::Warning, text);
            }
            Some(stage) => session.notices.log(Level::Info, format!("Drawing with {}", stage.gpu().name())),
            None => session.notices.push(Level::Error, "No graphics device: the scene cannot be shown"),
        }
        if let Some(request) = start.open {
            session.open(request);
        }
        Ok(Self {
            session,
            prefs,
            stage,
            dialogs: Dialogs::default(),
            pick: None,
            comparison: Comparison::default(),
            panels_visible: true,
            actions: Actions::default(),
            viewport: Viewport::default(),
            atlas: AtlasView::default(),
            toasts: Toasts::default(),
            picture_folder: start.picture_folder,
            ground: start.ground,
            quit: start.quit,
            numpad: start.numpad,
            gauges: start.shows_gauges.then(Gauges::default),
            rhythm,
            dock: tree.filter(dock::is_whole).unwrap_or_else(dock::default_tree),
        })
    }

    /// How the picture is drawn.
    pub fn view(&self) -> &ViewPrefs {
        &self.prefs.view
    }

    /// Opens a scene; asks first if work would be lost.
    pub fn open(&mut self, request: OpenRequest) {
        match self.session.objection() {
            Some(objection) => self.dialogs.ask(objection, request),
            None => self.session.open(request),
        }
    }

    /// Arranges the panels as they were at first.
    pub fn reset_panels(&mut self) {
        self.dock = dock::default_tree();
        self.panels_visible = true;
    }

    /// Brings a panel to the front.
    pub fn show_panel(&mut self, pane: Pane) {
        self.panels_visible = true;
        dock::focus(&mut self.dock, pane);
    }

    /// Runs a command.
    pub fn run(&mut self, command: Command, ctx: &egui::Context) {
        match command {
            Command::Open => self.dialogs.open(FileDialog::open_scene(&self.session)),
            Command::Reload => {
                if let Some(request) = self.session.document.as_ref().map(|d| d.request.clone()) {
                    self.open(request);
                }
            }
            Command::SaveMesh => {
                let view = &self.prefs.view;
                let stops = self.stage.as_ref().map_or(0.0, |stage| stage.stops(view));
                self.dialogs.open(FileDialog::save_mesh(&self.session, view.selection, stops));
            }
            Command::SaveProject => self.save_project(),
            Command::SaveProjectAs => self.dialogs.open(FileDialog::save_project(&self.session)),
            Command::LoadSolution => self.dialogs.open(FileDialog::load_solution(&self.session)),
            Command::CompareSolution => self.dialogs.open(FileDialog::compare_solution(&self.session)),
            Command::LoadSky => self.dialogs.open(FileDialog::load_sky(&self.session)),
            Command::SaveSolution => self.dialogs.open(FileDialog::save_solution(&self.session)),
            Command::SaveLightmap => self.dialogs.open(FileDialog::save_lightmap(&self.session)),
            Command::Screenshot => {
                let (stage, view) = (self.stage.as_ref(), &self.prefs.view);
                screenshot::from_window(&mut self.session, stage, view, &self.picture_folder);
            }
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => self.session.undo(),
            Command::Redo => self.session.redo(),
            Command::PlaceLight => self.session.place_light(),
            Command::AddLight => self.session.add_light(),
            Command::RemoveLight => self.session.remove_light(),
            Command::ToggleLight => self.session.toggle_light(),
            Command::NextLight => self.session.next_light(),
            Command::AimLight => self.aim_light(),
            Command::Frame => viewport::frame(&mut self.session, self.pick.as_ref(), self.viewport.aspect()),
            Command::View(side) => {
                viewport::view_from(&mut self.session, self.pick.as_ref(), self.viewport.aspect(), side);
            }
            Command::Parallel => {
                viewport::toggle_parallel(&mut self.session, self.pick.as_ref(), self.viewport.aspect());
            }
            Command::AlignUp => self.session.camera.align_up(),
            Command::ResetCamera => self.session.reset_camera(),
            Command::Solve => self.session.solve(),
            Command::SolveAnew => self.session.solve_anew(),
            Command::Stop => self.escape(),
            Command::ToggleQmc => self.toggle_qmc(),
            Command::ShowAll => self.prefs.view.selection = Selection::All,
            Command::ShowDirect => self.prefs.view.selection = Selection::DIRECT,
            Command::ShowIndirect => self.prefs.view.selection = Selection::Indirect,
            Command::PreviousBounce => self.step_bounce(-1),
            Command::NextBounce => self.step_bounce(1),
            Command::Wireframe => self.prefs.view.wireframe = !self.prefs.view.wireframe,
            Command::LumelGrid => self.prefs.view.grid = !self.prefs.view.grid,
            Command::Show(mode) => {
                let shown = &mut self.prefs.view.mode;
                *shown = if *shown == mode { ViewMode::default() } else { mode };
            }
            Command::Relief | Command::SplitRelief if self.session.directional() == Directional::Off => {
                self.session.notices.push(Level::Warning, UNKNOWN);
            }
            Command::Relief => self.prefs.view.relief.on = !self.prefs.view.relief.on,
            Command::SplitRelief => {
                self.prefs.view.relief.on = true;
                self.comparison.toggle_smooth();
            }
            Command::Shooters => self.prefs.view.shooters = !self.prefs.view.shooters,
            Command::Ambient => self.prefs.view.ambient = !self.prefs.view.ambient,
            Command::KeepLight => self.comparison.keep(&mut self.session),
            Command::Split => self.comparison.toggle(&self.session),
            Command::Help => self.dialogs.toggle_help(),
            Command::Panels => self.panels_visible = !self.panels_visible,
            Command::FullScreen => {
                let full = ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!full));
            }
            Command::SaveSlot(digit) => self.session.save_slot(digit),
            Command::RecallSlot(digit) => self.session.recall_slot(digit),
        }
    }

    fn save_project(&mut self) {
        let path =
            self.session.document.as_ref().and_then(|d| d.project.as_ref()).map(|(path, _)| path.clone());
        match path {
            Some(path) => {
                if let Err(problem) = self.session.save_project(&path) {
                    self.session.notices.push(Level::Error, format!("Cannot save the project: {problem}"));
                }
            }
            None => self.dialogs.open(FileDialog::save_project(&self.session)),
        }
    }

    fn aim_light(&mut self) {
        match viewport::focus(&self.session, self.pick.as_ref(), self.viewport.aspect()) {
            Some(at) => self.session.aim_light(at),
            None => self.session.notices.push(Level::Warning, "Open a scene first"),
        }
    }

    /// Closes a dialog, else stops the solve, else clears the picked spot.
    fn escape(&mut self) {
        if self.dialogs.close_top() {
            return;
        }
        if self.session.phase().is_some() {
            self.session.stop();
        } else {
            self.pick = None;
        }
    }

    fn toggle_qmc(&mut self) {
        let sampler = &mut self.session.settings.sampler;
        *sampler = if *sampler == SamplerKind::Random { SamplerKind::Sobol } else { SamplerKind::Random };
        let text = format!("Sampler: {}", self.session.settings.sampler);
        self.session.notices.push(Level::Info, text);
    }

    /// Shows the bounce before or after the one that is shown.
    fn step_bounce(&mut self, step: i64) {
        let last = (self.session.light.bounce_count() as i64 - 1).max(0);
        let shown = match self.prefs.view.selection {
            Selection::Range(first, to) => i64::from(if step < 0 { first } else { to }),
            Selection::All | Selection::Indirect if step < 0 => last + 1,
            Selection::All | Selection::Indirect => -1,
        };
        self.prefs.view.selection = Selection::bounce((shown + step).clamp(0, last) as u32);
    }

    /// Opens files that were dropped on the window.
    fn take_dropped(&mut self, ctx: &egui::Context) {
        let files: Vec<PathBuf> =
            ctx.input(|i| i.raw.dropped_files.iter().map(|file| file.path().to_path_buf()).collect());
        for path in files {
            let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            if SOLUTION_FORMATS.contains(&extension.as_str()) {
                self.session.load_solution(&path, LightUse::Show);
            } else if SKY_FORMATS.contains(&extension.as_str()) {
                self.session.load_sky(&path);
            } else {
                self.open(OpenRequest::new(path.to_string_lossy()));
            }
        }
    }

    fn handle_keys(&mut self, ctx: &egui::Context) {
        self.viewport.release_keys(|key| ctx.input(|i| i.key_down(key)));
        // Keys belong to whoever writes a text.
        let pressed = ctx.input(|i| input::pressed(i, &self.numpad));
        if ctx.text_edit_focused() {
            return;
        }
        let focused = ctx.memory(|memory| memory.focused());
        let elsewhere = focused.is_some() && focused != self.viewport.id();
        for (command, key) in pressed {
            // Space and Enter press the button that has the focus, Delete is for texts and tables.
            let belongs_to_widget = elsewhere && matches!(key, egui::Key::Space | egui::Key::Enter);
            // In flight Ctrl is for flying slowly, also where S or Q with it would do something.
            let flies = self.viewport.is_flying() && input::is_motion(key);
            let modal = self.dialogs.is_any_open() && !matches!(command, Command::Stop | Command::Help);
            if belongs_to_widget || modal || flies {
                continue;
            }
            self.viewport.spend(key);
            self.run(command, ctx);
        }
    }

    fn main_area(&mut self, ui: &mut egui::Ui) {
        let subject = Subject {
            session: &mut self.session,
            prefs: &mut self.prefs,
            stage: self.stage.as_mut(),
            comparison: &mut self.comparison,
            pick: &mut self.pick,
            actions: &mut self.actions,
            in_dialog: self.dialogs.is_any_open(),
        };
        let (viewport, atlas) = (&mut self.viewport, &mut self.atlas);
        let mut panels =
            Panels { subject, viewport, atlas, gauges: self.gauges.as_ref(), ground: self.ground };
        if self.panels_visible { panels.all(&mut self.dock, ui) } else { panels.picture(ui) }
    }

    /// Runs the queued actions.
    fn do_actions(&mut self, ctx: &egui::Context) {
        for action in self.actions.take() {
            match action {
                Action::Run(command) => self.run(command, ctx),
                Action::Open(request) => self.open(request),
                Action::ShowPanel(pane) => self.show_panel(pane),
                Action::ArrangePanels => self.reset_panels(),
            }
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        if self.quit.load(Ordering::Relaxed) {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        for problem in self.stage.iter().flat_map(Stage::take_problems) {
            self.session.notices.push(Level::Error, format!("The graphics device failed: {problem}"));
        }
        let busy = ctx.input(|i| i.pointer.any_down()) || ctx.text_edit_focused();
        let (opened, mesh) = (self.session.document_generation, self.session.mesh_generation);
        self.session.poll(if busy { Hand::Busy } else { Hand::Free });
        if self.session.document_generation != opened {
            self.pick = None;
            self.comparison = Comparison::default();
            if let Some(document) = &self.session.document {
                let name = document.request.name.clone();
                let title = format!("{} - lumel", document.request.title());
                self.prefs.opened(&name);
                ctx.send_viewport_cmd(ViewportCommand::Title(title));
            }
        }
        if self.session.mesh_generation != mesh {
            let mesh = self.session.document.as_ref().map(Document::mesh);
            let spot = self.pick.take().zip(mesh).and_then(|(pick, mesh)| pick.spot.on(&mesh));
            self.pick = spot.map(Pick::new);
        }
        if let Some(pick) = &mut self.pick {
            pick.measure(self.session.computed().and_then(|c| c.solved.as_ref()), self.session.wake());
            pick.poll();
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        if let Some(gauges) = &mut self.gauges {
            gauges.update(frame.info().cpu_usage);
        }
        self.take_dropped(&ctx);
        self.handle_keys(&ctx);
        self.main_area(ui);
        self.do_actions(&ctx);
        self.dialogs.show(&mut self.session, &self.prefs, &mut self.actions, &ctx);
        self.do_actions(&ctx);
        self.dialogs.show_question(&mut self.session, &ctx);
        self.toasts.add(self.session.notices.take_fresh());
        self.toasts.show(&ctx, self.viewport.area());
        let software = self.stage.as_ref().is_some_and(|stage| stage.gpu().is_software());
        self.rhythm.frame(software, ctx.input(|i| !i.events.is_empty()));
        if self.session.phase().is_some() {
            // Progress is shown while nothing else changes.
            ctx.request_repaint_after(self.rhythm.until_next().max(PROGRESS_PERIOD));
        }
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::PANEL.to_normalized_gamma_f32()
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        (self.prefs.settings, self.prefs.live) = (self.session.settings.clone(), self.session.live);
        self.prefs.lumels = self.session.lumels;
        for (key, text) in
            [(PREFS_KEY, serde_json::to_string(&self.prefs)), (DOCK_KEY, serde_json::to_string(&self.dock))]
        {
            if let Ok(text) = text {
                storage.set_string(key, text);
            }
        }
    }

    fn on_exit(&mut self) {
        self.session.close();
    }
}
