//! From a solve on vertices to light on the lumels of an atlas.

use crate::Baker;
use crate::BounceBasis;
use crate::assembly::directional_plan;
use crate::settings::Memory;
use crate::target::target;
use lumel_basis::{Basis, Directional, Field, Identity, LumelReceivers, NodeId, Receivers};
use lumel_lightmap::{LumelLight, PartLight};
use lumel_sample::SamplerKind;
use lumel_scene::Scene;
use lumel_solve::{Gatherable, SolveState, Target};
use lumel_transport::{
    CachedTransport, Control, CpuTransport, DIRECTIONAL_PASS, DirectionalTransport, Job, Order, Plan, Source,
    Stored, TransportError, accumulate,
};
use lumel_uv::{Atlas, Coverage};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// Where lumels lie on the surfaces of a scene.
#[derive(Clone, Debug)]
pub struct Lumels {
    /// The scene that was unwrapped.
    pub scene: Arc<Scene>,
    /// The places of its triangles.
    pub atlas: Arc<Atlas>,
    /// What each lumel covers.
    pub coverage: Arc<Coverage>,
}

impl Lumels {
    /// The lumels of an atlas of a scene.
    pub fn new(scene: Arc<Scene>, atlas: Atlas) -> Self {
        let coverage = Arc::new(Coverage::new(&atlas));
        Self { scene, atlas: Arc::new(atlas), coverage }
    }

    /// What decides the lumels: scene and atlas.
    pub fn identity(&self) -> Identity {
        self.receivers().identity()
    }

    fn receivers(&self) -> LumelReceivers {
        let Self { scene, atlas, coverage } = self;
        LumelReceivers::new(Arc::clone(scene), Arc::clone(atlas), Arc::clone(coverage))
    }
}

/// Lumels that are measured together at most: so many are lost when a bake is killed.
const PART: usize = 1 << 16;

/// Each half of the first round has this share of the samples of the settings.
const FIRST_SHARE: u32 = 4;

/// At least so many samples are asked for of each half, of which an area gets half.
const MIN_SAMPLES: u32 = 8;

/// The share of all lumels that each round after the first measures, doubling their samples: with a half of the samples of the
/// settings in the first round, all rounds together have as many as the settings say.
const SHARES: [f64; 2] = [0.5, 0.25];

/// Lumels darker than this share of the mean light are compared with it, where samples go to the noisiest lumels.
///
/// Measured in the Cornell box and the atrium: a tenth of it takes samples from bright lumels, whose noise is most of the mean
/// square; with the mean itself, shadows stay grainy.
const DIM: f64 = 0.5;

/// Lumels darker than this share of the mean light are compared with it, where a target error is relative.
const DARK: f64 = 0.1;

/// Half the width of a 95 % interval, in standard errors that many lumels tell together.
const CONFIDENCE: f32 = 1.96;

/// How noisy the light at lumels is: half the width of a 95 % interval of the luminance of all light, relative to it or to a
/// tenth of the mean light where that is more, as the differences of two halves of the samples say, of each lumel and those
/// around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumelAccuracy {
    /// Half of all lumels are below.
    pub median: f64,
    /// 95 % of all lumels are below.
    pub percentile_95: f64,
    /// The share of lumels that are below the target error, if there is one.
    pub share: Option<f64>,
}

/// How lumels are measured: in which parts, and with which rays.
///
/// Neither changes a bit of their light.
pub struct LumelParts {
    /// Lumels that are measured together at most.
    pub most: usize,
    /// Bytes of rays of the first round that may be kept, so that under other lights they need not be traced again. Later
    /// rounds measure other lumels then.
    pub kept_bytes: u64,
    /// By the first lumel of a part and the half of the samples.
    kept: BTreeMap<(usize, usize), Stored>,
}

impl Default for LumelParts {
    /// Large parts, of which no rays are kept.
    fn default() -> Self {
        Self { most: PART, kept_bytes: 0, kept: BTreeMap::new() }
    }
}

impl fmt::Debug for LumelParts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { most, kept_bytes, .. } = self;
        f.debug_struct("LumelParts")
            .field("most", most)
            .field("kept_bytes", kept_bytes)
            .finish_non_exhaustive()
    }
}

impl LumelParts {
    /// Bytes of the rays that are kept.
    pub fn bytes(&self) -> u64 {
        self.kept.values().map(|stored| stored.rows().bytes()).sum()
    }

    /// Keeps the rays of a part instead of those that were, if they fit.
    fn keep(&mut self, place: (usize, usize), stored: Stored) {
        self.kept.remove(&place);
        if self.bytes() + stored.rows().bytes() <= self.kept_bytes {
            self.kept.insert(place, stored);
        }
    }
}

/// Called with all light so far, whenever a part of the lumels has been measured.
pub type PartDone<'a> = &'a mut dyn FnMut(&LumelLight);

impl Baker {
    /// Measures the light of a solve over what each lumel covers: [`continue_lumels`](Self::continue_lumels) from the beginning.
    ///
    /// # Errors
    /// As there.
    pub fn light_at_lumels(
        &self,
        state: &SolveState,
        lumels: &Lumels,
        control: &Control,
    ) -> Result<LumelLight, TransportError> {
        let mut light = self.no_light_at_lumels(state, lumels);
        self.continue_lumels(state, lumels, &mut light, control, &mut |_| {})?;
        Ok(light)
    }

    /// What measuring the light of a solve at lumels begins with.
    pub fn no_light_at_lumels(&self, state: &SolveState, lumels: &Lumels) -> LumelLight {
        LumelLight::new(lumels.coverage.len(), sources(state, &**self.basis()).len(), has_tail(state))
    }

    /// Measures the light of a solve over what each lumel covers, on average with as many samples as a triangle of mean size: half
    /// of those of the settings.
    ///
    /// Direct light is measured at the lumels themselves; each bounce is gathered from the light that the solve has carried
    /// to the bounce before. All bounces share their rays.
    ///
    /// Samples go where light is noisy: all lumels get half as many as that, then the noisier half of them twice as many, then the
    /// noisiest quarter four times as many. With a target error, lumels get more until enough of them are below it, or
    /// have 64 times as many as in the beginning. Which lumels are measured again is decided by the differences of two halves of
    /// the samples and by the light, of each lumel and its neighbours together. What looks noisy by chance is measured again: the
    /// bias that this brings is far below the noise.
    ///
    /// Lumels are measured part by part, so that the rays that are kept fit the settings' memory; the bits do not depend on the
    /// parts. With directional light, all lumels are measured once more in the end. When it is cancelled, `light` holds all parts that were finished, and continues from there with the same bits.
    ///
    /// The surfaces of `lumels` must be those of the baker's scene; their triangles need not. `light` must be that of the
    /// same state and lumels.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn continue_lumels(
        &self,
        state: &SolveState,
        lumels: &Lumels,
        light: &mut LumelLight,
        control: &Control,
        part_done: PartDone<'_>,
    ) -> Result<(), TransportError> {
        self.continue_lumel_parts(state, lumels, light, &mut LumelParts::default(), control, part_done)
    }

    /// [Continues](Self::continue_lumels) in parts of a size of their own, with rays that are kept.
    ///
    /// # Errors
    /// As there.
    pub fn continue_lumel_parts(
        &self,
        state: &SolveState,
        lumels: &Lumels,
        light: &mut LumelLight,
        parts: &mut LumelParts,
        control: &Control,
        part_done: PartDone<'_>,
    ) -> Result<(), TransportError> {
        let (operator, sources) = (self.cached_at_lumels(lumels), sources(state, &**self.basis()));
        loop {
            self.finish_round((&operator, &sources), light, parts, control, part_done)?;
            let Some(active) = self.next_round(lumels, light) else { break };
            light.begin_round(active);
        }
        self.measure_by_direction(state, lumels, light, parts.most, control, part_done)
    }

    /// Measures the light of all lumels by direction, where the settings want it: by a part of the samples of the settings, once.
    fn measure_by_direction(
        &self,
        state: &SolveState,
        lumels: &Lumels,
        light: &mut LumelLight,
        most: usize,
        control: &Control,
        part_done: PartDone<'_>,
    ) -> Result<(), TransportError> {
        let kind = self.settings().directional;
        if kind == Directional::Off {
            return Ok(());
        }
        light.begin_directional(kind.harmonics());
        let plan = directional_plan(self.settings().plan());
        let operator = self.traced_at_lumels(lumels, plan);
        let gatherable = (state.bounces.len() > 1).then(|| state.gatherable(&**self.basis()));
        let sources = [Some(Source::Emitters(None)), gatherable.as_ref().map(Gatherable::source)];
        while let Some(range) = light.next_directional_part(most) {
            let wanted: Vec<bool> = (0..light.len()).map(|lumel| range.contains(&lumel)).collect();
            let operator = DirectionalTransport::new(operator.with_samples(plan, &wanted), kind);
            let mut fields = Vec::new();
            for (bounce, source) in (0..).zip(sources.into_iter().flatten()) {
                let job = Job { source, bounce, pass: DIRECTIONAL_PASS, active: None };
                fields.push(accumulate(&operator, &job, control, None)?.field);
            }
            let sum = Field::sum(light.len(), &fields);
            let coefficients = range.clone().map(|lumel| &sum.coefficients(NodeId(lumel as u32))[1..]);
            light.add_directional(range, coefficients);
            part_done(light);
        }
        Ok(())
    }

    /// The operator towards lumels, every job of which traces rays of its own.
    pub(crate) fn traced_at_lumels(
        &self,
        lumels: &Lumels,
        plan: Plan,
    ) -> CpuTransport<BounceBasis, LumelReceivers> {
        let receivers = lumels.receivers();
        let order = Order::new(&receivers);
        CpuTransport::in_order(
            Arc::clone(self.scene()),
            Arc::clone(self.tracer()),
            Arc::clone(self.basis()),
            (Arc::new(receivers), order),
            plan,
        )
    }

    fn cached_at_lumels(&self, lumels: &Lumels) -> CachedTransport<BounceBasis, LumelReceivers> {
        CachedTransport::new(self.traced_at_lumels(lumels, self.settings().plan()), None)
    }

    /// Measures the lumels that are left of a round.
    fn finish_round(
        &self,
        (operator, sources): (&CachedTransport<BounceBasis, LumelReceivers>, &[StepSource<'_>]),
        light: &mut LumelLight,
        parts: &mut LumelParts,
        control: &Control,
        part_done: PartDone<'_>,
    ) -> Result<(), TransportError> {
        let plans = [0, 1].map(|half| plan_of(self.settings().plan(), light, half));
        let most = self.part_of(operator, &plans[0], &light.active, parts.most)[0] as usize;
        while let Some(range) = light.next_part(most) {
            let wanted = |lumel: usize| range.contains(&lumel) && light.active[lumel];
            let wanted: Vec<bool> = (0..light.len()).map(wanted).collect();
            let is_first = light.round == 0;
            let [first, second] = [0, 1].map(|half| {
                let place = (range.start, half);
                let kept = parts.kept.get(&place).filter(|_| is_first);
                let operator = operator.with_shared_samples(plans[half], &wanted, kept);
                let mut found = PartLight { known: vec![false; range.len()], sources: Vec::new() };
                for (bounce, source) in sources.iter().enumerate() {
                    let job = Job { source: source.source(), bounce: bounce as u32, pass: 0, active: None };
                    let measured = accumulate(&operator, &job, control, None)?;
                    found.known.iter_mut().zip(&measured.known[range.clone()]).for_each(|(a, b)| *a |= b);
                    found.sources.push(measured.field.values()[range.clone()].to_vec());
                }
                if is_first {
                    parts.keep(place, operator.stored());
                }
                Ok(found)
            });
            light.add(range, &[first?, second?]);
            part_done(light);
        }
        Ok(())
    }

    /// How many lumels are measured together, so that their rays fit the settings' memory, and the bytes of these.
    fn part_of(
        &self,
        operator: &CachedTransport<BounceBasis, LumelReceivers>,
        plan: &Plan,
        active: &[bool],
        most: usize,
    ) -> [u64; 2] {
        let n = active.iter().filter(|active| **active).count().max(1) as u64;
        let bytes = operator.memory_with(plan, active) / n;
        let most = (self.settings().memory.0 / bytes.max(1)).clamp(1, most.max(1) as u64).min(n);
        [most, most * bytes]
    }

    /// What the rays take that are kept at a time while lumels are measured, at most, without a target error.
    pub fn memory_of_lumel_rays(&self, lumels: &Lumels) -> Memory {
        let operator = self.cached_at_lumels(lumels);
        let light = LumelLight::new(lumels.coverage.len(), 0, false);
        let first = plan_of(self.settings().plan(), &light, 0);
        // The last round has the samples of all before it, for some of the lumels.
        let times = 1 << SHARES.len().saturating_sub(1);
        let plan = Plan { indirect_samples: first.indirect_samples.saturating_mul(times), ..first };
        Memory(self.part_of(&operator, &plan, &light.active, PART)[1])
    }

    /// Share of all samples at lumels that is done; `None` with a target error, which takes as many as it takes.
    pub fn share_at_lumels(&self, light: &LumelLight) -> Option<f64> {
        // Half of all samples, and as many again on those that are noisier.
        let mut shares = [0.5]
            .into_iter()
            .chain(SHARES.into_iter().enumerate().map(|(k, share)| share * f64::from(1 << k) / 2.0));
        let before: f64 = shares.by_ref().take(light.round as usize).sum();
        let active = light.active.iter().filter(|active| **active).count().max(1);
        let done = 1.0 - light.left() as f64 / active as f64;
        let of_rounds = before + done * shares.next().unwrap_or_default();
        let by_direction = if self.settings().directional == Directional::Off { 0.0 } else { 0.25 };
        let directional = f64::from(light.directional.done) / light.len().max(1) as f64;
        let share = (of_rounds + by_direction * directional) / (1.0 + by_direction);
        target(self.settings()).is_none().then_some(share)
    }

    /// How noisy the light at lumels is.
    pub fn accuracy_at_lumels(&self, lumels: &Lumels, light: &LumelLight) -> LumelAccuracy {
        self.accuracy_of(light, &light.relative_errors(&lumels.atlas, &lumels.coverage, DARK))
    }

    /// The same, from the errors of the lumels.
    fn accuracy_of(&self, light: &LumelLight, errors: &[f32]) -> LumelAccuracy {
        let valid = errors.iter().enumerate().filter(|(lumel, _)| light.is_valid(*lumel));
        let mut widths: Vec<f64> = valid.map(|(_, error)| f64::from(CONFIDENCE * error)).collect();
        widths.sort_by(f64::total_cmp);
        let at = |share: f64| widths.get((share * widths.len() as f64) as usize).copied().unwrap_or_default();
        let share = target(self.settings()).map(|Target { error, .. }| {
            widths.partition_point(|width| *width <= error) as f64 / widths.len().max(1) as f64
        });
        LumelAccuracy { median: at(0.5), percentile_95: at(0.95), share }
    }

    /// The lumels that are to have more samples; `None` if there are enough.
    fn next_round(&self, lumels: &Lumels, light: &LumelLight) -> Option<Vec<bool>> {
        let errors = |floor| light.relative_errors(&lumels.atlas, &lumels.coverage, floor);
        let (errors, least) = match target(self.settings()) {
            Some(Target { error, share, rounds, .. }) => {
                let errors = (light.round + 1 < rounds).then(|| errors(DARK))?;
                let enough = self.accuracy_of(light, &errors).share.is_some_and(|below| below >= share);
                (!enough).then_some((errors, error as f32 / CONFIDENCE))?
            }
            None => {
                let share = SHARES.get(light.round as usize)?;
                let errors = errors(DIM);
                let mut sorted = errors.clone();
                let place = ((1.0 - share) * errors.len() as f64) as usize;
                let least =
                    *sorted.select_nth_unstable_by(place.min(errors.len().checked_sub(1)?), f32::total_cmp).1;
                (errors, least)
            }
        };
        let active: Vec<bool> = errors.iter().map(|&error| error > least).collect();
        active.contains(&true).then_some(active)
    }
}

/// The samples of a half of a round: they continue those of all rounds before, where the sampler can.
fn plan_of(plan: Plan, light: &LumelLight, half: u32) -> Plan {
    let (round, times) = (light.round, light.samples_of_round());
    let samples = |samples: u32| samples.div_ceil(FIRST_SHARE).max(MIN_SAMPLES).saturating_mul(times);
    let plan = Plan {
        direct_samples: samples(plan.direct_samples),
        indirect_samples: samples(plan.indirect_samples),
        ..plan
    };
    portion_of(plan, [round, half])
}

/// A half of the samples of a round, as many as those of all rounds before.
pub(crate) fn portion_of(plan: Plan, [round, half]: [u32; 2]) -> Plan {
    let portion = if round == 0 { half } else { 2 + half };
    if plan.sampler == SamplerKind::Stratified {
        return Plan { seed: plan.seed.wrapping_add(u64::from(2 * round + half)), ..plan };
    }
    Plan { portion, ..plan }
}

/// What the light of one step at the lumels comes from.
enum StepSource<'a> {
    Bounce(Source<'a>),
    /// What surfaces reflect into light that no bounce contains.
    Rest(Gatherable<'a>),
}

impl StepSource<'_> {
    fn source(&self) -> Source<'_> {
        match self {
            Self::Bounce(source) => *source,
            Self::Rest(gatherable) => gatherable.source(),
        }
    }
}

/// The sources of all bounces of a state in a basis, and of the rest; direct light is measured in any case.
fn sources<'a>(state: &'a SolveState, basis: &dyn Basis) -> Vec<StepSource<'a>> {
    let bounces = (0..state.bounces.len().max(1)).map(|k| StepSource::Bounce(state.source_of(k, basis)));
    bounces.chain(state.gatherable_beyond_bounces(basis).map(StepSource::Rest)).collect()
}

/// Whether the last source of a state is its tail.
fn has_tail(state: &SolveState) -> bool {
    state.shot.is_some() || state.tail.is_some() && !state.bounces.is_empty()
}
