//! What the program is doing, for people and for programs.

use crate::args::ProgressMode;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::report;
use indicatif::{ProgressBar, ProgressStyle};
use lumel::{Accuracy, Position, Remainder, Step, Workload};
use serde_json::{Value, json};
use std::io::{self, IsTerminal};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Steps of a bar: enough to move smoothly.
const BAR_STEPS: u64 = 1000;

/// How progress is shown.
enum Display {
    Bar(ProgressBar),
    Lines,
    Json,
}

/// Shows progress from a thread of its own, until it is dropped.
pub(crate) struct Progress {
    shared: Option<Arc<Shared>>,
    ticker: Option<JoinHandle<()>>,
}

struct Shared {
    display: Display,
    console: Arc<Console>,
    interrupt: Interrupt,
    started: Instant,
    state: Mutex<State>,
    ended: Condvar,
}

/// What is going on.
struct State {
    ended: bool,
    phase: String,
    step: Option<Step>,
    since: Instant,
    elements_before: u64,
    rays_before: u64,
    workload: Option<Workload>,
    remainders: Vec<Remainder>,
    /// What the last round of samples has reached.
    accuracy: Option<Accuracy>,
    /// The last phase that was told of by its name alone.
    told: Option<String>,
}

impl Progress {
    /// Begins to show progress.
    pub(crate) fn start(mode: ProgressMode, console: &Arc<Console>, interrupt: &Interrupt) -> Self {
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
        let now = Instant::now();
        let state = State {
            ended: false,
            phase: String::new(),
            step: None,
            since: now,
            elements_before: 0,
            rays_before: 0,
            workload: None,
            remainders: Vec::new(),
            accuracy: None,
            told: None,
        };
        let shared = Arc::new(Shared {
            display,
            console: Arc::clone(console),
            interrupt: interrupt.clone(),
            started: now,
            state: Mutex::new(state),
            ended: Condvar::new(),
        });
        let ticking = Arc::clone(&shared);
        // A system without threads to spare does without the display.
        let ticker =
            std::thread::Builder::new().name("progress".into()).spawn(move || ticking.tick(interval));
        Self { shared: Some(shared), ticker: ticker.ok() }
    }

    /// Something that is no step of the solve begins: "build".
    pub(crate) fn phase(&self, name: &str) {
        if let Some(shared) = &self.shared {
            shared.enter(name.to_owned(), None);
        }
    }

    /// How much the solve has to do.
    pub(crate) fn expect(&self, workload: Workload) {
        if let Some(shared) = &self.shared {
            shared.lock().workload = Some(workload);
        }
    }

    /// A step of the solve begins.
    pub(crate) fn step_started(&self, step: Step) {
        if let Some(shared) = &self.shared {
            let name = shared.lock().name_of(step);
            shared.enter(name, Some(step));
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
        if let (Step::Bounce(after), Some(share)) = (step, remainder) {
            shared.lock().remainders.push(Remainder { after, share });
        }
        shared.lock().accuracy = accuracy;
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
        Step::Probe => event["step"] = "probe".into(),
        Step::Bounce(bounce) => {
            event["step"] = "bounce".into();
            event["bounce"] = bounce.into();
        }
        Step::FinalGather => event["step"] = "final gather".into(),
        Step::Round(round) => {
            event["step"] = "round".into();
            event["round"] = (round + 1).into();
        }
    }
}

impl State {
    fn name_of(&self, step: Step) -> String {
        match step {
            Step::Probe => "looking inside geometry".to_owned(),
            Step::Bounce(0) => "direct light".to_owned(),
            Step::Bounce(bounce) => {
                let last = self.workload.as_ref().and_then(|work| work.last_bounce(&self.remainders));
                match last.filter(|&last| last >= bounce) {
                    Some(last) => format!("bounce {bounce} of {last}"),
                    None => format!("bounce {bounce}"),
                }
            }
            Step::FinalGather => "final gather".to_owned(),
            Step::Round(round) => match &self.accuracy {
                Some(Accuracy { share, target, .. }) => {
                    let (share, target) = (report::percent(*share), report::percent(target.error));
                    format!("round {}, {share} of values within {target} so far", round + 1)
                }
                None => format!("round {}", round + 1),
            },
        }
    }
}

/// What is shown at one moment.
struct Moment {
    phase: String,
    step: Option<Step>,
    share: Option<f64>,
    mrays_per_second: Option<f64>,
    seconds_left: Option<f64>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn enter(&self, phase: String, step: Option<Step>) {
        let control = self.interrupt.control();
        let mut state = self.lock();
        state.phase = phase;
        state.step = step;
        state.since = Instant::now();
        (state.elements_before, state.rays_before) = (control.elements(), control.rays());
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
        let control = self.interrupt.control();
        let state = self.lock();
        let seconds = state.since.elapsed().as_secs_f64();
        let elements = control.elements().saturating_sub(state.elements_before);
        let rays = control.rays().saturating_sub(state.rays_before);
        let position = state.step.map(|step| Position { step, seconds, elements, rays });
        let work = state.workload.as_ref().zip(position);
        Moment {
            phase: state.phase.clone(),
            step: state.step,
            share: work.as_ref().and_then(|(work, at)| work.share_known(at)),
            mrays_per_second: state.step.map(|_| 1e-6 * rays as f64 / seconds.max(1e-6)),
            seconds_left: work.as_ref().and_then(|(work, at)| work.seconds_left(at, &state.remainders)),
        }
    }

    fn show(&self) {
        let moment = self.moment();
        match &self.display {
            Display::Bar(bar) => {
                bar.set_prefix(moment.phase.clone());
                bar.set_position((moment.share.unwrap_or(0.0) * BAR_STEPS as f64) as u64);
                bar.set_message(moment.details().join(", "));
                bar.tick();
            }
            Display::Lines => {
                let share = moment.share.map(|share| format!("{:.0} %", 100.0 * share));
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
                    "share": moment.share,
                    "mrays_per_second": moment.mrays_per_second,
                    "seconds": self.started.elapsed().as_secs_f64(),
                    "seconds_left": moment.seconds_left,
                });
                if let Some(step) = moment.step {
                    add_step(&mut event, step);
                }
                self.console.event(&event);
            }
        }
    }
}

impl Moment {
    fn details(&self) -> Vec<String> {
        let speed = self.mrays_per_second.map(|speed| format!("{speed:.2} Mrays/s"));
        let left = self.seconds_left.map(|left| format!("{} left", report::duration(left)));
        speed.into_iter().chain(left).collect()
    }
}
