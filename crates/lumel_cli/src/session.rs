//! What bakes and measurements have in common: threads, signals, progress and the solve.

use crate::args::{ProgressMode, ThreadArgs};
use crate::checkpoint::Checkpoint;
use crate::console::Console;
use crate::failure::with_hint;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use anyhow::Context;
use lumel::{Baker, Observer, SolveError, SolveState, Step, Workload};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// The threads that everything runs on.
pub(crate) fn thread_pool(args: &ThreadArgs) -> anyhow::Result<ThreadPool> {
    let threads = args.threads.unwrap_or(0) as usize;
    ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start the threads")
}

/// A run of a command that takes its time.
pub(crate) struct Session {
    /// Where messages go.
    pub(crate) console: Arc<Console>,
    /// What the user wants to be stopped.
    pub(crate) interrupt: Interrupt,
    /// What is shown meanwhile.
    pub(crate) progress: Progress,
    /// When it began.
    pub(crate) started: Instant,
}

/// What a solve did.
pub(crate) struct SolveLog {
    /// Each step and its seconds, without those of its checkpoint.
    pub(crate) steps: Vec<(Step, f64)>,
    /// All seconds of the solve but those of checkpoints.
    pub(crate) seconds: f64,
    /// Seconds for checkpoints.
    pub(crate) checkpoint_seconds: f64,
}

impl Session {
    /// Begins.
    pub(crate) fn start(mode: ProgressMode, console: &Arc<Console>) -> anyhow::Result<Self> {
        let started = Instant::now();
        let interrupt = Interrupt::listen(console)?;
        let progress = Progress::start(mode, console, &interrupt);
        Ok(Self { console: Arc::clone(console), interrupt, progress, started })
    }

    /// Runs something under a name. Returns its result and its seconds.
    pub(crate) fn timed<T>(&self, phase: &str, run: impl FnOnce() -> T) -> (T, f64) {
        self.progress.phase(phase);
        let begun = Instant::now();
        let result = run();
        (result, begun.elapsed().as_secs_f64())
    }

    /// Solves, going on from `state`. `Ok(None)` when it was cancelled.
    pub(crate) fn solve(
        &self,
        baker: &Baker,
        state: &mut SolveState,
        checkpoint: Option<&Checkpoint>,
    ) -> anyhow::Result<Option<SolveLog>> {
        self.progress.expect(Workload::new(baker));
        let watch = Watch { baker, progress: &self.progress, checkpoint, notes: Mutex::default() };
        let begun = Instant::now();
        let result = {
            let _heeding = self.interrupt.heed();
            baker.run(state, self.interrupt.control(), &watch)
        };
        let all_seconds = begun.elapsed().as_secs_f64();
        let notes = watch.notes.into_inner().unwrap_or_else(PoisonError::into_inner);
        match result {
            Ok(()) => Ok(Some(SolveLog {
                seconds: all_seconds - notes.checkpoint_seconds,
                steps: notes.steps,
                checkpoint_seconds: notes.checkpoint_seconds,
            })),
            Err(SolveError::Cancelled(_)) => Ok(None),
            Err(error @ SolveError::Memory { needed, .. }) => {
                let hint = format!("allow more, with --memory {}MiB", needed.div_ceil(1 << 20));
                Err(with_hint(anyhow::Error::new(error), hint))
            }
            Err(error) => Err(error.into()),
        }
    }
}

/// Follows a solve.
struct Watch<'a> {
    baker: &'a Baker,
    progress: &'a Progress,
    checkpoint: Option<&'a Checkpoint>,
    notes: Mutex<Notes>,
}

#[derive(Default)]
struct Notes {
    begun: Option<Instant>,
    steps: Vec<(Step, f64)>,
    checkpoint_seconds: f64,
}

impl Observer for Watch<'_> {
    fn step_started(&self, step: Step) {
        self.lock().begun = Some(Instant::now());
        self.progress.step_started(step);
    }

    fn step_done(&self, step: Step, state: &SolveState) {
        let seconds = {
            let mut notes = self.lock();
            let seconds = notes.begun.take().map_or(0.0, |begun| begun.elapsed().as_secs_f64());
            notes.steps.push((step, seconds));
            seconds
        };
        let accuracy = state.errors.as_ref().map(|errors| errors.accuracy);
        self.progress.step_done(step, seconds, self.baker.remainder(state), accuracy);
        if let (Some(checkpoint), Step::Bounce(_) | Step::Round(_)) = (self.checkpoint, step) {
            let begun = Instant::now();
            checkpoint.save(self.baker, state);
            self.lock().checkpoint_seconds += begun.elapsed().as_secs_f64();
        }
    }
}

impl Watch<'_> {
    fn lock(&self) -> std::sync::MutexGuard<'_, Notes> {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
