//! How long a solve will still take.

use crate::Baker;
use crate::method::Method;
use crate::settings::{BasisKind, BounceLimit, Settings};
use lumel_solve::Step;

/// How much there is to do.
#[derive(Clone, Debug)]
pub struct Workload {
    /// Elements measured per bounce.
    elements: u64,
    rays: RaysPerElement,
    limit: BounceLimit,
    remainder: f64,
}

/// Hemisphere rays of an element by step.
#[derive(Clone, Copy, Debug)]
struct RaysPerElement {
    /// In the first bounce.
    first: f64,
    /// In each bounce after it.
    later: f64,
    /// At the end.
    gathered: f64,
}

/// How far the solve is.
#[derive(Clone, Copy, Debug)]
pub struct Position {
    /// What is being measured.
    pub step: Step,
    /// Seconds since it began.
    pub seconds: f64,
    /// Elements measured since then.
    pub elements: u64,
    /// Rays traced since then.
    pub rays: u64,
}

/// What is still missing after a bounce.
#[derive(Clone, Copy, Debug)]
pub struct Remainder {
    /// The bounce.
    pub after: u32,
    /// Share of all light.
    pub share: f64,
}

impl Workload {
    /// That of a baker.
    pub fn new(baker: &Baker) -> Self {
        Self::of(baker.elements_per_step(), baker.settings(), baker.method())
    }

    fn of(elements: u64, settings: &Settings, method: Method) -> Self {
        // Per triangle half as many, of which there are twice as many as vertices.
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

    /// The last bounce, as far as it is known: from the remainders after the bounces so far.
    pub fn last_bounce(&self, remainders: &[Remainder]) -> Option<u32> {
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

    /// Share of the current step that is done.
    pub fn share(&self, at: &Position) -> f64 {
        (at.elements as f64 / self.elements.max(1) as f64).min(1.0)
    }

    /// [`share`](Self::share), where it can be told: not of a round, whose solves are as many as it takes.
    pub fn share_known(&self, at: &Position) -> Option<f64> {
        (!matches!(at.step, Step::Round(_))).then(|| self.share(at))
    }

    /// Seconds until the end of the solve; `None` while nobody can tell, as with rounds until an error is reached.
    ///
    /// Bounces to come are taken to trace rays as fast as the current step.
    pub fn seconds_left(&self, at: &Position, remainders: &[Remainder]) -> Option<f64> {
        let share = self.share(at);
        if share < 0.02 || at.rays == 0 || matches!(at.step, Step::Round(_)) {
            return None;
        }
        let last = self.last_bounce(remainders)?;
        let RaysPerElement { first, later, gathered } = self.rays;
        let bounces_after = |bounce: u32| match last.saturating_sub(bounce) {
            0 => 0.0,
            n if bounce == 0 => first + f64::from(n - 1) * later,
            n => f64::from(n) * later,
        };
        let to_come = match at.step {
            Step::Probe => first + bounces_after(0) + gathered,
            Step::Bounce(bounce) => bounces_after(bounce) + gathered,
            Step::FinalGather | Step::Round(_) => 0.0,
        };
        let this_step = at.seconds * (1.0 - share) / share;
        Some(this_step + self.elements as f64 * to_come * at.seconds / at.rays as f64)
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
        let at = |step| Position { step, seconds: 2.0, elements: 500, rays: 50_000 };
        let cached = Workload::of(1000, &settings, Method::Cached { memory: Memory(1) });
        assert_eq!(cached.seconds_left(&at(Step::Bounce(1)), &[]), Some(2.0));
        assert_eq!(cached.seconds_left(&at(Step::Bounce(0)), &[]), Some(2.0 + 4.0));
        let method = Method::FinalGather { stored: 50, memory: Memory(1) };
        let gathers = Workload::of(1000, &settings, method);
        assert_eq!(gathers.seconds_left(&at(Step::Bounce(0)), &[]), Some(2.0 + 2.0 + 4.0));
        assert_eq!(gathers.seconds_left(&at(Step::FinalGather), &[]), Some(2.0));
    }

    #[test]
    fn bounces_to_come_take_as_long_as_their_rays() {
        let work = workload(BounceLimit::Count(3));
        let at = Position { step: Step::Bounce(1), seconds: 2.0, elements: 500, rays: 50_000 };
        // Half of bounce 1, then bounces 2 and 3 at 25000 rays a second.
        assert_eq!(work.seconds_left(&at, &[]), Some(2.0 + 2.0 * 4.0));
        assert_eq!(work.seconds_left(&Position { elements: 1, ..at }, &[]), None);
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
