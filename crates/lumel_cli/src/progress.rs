//! Progress, as a bar, as text and as JSON.

use crate::args::ProgressMode;
use crate::clock::Clock;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::report;
use indicatif::{ProgressBar, ProgressStyle};
use lumel::{Accuracy, Reading, Step, Tracker};
use serde_json::{Value, json};
use std::io::{self, IsTerminal};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Steps of the bar: enough for smooth movement.
const BAR_STEPS: u64 = 1000;

/// How progress is shown.
enum Display {
    Bar(ProgressBar),
    Lines,
    Json,
}

/// Shows progress from its own thread until it is dropped.
pub(crate) struct Progress {
    shared: Option<Arc<Shared>>,
    ticker: Option<JoinHandle<()>>,
}

struct Shared {
    display: Display,
    console: Arc<Console>,
    interrupt: Interrupt,
    clock: Clock,
    state: Mutex<State>,
    ended: Condvar,
}

/// The current activity.
#[derive(Default)]
struct State {
    ended: bool,
    phase: String,
    /// Follows the solve, while the phase is one of its steps.
    tracker: Option<Arc<Mutex<Tracker>>>,
    /// Share of the phase that is done, where it is no step of a solve.
    share: Option<f64>,
    /// The last phase that was reported by name only.
    told: Option<String>,
}

impl Progress {
    /// Begins to show progress.
    pub(crate) fn start(
        mode: ProgressMode,
        console: &Arc<Console>,
        interrupt: &Interrupt,
        clock: Clock,
    ) -> Self {
        let (display, interval) = match mode {
            ProgressMode::None => return Self { shared: None, ticker: None },
            ProgressMode::Auto if io::stderr().is_terminal() => {
                (Display::Bar(new_bar()), Duration::from_millis(100))
            }
            ProgressMode::Auto | ProgressMode::Plain => (Display::Lines, Duration::from_secs(4)),
            ProgressMode::Json => (Display::Json, Duration::from_millis(500)),
        };
        if let Display::Bar(bar) = &display {
            console.set_bar(Some(bar.clone()));
        }
        let shared = Arc::new(Shared {
            display,
            console: Arc::clone(console),
            interrupt: interrupt.clone(),
            clock,
            state: Mutex::default(),
            ended: Condvar::new(),
        });
        let ticking = Arc::clone(&shared);
        // If no thread can be started, there is no display.
        let ticker =
            std::thread::Builder::new().name("progress".into()).spawn(move || ticking.tick(interval));
        Self { shared: Some(shared), ticker: ticker.ok() }
    }

    /// A phase outside the solve begins, such as "build".
    pub(crate) fn phase(&self, name: &str) {
        if let Some(shared) = &self.shared {
            shared.enter(name.to_owned(), None);
        }
    }

    /// So much of the phase is done.
    pub(crate) fn share(&self, share: Option<f64>) {
        if let Some(shared) = &self.shared {
            shared.lock().share = share;
        }
    }

    /// A step of a solve begins, which the tracker knows of.
    pub(crate) fn step_started(&self, step: Step, tracker: &Arc<Mutex<Tracker>>) {
        if let Some(shared) = &self.shared {
            let progress = lock(tracker).progress(shared.reading());
            shared.enter(name_of(step, &progress), Some(Arc::clone(tracker)));
        }
    }

    /// A step is done; `remainder` is the share of all light that is still missing.
    pub(crate) fn step_done(
        &self,
        step: Step,
        seconds: f64,
        remainder: Option<f64>,
        accuracy: Option<Accuracy>,
    ) {
        let Some(shared) = &self.shared else { return };
        if matches!(shared.display, Display::Json) {
            let mut event = json!({ "event": "step_done", "seconds": seconds, "remainder": remainder });
            add_step(&mut event, step);
            if let Some(accuracy) = accuracy {
                event["share_below_target"] = accuracy.share.into();
            }
            shared.console.event(&event);
        }
    }

    /// Ends the display; messages may follow.
    pub(crate) fn finish(&mut self) {
        let Some(shared) = self.shared.take() else { return };
        shared.lock().ended = true;
        shared.ended.notify_all();
        if let Some(ticker) = self.ticker.take() {
            // It has nothing to fail with.
            let _ = ticker.join();
        }
        if let Display::Bar(bar) = &shared.display {
            bar.finish_and_clear();
            shared.console.set_bar(None);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

fn new_bar() -> ProgressBar {
    let bar = ProgressBar::new(BAR_STEPS);
    if let Ok(style) = ProgressStyle::with_template("{prefix:24} {wide_bar} {msg:36}") {
        bar.set_style(style.progress_chars("━╸ "));
    }
    bar
}

fn add_step(event: &mut Value, step: Step) {
    match step {
        Step::Validity => event["step"] = "validity".into(),
        Step::Bounce(bounce) => {
            event["step"] = "bounce".into();
            event["bounce"] = bounce.into();
        }
        Step::Shot(shot) => {
            event["step"] = "shot".into();
            event["shot"] = (shot + 1).into();
        }
        Step::FinalGather => event["step"] = "final gather".into(),
        Step::ReadDirect => event["step"] = "direct at vertices".into(),
        Step::Directional => event["step"] = "directional".into(),
        Step::Round(round) => {
            event["step"] = "round".into();
            event["round"] = (round + 1).into();
        }
        Step::Layer(layer) => {
            event["step"] = "layer".into();
            event["layer"] = (layer + 1).into();
        }
    }
}

fn name_of(step: Step, progress: &lumel::Progress) -> String {
    match step {
        Step::Validity if progress.traces_kept_rays => "tracing rays".to_owned(),
        Step::Validity => "looking inside geometry".to_owned(),
        Step::Bounce(0) if progress.traces_kept_rays => "direct light, tracing rays".to_owned(),
        Step::Bounce(0) => "direct light".to_owned(),
        Step::Bounce(bounce) => match progress.last_bounce.filter(|&last| last >= bounce) {
            Some(last) => format!("bounce {bounce} of {last}"),
            None => format!("bounce {bounce}"),
        },
        Step::Shot(shot) => match progress.missing {
            Some(missing) => format!("shot {}, {} of all light missing", shot + 1, report::percent(missing)),
            None => format!("shot {}", shot + 1),
        },
        Step::FinalGather => "final gather".to_owned(),
        Step::ReadDirect => "direct light at vertices".to_owned(),
        Step::Directional => "light by direction".to_owned(),
        Step::Layer(layer) => format!("layer {} of {}", layer + 1, progress.layers),
        Step::Round(round) => match &progress.accuracy {
            Some(Accuracy { share, target, .. }) => {
                let (share, target) = (report::percent(*share), report::percent(target.error));
                format!("round {}, {share} of values within {target} so far", round + 1)
            }
            None => format!("round {}", round + 1),
        },
    }
}

/// What is shown at one moment.
struct Moment {
    phase: String,
    solve: lumel::Progress,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }

    fn reading(&self) -> Reading {
        Reading::new(self.interrupt.control(), self.clock.seconds())
    }

    fn enter(&self, phase: String, tracker: Option<Arc<Mutex<Tracker>>>) {
        let mut state = self.lock();
        (state.phase, state.tracker, state.share) = (phase, tracker, None);
        drop(state);
        if matches!(self.display, Display::Json) {
            self.show();
        }
    }

    fn tick(&self, interval: Duration) {
        let mut state = self.lock();
        while !state.ended {
            let waited = self.ended.wait_timeout(state, interval).unwrap_or_else(PoisonError::into_inner);
            state = waited.0;
            if state.ended {
                return;
            }
            if waited.1.timed_out() {
                drop(state);
                self.show();
                state = self.lock();
            }
        }
    }

    fn moment(&self) -> Moment {
        let state = self.lock();
        let solve = state.tracker.as_ref().map(|tracker| lock(tracker).progress(self.reading()));
        let no_solve =
            || lumel::Progress { share: state.share, step_share: state.share, ..lumel::Progress::default() };
        Moment { phase: state.phase.clone(), solve: solve.unwrap_or_else(no_solve) }
    }

    fn show(&self) {
        let moment = self.moment();
        match &self.display {
            Display::Bar(bar) => {
                bar.set_prefix(moment.phase.clone());
                bar.set_position((moment.solve.share.unwrap_or(0.0) * BAR_STEPS as f64) as u64);
                bar.set_message(moment.details().join(", "));
                bar.tick();
            }
            Display::Lines => {
                let share = moment.solve.share.map(|share| format!("{:.0} %", 100.0 * share));
                let details: Vec<String> = share.into_iter().chain(moment.details()).collect();
                if details.is_empty() {
                    // There is nothing new to say about it.
                    if self.lock().told.replace(moment.phase.clone()).as_ref() != Some(&moment.phase) {
                        self.console.line(&format!("{} ...", moment.phase));
                    }
                } else {
                    self.console.line(&format!("{}: {}", moment.phase, details.join(", ")));
                }
            }
            Display::Json => {
                let mut event = json!({
                    "event": "progress",
                    "phase": moment.phase,
                    "share": moment.solve.step_share,
                    "share_of_solve": moment.solve.share,
                    "mrays_per_second": moment.mrays_per_second(),
                    "seconds": self.clock.seconds(),
                    "seconds_left": moment.solve.seconds_left,
                });
                if let Some(step) = moment.solve.step {
                    add_step(&mut event, step);
                }
                self.console.event(&event);
            }
        }
    }
}

impl Moment {
    fn mrays_per_second(&self) -> Option<f64> {
        self.solve.rays_per_second.map(|rays| 1e-6 * rays)
    }

    fn details(&self) -> Vec<String> {
        let speed = self.solve.rays_per_second.and_then(lumel::ray_rate);
        let left = self.solve.seconds_left.map(|left| format!("{} left", report::duration(left)));
        speed.into_iter().chain(left).collect()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
