//! From a solve on vertices to light on the lumels of an atlas.

use crate::Baker;
use glam::Vec3;
use lumel_basis::{Field, LumelReceivers, Receivers};
use lumel_sample::SamplerKind;
use lumel_scene::{Scene, luminance};
use lumel_solve::SolveState;
use lumel_transport::{
    CachedTransport, Control, CpuTransport, Job, Order, Plan, SampleRange, Source, TransportError, accumulate,
};
use lumel_uv::{Atlas, Coverage};
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
}

/// Light at each lumel of a [`Coverage`], bounce by bounce, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct LumelLight {
    /// Which lumels see anything but the inside of geometry; the light of others is zero.
    pub valid: Vec<bool>,
    /// Bounce by bounce; the first is direct light.
    pub bounces: Vec<Vec<Vec3>>,
    /// The light of all bounces after those, if the solve has estimated it.
    pub tail: Option<Vec<Vec3>>,
    /// The standard error of the luminance of all light, W·m⁻²: half of how far two halves of the samples differ. A single one
    /// says little; those of neighbours together say how noisy light is there.
    pub errors: Vec<f32>,
}

impl LumelLight {
    /// All light.
    pub fn irradiance(&self) -> Vec<Vec3> {
        sums(self.bounces.iter().chain(&self.tail), self.valid.len())
    }
}

/// The sum of all steps at each lumel.
fn sums<'a>(steps: impl Iterator<Item = &'a Vec<Vec3>> + Clone, n_lumels: usize) -> Vec<Vec3> {
    (0..n_lumels).map(|lumel| steps.clone().map(|step| step[lumel]).sum()).collect()
}

impl Baker {
    /// Measures the light of a solve over what each lumel covers, each with as many samples as a triangle of mean size: half of
    /// those of the settings.
    ///
    /// Direct light is measured at the lumels themselves; each bounce is gathered from the light that the solve has carried
    /// to the bounce before. All bounces share their rays, which are stored as far as the settings' memory allows: with more
    /// lumels than that, one part of them is measured after the other. The bits do not depend on it.
    ///
    /// The surfaces of `lumels` must be those of the baker's scene; their triangles need not.
    ///
    /// # Errors
    /// When it is cancelled or tracing fails.
    pub fn light_at_lumels(
        &self,
        state: &SolveState,
        lumels: &Lumels,
        control: &Control,
    ) -> Result<LumelLight, TransportError> {
        let Lumels { scene, atlas, coverage } = lumels;
        let n_lumels = coverage.len();
        let receivers = LumelReceivers::new(Arc::clone(scene), Arc::clone(atlas), Arc::clone(coverage));
        let order = Order::new(&receivers);
        let measured = (Arc::new(receivers), order);
        let sources = sources(state);
        let [first, second] = halves(self.settings().plan());
        let mut whole = self.steps_at_lumels(&sources, measured.clone(), first, control)?;
        let half = self.steps_at_lumels(&sources, measured, second, control)?;
        let [a, b] = [&whole, &half].map(|half| sums(half.steps.iter(), n_lumels));
        let errors = a.iter().zip(&b).map(|(a, b)| 0.5 * (luminance(*a) - luminance(*b)).abs()).collect();
        whole.add(&half);
        let Steps { valid, mut steps } = whole;
        let tail = (state.tail.is_some() && steps.len() > 1).then(|| steps.pop()).flatten();
        Ok(LumelLight { valid, bounces: steps, tail, errors })
    }

    /// Light from each source, by samples of their own.
    fn steps_at_lumels(
        &self,
        sources: &[StepSource<'_>],
        measured: (Arc<LumelReceivers>, Order),
        plan: Plan,
        control: &Control,
    ) -> Result<Steps, TransportError> {
        let n_lumels = measured.0.node_count();
        let traced = CpuTransport::in_order(
            Arc::clone(self.scene()),
            Arc::clone(self.tracer()),
            Arc::clone(self.basis()),
            measured,
            plan,
        );
        let all = CachedTransport::new(traced, None);
        let parts = all.memory().div_ceil(self.settings().memory.0.max(1)).clamp(1, n_lumels.max(1) as u64);
        let mut found =
            Steps { valid: vec![false; n_lumels], steps: vec![vec![Vec3::ZERO; n_lumels]; sources.len()] };
        for part in 0..parts {
            let bound = |part: u64| (part * n_lumels as u64 / parts) as usize;
            let range = bound(part)..bound(part + 1);
            let chosen = || (0..n_lumels).map(|lumel| range.contains(&lumel)).collect::<Vec<bool>>();
            let some = (parts > 1).then(|| all.with_samples(plan, &chosen()));
            let transport = some.as_ref().unwrap_or(&all);
            for (bounce, (source, light)) in sources.iter().zip(&mut found.steps).enumerate() {
                let job = Job { source: source.source(), bounce: bounce as u32, pass: 0, active: None };
                let measured = accumulate(transport, &job, control, None)?;
                for lumel in range.clone() {
                    found.valid[lumel] |= measured.known[lumel];
                    light[lumel] = measured.field.values()[lumel];
                }
            }
        }
        Ok(found)
    }
}

/// Two halves of the samples of a plan: of one sequence, where the second half of its points continues the first.
fn halves(plan: Plan) -> [Plan; 2] {
    let half = |samples: u32| samples.div_ceil(2);
    let (direct_samples, indirect_samples) = (half(plan.direct_samples), half(plan.indirect_samples));
    let first = Plan { direct_samples, indirect_samples, ..plan };
    let second = match plan.sampler {
        SamplerKind::Stratified => Plan { seed: plan.seed.wrapping_add(1), ..first },
        _ => Plan { range: SampleRange::Second, ..first },
    };
    [first, second]
}

/// Light at all lumels, source by source.
struct Steps {
    valid: Vec<bool>,
    steps: Vec<Vec<Vec3>>,
}

impl Steps {
    /// Makes it the mean of itself and another half; lumels that only one of them has seen have its light.
    fn add(&mut self, other: &Self) {
        for (step, others) in self.steps.iter_mut().zip(&other.steps) {
            for (lumel, (light, other_light)) in step.iter_mut().zip(others).enumerate() {
                *light = match (self.valid[lumel], other.valid[lumel]) {
                    (true, true) => (*light + *other_light) / 2.0,
                    (true, false) => *light,
                    (false, _) => *other_light,
                };
            }
        }
        self.valid.iter_mut().zip(&other.valid).for_each(|(valid, other)| *valid |= other);
    }
}

/// What the light of one step at the lumels comes from.
enum StepSource<'a> {
    Emitters,
    Bounce(&'a Field),
    /// The last bounce and all after it, which arrive as the tail.
    Rest(Field),
}

impl StepSource<'_> {
    fn source(&self) -> Source<'_> {
        match self {
            Self::Emitters => Source::Emitters(None),
            Self::Bounce(field) => Source::Field(field),
            Self::Rest(field) => Source::Field(field),
        }
    }
}

/// The sources of all bounces of a state, and of its tail.
fn sources(state: &SolveState) -> Vec<StepSource<'_>> {
    let mut sources = vec![StepSource::Emitters];
    let (carried, last) = state.bounces.split_at(state.bounces.len().saturating_sub(1));
    sources.extend(carried.iter().map(StepSource::Bounce));
    if let (Some(tail), [last]) = (&state.tail, last) {
        sources.push(StepSource::Rest(Field::sum(tail.node_count(), [last, tail])));
    }
    sources
}
