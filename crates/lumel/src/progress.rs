//! How far a solve is: what programs and windows display.

use crate::Baker;
use crate::reading::Reading;
use crate::workload::{Remainder, Workload};
use lumel_solve::{Accuracy, SolveState, Step};

/// Below this share of a solve that is done, its speed says little.
const MIN_SHARE: f64 = 0.02;

/// Follows a solve and foresees its end.
///
/// An [`Observer`](crate::Observer) tells it of every step, with the time; whoever displays progress asks it at any
/// time in between.
#[derive(Clone, Debug)]
pub struct Tracker {
    workload: Workload,
    /// The first step and when it began: what was done before is known from a checkpoint.
    started: Option<(Step, Reading)>,
    /// The last step that began.
    current: Option<Current>,
    remainders: Vec<Remainder>,
    missing: Option<f64>,
    accuracy: Option<Accuracy>,
    steps: Vec<(Step, f64)>,
}

/// A step.
#[derive(Clone, Copy, Debug)]
struct Current {
    step: Step,
    started: Reading,
    /// When it was done; the next step may begin later, after a checkpoint.
    done: Option<Reading>,
}

/// How far a solve is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// What is being computed, or was last; `None` before the first step.
    pub step: Option<Step>,
    /// Share of the step that is done; `None` for a round of a target error, which has as many solves as it takes, and
    /// for a layer while the number of its bounces cannot be told.
    pub step_share: Option<f64>,
    /// Share of the whole solve that is done, by time; `None` while [`seconds_left`](Self::seconds_left) is.
    pub share: Option<f64>,
    /// Seconds until the solve ends, if it goes on as it went so far; `None` while it is unknown.
    pub seconds_left: Option<f64>,
    /// Rays per second in this step, if it traces any.
    pub rays_per_second: Option<f64>,
    /// Whether this step traces the rays that later ones read.
    pub traces_kept_rays: bool,
    /// The last bounce that will be computed, as far as it is known.
    pub last_bounce: Option<u32>,
    /// How many layers of lights are told apart after the last bounce.
    pub layers: u32,
    /// What was missing after the last finished bounce, if it could be told.
    pub remainder: Option<Remainder>,
    /// Share of all light that was missing after the last shot, where light is shot.
    pub missing: Option<f64>,
    /// What the last round has reached, where there is a target error.
    pub accuracy: Option<Accuracy>,
}

impl Tracker {
    /// For a solve that begins with `state`.
    pub fn new(baker: &Baker, state: &SolveState) -> Self {
        let after = |n: usize| {
            let bounces = state.bounces[..n].to_vec();
            let share = baker.remainder(&SolveState { bounces, ..SolveState::new() })?;
            Some(Remainder { after: n as u32 - 1, share })
        };
        // The end is foreseen from the last two.
        let n = state.bounces.len();
        let remainders = (n.saturating_sub(1).max(1)..=n).filter_map(after).collect();
        let accuracy = state.errors.as_ref().map(|errors| errors.accuracy);
        let missing = state.shot.as_ref().and_then(|_| baker.remainder(state));
        Self { remainders, missing, accuracy, ..Self::of(Workload::new(baker)) }
    }

    fn of(workload: Workload) -> Self {
        Self {
            workload,
            started: None,
            current: None,
            remainders: Vec::new(),
            missing: None,
            accuracy: None,
            steps: Vec::new(),
        }
    }

    /// A step begins.
    pub fn step_started(&mut self, step: Step, now: Reading) {
        self.started.get_or_insert((step, now));
        self.current = Some(Current { step, started: now, done: None });
    }

    /// A step is done. `remainder` is [`Baker::remainder`] of its state, `accuracy` that of the state's errors.
    ///
    /// Returns the seconds it took.
    pub fn step_done(
        &mut self,
        step: Step,
        remainder: Option<f64>,
        accuracy: Option<Accuracy>,
        now: Reading,
    ) -> f64 {
        let mut seconds = 0.0;
        if let Some(current) = self.current.as_mut().filter(|current| current.step == step) {
            current.done = Some(now);
            seconds = now.since(current.started).seconds;
        }
        self.steps.push((step, seconds));
        if let (Step::Bounce(after), Some(share)) = (step, remainder) {
            self.remainders.push(Remainder { after, share });
        }
        if let Step::Shot(_) = step {
            self.missing = remainder;
        }
        self.accuracy = accuracy;
        seconds
    }

    /// The finished steps, and how many seconds each took.
    pub fn steps(&self) -> &[(Step, f64)] {
        &self.steps
    }

    /// How far the solve is.
    pub fn progress(&self, now: Reading) -> Progress {
        let fixed = Progress {
            layers: self.workload.layers(),
            last_bounce: self.workload.last_bounce(&self.remainders),
            remainder: self.remainders.last().copied(),
            missing: self.missing,
            accuracy: self.accuracy,
            ..Progress::default()
        };
        let Some(Current { step, started, done }) = self.current else { return fixed };
        let done = done.unwrap_or(now).since(started);
        let elapsed = self.started.map_or(0.0, |(_, started)| now.since(started).seconds);
        let seconds_left = self.seconds_left(step, done.elements, elapsed);
        Progress {
            step: Some(step),
            step_share: self.workload.step_share(step, done.elements, &self.remainders),
            share: seconds_left.map(|left| elapsed / (elapsed + left)),
            seconds_left,
            // A clock may not have moved yet.
            rays_per_second: (done.rays > 0).then(|| done.rays as f64 / done.seconds.max(1e-6)),
            traces_kept_rays: self.workload.traces_kept_rays(step),
            ..fixed
        }
    }

    /// Seconds until the end, if it goes on as it went so far.
    fn seconds_left(&self, step: Step, elements: u64, elapsed: f64) -> Option<f64> {
        let share = self.workload.share(step, elements, &self.remainders)?;
        let done = share - self.workload.share_before(self.started?.0, &self.remainders)?;
        (done >= MIN_SHARE).then(|| elapsed * (1.0 - share) / done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BounceLimit, Projection, Settings};

    fn tracker(bounces: BounceLimit) -> Tracker {
        let settings =
            Settings { projection: Projection::Point, bounces, indirect_samples: 100, ..Settings::default() };
        Tracker::of(Workload::of(1000, &settings, crate::Method::Neumann))
    }

    fn at(seconds: f64, elements: u64, rays: u64) -> Reading {
        Reading { seconds, elements, rays }
    }

    #[test]
    fn progress_is_that_of_the_current_step_and_of_the_whole() {
        let mut tracker = tracker(BounceLimit::Count(2));
        // The clock and the counters were used before.
        tracker.step_started(Step::Bounce(0), at(100.0, 70, 7));
        assert_eq!(tracker.progress(at(100.0, 70, 7)).step_share, Some(0.0));
        assert_eq!(tracker.step_done(Step::Bounce(0), None, None, at(102.0, 1070, 2007)), 2.0);
        // A checkpoint is written; the step is done and no slower for it.
        let between = tracker.progress(at(103.0, 1070, 2007));
        assert_eq!((between.step_share, between.rays_per_second), (Some(1.0), Some(1000.0)));
        tracker.step_started(Step::Bounce(1), at(103.0, 1070, 2007));
        let progress = tracker.progress(at(104.0, 1320, 27_007));
        assert_eq!((progress.step, progress.step_share), (Some(Step::Bounce(1)), Some(0.25)));
        assert_eq!((progress.rays_per_second, progress.last_bounce), (Some(25_000.0), Some(2)));
        // 64 rays of direct light and 25 of the bounce, after 4 s; the rest of the bounce and another of 100 rays are to come.
        let left = 4.0 * 175.0 / 89.0;
        assert!((progress.seconds_left.unwrap() - left).abs() < 1e-9);
        assert!((progress.share.unwrap() - 4.0 / (4.0 + left)).abs() < 1e-9);
        assert_eq!(tracker.steps(), [(Step::Bounce(0), 2.0)]);
    }

    #[test]
    fn the_last_bounce_is_foreseen_from_remainders() {
        let mut tracker = tracker(BounceLimit::All);
        for (bounce, share) in [(1, 0.5), (2, 0.25)] {
            tracker.step_started(Step::Bounce(bounce), Reading::default());
            tracker.step_done(Step::Bounce(bounce), Some(share), None, Reading::default());
        }
        let progress = tracker.progress(Reading::default());
        // It halves each time: five more until a hundredth.
        assert_eq!(progress.last_bounce, Some(2 + 5));
        assert_eq!(progress.remainder, Some(Remainder { after: 2, share: 0.25 }));
    }

    #[test]
    fn a_round_has_no_share_and_no_end_in_sight() {
        let mut tracker = tracker(BounceLimit::Count(2));
        tracker.step_started(Step::Round(0), Reading::default());
        let progress = tracker.progress(at(1.0, 500, 1000));
        assert_eq!((progress.step_share, progress.share, progress.seconds_left), (None, None, None));
        assert_eq!(progress.rays_per_second, Some(1000.0));
    }
}
