//! A solve on a thread of its own.

use super::published::{Ending, Phase, Published, Shared, lock};
use super::run::run;
use super::task::{Keep, Solved, Task, Work};
use crate::wake::Wakes;
use lumel::{Baker, Control, Progress, RefinementState, Settings};
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;

const BUG: &str = "this is a bug in lumel; please report it with the scene and the settings";

/// A running or ended job.
pub struct SolveJob {
    control: Arc<Control>,
    shared: Arc<Shared>,
    settings: Settings,
    thread: Option<JoinHandle<()>>,
}

impl SolveJob {
    /// Starts a job on the threads of a pool; `keep` is called after each bounce of a solve.
    pub fn start(task: Task, work: Work, pool: Arc<ThreadPool>, keep: Keep, wakes: Wakes) -> Self {
        let control = Arc::new(Control::default());
        let shared = Arc::new(Shared::new(wakes, task.cloud.clone()));
        let settings = task.settings.clone();
        let thread = {
            let (control, shared) = (Arc::clone(&control), Arc::clone(&shared));
            std::thread::spawn(move || {
                let run = AssertUnwindSafe(|| pool.install(|| run(&task, work, &control, &shared, &keep)));
                // A panic is a bug in lumel; it must not take the window and its unsaved work with it.
                let ending = catch_unwind(run).unwrap_or_else(|_| Ending::Failed(BUG.to_owned()));
                shared.publish_phase(Phase::Ended(ending));
            })
        };
        Self { control, shared, settings, thread: Some(thread) }
    }

    /// Asks it to stop.
    pub fn stop(&self) {
        self.control.cancel();
    }

    /// Whether it was asked to stop.
    pub fn is_stopping(&self) -> bool {
        self.control.is_cancelled()
    }

    /// Waits until it has ended.
    pub fn join(&mut self) {
        if let Some(thread) = self.thread.take() {
            // Its panics are caught and told as its ending.
            let _ = thread.join();
        }
    }

    /// The settings it was started with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What can be seen now; cheap, the light is shared.
    pub fn published(&self) -> Published {
        lock(&self.shared.published).clone()
    }

    /// The generation of the light and the phase, without the light.
    pub fn glance(&self) -> (u64, Phase) {
        let published = lock(&self.shared.published);
        (published.generation, published.phase.clone())
    }

    /// How it ended; `None` while it runs.
    pub fn ending(&self) -> Option<Ending> {
        match &lock(&self.shared.published).phase {
            Phase::Ended(ending) => Some(ending.clone()),
            _ => None,
        }
    }

    /// What it has computed, once it has ended.
    pub fn solved(&self) -> Option<Arc<Solved>> {
        lock(&self.shared.solved).clone()
    }

    /// The mesh that is refined, once it was read.
    pub fn given(&self) -> Option<Arc<Baker>> {
        lock(&self.shared.given).clone()
    }

    /// What its refinement goes on with, if it was stopped in it.
    pub fn refinement(&self) -> Option<RefinementState> {
        lock(&self.shared.refinement).clone()
    }

    /// How many vertices its mesh was allowed, where light needs more.
    pub fn vertices_missing(&self) -> Option<usize> {
        *lock(&self.shared.vertices_missing)
    }

    /// How far its solve is.
    pub fn progress(&self) -> Progress {
        let now = self.shared.reading(&self.control);
        lock(&self.shared.tracker).as_ref().map_or_else(Progress::default, |tracker| tracker.progress(now))
    }

    /// Seconds since it began.
    pub fn seconds(&self) -> f64 {
        self.shared.begun.elapsed().as_secs_f64()
    }
}

impl Drop for SolveJob {
    fn drop(&mut self) {
        self.stop();
        self.join();
    }
}
