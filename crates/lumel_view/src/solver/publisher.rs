//! Publishes what a solve finds while it runs.

use super::course::Moment;
use super::first_look::FirstLook;
use super::points::{Points, extrapolated};
use super::published::{BounceStats, Phase, Shared, lock};
use super::task::Keep;
use crate::point_light::Direct;
use crate::selection::{Illumination, VertexValues};
use crate::unshot::Unshot;
use glam::Vec3;
use lumel::{Baker, Control, LightReader, Observer, Reading, Snapshot, SolveState, Step, Tracker};
use lumel_basis::{Basis as _, Field};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at a bounce that is being measured. The picture is to change twice a second at least.
const SNAPSHOT_PERIOD: Duration = Duration::from_millis(490);

/// The first look comes sooner: one has just pressed the key.
const FIRST_SNAPSHOT: Duration = Duration::from_millis(120);

/// Follows a solve and publishes what it finds.
pub(super) struct Publisher<'a> {
    baker: &'a Baker,
    control: &'a Control,
    points: Points,
    shared: &'a Shared,
    keep: &'a Keep,
    clock: Instant,
    /// What stands for light that is not measured yet.
    first_look: Option<FirstLook>,
    /// Made when direct light is there; each round of a target error has others.
    reader: OnceLock<LightReader<'a>>,
    /// Direct light, once it is there.
    direct: OnceLock<Field>,
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
    /// What shots have brought so far, without what is made of it in the end.
    shot: Option<SolveState>,
    /// Finished bounces to keep somewhere.
    state: Option<SolveState>,
    /// No more will come.
    closed: bool,
}

impl<'a> Publisher<'a> {
    pub(super) fn new(baker: &'a Baker, control: &'a Control, shared: &'a Shared, keep: &'a Keep) -> Self {
        Self {
            baker,
            control,
            points: Points::of(baker, shared),
            shared,
            keep,
            clock: Instant::now(),
            first_look: None,
            reader: OnceLock::new(),
            direct: OnceLock::new(),
            due: AtomicU64::new(FIRST_SNAPSHOT.as_millis() as u64),
            mail: Mutex::default(),
            arrived: Condvar::new(),
        }
    }

    /// The same after a first look at all light.
    pub(super) fn after(self, first_look: Option<FirstLook>) -> Self {
        Self { first_look, ..self }
    }

    /// Publishes the first look at all light.
    pub(super) fn publish_first_look(&self) {
        let Some(first_look) = &self.first_look else { return };
        let direct = first_look.direct();
        let current = direct.bounces.first().map(|field| Arc::new(self.baker.carried_at_vertices(field)));
        let at_points = direct.bounces.first().and_then(|field| self.points.values(field));
        let unshot = self.unshot(&direct, 1);
        self.shared.publish_light(|p| {
            (p.light.current, p.unshot) = (current, unshot);
            self.points.publish(p, |points| points.current = at_points);
        });
    }

    /// What is still to come after so many bounces of a state.
    fn unshot(&self, state: &SolveState, bounces: usize) -> Option<Arc<Unshot>> {
        let unshot = Unshot::of(self.baker, state)?;
        let Some(first_look) = &self.first_look else { return Some(Arc::new(unshot)) };
        let share = match state.shot {
            None => Vec3::ONE,
            // Of what was to come before the first shot.
            Some(_) => {
                let direct = SolveState { bounces: state.bounces.clone(), ..SolveState::new() };
                let share = unshot.ambient / self.baker.ambient(&direct);
                share.map(|share| if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 })
            }
        };
        Some(Arc::new(first_look.instead(self.baker, unshot, bounces, share)))
    }

    /// Publishes the bounces that are there from the start, or the last round.
    pub(super) fn resumed(&self, state: &SolveState) {
        if state.errors.is_some() {
            return self.publish_round(state);
        }
        for_each_prefix(state, |so_far| self.publish_bounce(so_far, 0.0));
        self.publish_direct(state);
        self.publish_shots(state);
    }

    fn publish_bounce(&self, state: &SolveState, seconds: f64) {
        let reader = self.reader.get_or_init(|| self.baker.light_reader(state));
        let Some((values, stats)) = self.last_bounce(reader, state, seconds) else { return };
        let valid = Arc::new(self.baker.flags_at_vertices(&state.valid));
        if let Some(direct) = state.bounces.first() {
            self.direct.get_or_init(|| direct.clone());
        }
        let unshot = self.unshot(state, state.bounces.len());
        let at_points = state.bounces.last().and_then(|field| self.points.values(field));
        self.shared.publish_light(|p| {
            // Light to look at while the mesh was refined.
            if p.light.sum_only.is_some() {
                p.light = Illumination::new();
            }
            p.light.bounces.push(values);
            p.light.current = None;
            p.light.valid = valid;
            p.unshot = unshot;
            p.stats.push(stats);
            self.points.publish(p, |points| {
                points.bounces.extend(at_points);
                points.current = None;
                points.valid = Arc::new(state.valid.clone());
            });
        });
    }

    /// Publishes direct light as it was measured at the vertices in place of what points have of it.
    fn publish_direct(&self, state: &SolveState) {
        let reader = self.baker.light_reader(state);
        let Some(direct) = reader.direct_at_vertices() else { return };
        let direct = Arc::new(direct.to_vec());
        self.shared.publish_light(|p| {
            p.light.set_direct(direct);
            self.points.publish(p, |points| points.direct = Direct::AtVertices);
        });
    }

    /// The light of the last bounce of a state, and what it brought.
    fn last_bounce(
        &self,
        reader: &LightReader<'_>,
        state: &SolveState,
        seconds: f64,
    ) -> Option<(VertexValues, BounceStats)> {
        let last = state.bounces.last()?;
        let values: VertexValues = Arc::new(reader.at_vertices(last));
        let power = self.baker.power(last);
        let change = self.baker.root_mean_square(last) / self.baker.root_mean_square(&state.total());
        let change = if change.is_finite() { change } else { 0.0 };
        Some((values, BounceStats { power, change, unfinished: self.baker.remainder(state), seconds }))
    }

    /// Publishes all bounces again: a round changes every one of them.
    fn publish_round(&self, state: &SolveState) {
        let reader = self.baker.light_reader(state);
        let (mut bounces, mut stats) = (Vec::new(), Vec::new());
        for_each_prefix(state, |so_far| {
            if let Some((values, brought)) = self.last_bounce(&reader, so_far, 0.0) {
                bounces.push(values);
                stats.push(brought);
            }
        });
        let tail = state.tail.as_ref().map(|tail| Arc::new(reader.at_vertices(tail)));
        let valid = Arc::new(self.baker.flags_at_vertices(&state.valid));
        let errors = state.errors.as_ref();
        let standard_error = errors.map(|e| Arc::new(self.baker.carried_at_vertices(&e.standard_error)));
        self.shared.publish_light(|p| {
            p.light = Illumination { bounces, tail, valid, standard_error, ..Illumination::new() };
            p.stats = stats;
            self.points.publish_all(p, (&reader, state), state.tail.as_ref());
        });
    }

    /// Publishes snapshots and keeps finished bounces until the solve ends, beside the threads that solve: neither
    /// a disk nor a picture holds them up.
    pub(super) fn serve(&self) {
        let mut mail = lock(&self.mail);
        loop {
            if let Some(state) = mail.state.take() {
                drop(mail);
                let problem = self.keep.as_ref().and_then(|keep| keep(&self.baker.checkpoint(&state)).err());
                lock(&self.shared.published).checkpoint_problem = problem;
                mail = lock(&self.mail);
            } else if mail.closed {
                return;
            } else if let Some(snapshot) = mail.snapshot.take() {
                drop(mail);
                self.publish_snapshot(&snapshot);
                mail = lock(&self.mail);
            } else if let Some(state) = mail.shot.take() {
                drop(mail);
                self.publish_shots(&state);
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
            Step::Round(_)
            | Step::Shot(_)
            | Step::Validity
            | Step::FinalGather
            | Step::ReadDirect
            | Step::Directional
            | Step::Layer(_) => return,
        };
        let field = self.completed(bounce, snapshot);
        // It is not read as the nearest function, which would swing between what is measured and what is not.
        let current = Some(Arc::new(self.baker.carried_at_vertices(&field)));
        let at_points = self.points.values(&field);
        let unshot = self.unshot(&self.with_current(snapshot, field), bounce as usize + 1);
        // The bounce may have been finished meanwhile.
        self.shared.change_light(|p| {
            if p.light.bounces.len() == bounce as usize {
                (p.light.current, p.unshot) = (current, unshot);
                self.points.publish(p, |points| points.current = at_points);
            }
        });
        (self.shared.wakes.glimpse)();
    }

    /// The bounce under way with a guess for looking at where nothing is measured yet.
    fn completed(&self, bounce: u32, snapshot: &Snapshot) -> Field {
        let seen =
            |first_look: &FirstLook| first_look.completing(bounce, &snapshot.current, &snapshot.measured);
        // What levels differ by makes no sense beside that of other light.
        let first_look = self.first_look.as_ref().filter(|_| self.baker.basis().hierarchy().is_none());
        first_look.and_then(seen).unwrap_or_else(|| extrapolated(self.baker, snapshot))
    }

    /// The bounces that are done, all but the direct light as one, and what is known of the bounce under way as the last.
    fn with_current(&self, snapshot: &Snapshot, current: Field) -> SolveState {
        let less = |from: &Field, field: &Field| {
            Field::from_values(from.values().iter().zip(field.values()).map(|(a, b)| *a - *b).collect())
        };
        let mut bounces = Vec::new();
        if let Some(direct) = self.direct.get() {
            bounces.push(direct.clone());
            bounces.push(less(&less(&snapshot.total, &snapshot.current), direct));
        }
        bounces.push(current);
        SolveState { bounces, ..SolveState::new() }
    }

    /// What shots have brought so far stands beyond direct light, as a tail does. It is looked at as it is carried: reading it as
    /// the nearest function takes about as long as a shot.
    fn publish_shots(&self, state: &SolveState) {
        let Some(shot) = &state.shot else { return };
        let tail = Some(Arc::new(self.baker.carried_at_vertices(&shot.reflected)));
        let at_points = self.points.values(&shot.reflected);
        let unshot = self.unshot(state, 1);
        self.shared.change_light(|p| {
            (p.light.tail, p.unshot) = (tail, unshot);
            self.points.publish(p, |points| points.tail = at_points);
        });
        (self.shared.wakes.glimpse)();
    }

    fn track<T>(&self, tell: impl FnOnce(&mut Tracker, Reading) -> T) -> Option<T> {
        let now = self.shared.reading(self.control);
        lock(&self.shared.tracker).as_mut().map(|tracker| tell(tracker, now))
    }

    /// Ends [`Self::serve`] when it is dropped.
    pub(super) fn closing(&self) -> Closing<'_, 'a> {
        Closing(self)
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
pub(super) struct Closing<'p, 'a>(&'p Publisher<'a>);

impl Drop for Closing<'_, '_> {
    fn drop(&mut self) {
        self.0.hand_over(|mail| mail.closed = true);
    }
}

impl Observer for Publisher<'_> {
    fn step_started(&self, step: Step) {
        self.track(|tracker, now| tracker.step_started(step, now));
        // Before there is any light one waits for it; later the light so far stays in sight.
        match step {
            Step::Bounce(0) | Step::Round(0) => self.next_due(FIRST_SNAPSHOT),
            Step::Shot(0) => self.next_due(Duration::ZERO),
            // Many of them may take less time than is between two looks.
            Step::Shot(_) => {}
            _ => self.next_due(SNAPSHOT_PERIOD),
        }
        self.shared.publish_phase(match step {
            Step::Validity => Phase::Probing,
            Step::Bounce(k) => Phase::Bounce(k),
            Step::Shot(shot) => Phase::Shot(shot),
            Step::FinalGather => Phase::FinalGather,
            Step::ReadDirect => Phase::ReadDirect,
            Step::Directional => Phase::Directional,
            Step::Round(round) => Phase::Round(round),
            Step::Layer(layer) => Phase::Layer(layer),
        });
    }

    fn step_done(&self, step: Step, state: &SolveState) {
        let remainder = self.baker.remainder(state);
        let accuracy = state.errors.as_ref().map(|errors| errors.accuracy);
        let seconds = self.track(|tracker, now| tracker.step_done(step, remainder, accuracy, now));
        if let Step::Bounce(_) | Step::Shot(_) = step {
            let moment = Moment::of(self.baker, state, self.shared.begun.elapsed().as_secs_f64());
            lock(&self.shared.published).course.extend(moment);
        }
        match step {
            Step::Bounce(bounce) => {
                self.publish_bounce(state, seconds.unwrap_or(0.0));
                if bounce == 0 {
                    self.publish_direct(state);
                }
            }
            // It may be there before what points have of it.
            Step::ReadDirect if !state.bounces.is_empty() => self.publish_direct(state),
            Step::Round(_) => self.publish_round(state),
            Step::Shot(_) if self.wants_snapshot() => {
                let (bounces, shot) = (state.bounces.clone(), state.shot.clone());
                self.hand_over(|mail| mail.shot = Some(SolveState { bounces, shot, ..SolveState::new() }));
            }
            Step::Shot(_) => {}
            Step::Validity | Step::FinalGather | Step::ReadDirect | Step::Directional | Step::Layer(_) => {
                return;
            }
        }
        if self.keep.is_some() {
            self.hand_over(|mail| mail.state = Some(state.clone()));
        }
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

/// Calls with the first bounce of a state, then with the first two, and so on.
fn for_each_prefix(state: &SolveState, mut call: impl FnMut(&SolveState)) {
    let mut so_far = SolveState { valid: state.valid.clone(), ..SolveState::new() };
    for bounce in &state.bounces {
        so_far.bounces.push(bounce.clone());
        call(&so_far);
    }
}
