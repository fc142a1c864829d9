//! The operator on stored rows: rays are traced once, and every bounce after that is a sparse product.

use crate::cpu::{CHUNK, CpuTransport, Group, OPENNESS_RAYS};
use crate::hemisphere::{self, Seen};
use crate::job::{Cancelled, ChunkSink, ChunkSums, Control, Job, NodeSum, Shape, Source, Transport};
use crate::paint::{Paint, Painted, unpacked};
use crate::plan::Plan;
use crate::rows::{End, Origin, Rows};
use crate::scatter::scattered;
use glam::{DVec3, Vec4};
use lumel_basis::{Basis, ElementId, Measure, NodeWeights};
use lumel_sample::{Dim, StreamKey};
use lumel_scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// The bounce and the pass whose sample points all bounces share.
const SHARED_BOUNCE: u32 = 1;
const SHARED_PASS: u32 = 0;

/// Rays whose light is summed in single precision before it goes into a sum in double precision.
const BLOCK: usize = 16;

/// A [`CpuTransport`] whose hemisphere rays are traced once and stored, 8 bytes each.
///
/// All bounces share their rays, so that the sum of all of them solves one discrete equation exactly; its bias falls
/// with the number of rays of a row, as rows that are visited again are not independent: 1.5 % over that number, as
/// measured in a closed box. The rows depend on the surfaces alone and are shared by operators of the same surfaces
/// under other lights, skies and materials.
pub struct CachedTransport<B> {
    inner: CpuTransport<B>,
    rows: Arc<Rows>,
    paint: Arc<Paint>,
}

/// What an operator has stored and others of the same surfaces may share.
#[derive(Clone)]
pub struct Stored {
    rows: Arc<Rows>,
    paint: Arc<Paint>,
    scene: Arc<Scene>,
}

impl Stored {
    /// The rays.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }
}

impl<B: Basis> CachedTransport<B> {
    /// Stores the rays of an operator, or takes those of another one where they are the same.
    pub fn new(inner: CpuTransport<B>, shared: Option<&Stored>) -> Self {
        let origin = origin(&inner);
        let shared = shared.filter(|stored| stored.rows.origin == origin && origin.is_whole);
        let rows = shared.map_or_else(|| Arc::new(Rows::new(origin)), |stored| Arc::clone(&stored.rows));
        // Other materials need other albedos at the ends of the same rays.
        let painted = shared.filter(|stored| stored.scene.has_surfaces_of(&inner.scene));
        let new_paint = || Arc::new(Paint::new(&inner.scene, &*inner.source, rows.chunks.len()));
        let paint = painted.map_or_else(new_paint, |stored| Arc::clone(&stored.paint));
        Self { inner, rows, paint }
    }

    /// An operator with other samples, for the elements alone that count towards one of certain nodes.
    ///
    /// It traces rays of its own; what surfaces reflect is shared.
    pub fn with_samples(&self, plan: Plan, nodes: &[bool]) -> Self {
        let inner = self.inner.with_samples(plan, nodes);
        let rows = Arc::new(Rows::new(origin(&inner)));
        let paint = Arc::new(self.paint.for_chunks(rows.chunks.len()));
        Self { inner, rows, paint }
    }

    /// How many elements count towards one of certain nodes.
    pub fn elements_towards(&self, nodes: &[bool]) -> usize {
        self.inner.elements_towards(nodes).count()
    }

    /// What [`memory`](Self::memory) would be [with other samples](Self::with_samples).
    pub fn memory_with(&self, plan: &Plan, nodes: &[bool]) -> u64 {
        let per_element = plan.rays_per_element(self.inner.receivers.measure());
        Rows::bytes_for(self.elements_towards(nodes), per_element, self.paint.varies())
    }

    /// What it stores, to be shared.
    pub fn stored(&self) -> Stored {
        let (rows, paint) = (Arc::clone(&self.rows), Arc::clone(&self.paint));
        Stored { rows, paint, scene: Arc::clone(&self.inner.scene) }
    }

    /// The rows.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Bytes of the rows, once all are traced, and of the albedos that belong to them.
    pub fn memory(&self) -> u64 {
        let Origin { elements, per_element, .. } = self.rows.origin;
        Rows::bytes_for(elements, per_element, self.paint.varies())
    }

    fn ends(&self, chunk: u32, control: &Control) -> Result<&[End], Cancelled> {
        let slot = &self.rows.chunks[chunk as usize];
        if let Some(ends) = slot.get() {
            return Ok(ends);
        }
        let ends = trace(&self.inner, &self.rows.origin, chunk, control)?;
        Ok(slot.get_or_init(|| ends))
    }

    fn measure_chunk(
        &self,
        job: &Job<'_>,
        painted: Option<&Painted<'_>>,
        chunk: u32,
        control: &Control,
    ) -> Result<ChunkSums, Cancelled> {
        control.check()?;
        let ends = self.ends(chunk, control)?;
        let sums = match painted {
            Some(painted) => apply(&self.inner, painted, job, chunk, ends, &self.rows.origin, control)?,
            None => self.at_points_by_kind(job, chunk, ends, control)?,
        };
        control.count(self.inner.elements(chunk).len() as u64, 0);
        Ok(sums)
    }

    /// What depends on whether rays meet anything: light of sky and glowing surfaces, besides that of lights by shadow
    /// rays; or openness.
    fn at_points_by_kind(
        &self,
        job: &Job<'_>,
        chunk: u32,
        ends: &[End],
        control: &Control,
    ) -> Result<ChunkSums, Cancelled> {
        let inner = &self.inner;
        let elements = inner.elements(chunk);
        let (active, group) = active(inner, job, elements);
        let (mut values, n_rays) = match job.source {
            Source::Emitters => inner.direct_at(job, &group, control)?,
            _ => (vec![DVec3::ZERO; active.len()], 0),
        };
        let measured = |end: &End| match (job.source, end.seen()) {
            (Source::Openness, Some(seen)) => hemisphere::openness(&seen),
            (_, Some(seen)) => {
                hemisphere::emitted(&inner.scene, inner.lights.emission_by_rays, &seen).0.as_dvec3()
            }
            (_, None) => DVec3::ZERO,
        };
        let lanes = elements.len();
        for (value, lane) in values.iter_mut().zip(active) {
            let row = ends.iter().skip(lane).step_by(lanes);
            *value += row.map(measured).sum::<DVec3>() / (ends.len() / lanes) as f64;
        }
        control.count(0, n_rays);
        Ok(group.sums(&values))
    }
}

/// What the rays of an operator depend on.
fn origin<B: Basis>(inner: &CpuTransport<B>) -> Origin {
    let plan = &inner.plan;
    let measure = inner.receivers.measure();
    Origin {
        geometry: *inner.scene.geometry_hash().as_bytes(),
        elements: inner.shape().elements,
        is_whole: inner.is_whole,
        per_element: plan.rays_per_element(measure),
        sampler: plan.sampler,
        seed: plan.seed,
        second_half: plan.second_half,
        over_area: measure == Measure::OverArea,
    }
}

fn key(origin: &Origin, element: ElementId) -> StreamKey {
    StreamKey::new(origin.seed).element(element.0).bounce(SHARED_BOUNCE).pass(SHARED_PASS)
}

/// Traces the rays of a chunk: at points stratum by stratum, over areas element by element.
fn trace<B: Basis>(
    inner: &CpuTransport<B>,
    origin: &Origin,
    chunk: u32,
    control: &Control,
) -> Result<Box<[End]>, Cancelled> {
    let elements = inner.elements(chunk);
    let strata = origin.per_element as usize;
    let mut ends = vec![End::SKY; elements.len() * strata];
    if origin.over_area {
        for (&element, ends) in elements.iter().zip(ends.chunks_mut(strata)) {
            inner.trace_area(element, key(origin, element), ends, control)?;
        }
        return Ok(ends.into());
    }
    let group = inner.group(elements);
    let mut gather =
        inner.rays(&group, (origin.per_element, Dim::Hemisphere), |e| key(origin, e), control)?;
    let mut next = vec![0; elements.len()];
    gather.trace(inner.tracer(), &group.sites, strata, control, |i, hit| {
        ends[next[i] * elements.len() + i] = End::new(&Seen::new(&inner.scene, hit));
        next[i] += 1;
    })?;
    control.count(0, ends.len() as u64);
    Ok(ends.into())
}

/// Applies the rows of a chunk to a field.
fn apply<B: Basis>(
    inner: &CpuTransport<B>,
    painted: &Painted<'_>,
    job: &Job<'_>,
    chunk: u32,
    ends: &[End],
    origin: &Origin,
    control: &Control,
) -> Result<ChunkSums, Cancelled> {
    let elements = inner.elements(chunk);
    let albedos = painted.albedos(&inner.scene, chunk, ends);
    if origin.over_area {
        return over_area(inner, painted, job, elements, (ends, albedos), origin, control);
    }
    let values = at_points(inner, painted, elements.len(), ends, albedos);
    let (active, group) = active(inner, job, elements);
    Ok(group.sums(&active.iter().map(|&i| values[i]).collect::<Vec<_>>()))
}

/// The places of the elements that a job measures among those of a chunk, and where they are measured.
fn active<B: Basis>(inner: &CpuTransport<B>, job: &Job<'_>, elements: &[ElementId]) -> (Vec<usize>, Group) {
    let places: Vec<usize> = (0..elements.len()).filter(|&i| job.measures(elements[i])).collect();
    let group = inner.group(&places.iter().map(|&i| elements[i]).collect::<Vec<_>>());
    (places, group)
}

/// The mean of each row of `lanes` interleaved ones.
fn at_points<B: Basis>(
    inner: &CpuTransport<B>,
    painted: &Painted<'_>,
    lanes: usize,
    ends: &[End],
    albedos: Option<&[[u16; 3]]>,
) -> Vec<DVec3> {
    match albedos {
        _ if !painted.is_linear() => {
            let mut weights = NodeWeights::default();
            means(lanes, ends, |end, _| {
                painted.reflected(&inner.scene, &*inner.source, end, None, &mut weights)
            })
        }
        None => means(lanes, ends, |end, _| painted.sent(end)),
        Some(albedos) => means(lanes, ends, |end, i| painted.sent(end) * unpacked(albedos[i])),
    }
}

/// The mean of `value(end, its place)` over each row of `lanes` interleaved ones.
///
/// This is where the time of all bounces goes: neighbours' rays through one cell follow each other here, and mostly end
/// on the same triangles.
#[inline(always)]
fn means(lanes: usize, ends: &[End], mut value: impl FnMut(End, usize) -> Vec4) -> Vec<DVec3> {
    let mut sums = [DVec3::ZERO; CHUNK];
    let mut partial = [Vec4::ZERO; CHUNK];
    for (b, block) in ends.chunks(BLOCK * lanes).enumerate() {
        partial.fill(Vec4::ZERO);
        for (k, row) in block.chunks_exact(lanes).enumerate() {
            let first = (b * BLOCK + k) * lanes;
            for (lane, (end, sum)) in row.iter().zip(&mut partial).enumerate() {
                *sum += value(*end, first + lane);
            }
        }
        for (sum, partial) in sums.iter_mut().zip(&partial) {
            *sum += partial.truncate().as_dvec3();
        }
    }
    let strata = (ends.len() / lanes.max(1)).max(1) as f64;
    sums[..lanes].iter().map(|sum| *sum / strata).collect()
}

/// What the elements of a chunk see, at the origins that their rays started from.
fn over_area<B: Basis>(
    inner: &CpuTransport<B>,
    painted: &Painted<'_>,
    job: &Job<'_>,
    elements: &[ElementId],
    (ends, albedos): (&[End], Option<&[[u16; 3]]>),
    origin: &Origin,
    control: &Control,
) -> Result<ChunkSums, Cancelled> {
    let strata = origin.per_element as usize;
    let (mut towards, mut weights) = (NodeWeights::default(), NodeWeights::default());
    let mut sums = ChunkSums::default();
    for (e, &element) in elements.iter().enumerate().filter(|(_, e)| job.measures(**e)) {
        control.check()?;
        let stream = inner.area_stream(origin.per_element, key(origin, element));
        let mut nodes: Vec<NodeSum> = Vec::with_capacity(3);
        for k in 0..strata {
            let at = e * strata + k;
            if ends[at] == End::INSIDE {
                continue;
            }
            let [s, t, ..] = stream.sample_4d(k as u32);
            towards.clear();
            inner.receivers.receiver(element, [s, t], &mut towards);
            let albedo = albedos.map(|a| a[at]);
            let value = painted.reflected(&inner.scene, &*inner.source, ends[at], albedo, &mut weights);
            let value = value.truncate().as_dvec3();
            for (node, weight) in towards.iter() {
                let sum = NodeSum { node, weight: weight.into(), value: value * f64::from(weight) };
                crate::cpu::add(&mut nodes, sum);
            }
        }
        sums.sums.append(&mut nodes);
    }
    Ok(sums)
}

impl<B: Basis> Transport for CachedTransport<B> {
    fn shape(&self) -> Shape {
        self.inner.shape()
    }

    /// Other passes than the first, direct light of lights alone and all direct light over areas go without the rows.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), Cancelled> {
        let at_points = !self.rows.origin.over_area;
        let painted = match job.source {
            _ if job.pass != SHARED_PASS => return self.inner.measure(job, chunks, control, sink),
            Source::Field(field) => Some(self.paint.with(field)),
            Source::Openness if at_points && self.rows.origin.per_element >= OPENNESS_RAYS => None,
            Source::Emitters if at_points && self.inner.lights.needs_hemisphere() => None,
            Source::Emitters | Source::Openness => return self.inner.measure(job, chunks, control, sink),
        };
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            sink.accept(chunk, self.measure_chunk(job, painted.as_ref(), chunk, control)?);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Plan, accumulate};
    use lumel_accel::Bvh;
    use lumel_basis::{Field, VertexBasis};

    /// Bounces by the definition: where each stored ray ends, light and albedo are looked up and multiplied.
    struct ByDefinition<'a>(&'a CachedTransport<VertexBasis>);

    impl Transport for ByDefinition<'_> {
        fn shape(&self) -> Shape {
            self.0.shape()
        }

        fn measure(
            &self,
            job: &Job<'_>,
            chunks: Range<u32>,
            control: &Control,
            sink: &dyn ChunkSink,
        ) -> Result<(), Cancelled> {
            let Source::Field(field) = job.source else { return self.0.measure(job, chunks, control, sink) };
            let CpuTransport { scene, source, .. } = &self.0.inner;
            chunks.into_par_iter().try_for_each(|chunk| {
                let (ends, elements) = (self.0.ends(chunk, control)?, self.0.inner.elements(chunk));
                let mut weights = NodeWeights::default();
                let mut reflected = |end: &End| {
                    let seen = end.seen().unwrap_or(Seen::Back);
                    hemisphere::reflected(scene, &**source, field, &seen, &mut weights).0.as_dvec3()
                };
                let mut mean = |lane: usize| {
                    let row = ends.iter().skip(lane).step_by(elements.len());
                    row.map(&mut reflected).sum::<DVec3>() / (ends.len() / elements.len()) as f64
                };
                let values: Vec<DVec3> = (0..elements.len()).map(&mut mean).collect();
                sink.accept(chunk, self.0.inner.group(elements).sums(&values));
                Ok(())
            })
        }
    }

    #[test]
    fn the_sum_of_bounces_is_the_neumann_series_on_the_same_rows() {
        for name in ["cornell-box", "atrium"] {
            let scene = Arc::new(lumel_builtin::scene(name, 0).unwrap().build().unwrap().0);
            let (tracer, basis) =
                (Arc::new(Bvh::build(&scene)), Arc::new(VertexBasis::new(Arc::clone(&scene))));
            let plan = Plan { direct_samples: 4, indirect_samples: 128, ..Plan::default() };
            let inner = CpuTransport::new(scene, tracer, Arc::clone(&basis), basis, plan);
            let cached = CachedTransport::new(inner, None);
            let solved = |transport: &dyn Transport| {
                let applied = |source: Source<'_>, bounce: u32| {
                    let job = Job { source, bounce, pass: SHARED_PASS, active: None };
                    accumulate(transport, &job, &Control::default(), None).unwrap().field
                };
                let mut bounces = vec![applied(Source::Emitters, 0)];
                for bounce in 1..=4 {
                    bounces.push(applied(Source::Field(&bounces[bounce as usize - 1]), bounce));
                }
                Field::sum(bounces[0].len(), &bounces)
            };
            let (by_rows, by_definition) = (solved(&cached), solved(&ByDefinition(&cached)));
            let square =
                |field: &Field| field.values().iter().map(|v| v.as_dvec3().length_squared()).sum::<f64>();
            let pairs = by_rows.values().iter().zip(by_definition.values());
            let difference: f64 = pairs.map(|(a, b)| (a.as_dvec3() - b.as_dvec3()).length_squared()).sum();
            let relative = (difference / square(&by_definition)).sqrt();
            println!("{name}: {relative:.2e}");
            assert!(relative < 1e-6, "{name}: {relative:e}");
        }
    }
}
