//! Solves in the background, on all cores, and what can be seen of them meanwhile.
//!
//! The thread that draws never waits for the threads that solve: it reads what was [`Published`] last and may ask to
//! stop. A solve is cancelled within a few milliseconds.

use crate::selection::{Light, VertexValues};
use crate::spread::Neighbours;
use glam::Vec3;
use lumel::{
    Baker, Control, Observer, Progress, Reading, Scene, Settings, Snapshot, SolveState, Step, Tracker,
};
use lumel_basis::Field;
use lumel_scene::luminance;
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two looks at a bounce that is being measured. The picture is to change twice a second at least.
const SNAPSHOT_PERIOD: Duration = Duration::from_millis(490);

/// The first look comes sooner: one has just pressed the key.
const FIRST_SNAPSHOT: Duration = Duration::from_millis(120);

/// Called from any thread when there is something new to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How the window is told of a solve.
#[derive(Clone)]
pub struct Wakes {
    /// Something has happened.
    pub event: Wake,
    /// A little more is known of the bounce under way; may be drawn when it suits.
    pub glimpse: Wake,
}

/// What a solve works with.
#[derive(Clone)]
pub struct Task {
    /// The scene with the lights to solve for.
    pub scene: Arc<Scene>,
    /// What computed light on these surfaces before.
    pub baker: Arc<Baker>,
    /// For what is not measured yet.
    pub neighbours: Arc<Neighbours>,
    /// The area that each vertex stands for, m².
    pub areas: Arc<Vec<f32>>,
    /// The settings.
    pub settings: Settings,
}

/// What to compute.
pub enum Work {
    /// All bounces, from the beginning or from what a stopped solve or a file has.
    Solve(Start),
    /// The standard error of a finished solve.
    StandardError(Arc<Solved>),
}

/// Where a solve begins.
pub enum Start {
    /// With direct light.
    Anew,
    /// After the bounces of this state.
    From(SolveState),
    /// After the bounces of a solution that was saved; an error if it does not fit.
    FromFile(Box<lumel::Solution>),
}

/// A solve that ended, well or because it was stopped.
#[derive(Clone)]
pub struct Solved {
    /// What computed it.
    pub baker: Arc<Baker>,
    /// All bounces that were finished.
    pub state: SolveState,
}

/// Where a job is.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Building what the solve needs.
    Preparing,
    /// Finding vertices that lie inside geometry.
    Probing,
    /// Measuring this bounce; 0 is direct light.
    Bounce(u32),
    /// Measuring all light but the direct once more.
    FinalGather,
    /// Adding samples where the error is above the target; 0 is the first round.
    Round(u32),
    /// Measuring the light of some emitters alone.
    Layer(u32),
    /// Measuring the standard error.
    StandardError,
    /// It is over.
    Ended(Ending),
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// All bounces that were asked for are there.
    Done,
    /// It was asked to stop.
    Stopped,
    /// It could not go on.
    Failed(String),
}

/// What one bounce brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceStats {
    /// Luminance of the power that arrives, W.
    pub power: f64,
    /// Root mean square over the surfaces of what it changed, relative to that of all light so far.
    pub change: f64,
    /// Share of all light that later bounces will bring, as far as it can be told.
    pub unfinished: Option<f64>,
    /// How long it took; zero for a bounce that was resumed.
    pub seconds: f64,
}

/// What can be seen of a job.
#[derive(Clone, Debug)]
pub struct Published {
    /// Where it is.
    pub phase: Phase,
    /// The light so far.
    pub light: Light,
    /// One for each finished bounce.
    pub stats: Vec<BounceStats>,
    /// Changes with the light.
    pub generation: u64,
    /// Why the last checkpoint could not be written, if it could not.
    pub checkpoint_problem: Option<String>,
}

/// A running or ended job.
pub struct Job {
    control: Arc<Control>,
    shared: Arc<Shared>,
    settings: Settings,
    thread: Option<JoinHandle<()>>,
}

/// Keeps the state of a solve somewhere after each bounce.
pub type Keep = Box<dyn Fn(&Baker, &SolveState) -> Result<(), String> + Send + Sync>;

struct Shared {
    published: Mutex<Published>,
    solved: Mutex<Option<Arc<Solved>>>,
    /// When the job began.
    begun: Instant,
    /// Follows the solve, once there is one.
    tracker: Mutex<Option<Tracker>>,
    wakes: Wakes,
}

impl Job {
    /// Starts a job on the threads of a pool; `keep` is called after each bounce of a solve.
    pub fn start(task: Task, work: Work, pool: Arc<ThreadPool>, keep: Keep, wakes: Wakes) -> Self {
        let control = Arc::new(Control::default());
        let published = Published {
            phase: Phase::Preparing,
            light: Light::new(),
            stats: Vec::new(),
            generation: 0,
            checkpoint_problem: None,
        };
        let shared = Arc::new(Shared {
            published: Mutex::new(published),
            solved: Mutex::default(),
            begun: Instant::now(),
            tracker: Mutex::default(),
            wakes,
        });
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

impl Drop for Job {
    fn drop(&mut self) {
        self.stop();
        self.join();
    }
}

const BUG: &str = "this is a bug in lumel; please report it with the scene and the settings";

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is behind these is written whole, so a panic elsewhere leaves nothing half-done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Time and counters now.
    fn reading(&self, control: &Control) -> Reading {
        Reading::new(control, self.begun.elapsed().as_secs_f64())
    }

    fn publish_light(&self, change: impl FnOnce(&mut Published)) {
        self.change_light(change);
        (self.wakes.event)();
    }

    fn change_light(&self, change: impl FnOnce(&mut Published)) {
        let mut published = lock(&self.published);
        change(&mut published);
        published.generation += 1;
    }

    fn publish_phase(&self, phase: Phase) {
        lock(&self.published).phase = phase;
        (self.wakes.event)();
    }
}

fn run(task: &Task, work: Work, control: &Control, shared: &Shared, keep: &Keep) -> Ending {
    match work {
        Work::Solve(start) => solve(task, start, control, shared, keep),
        Work::StandardError(solved) => {
            shared.publish_phase(Phase::StandardError);
            let result = lumel::vertex_errors(&solved.baker, &solved.state, control);
            *lock(&shared.solved) = Some(solved);
            match result {
                Ok(errors) => {
                    shared.publish_light(|p| p.light.standard_error = Some(Arc::new(errors)));
                    Ending::Done
                }
                Err(_) => Ending::Stopped,
            }
        }
    }
}

fn solve(task: &Task, start: Start, control: &Control, shared: &Shared, keep: &Keep) -> Ending {
    if let Err(error) = task.settings.validate() {
        return Ending::Failed(error.to_string());
    }
    let baker = Arc::new(task.baker.relit(Arc::clone(&task.scene), task.settings.clone()));
    let mut state = match start {
        Start::Anew => SolveState::new(),
        Start::From(state) => state,
        Start::FromFile(solution) => match baker.resume(&solution) {
            Ok(state) => state,
            Err(error) => return Ending::Failed(error.to_string()),
        },
    };
    *lock(&shared.tracker) = Some(Tracker::new(&baker, &state));
    let watch = Watch::new(task, &baker, control, shared, keep);
    watch.resumed(&state);
    let result = std::thread::scope(|scope| {
        scope.spawn(|| watch.serve());
        let _closing = Closing(&watch);
        baker.run(&mut state, control, &watch)
    });
    let tail = beyond_bounces(&state).map(|tail| Arc::new(baker.at_vertices(&tail)));
    let valid = Arc::new(baker.flags_at_vertices(&state.valid));
    shared.publish_light(|p| {
        p.light.current = None;
        p.light.tail = tail;
        p.light.valid = valid;
    });
    *lock(&shared.solved) = Some(Arc::new(Solved { baker, state }));
    match result {
        Ok(()) => Ending::Done,
        Err(lumel::SolveError::Cancelled) => Ending::Stopped,
        Err(error) => Ending::Failed(error.to_string()),
    }
}

/// What the sum of the bounces lacks of all light: the tail, or what a final gather has made different.
fn beyond_bounces(state: &SolveState) -> Option<Field> {
    if state.gathered.is_none() {
        return state.tail.clone();
    }
    let bounces = Field::sum(state.valid.len(), &state.bounces);
    let total = state.total();
    let rest = total.values().iter().zip(bounces.values()).map(|(total, bounces)| *total - *bounces);
    Some(Field::from_values(rest.collect()))
}

/// Follows a solve.
struct Watch<'a> {
    task: &'a Task,
    baker: &'a Baker,
    control: &'a Control,
    shared: &'a Shared,
    keep: &'a Keep,
    clock: Instant,
    /// Milliseconds of the clock from which on a snapshot is wanted.
    due: AtomicU64,
    /// Handed from the threads that solve to the one that publishes.
    mail: Mutex<Mail>,
    arrived: Condvar,
}

/// What is to be done beside a solve.
#[derive(Default)]
struct Mail {
    /// A look at the bounce under way.
    snapshot: Option<Snapshot>,
    /// Finished bounces to keep somewhere.
    state: Option<SolveState>,
    /// No more will come.
    closed: bool,
}

impl<'a> Watch<'a> {
    fn new(
        task: &'a Task,
        baker: &'a Baker,
        control: &'a Control,
        shared: &'a Shared,
        keep: &'a Keep,
    ) -> Self {
        Self {
            task,
            baker,
            control,
            shared,
            keep,
            clock: Instant::now(),
            due: AtomicU64::new(FIRST_SNAPSHOT.as_millis() as u64),
            mail: Mutex::default(),
            arrived: Condvar::new(),
        }
    }

    /// Publishes the bounces that are there from the start.
    fn resumed(&self, state: &SolveState) {
        for k in 0..state.bounces.len() {
            let so_far = SolveState { bounces: state.bounces[..=k].to_vec(), ..state.clone() };
            self.publish_bounce(&so_far, 0.0);
        }
    }

    fn publish_bounce(&self, state: &SolveState, seconds: f64) {
        let Some((values, stats)) = self.last_bounce(state, seconds) else { return };
        let valid = Arc::new(self.baker.flags_at_vertices(&state.valid));
        self.shared.publish_light(|p| {
            p.light.bounces.push(values);
            p.light.current = None;
            p.light.valid = valid;
            p.stats.push(stats);
        });
    }

    /// The light of the last bounce of a state, and what it brought.
    fn last_bounce(&self, state: &SolveState, seconds: f64) -> Option<(VertexValues, BounceStats)> {
        let values: VertexValues = Arc::new(self.baker.at_vertices(state.bounces.last()?));
        let areas = &self.task.areas;
        let power = areas.iter().zip(values.iter()).map(|(a, e)| f64::from(a * luminance(*e))).sum();
        let total = self.baker.at_vertices(&state.total());
        let change = mean_square(areas, &values).sqrt() / mean_square(areas, &total).sqrt();
        let change = if change.is_finite() { change } else { 0.0 };
        Some((values, BounceStats { power, change, unfinished: self.baker.remainder(state), seconds }))
    }

    /// Publishes all bounces anew: a round changes every one of them.
    fn publish_round(&self, state: &SolveState) {
        let up_to = |k: usize| SolveState { bounces: state.bounces[..=k].to_vec(), ..SolveState::new() };
        let (bounces, stats) =
            (0..state.bounces.len()).filter_map(|k| self.last_bounce(&up_to(k), 0.0)).unzip();
        let tail = state.tail.as_ref().map(|tail| Arc::new(self.baker.at_vertices(tail)));
        let valid = Arc::new(self.baker.flags_at_vertices(&state.valid));
        let errors = state.errors.as_ref();
        let standard_error = errors.map(|e| Arc::new(self.baker.at_vertices(&e.standard_error)));
        self.shared.publish_light(|p| {
            p.light = Light { bounces, tail, valid, standard_error, ..Light::new() };
            p.stats = stats;
        });
    }

    /// Publishes snapshots and keeps finished bounces until the solve ends, beside the threads that solve: neither
    /// a disk nor a picture holds them up.
    fn serve(&self) {
        let mut mail = lock(&self.mail);
        loop {
            if let Some(state) = mail.state.take() {
                drop(mail);
                let problem = (self.keep)(self.baker, &state).err();
                lock(&self.shared.published).checkpoint_problem = problem;
                mail = lock(&self.mail);
            } else if mail.closed {
                return;
            } else if let Some(snapshot) = mail.snapshot.take() {
                drop(mail);
                self.publish_snapshot(&snapshot);
                mail = lock(&self.mail);
            } else {
                mail = self.arrived.wait(mail).unwrap_or_else(PoisonError::into_inner);
            }
        }
    }

    fn publish_snapshot(&self, snapshot: &Snapshot) {
        let bounce = match snapshot.step {
            Step::Bounce(bounce) => bounce,
            // Direct light of the first replicates, before there is any other.
            Step::Round(0) => 0,
            Step::Round(_) | Step::Validity | Step::FinalGather | Step::Layer(_) => return,
        };
        let mut values = self.baker.at_vertices(&snapshot.current);
        let measured = self.baker.flags_at_vertices(&snapshot.measured);
        self.task.neighbours.spread(&mut values, &measured);
        let current = Some(Arc::new(values));
        // The bounce may have been finished meanwhile.
        self.shared.change_light(|p| {
            if p.light.bounces.len() == bounce as usize {
                p.light.current = current;
            }
        });
        (self.shared.wakes.glimpse)();
    }

    fn track<T>(&self, tell: impl FnOnce(&mut Tracker, Reading) -> T) -> Option<T> {
        let now = self.shared.reading(self.control);
        lock(&self.shared.tracker).as_mut().map(|tracker| tell(tracker, now))
    }

    fn hand_over(&self, change: impl FnOnce(&mut Mail)) {
        change(&mut lock(&self.mail));
        self.arrived.notify_all();
    }

    fn next_due(&self, after: Duration) {
        self.due.store((self.clock.elapsed() + after).as_millis() as u64, Ordering::Relaxed);
    }
}

/// Lets the thread that publishes end, also after a panic.
struct Closing<'a>(&'a Watch<'a>);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.hand_over(|mail| mail.closed = true);
    }
}

impl Observer for Watch<'_> {
    fn step_started(&self, step: Step) {
        self.track(|tracker, now| tracker.step_started(step, now));
        // Before there is any light one waits for it; later the light so far stays in sight.
        let first =
            if matches!(step, Step::Bounce(0) | Step::Round(0)) { FIRST_SNAPSHOT } else { SNAPSHOT_PERIOD };
        self.next_due(first);
        self.shared.publish_phase(match step {
            Step::Validity => Phase::Probing,
            Step::Bounce(k) => Phase::Bounce(k),
            Step::FinalGather => Phase::FinalGather,
            Step::Round(round) => Phase::Round(round),
            Step::Layer(layer) => Phase::Layer(layer),
        });
    }

    fn step_done(&self, step: Step, state: &SolveState) {
        let remainder = self.baker.remainder(state);
        let accuracy = state.errors.as_ref().map(|errors| errors.accuracy);
        let seconds = self.track(|tracker, now| tracker.step_done(step, remainder, accuracy, now));
        match step {
            Step::Bounce(_) => self.publish_bounce(state, seconds.unwrap_or(0.0)),
            Step::Round(_) => self.publish_round(state),
            Step::Validity | Step::FinalGather | Step::Layer(_) => return,
        }
        self.hand_over(|mail| mail.state = Some(state.clone()));
    }

    fn wants_snapshot(&self) -> bool {
        let now = self.clock.elapsed();
        let due = self.due.load(Ordering::Relaxed);
        if (now.as_millis() as u64) < due {
            return false;
        }
        // Only one of the threads that ask at once gets a yes.
        let next = (now + SNAPSHOT_PERIOD).as_millis() as u64;
        self.due.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    fn snapshot(&self, snapshot: Snapshot) {
        self.hand_over(|mail| mail.snapshot = Some(snapshot));
    }
}

/// Mean of the squared luminance over the surfaces.
fn mean_square(areas: &[f32], values: &[Vec3]) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for (&a, value) in areas.iter().zip(values) {
        sum += f64::from(a) * f64::from(luminance(*value)).powi(2);
        area += f64::from(a);
    }
    if area > 0.0 { sum / area } else { 0.0 }
}
