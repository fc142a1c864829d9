//! How much a solve has to do, and how long it will still take.

use crate::Baker;
use crate::method::Method;
use crate::reading::Reading;
use crate::settings::{BasisKind, BounceLimit, Settings};
use lumel_solve::Step;

/// Below this share of a step that is done, its speed says little.
const MIN_SHARE: f64 = 0.02;

/// How much a solve has to do.
#[derive(Clone, Debug)]
pub(crate) struct Workload {
    /// Elements measured per bounce.
    elements: u64,
    rays: RaysPerElement,
    limit: BounceLimit,
    remainder: f64,
}

/// Hemisphere rays per element, by step.
#[derive(Clone, Copy, Debug)]
struct RaysPerElement {
    /// In the first bounce.
    first: f64,
    /// In each later bounce.
    later: f64,
    /// In the final gather.
    gathered: f64,
}

/// What is still missing after a bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// The bounce.
    pub after: u32,
    /// Share of all light that later bounces would bring.
    pub share: f64,
}

impl Workload {
    /// What a baker has to do.
    pub(crate) fn new(baker: &Baker) -> Self {
        Self::of(baker.elements_per_step(), baker.settings(), baker.method())
    }

    pub(crate) fn of(elements: u64, settings: &Settings, method: Method) -> Self {
        // A mesh has about twice as many triangles as vertices; each gets half the rays of a vertex.
        let share = if settings.basis == BasisKind::Vertex { 1.0 } else { 0.5 };
        let all = share * f64::from(settings.indirect_samples);
        let rays = match method {
            Method::Neumann | Method::Replicates { .. } => {
                RaysPerElement { first: all, later: all, gathered: 0.0 }
            }
            Method::Cached { .. } => RaysPerElement { first: all, later: 0.0, gathered: 0.0 },
            Method::FinalGather { stored, .. } => {
                RaysPerElement { first: share * f64::from(stored), later: 0.0, gathered: all }
            }
        };
        Self { elements, rays, limit: settings.bounces, remainder: f64::from(settings.remainder) }
    }

    /// The last bounce that will be computed, as far as it can be foreseen from the remainders so far.
    pub(crate) fn last_bounce(&self, remainders: &[Remainder]) -> Option<u32> {
        match self.limit {
            BounceLimit::Count(n) => Some(n),
            BounceLimit::All => {
                let [.., before, last] = remainders else { return None };
                let ratio = last.share / before.share;
                let more = (self.remainder / last.share).ln() / ratio.ln();
                let sensible = ratio > 0.0 && ratio < 1.0 && more.is_finite() && more < 1e4;
                sensible.then(|| last.after + more.max(0.0).ceil() as u32)
            }
        }
    }

    /// Share of a step that is done; `None` for a round, which has as many solves as it takes.
    pub(crate) fn step_share(&self, step: Step, elements: u64) -> Option<f64> {
        (!matches!(step, Step::Round(_))).then(|| (elements as f64 / self.elements.max(1) as f64).min(1.0))
    }

    /// Seconds until the end of the solve, where `done` was done of the current step; `None` while it is unknown, as
    /// with rounds for a target error.
    ///
    /// Assumes that later bounces trace rays as fast as the current step.
    pub(crate) fn seconds_left(&self, step: Step, done: Reading, remainders: &[Remainder]) -> Option<f64> {
        let share =
            self.step_share(step, done.elements).filter(|&share| share >= MIN_SHARE && done.rays > 0)?;
        let last = self.last_bounce(remainders)?;
        let RaysPerElement { first, later, gathered } = self.rays;
        let bounces_after = |bounce: u32| match last.saturating_sub(bounce) {
            0 => 0.0,
            n if bounce == 0 => first + f64::from(n - 1) * later,
            n => f64::from(n) * later,
        };
        let to_come = match step {
            Step::Validity => first + bounces_after(0) + gathered,
            Step::Bounce(bounce) => bounces_after(bounce) + gathered,
            Step::FinalGather | Step::Round(_) | Step::Layer(_) => 0.0,
        };
        let this_step = done.seconds * (1.0 - share) / share;
        Some(this_step + self.elements as f64 * to_come * done.seconds / done.rays as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Memory;

    fn workload(bounces: BounceLimit) -> Workload {
        let settings = Settings { bounces, indirect_samples: 100, ..Settings::default() };
        Workload::of(1000, &settings, Method::Neumann)
    }

    #[test]
    fn bounces_on_stored_rays_cost_nothing() {
        let settings =
            Settings { bounces: BounceLimit::Count(5), indirect_samples: 100, ..Settings::default() };
        let done = Reading { seconds: 2.0, elements: 500, rays: 50_000 };
        let cached = Workload::of(1000, &settings, Method::Cached { memory: Memory(1) });
        assert_eq!(cached.seconds_left(Step::Bounce(1), done, &[]), Some(2.0));
        assert_eq!(cached.seconds_left(Step::Bounce(0), done, &[]), Some(2.0 + 4.0));
        let method = Method::FinalGather { stored: 50, memory: Memory(1) };
        let gathers = Workload::of(1000, &settings, method);
        assert_eq!(gathers.seconds_left(Step::Bounce(0), done, &[]), Some(2.0 + 2.0 + 4.0));
        assert_eq!(gathers.seconds_left(Step::FinalGather, done, &[]), Some(2.0));
    }

    #[test]
    fn bounces_to_come_take_as_long_as_their_rays() {
        let work = workload(BounceLimit::Count(3));
        let done = Reading { seconds: 2.0, elements: 500, rays: 50_000 };
        // Half of bounce 1, then bounces 2 and 3 at 25000 rays a second.
        assert_eq!(work.seconds_left(Step::Bounce(1), done, &[]), Some(2.0 + 2.0 * 4.0));
        assert_eq!(work.seconds_left(Step::Bounce(1), Reading { elements: 1, ..done }, &[]), None);
        assert_eq!(work.seconds_left(Step::Round(1), done, &[]), None);
    }

    #[test]
    fn the_last_of_all_bounces_is_foreseen_from_how_they_shrink() {
        let work = workload(BounceLimit::All);
        let after = |shares: [f64; 2]| {
            let [first, second] = shares;
            [Remainder { after: 1, share: first }, Remainder { after: 2, share: second }]
        };
        assert_eq!(work.last_bounce(&after([0.5, 0.25])[..1]), None);
        // It halves each time: eight more until a thousandth.
        assert_eq!(work.last_bounce(&after([0.5, 0.25])), Some(2 + 8));
        assert_eq!(work.last_bounce(&after([0.5, 0.6])), None);
        assert_eq!(work.last_bounce(&after([f64::NAN, 0.6])), None);
    }
}
