//! What bakes and measurements share: threads, signals, progress and the solve.

use crate::args::{ProgressMode, ThreadArgs};
use crate::checkpoint::Checkpoint;
use crate::clock::Clock;
use crate::console::Console;
use crate::failure::with_hint;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use anyhow::Context;
use lumel::{
    Adaptive, Baker, Observer, Reading, RefinementEnd, RefinementState, Refining, SolveError, SolveState,
    Step, Tracker, TransportError,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The threads that everything runs on.
pub(crate) fn thread_pool(args: &ThreadArgs) -> anyhow::Result<ThreadPool> {
    let threads = args.threads.unwrap_or(0) as usize;
    ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start the threads")
}

/// A run of a long command.
pub(crate) struct CommandRun {
    /// Where messages go.
    pub(crate) console: Arc<Console>,
    /// Requests to stop.
    pub(crate) interrupt: Interrupt,
    /// The progress display.
    pub(crate) progress: Progress,
    /// Its time.
    pub(crate) clock: Clock,
}

/// Checkpoints take about this share of the time of a solve at most.
pub(crate) const CHECKPOINT_SHARE: f64 = 0.1;

/// How a mesh was refined.
#[derive(Debug, Serialize)]
pub(crate) struct AdaptiveReport {
    /// What light may differ by from a linear function, relative.
    pub(crate) error: f32,
    /// Vertices before.
    pub(crate) given_vertices: usize,
    /// Whether it does not differ by more, as far as was measured, or edges are as short as they become.
    pub(crate) reached: bool,
    pub(crate) seconds: f64,
}

/// What a solve did.
pub(crate) struct SolveLog {
    /// Each step and its seconds, without its checkpoint.
    pub(crate) steps: Vec<(Step, f64)>,
    /// Seconds of the solve without checkpoints.
    pub(crate) seconds: f64,
    /// Seconds for checkpoints.
    pub(crate) checkpoint_seconds: f64,
}

impl CommandRun {
    /// Starts a run.
    pub(crate) fn start(mode: ProgressMode, console: &Arc<Console>) -> anyhow::Result<Self> {
        let clock = Clock::start();
        let interrupt = Interrupt::listen(console)?;
        let progress = Progress::start(mode, console, &interrupt, clock);
        Ok(Self { console: Arc::clone(console), interrupt, progress, clock })
    }

    /// Runs something under a name. Returns its result and its seconds.
    pub(crate) fn timed<T>(&self, phase: &str, run: impl FnOnce() -> T) -> (T, f64) {
        self.progress.phase(phase);
        let begun = self.clock.seconds();
        let result = run();
        (result, self.clock.seconds() - begun)
    }

    /// Splits edges where light needs it, if the settings say so, from `state` on. `Ok(None)` if cancelled.
    pub(crate) fn adapt(
        &self,
        baker: Baker,
        state: Option<&RefinementState>,
        checkpoint: Option<&Checkpoint>,
    ) -> anyhow::Result<Option<(Baker, Option<AdaptiveReport>)>> {
        let Adaptive::At(error) = baker.settings().adaptive else { return Ok(Some((baker, None))) };
        let (adapted, seconds) = self.timed("refine", || {
            let _heeding = self.interrupt.heed();
            let mut tell = |refining: &Refining<'_>| {
                self.progress.phase(&format!("refine, {} vertices", refining.mesh().vertex_count()));
                if let Some((checkpoint, state)) = checkpoint.zip(refining.state()) {
                    checkpoint.save_refinement(&baker, state);
                }
            };
            baker.adapted_from(state, self.interrupt.control(), &mut tell)
        });
        match adapted {
            Ok(None) => Ok(Some((baker, None))),
            Ok(Some(adapted)) => {
                let (given, limit) = (baker.scene().vertex_count(), baker.settings().max_vertices);
                if adapted.ended == RefinementEnd::Vertices {
                    self.console.warning(&format!(
                        "the mesh does not follow light to {error} everywhere: that takes more than {limit} vertices; raise \
                         --max-vertices"
                    ));
                }
                let report = AdaptiveReport {
                    error: error.get(),
                    given_vertices: given,
                    reached: adapted.ended == RefinementEnd::Reached,
                    seconds,
                };
                Ok(Some((adapted.baker, Some(report))))
            }
            Err(SolveError::Cancelled) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Solves, resuming from `state`. `Ok(None)` if cancelled.
    pub(crate) fn solve(
        &self,
        baker: &Baker,
        state: &mut SolveState,
        checkpoint: Option<&Checkpoint>,
    ) -> anyhow::Result<Option<SolveLog>> {
        let tracker = Arc::new(Mutex::new(Tracker::new(baker, state)));
        let started = self.clock.seconds();
        let watch =
            Watch { run: self, baker, checkpoint, started, tracker, checkpoint_seconds: Mutex::default() };
        let begun = self.clock.seconds();
        let result = {
            let _heeding = self.interrupt.heed();
            baker.run(state, self.interrupt.control(), &watch)
        };
        let seconds = self.clock.seconds() - begun;
        let checkpoint_seconds = *lock(&watch.checkpoint_seconds);
        match result {
            Ok(()) => {
                let steps = lock(&watch.tracker).steps().to_vec();
                Ok(Some(SolveLog { steps, seconds: seconds - checkpoint_seconds, checkpoint_seconds }))
            }
            Err(SolveError::Cancelled) => Ok(None),
            Err(error @ SolveError::Memory { needed, .. }) => {
                let hint = format!("allow more, with --memory {}MiB", needed.div_ceil(1 << 20));
                Err(with_hint(anyhow::Error::new(error), hint))
            }
            Err(error) => Err(error.into()),
        }
    }
}

/// What was measured; `None` if it was cancelled.
pub(crate) fn unless_stopped<T>(measured: Result<T, TransportError>) -> anyhow::Result<Option<T>> {
    match measured {
        Ok(measured) => Ok(Some(measured)),
        Err(TransportError::Cancelled) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Observes a solve.
struct Watch<'a> {
    run: &'a CommandRun,
    baker: &'a Baker,
    checkpoint: Option<&'a Checkpoint>,
    /// When the solve began, seconds.
    started: f64,
    tracker: Arc<Mutex<Tracker>>,
    checkpoint_seconds: Mutex<f64>,
}

impl Watch<'_> {
    fn reading(&self) -> Reading {
        Reading::new(self.run.interrupt.control(), self.run.clock.seconds())
    }
}

impl Observer for Watch<'_> {
    fn step_started(&self, step: Step) {
        lock(&self.tracker).step_started(step, self.reading());
        self.run.progress.step_started(step, &self.tracker);
    }

    fn step_done(&self, step: Step, state: &SolveState) {
        let now = self.reading();
        let remainder = self.baker.remainder(state);
        let accuracy = state.errors.as_ref().map(|errors| errors.accuracy);
        let seconds = lock(&self.tracker).step_done(step, remainder, accuracy, now);
        self.run.progress.step_done(step, seconds, remainder, accuracy);
        if let (Some(checkpoint), Step::Bounce(_) | Step::Shot(_) | Step::Round(_)) = (self.checkpoint, step)
        {
            let begun = self.run.clock.seconds();
            let mut spent = lock(&self.checkpoint_seconds);
            // Later bounces take less time than it takes to write all of them once more.
            if matches!(step, Step::Bounce(0)) || *spent <= CHECKPOINT_SHARE * (begun - self.started) {
                checkpoint.save(self.baker, state, None);
                *spent += self.run.clock.seconds() - begun;
            } else {
                checkpoint.outdated();
            }
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
