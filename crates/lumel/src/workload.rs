//! How much a solve has to do, and how long it will still take.

use crate::Baker;
use crate::assembly::directional_plan;
use crate::layers::light_layers;
use crate::method::Method;
use crate::reading::Reading;
use crate::settings::{BounceLimit, Layers, Settings};
use lumel_basis::{Directional, Sampling};
use lumel_solve::Step;

/// Below this share of a step that is done, its speed says little.
const MIN_SHARE: f64 = 0.02;

/// How much a solve has to do.
#[derive(Clone, Debug)]
pub(crate) struct Workload {
    /// Elements measured per bounce.
    elements: u64,
    rays: RaysPerElement,
    /// Layers of lights that are told apart in the end.
    layers: u32,
    limit: BounceLimit,
    remainder: f64,
}

/// Rays per element, by step.
#[derive(Clone, Copy, Debug)]
struct RaysPerElement {
    /// Shadow rays to one light.
    shadow: f64,
    /// In the first bounce.
    first: f64,
    /// In each later bounce, and in each bounce of a layer.
    later: f64,
    /// In the final gather.
    gathered: f64,
    /// By direction, shadow rays included.
    directional: f64,
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
        let settings = baker.settings();
        let layers = match settings.layers {
            Layers::Off => 0,
            Layers::Lights => light_layers(baker.scene(), settings).len() as u32,
        };
        Self { layers, ..Self::of(baker.elements_per_step(), settings, baker.method()) }
    }

    /// Without layers.
    pub(crate) fn of(elements: u64, settings: &Settings, method: Method) -> Self {
        // A mesh has about twice as many triangles as vertices; each gets half the rays of a vertex.
        let share = if settings.sampling() == Sampling::Point { 1.0 } else { 0.5 };
        let all = share * f64::from(settings.indirect_samples);
        let shadow = f64::from(settings.direct_samples);
        let directional = match settings.directional {
            Directional::Off => 0.0,
            Directional::Sh1 | Directional::Sh2 => {
                let plan = directional_plan(settings.plan());
                share * f64::from(plan.indirect_samples) + f64::from(plan.direct_samples)
            }
        };
        let (first, later, gathered) = match method {
            Method::Neumann | Method::Replicates { .. } => (all, all, 0.0),
            Method::Cached { .. } => (all, 0.0, 0.0),
            Method::FinalGather { stored, .. } => (share * f64::from(stored), 0.0, all),
        };
        let rays = RaysPerElement { shadow, first, later, gathered, directional };
        let (limit, remainder) = (settings.bounces, f64::from(settings.remainder));
        Self { elements, rays, layers: 0, limit, remainder }
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

    /// How many layers of lights there are.
    pub(crate) fn layers(&self) -> u32 {
        self.layers
    }

    /// Share of a step that is done; `None` for a round, which has as many solves as it takes, for direct light that is read elsewhere, and for a layer while the
    /// number of its bounces is unknown.
    pub(crate) fn step_share(&self, step: Step, elements: u64, remainders: &[Remainder]) -> Option<f64> {
        let jobs = match step {
            Step::Round(_) | Step::ReadDirect => return None,
            Step::Validity | Step::Bounce(_) | Step::Shot(_) | Step::FinalGather => 1,
            Step::Directional => 1 + u64::from(self.last_bounce(remainders) != Some(0)),
            Step::Layer(_) => {
                let last = self.last_bounce(remainders)?;
                let gathers = last > 0 && self.rays.gathered > 0.0;
                let by_direction = if self.rays.directional > 0.0 { 1 + u64::from(last > 0) } else { 0 };
                u64::from(last) + 1 + u64::from(gathers) + by_direction
            }
        };
        Some((elements as f64 / (jobs * self.elements).max(1) as f64).min(1.0))
    }

    /// Seconds until the end of the solve, where `done` was done of the current step; `None` while it is unknown, as
    /// with rounds for a target error.
    ///
    /// Assumes that later steps trace rays as fast as the current step, and that layers take as long as each other.
    pub(crate) fn seconds_left(&self, step: Step, done: Reading, remainders: &[Remainder]) -> Option<f64> {
        let share = self.step_share(step, done.elements, remainders).filter(|&share| share >= MIN_SHARE)?;
        let last = self.last_bounce(remainders)?;
        let this_step = done.seconds * (1.0 - share) / share;
        let RaysPerElement { shadow, first, later, gathered, directional } = self.rays;
        let bounces_after = |bounce: u32| match last.saturating_sub(bounce) {
            0 => 0.0,
            n if bounce == 0 => first + f64::from(n - 1) * later,
            n => f64::from(n) * later,
        };
        let gather = if last > 0 { gathered } else { 0.0 };
        let layers = f64::from(self.layers) * (shadow + f64::from(last) * later + gather + directional);
        let to_come = match step {
            Step::Validity => first + bounces_after(0) + gathered + directional + layers,
            Step::Bounce(bounce) => bounces_after(bounce) + gathered + directional + layers,
            Step::FinalGather => directional + layers,
            Step::Directional | Step::ReadDirect => layers,
            Step::Layer(layer) => {
                let to_come = self.layers.saturating_sub(layer + 1);
                return Some(this_step + f64::from(to_come) * done.seconds / share);
            }
            // How many shots will follow is not known.
            Step::Round(_) | Step::Shot(_) => return None,
        };
        let rays = self.elements as f64 * to_come;
        (done.rays > 0).then(|| this_step + rays * done.seconds / done.rays as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Memory, Projection};

    fn at_vertices() -> Settings {
        Settings { projection: Projection::Point, ..Settings::default() }
    }

    fn workload(bounces: BounceLimit) -> Workload {
        let settings = Settings { bounces, indirect_samples: 100, ..at_vertices() };
        Workload::of(1000, &settings, Method::Neumann)
    }

    #[test]
    fn bounces_on_stored_rays_cost_nothing() {
        let settings = Settings { bounces: BounceLimit::Count(5), indirect_samples: 100, ..at_vertices() };
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
    fn layers_of_lights_are_steps_to_come() {
        let settings = Settings {
            bounces: BounceLimit::Count(3),
            direct_samples: 25,
            indirect_samples: 100,
            ..at_vertices()
        };
        let done = Reading { seconds: 2.0, elements: 500, rays: 50_000 };
        let with = |method| Workload { layers: 4, ..Workload::of(1000, &settings, method) };
        let cached = with(Method::Cached { memory: Memory(1) });
        // Half of bounce 1 at 25 000 rays a second, then 25 shadow rays for each element and layer.
        assert_eq!(cached.seconds_left(Step::Bounce(1), done, &[]), Some(2.0 + 4.0));
        let traced = with(Method::Neumann);
        assert_eq!(traced.seconds_left(Step::Bounce(3), done, &[]), Some(2.0 + 4.0 * (1.0 + 3.0 * 4.0)));
        let gathers = with(Method::FinalGather { stored: 50, memory: Memory(1) });
        assert_eq!(gathers.seconds_left(Step::FinalGather, done, &[]), Some(2.0 + 4.0 * (1.0 + 4.0)));
        // Each measures four times, or five with a gather; the third takes as long as the last.
        let layer = Reading { elements: 1000, ..done };
        assert_eq!(cached.step_share(Step::Layer(2), 1000, &[]), Some(0.25));
        assert_eq!(cached.seconds_left(Step::Layer(2), layer, &[]), Some(6.0 + 8.0));
        assert_eq!(cached.seconds_left(Step::Layer(3), Reading { rays: 0, ..layer }, &[]), Some(6.0));
        assert_eq!(gathers.step_share(Step::Layer(0), 1000, &[]), Some(0.2));
        assert_eq!(workload(BounceLimit::All).step_share(Step::Layer(0), 1000, &[]), None);
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
        // It halves each time: five more until a hundredth.
        assert_eq!(work.last_bounce(&after([0.5, 0.25])), Some(2 + 5));
        assert_eq!(work.last_bounce(&after([0.5, 0.6])), None);
        assert_eq!(work.last_bounce(&after([f64::NAN, 0.6])), None);
    }
}
