//! How much a solve has to do, and how much of it is done.

use crate::Baker;
use crate::assembly::directional_plan;
use crate::layers::light_layers;
use crate::method::Method;
use crate::settings::{BounceLimit, Layers, Settings};
use lumel_basis::{Basis, Directional, Sampling};
use lumel_solve::Step;

/// Rays that are looked along at each vertex to tell whether it lies inside geometry, where none are kept.
const VALIDITY_RAYS: f64 = 64.0;

/// A mesh has about twice as many triangles as vertices; each gets this share of the rays of a vertex.
const AREA_SHARE: f64 = 0.5;

/// What reading the ends of kept rays takes of tracing them: the first time, when textures are looked up, and from then on.
/// Measured on the atrium.
const FIRST_READING: f64 = 0.3;
const READING: f64 = 0.04;

/// How much a solve has to do.
#[derive(Clone, Debug)]
pub(crate) struct Workload {
    /// Elements measured per bounce.
    elements: u64,
    work: Work,
    /// Direct light at the vertices, where points carry the bounces.
    at_vertices: Option<AtVertices>,
    /// Layers of lights that are told apart in the end.
    layers: u32,
    limit: BounceLimit,
    remainder: f64,
    /// The last bounce, as far as settings and albedo tell.
    expected: Option<u32>,
}

/// Work per element, by step, in rays that are traced.
#[derive(Clone, Copy, Debug)]
struct Work {
    /// Looking inside geometry: 0 over areas, whose samples tell it by themselves.
    validity: f64,
    /// Direct light.
    direct: f64,
    /// The first bounce.
    first: f64,
    /// Each later bounce.
    later: f64,
    /// The final gather.
    gather: f64,
    /// Light by direction.
    directional: f64,
    /// Direct light alone, as for a layer.
    shadow: f64,
    /// Whether rays are kept.
    keeps_rays: bool,
}

/// How much measuring direct light at the vertices has to do.
#[derive(Clone, Copy, Debug)]
struct AtVertices {
    /// Elements measured, all jobs together.
    elements: u64,
    /// Work per element of a bounce, in rays that are traced.
    work: f64,
    /// Whether it comes before all other steps: which points are measured depends on it.
    is_first: bool,
}

impl AtVertices {
    fn new(baker: &Baker) -> Option<Self> {
        let (settings, direct) = (baker.settings(), baker.at_vertices()?);
        let shape = direct.transport.shape();
        let shadow = f64::from(settings.direct_samples);
        let by_rays = if direct.needs_hemisphere { f64::from(settings.indirect_samples) } else { 0.0 };
        let (jobs, rays) = match shape.sampling {
            Sampling::Point => (2, VALIDITY_RAYS + shadow + by_rays),
            // Places that see the lights are looked from, too.
            Sampling::Area => (1, AREA_SHARE * (2.0 * shadow + by_rays)),
        };
        let elements = shape.elements as u64;
        let work = rays * elements as f64 / baker.elements_per_step().max(1) as f64;
        let is_first = settings.refines_points() && baker.basis().direct().is_some();
        Some(Self { elements: jobs * elements, work, is_first })
    }
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
        let expected = u32::try_from(baker.expected_steps().saturating_sub(1)).ok();
        let at_vertices = AtVertices::new(baker);
        Self {
            at_vertices,
            layers,
            expected,
            ..Self::of(baker.elements_per_step(), settings, baker.method())
        }
    }

    /// Without layers.
    pub(crate) fn of(elements: u64, settings: &Settings, method: Method) -> Self {
        let over_areas = settings.projection.sampling() == Sampling::Area;
        let share = if over_areas { AREA_SHARE } else { 1.0 };
        let all = share * f64::from(settings.indirect_samples);
        let shadow = f64::from(settings.direct_samples);
        let directional = match settings.directional {
            Directional::Off => 0.0,
            Directional::Sh1 | Directional::Sh2 => {
                let plan = directional_plan(settings.plan());
                share * f64::from(plan.indirect_samples) + f64::from(plan.direct_samples)
            }
        };
        let (kept, gather) = match method {
            Method::Neumann | Method::Replicates { .. } => (0.0, 0.0),
            Method::Cached { .. } => (all, 0.0),
            Method::FinalGather { stored, .. } => (share * f64::from(stored), all),
        };
        let keeps_rays = kept > 0.0;
        // Rays to keep are traced by the first step, which looks inside geometry along them.
        let looking = match (keeps_rays, over_areas) {
            (true, _) => kept,
            (false, true) => all,
            (false, false) => VALIDITY_RAYS,
        };
        let (validity, direct) = if over_areas { (0.0, shadow + looking) } else { (looking, shadow) };
        let (first, later) = if keeps_rays { (FIRST_READING * kept, READING * kept) } else { (all, all) };
        let work = Work { validity, direct, first, later, gather, directional, shadow, keeps_rays };
        let (limit, remainder) = (settings.bounces, f64::from(settings.remainder));
        Self { elements, work, at_vertices: None, layers: 0, limit, remainder, expected: None }
    }

    /// Whether a step traces the rays that later ones read.
    pub(crate) fn traces_kept_rays(&self, step: Step) -> bool {
        let first = if self.work.validity > 0.0 { Step::Validity } else { Step::Bounce(0) };
        self.work.keeps_rays && step == first
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

    /// Share of a step that is done; `None` for a round, which has as many solves as it takes, and for a layer while the number of
    /// its bounces is unknown.
    pub(crate) fn step_share(&self, step: Step, elements: u64, remainders: &[Remainder]) -> Option<f64> {
        let jobs = match step {
            Step::Round(_) => return None,
            Step::ReadDirect => {
                let all = self.at_vertices?.elements.max(1);
                return Some((elements as f64 / all as f64).min(1.0));
            }
            Step::Validity | Step::Bounce(_) | Step::Shot(_) | Step::FinalGather => 1,
            Step::Directional => 1 + u64::from(self.last_bounce(remainders) != Some(0)),
            Step::Layer(_) => {
                let last = self.last_bounce(remainders)?;
                let gathers = last > 0 && self.work.gather > 0.0;
                let by_direction = if self.work.directional > 0.0 { 1 + u64::from(last > 0) } else { 0 };
                u64::from(last) + 1 + u64::from(gathers) + by_direction
            }
        };
        Some((elements as f64 / (jobs * self.elements).max(1) as f64).min(1.0))
    }

    /// Share of the whole solve that is done in the middle of a step, by the rays that it takes; `None` while it is unknown, as
    /// with rounds for a target error.
    pub(crate) fn share(&self, step: Step, elements: u64, remainders: &[Remainder]) -> Option<f64> {
        let of_step = self.step_share(step, elements, remainders)?;
        let last = self.last_bounce(remainders).or(self.expected)?;
        let last = if let Step::Bounce(bounce) = step { last.max(bounce) } else { last };
        let [before, after] = self.around(step, last)?;
        Some((before + of_step * (after - before)) / self.before_layer(self.layers, last))
    }

    /// Share of the whole solve before a step.
    pub(crate) fn share_before(&self, step: Step, remainders: &[Remainder]) -> Option<f64> {
        self.share(step, 0, remainders)
    }

    /// The work before a step and after it, where `last` is the last bounce.
    fn around(&self, step: Step, last: u32) -> Option<[f64; 2]> {
        let Work { validity, direct, gather, .. } = self.work;
        let read = self.read_direct();
        let first = if self.at_vertices.is_some_and(|direct| direct.is_first) { read } else { 0.0 };
        let after = |bounces: u32| validity + direct + read + self.bounces(bounces);
        let all = after(last) + if last > 0 { gather } else { 0.0 };
        Some(match step {
            Step::ReadDirect if first > 0.0 => [0.0, first],
            Step::Validity => [first, first + validity],
            Step::Bounce(0) => [first + validity, first + validity + direct],
            Step::ReadDirect => [after(0) - read, after(0)],
            Step::Bounce(bounce) => [after(bounce - 1), after(bounce)],
            Step::FinalGather => [after(last), all],
            Step::Directional => [all, self.before_layer(0, last)],
            Step::Layer(layer) => [layer, layer + 1].map(|layer| self.before_layer(layer, last)),
            // How many will follow is not known.
            Step::Round(_) | Step::Shot(_) => return None,
        })
    }

    /// The work before a layer.
    fn before_layer(&self, layer: u32, last: u32) -> f64 {
        let Work { validity, direct, later, gather, directional, shadow, .. } = self.work;
        let gather = if last > 0 { gather } else { 0.0 };
        let of_layer = shadow + f64::from(last) * later + gather + directional;
        let once = validity + direct + self.read_direct();
        once + self.bounces(last) + gather + directional + f64::from(layer) * of_layer
    }

    /// The work of direct light at the vertices.
    fn read_direct(&self) -> f64 {
        self.at_vertices.map_or(0.0, |direct| direct.work)
    }

    /// The work of so many bounces.
    fn bounces(&self, n: u32) -> f64 {
        let Work { first, later, .. } = self.work;
        if n == 0 { 0.0 } else { first + f64::from(n - 1) * later }
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
    fn rays_that_are_kept_are_traced_first_and_then_read() {
        let settings = Settings {
            bounces: BounceLimit::Count(5),
            direct_samples: 50,
            indirect_samples: 100,
            ..at_vertices()
        };
        let cached = Workload::of(1000, &settings, Method::Cached { memory: Memory(1) });
        let share = |step, elements| cached.share(step, elements, &[]);
        // 100 rays, 50 of direct light, and what reading 100 takes once and four times more.
        assert_eq!(share(Step::Validity, 500), Some(50.0 / 196.0));
        assert_eq!(share(Step::Bounce(0), 500), Some(125.0 / 196.0));
        assert_eq!(share(Step::Bounce(3), 0), Some(184.0 / 196.0));
        assert_eq!(share(Step::Bounce(5), 1000), Some(1.0));
        assert!(cached.traces_kept_rays(Step::Validity) && !cached.traces_kept_rays(Step::Bounce(0)));
        let method = Method::FinalGather { stored: 50, memory: Memory(1) };
        let gathers = Workload::of(1000, &settings, method);
        assert_eq!(gathers.share(Step::FinalGather, 500, &[]), Some((123.0 + 50.0) / 223.0));
        let over_areas = Settings { projection: Projection::Area, ..settings };
        let cached = Workload::of(1000, &over_areas, Method::Cached { memory: Memory(1) });
        assert_eq!(cached.share(Step::Bounce(0), 500, &[]), Some(50.0 / 123.0));
        assert!(cached.traces_kept_rays(Step::Bounce(0)));
    }

    #[test]
    fn layers_of_lights_are_steps_to_come() {
        let settings = Settings {
            bounces: BounceLimit::Count(3),
            direct_samples: 25,
            indirect_samples: 100,
            ..at_vertices()
        };
        let with = |method| Workload { layers: 4, ..Workload::of(1000, &settings, method) };
        let cached = with(Method::Cached { memory: Memory(1) });
        // 100 rays, 25 of direct light and three times reading; then four times 25 and three times reading again.
        let (before, layer) = (163.0, 37.0);
        assert_eq!(cached.share(Step::Layer(0), 0, &[]), Some(before / (before + 4.0 * layer)));
        let share = (before + 2.5 * layer) / (before + 4.0 * layer);
        assert_eq!(cached.share(Step::Layer(2), 2000, &[]), Some(share));
        let gathers = with(Method::FinalGather { stored: 50, memory: Memory(1) });
        // Each measures four times, or five with a gather.
        assert_eq!(cached.step_share(Step::Layer(2), 1000, &[]), Some(0.25));
        assert_eq!(gathers.step_share(Step::Layer(0), 1000, &[]), Some(0.2));
        assert_eq!(workload(BounceLimit::All).step_share(Step::Layer(0), 1000, &[]), None);
    }

    #[test]
    fn direct_light_at_vertices_comes_before_the_first_bounce_or_before_all() {
        let settings = Settings {
            bounces: BounceLimit::Count(1),
            direct_samples: 50,
            indirect_samples: 100,
            ..at_vertices()
        };
        // 100 rays to keep, 50 of direct light, 60 at the vertices, and what reading 100 takes once.
        let work = |is_first| Workload {
            at_vertices: Some(AtVertices { elements: 4000, work: 60.0, is_first }),
            ..Workload::of(1000, &settings, Method::Cached { memory: Memory(1) })
        };
        let share = |is_first, step, elements| work(is_first).share(step, elements, &[]).unwrap() * 240.0;
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        is(share(false, Step::Validity, 500), 50.0);
        is(share(false, Step::Bounce(0), 500), 125.0);
        is(share(false, Step::ReadDirect, 1000), 165.0);
        is(share(true, Step::ReadDirect, 1000), 15.0);
        is(share(true, Step::Validity, 500), 110.0);
        is(share(true, Step::Bounce(0), 500), 185.0);
        is(share(false, Step::Bounce(1), 500), 225.0);
        is(share(true, Step::Bounce(1), 500), 225.0);
        assert_eq!(work(false).step_share(Step::ReadDirect, 1000, &[]), Some(0.25));
    }

    #[test]
    fn the_number_of_bounces_is_expected_before_it_can_be_foreseen() {
        let unknown = workload(BounceLimit::All);
        assert_eq!(unknown.share(Step::Bounce(1), 500, &[]), None);
        let expected = Workload { expected: Some(2), ..unknown };
        let shadow = f64::from(Settings::default().direct_samples);
        let before = VALIDITY_RAYS + shadow;
        let share = |step, elements| expected.share(step, elements, &[]).unwrap();
        assert_eq!(share(Step::Bounce(1), 500), (before + 50.0) / (before + 200.0));
        // There are more than were expected.
        assert_eq!(share(Step::Bounce(3), 500), (before + 250.0) / (before + 300.0));
        assert_eq!(expected.share(Step::Round(1), 500, &[]), None);
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
