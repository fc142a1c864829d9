//! The program in a window of its own, and waiting for what goes on in the background.

use crate::scenes::write_room;
use eframe::Storage;
use eframe::egui::{Key, ViewportCommand, ViewportId};
use eframe::egui_wgpu::WgpuSetup;
use egui_kittest::Harness;
use lumel::{BounceLimit, SolverKind};
use lumel_render_cpu::Picture;
use lumel_render_gpu::Gpu;
use lumel_view::app::{App, StartUp};
use lumel_view::document::OpenRequest;
use lumel_view::input::Numpad;
use lumel_view::session::Session;
use lumel_view::solver::Phase;
use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longer than anything in the background takes, on a machine with other work too.
const PATIENCE: Duration = Duration::from_secs(240);

/// A window with the program in it, and a folder for its files.
pub(crate) struct Window {
    harness: Harness<'static, App>,
    pub(crate) numpad: Arc<Numpad>,
    folder: Arc<TempDir>,
}

impl Deref for Window {
    type Target = Harness<'static, App>;

    fn deref(&self) -> &Self::Target {
        &self.harness
    }
}

impl DerefMut for Window {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.harness
    }
}

/// How to start the program.
pub(crate) struct Setup {
    /// Of the window, points.
    pub(crate) size: [f32; 2],
    pub(crate) start: StartUp,
    /// What was kept from an earlier run.
    pub(crate) memory: Option<Box<dyn Storage>>,
}

/// Whether there is anything to draw with; a software renderer will do.
fn has_adapter() -> bool {
    static FOUND: LazyLock<Result<(), String>> =
        LazyLock::new(|| Gpu::headless().map(drop).map_err(|e| e.to_string()));
    if let Err(error) = &*FOUND {
        assert!(std::env::var_os("CI").is_none(), "{error}");
        println!("skipped: no adapter");
    }
    FOUND.is_ok()
}

/// A folder for the files of a window.
pub(crate) fn folder() -> Arc<TempDir> {
    Arc::new(tempfile::tempdir().unwrap())
}

impl Window {
    /// Starts the program with nothing open, or as `prepare` says; `None`, and a word about it, where there is no
    /// adapter.
    pub(crate) fn start(folder: Arc<TempDir>, prepare: impl FnOnce(&mut Setup)) -> Option<Self> {
        if !has_adapter() {
            return None;
        }
        let start = StartUp { picture_folder: folder.path().to_owned(), threads: 2, ..StartUp::default() };
        let mut setup = Setup { size: [1280.0, 720.0], start, memory: None };
        prepare(&mut setup);
        let mut wgpu = egui_kittest::wgpu::default_wgpu_setup();
        if let WgpuSetup::CreateNew(new) = &mut wgpu {
            new.device_descriptor = Arc::new(Gpu::device_descriptor);
        }
        let builder = Harness::builder().with_size(setup.size).with_step_dt(1.0 / 60.0).wgpu_setup(wgpu);
        let numpad = Arc::clone(&setup.start.numpad);
        let harness = builder.build_eframe(|cc| {
            cc.storage = setup.memory.map(|memory| &*Box::leak(memory));
            App::new(cc, setup.start).unwrap()
        });
        let mut window = Self { harness, numpad, folder };
        // Most tests are about solves that are asked for.
        window.session().live = false;
        window.wait_for_files();
        Some(window)
    }

    /// With nothing open.
    pub(crate) fn empty() -> Option<Self> {
        Self::start(folder(), |_| {})
    }

    /// With a built-in scene.
    pub(crate) fn builtin(name: &str) -> Option<Self> {
        Self::start(folder(), |setup| setup.start.open = Some(OpenRequest::new(name)))
    }

    /// With the room.
    pub(crate) fn room() -> Option<Self> {
        let folder = folder();
        let room = write_room(folder.path());
        Self::keeping(folder, |setup| setup.start.open = Some(OpenRequest::new(room.to_string_lossy())))
    }

    /// With the room, solved.
    pub(crate) fn solved_room() -> Option<Self> {
        let mut window = Self::room()?;
        window.solve();
        Some(window)
    }

    /// With a place for unsaved work in its folder.
    pub(crate) fn keeping(folder: Arc<TempDir>, prepare: impl FnOnce(&mut Setup)) -> Option<Self> {
        let unsaved = folder.path().join("unsaved");
        Self::start(folder, |setup| {
            setup.start.data_folder = Some(unsaved);
            prepare(setup);
        })
    }

    /// Its folder, for another window.
    pub(crate) fn folder(&self) -> Arc<TempDir> {
        Arc::clone(&self.folder)
    }

    /// Closes it, which keeps unsaved work; its folder, for the next window.
    pub(crate) fn closed(mut self) -> Arc<TempDir> {
        eframe::App::on_exit(self.state_mut());
        self.folder()
    }

    /// A file in its folder.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn session(&mut self) -> &mut Session {
        &mut self.state_mut().session
    }

    /// Steps until a condition holds.
    #[track_caller]
    pub(crate) fn wait_until(&mut self, what: &str, done: impl Fn(&App) -> bool) {
        let begun = Instant::now();
        while !done(self.state()) {
            assert!(begun.elapsed() < PATIENCE, "waited for {what}");
            std::thread::sleep(Duration::from_millis(2));
            self.run_steps(1);
        }
        // What other threads do may be newer than the last frame.
        self.run_steps(1);
    }

    /// Presses Enter and waits until all is solved.
    #[track_caller]
    pub(crate) fn solve(&mut self) {
        self.press(Key::Enter);
        self.wait_until("the solve", |app| {
            app.session.phase().is_none() && app.session.computed().is_some_and(|c| c.complete)
        });
        self.run_steps(2);
    }

    /// Starts a solve whose first bounce takes half a minute, and waits until it is at that.
    #[track_caller]
    pub(crate) fn solve_for_long(&mut self) {
        let settings = &mut self.session().settings;
        (settings.solver, settings.indirect_samples) = (SolverKind::Neumann, 65_536);
        self.press(Key::Enter);
        self.wait_until("the first bounce", |app| app.session.phase() == Some(Phase::Bounce(1)));
    }

    /// Starts a solve of eight bounces and waits until some are finished; more are to come.
    #[track_caller]
    pub(crate) fn solve_bounces(&mut self, finished: usize) {
        let settings = &mut self.session().settings;
        settings.solver = SolverKind::Neumann;
        (settings.indirect_samples, settings.bounces) = (6144, BounceLimit::Count(8));
        self.press(Key::Enter);
        self.wait_until("some bounces", |app| app.session.light.bounces.len() >= finished);
        assert!(self.state().session.is_solving());
    }

    /// Waits for files that are read or written.
    #[track_caller]
    pub(crate) fn wait_for_files(&mut self) {
        self.wait_until("files", |app| app.session.background_work().is_none());
        self.run_steps(2);
    }

    /// Waits until nothing moves any more.
    pub(crate) fn settle(&mut self) {
        std::thread::sleep(Duration::from_millis(230));
        self.run_steps(3);
    }

    /// The picture as it is drawn now, once all is still.
    pub(crate) fn picture(&mut self) -> Picture {
        self.settle();
        self.state().stage.as_ref().unwrap().picture().unwrap()
    }

    /// What the program asked of its window in the last frame.
    pub(crate) fn window_commands(&self) -> &[ViewportCommand] {
        &self.output().viewport_output[&ViewportId::ROOT].commands
    }
}
