//! The operator on stored rows: rays are traced once, and every bounce after that is a sparse product.

use crate::area_pattern::{AreaPatterns, WholePatterns};
use crate::arrivals::Arrivals;
use crate::ends::StoredEnd;
use crate::group::Group;
use crate::hemisphere::HemisphereDensity;
use crate::hidden;
use crate::job::{ChunkSink, Control, Job, Shape, Source, Transport, TransportError};
use crate::measure::{self, Reader, VALIDITY_RAYS};
use crate::operator::CpuTransport;
use crate::order::{CHUNK, Order};
use crate::plan::Plan;
use crate::reflectance::{Reflectance, Reflected, unpacked};
use crate::rows::{Rows, RowsKey};
use crate::scatter::scattered;
use crate::trace::{self, Rays};
use crate::{EmitterMask, Sums};
use glam::{DVec3, Vec4};
use lumel_basis::{Basis, ElementId, NodeWeights, Receivers, Sampling};
use lumel_sample::{Dim, StreamKey};
use lumel_scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// The bounce and the pass whose sample points all bounces share.
const SHARED_BOUNCE: u32 = 1;
const SHARED_PASS: u32 = 0;

/// The pass of light [by direction](crate::DirectionalTransport), whose rays all jobs share.
pub const DIRECTIONAL_PASS: u32 = 2;

/// Rays whose light is summed in single precision before it goes into a sum in double precision.
const BLOCK: usize = 16;

/// A [`CpuTransport`] whose hemisphere rays are traced once and stored, 8 bytes each.
///
/// All bounces share their rays, so that the sum of all of them solves one discrete equation exactly; its bias falls
/// with the number of rays of a row, as rows that are visited again are not independent: 1.5 % over that number, as
/// measured in a closed box. The rows depend on the surfaces alone and are shared by operators of the same surfaces
/// under other lights, skies and materials.
pub struct CachedTransport<B, R> {
    pub(crate) inner: CpuTransport<B, R>,
    pub(crate) rows: Arc<Rows>,
    pub(crate) reflectance: Arc<Reflectance>,
    pub(crate) areas: Option<AreaRows>,
}

/// How areas are sampled.
pub(crate) struct AreaRows {
    /// By the stored rays.
    pub(crate) rays: AreaPatterns,
    /// The same patterns whole, made when light is shot for the first time.
    pub(crate) whole: OnceLock<WholePatterns>,
    /// By shadow rays, if from some of the same places.
    pub(crate) lights: Option<AreaPatterns>,
}

/// What an operator has stored and others of the same surfaces may share.
#[derive(Clone)]
pub struct Stored {
    pub(crate) rows: Arc<Rows>,
    reflectance: Arc<Reflectance>,
    pub(crate) scene: Arc<Scene>,
    pub(crate) receivers: Arc<dyn Receivers>,
    pub(crate) order: Order,
}

impl Stored {
    /// The rays.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }
}

/// The rays of one chunk.
#[derive(Clone, Copy)]
pub(crate) struct ChunkRows<'a> {
    pub(crate) elements: &'a [ElementId],
    /// Stratum by stratum, with the elements side by side.
    pub(crate) ends: &'a [StoredEnd],
}

impl ChunkRows<'_> {
    pub(crate) fn per_element(&self) -> usize {
        self.ends.len() / self.elements.len().max(1)
    }

    /// Where the ray of an element in a stratum ends.
    #[inline]
    pub(crate) fn at(&self, stratum: u32, element: usize) -> usize {
        stratum as usize * self.elements.len() + element
    }
}

impl<B: Basis, R: Receivers + 'static> CachedTransport<B, R> {
    /// Stores the rays of an operator, or takes those that another one has stored where they are the same.
    pub fn new(inner: CpuTransport<B, R>, shared: Option<&Stored>) -> Self {
        let new = |inner: &CpuTransport<B, R>, chunks| Reflectance::new(&inner.scene, &*inner.basis, chunks);
        Self::sharing(inner, shared, new)
    }

    /// Takes what another operator has stored where it is the same; `new` makes the reflectance at so many chunks of ends.
    fn sharing(
        inner: CpuTransport<B, R>,
        shared: Option<&Stored>,
        new: impl FnOnce(&CpuTransport<B, R>, usize) -> Reflectance,
    ) -> Self {
        let key = key_of(&inner);
        let same_rows = shared.filter(|stored| stored.rows.key == key);
        let new_rows = || {
            let rows = Rows::new(key, inner.order.chunk_count());
            Arc::new(match shared {
                Some(stored) => rows.carried_from(stored, &inner),
                None => rows,
            })
        };
        let rows = same_rows.map_or_else(new_rows, |stored| Arc::clone(&stored.rows));
        // Other materials need other albedos at the ends of the same rays.
        let same_reflectance = same_rows.filter(|stored| {
            stored.scene.has_surfaces_of(&inner.scene) && stored.reflectance.basis() == inner.basis.identity()
        });
        let reflectance = match same_reflectance {
            Some(stored) => Arc::clone(&stored.reflectance),
            None => Arc::new(new(&inner, rows.chunks.len())),
        };
        Self::with_rows(inner, rows, reflectance)
    }

    fn with_rows(inner: CpuTransport<B, R>, rows: Arc<Rows>, reflectance: Arc<Reflectance>) -> Self {
        let is_over_areas = inner.receivers.sampling() == Sampling::Area;
        let mut new = Self { inner, rows, reflectance, areas: None };
        if is_over_areas {
            let plan = &new.inner.plan;
            let rays =
                AreaPatterns::new(plan, &new.inner.order, plan.indirect_samples, new.rows.key.shared());
            let lights = new.light_patterns(&rays);
            new.areas = Some(AreaRows { lights, rays, whole: OnceLock::new() });
        }
        new
    }

    /// An operator with other samples, for the elements alone that count towards one of certain nodes.
    ///
    /// It traces rays of its own; the reflectance of surfaces is shared.
    pub fn with_samples(&self, plan: Plan, nodes: &[bool]) -> Self {
        self.with_shared_samples(plan, nodes, None)
    }

    /// The same with the rays of another operator, where they are the same.
    pub fn with_shared_samples(&self, plan: Plan, nodes: &[bool], stored: Option<&Stored>) -> Self {
        let inner = self.inner.with_samples(plan, nodes);
        Self::sharing(inner, stored, |_, chunks| self.reflectance.for_chunks(chunks))
    }

    /// How many elements count towards one of certain nodes.
    pub fn elements_towards(&self, nodes: &[bool]) -> usize {
        self.inner.order.towards(&*self.inner.receivers, nodes).elements().len()
    }

    /// How many rays it would store [with other samples](Self::with_samples).
    pub fn rays_with(&self, plan: &Plan, nodes: &[bool]) -> u64 {
        self.inner.order.towards(&*self.inner.receivers, nodes).rays(plan)
    }

    /// What [`memory`](Self::memory) would be [with other samples](Self::with_samples).
    pub fn memory_with(&self, plan: &Plan, nodes: &[bool]) -> u64 {
        Rows::bytes_for(self.rays_with(plan, nodes), self.reflectance.varies())
    }

    /// What it stores, to be shared.
    pub fn stored(&self) -> Stored {
        let (rows, reflectance) = (Arc::clone(&self.rows), Arc::clone(&self.reflectance));
        let (scene, order) = (Arc::clone(&self.inner.scene), self.inner.order.clone());
        let receivers: Arc<dyn Receivers> = Arc::<R>::clone(&self.inner.receivers);
        Stored { rows, reflectance, scene, receivers, order }
    }

    /// The rows.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Bytes of the rows, once all are traced, and of the albedos that belong to them.
    pub fn memory(&self) -> u64 {
        Rows::bytes_for(self.inner.order.rays(&self.inner.plan), self.reflectance.varies())
    }

    pub(crate) fn chunk_rows(&self, chunk: u32, control: &Control) -> Result<ChunkRows<'_>, TransportError> {
        let (slot, elements) = (&self.rows.chunks[chunk as usize], self.inner.elements(chunk));
        if let Some(ends) = slot.get() {
            return Ok(ChunkRows { elements, ends });
        }
        let ends = self.trace_rows(chunk, control)?;
        Ok(ChunkRows { elements, ends: slot.get_or_init(|| ends) })
    }

    /// The rows of a chunk that have been traced; of others none.
    pub(crate) fn rows_there(&self, chunk: u32) -> ChunkRows<'_> {
        let ends = self.rows.chunks[chunk as usize].get().map_or(&[][..], |ends| ends);
        ChunkRows { elements: self.inner.elements(chunk), ends }
    }

    fn measure_chunk(
        &self,
        job: &Job<'_>,
        reflected: &[Reflected<'_>],
        chunk: u32,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        control.check()?;
        let rows = self.chunk_rows(chunk, control)?;
        let sums = match (reflected.split_first(), job.source) {
            (Some(reflected), _) => match &self.areas {
                None => self.bounce_at_points(job, reflected, rows, chunk),
                Some(areas) => self.bounce_over_areas(job, (&areas.rays, chunk), rows, reflected, control)?,
            },
            (None, Source::Emitters(mask)) => match &self.areas {
                Some(AreaRows { rays, lights: Some(lights), .. }) => {
                    self.direct_over_areas(job, mask, (rays, lights, chunk), rows, control)?
                }
                _ => self.direct_at_points(job, mask, rows, control)?,
            },
            (None, _) => self.hidden_at_points(job, rows, control)?,
        };
        control.count(rows.elements.len() as u64, 0);
        Ok(sums)
    }

    /// The sample points of the rays that are stored of an element.
    pub(crate) fn row_key(&self, element: ElementId) -> StreamKey {
        self.rows.key.of(self.inner.receivers.stream(element))
    }

    /// The places of the elements that a job measures among those of a chunk, and where they are measured.
    fn active(&self, job: &Job<'_>, elements: &[ElementId]) -> (Vec<usize>, Group) {
        let places: Vec<usize> = (0..elements.len()).filter(|&i| job.measures(elements[i])).collect();
        let active: Vec<ElementId> = places.iter().map(|&i| elements[i]).collect();
        (places, Group::new(&*self.inner.receivers, &active))
    }

    /// One bounce, read from the ends of a chunk's rays.
    fn bounce_at_points(
        &self,
        job: &Job<'_>,
        (first, others): (&Reflected<'_>, &[Reflected<'_>]),
        rows: ChunkRows<'_>,
        chunk: u32,
    ) -> Sums {
        let lanes = rows.elements.len();
        let of = |reflected: &Reflected<'_>| match reflected.albedos(&self.inner.scene, chunk, rows.ends) {
            _ if !reflected.is_linear() => {
                let (scene, basis) = (&self.inner.scene, &*self.inner.basis);
                let mut weights = NodeWeights::default();
                means(lanes, rows.ends, |end, _| reflected.at(scene, basis, end, None, &mut weights))
            }
            None => means(lanes, rows.ends, |end, _| reflected.plane_at(end)),
            Some(albedos) => means(lanes, rows.ends, |end, i| reflected.plane_at(end) * unpacked(albedos[i])),
        };
        let mut values = of(first);
        for other in others {
            values.iter_mut().zip(of(other)).for_each(|(sum, value)| *sum += value);
        }
        let (active, group) = self.active(job, rows.elements);
        group.irradiance(&active.iter().map(|&i| values[i]).collect::<Vec<_>>())
    }

    /// Light by shadow rays, and of the sky and emissive surfaces that stored rays meet.
    fn direct_at_points(
        &self,
        job: &Job<'_>,
        mask: Option<&EmitterMask>,
        rows: ChunkRows<'_>,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let (active, group) = self.active(job, rows.elements);
        let mut values = vec![DVec3::ZERO; group.len()];
        measure::add_direct_at_points(&self.inner, job, mask, &group, &mut values, control)?;
        let (lanes, mut reader) = (rows.elements.len(), Reader::new(&self.inner, job.source));
        let per_element = rows.per_element();
        let mut arrivals = Arrivals::new(&self.inner, job.source);
        if let Some(arrivals) = &mut arrivals {
            let rays = Rays { per_element: per_element as u32, dim: Dim::Hemisphere };
            arrivals.set_points(&self.inner, &group, rays, |element| self.row_key(element));
        }
        for (i, (value, lane)) in values.iter_mut().zip(active).enumerate() {
            let row = rows.ends.iter().skip(lane).step_by(lanes);
            let mut sum: DVec3 = row.clone().filter_map(|end| end.end()).map(|end| reader.read(&end)).sum();
            if let Some(arrivals) = &arrivals {
                let arriving = |(k, end)| arrivals.arriving(i * per_element + k, &end);
                let ends = row.enumerate().filter_map(|(k, end)| Some((k, end.end()?)));
                sum += ends.map(arriving).sum::<DVec3>();
            }
            *value += sum / per_element as f64;
        }
        Ok(group.irradiance(&values))
    }

    fn hidden_at_points(
        &self,
        job: &Job<'_>,
        rows: ChunkRows<'_>,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let (active, group) = self.active(job, rows.elements);
        let lanes = rows.elements.len();
        let share = |i: usize| {
            let row = rows.ends.iter().skip(active[i]).step_by(lanes);
            row.filter(|end| **end == StoredEnd::BACK_FACE).count() as f64 / rows.per_element() as f64
        };
        hidden::at_points(&self.inner, &group, |element| self.inner.key(job, element), control, share)
    }
}

/// What the rays of an operator depend on.
fn key_of<B: Basis, R: Receivers>(inner: &CpuTransport<B, R>) -> RowsKey {
    let plan = &inner.plan;
    RowsKey {
        elements: inner.elements_identity(),
        requested: plan.indirect_samples,
        sampler: plan.sampler,
        seed: plan.seed,
        portion: plan.portion,
        density: inner.density,
    }
}

impl RowsKey {
    /// The sample points that all elements share.
    pub(crate) fn shared(&self) -> StreamKey {
        StreamKey::new(self.seed).bounce(SHARED_BOUNCE).pass(self.pass())
    }

    fn pass(&self) -> u32 {
        match self.density {
            HemisphereDensity::Cosine => SHARED_PASS,
            HemisphereDensity::Mixed => DIRECTIONAL_PASS,
        }
    }

    /// The sample points of an element with this [stream](Receivers::stream).
    pub(crate) fn of(&self, stream: u32) -> StreamKey {
        StreamKey::new(self.seed).element(stream).bounce(SHARED_BOUNCE).pass(self.pass())
    }
}

impl<B: Basis, R: Receivers + 'static> CachedTransport<B, R> {
    /// Traces the rays of a chunk, but for those of elements that were carried over.
    fn trace_rows(&self, chunk: u32, control: &Control) -> Result<Box<[StoredEnd]>, TransportError> {
        let elements = self.inner.elements(chunk);
        let Some(mut carried) = self.rows.take_carried(chunk) else {
            return self.trace_rows_of(chunk, elements, control);
        };
        let missing: Vec<usize> = (0..elements.len()).filter(|&lane| !carried.has(lane)).collect();
        let new: Vec<ElementId> = missing.iter().map(|&lane| elements[lane]).collect();
        if !new.is_empty() {
            carried.fill(&missing, &self.trace_rows_of(chunk, &new, control)?);
        }
        Ok(carried.ends)
    }

    /// Traces the rays of some elements of a chunk.
    fn trace_rows_of(
        &self,
        chunk: u32,
        elements: &[ElementId],
        control: &Control,
    ) -> Result<Box<[StoredEnd]>, TransportError> {
        let inner = &self.inner;
        if let Some(areas) = &self.areas {
            return self.trace_area_rows(&areas.rays, chunk, elements, control);
        }
        let (lanes, requested) = (elements.len(), self.rows.key.requested);
        let per_element = inner.plan.samples(requested, Sampling::Point, inner.order.doublings_of(chunk));
        let mut ends = vec![StoredEnd::SKY; lanes * per_element as usize];
        let group = Group::new(&*inner.receivers, elements);
        let rays = Rays { per_element, dim: Dim::Hemisphere };
        let mut next = vec![0; lanes];
        trace::at_points(
            inner,
            &group,
            rays,
            |element| self.row_key(element),
            control,
            |i, end, _| {
                ends[next[i] * lanes + i] = StoredEnd::new(&end);
                next[i] += 1;
            },
        )?;
        Ok(ends.into())
    }
}

/// The mean of `value(end, its place)` over each row of `lanes` interleaved ones.
///
/// This is where the time of all bounces goes: neighbours' rays through one cell follow each other here, and mostly end
/// on the same triangles.
#[inline(always)]
fn means(lanes: usize, ends: &[StoredEnd], mut value: impl FnMut(StoredEnd, usize) -> Vec4) -> Vec<DVec3> {
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

impl<B: Basis, R: Receivers + 'static> Transport for CachedTransport<B, R> {
    fn shape(&self) -> Shape {
        self.inner.sizes()
    }

    /// Other passes than the first go without the rows, and so does direct light where the rows say nothing about it: at
    /// points that of lights alone, over areas that of samples in other places.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        let at_points = self.areas.is_none();
        let lights_on_rows = self.areas.as_ref().is_some_and(|areas| areas.lights.is_some());
        let reflected = match job.source {
            _ if job.pass != SHARED_PASS => return self.inner.measure(job, chunks, control, sink),
            Source::Shot(field, nodes) if self.can_shoot() => {
                let shot = self.shot_of((field, nodes), control)?;
                if shot.is_small() {
                    return self.shoot(job, &shot, chunks, control, sink);
                }
                self.reflectance.of_source(&*self.inner.basis, job.source)
            }
            Source::Field(_) | Source::Reflecting { .. } | Source::Shot(..) => {
                self.reflectance.of_source(&*self.inner.basis, job.source)
            }
            Source::Nothing if at_points && self.rows.key.requested >= VALIDITY_RAYS => Vec::new(),
            Source::Emitters(_) if lights_on_rows => Vec::new(),
            Source::Emitters(_) if at_points && self.inner.lights.needs_hemisphere() => Vec::new(),
            Source::Emitters(_) | Source::Ambient(_) | Source::Nothing => {
                return self.inner.measure(job, chunks, control, sink);
            }
        };
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            sink.accept(chunk, self.measure_chunk(job, &reflected, chunk, control)?);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ends::RayEnd;
    use crate::hemisphere;
    use crate::{Plan, accumulate};
    use lumel_accel::Bvh;
    use lumel_basis::{Field, PointReceivers, VertexBasis};

    /// Bounces by the definition: where each stored ray ends, light and albedo are looked up and multiplied.
    struct ByDefinition<'a>(&'a CachedTransport<VertexBasis, PointReceivers>);

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
        ) -> Result<(), TransportError> {
            let Source::Field(field) = job.source else { return self.0.measure(job, chunks, control, sink) };
            let CpuTransport { scene, basis, receivers, .. } = &self.0.inner;
            chunks.into_par_iter().try_for_each(|chunk| {
                let ChunkRows { ends, elements } = self.0.chunk_rows(chunk, control)?;
                let mut weights = NodeWeights::default();
                let mut reflected = |end: &StoredEnd| {
                    let end = end.end().unwrap_or(RayEnd::BackFace);
                    hemisphere::reflected(scene, &**basis, field, &end, &mut weights).0.as_dvec3()
                };
                let mut mean = |lane: usize| {
                    let row = ends.iter().skip(lane).step_by(elements.len());
                    row.map(&mut reflected).sum::<DVec3>() / (ends.len() / elements.len()) as f64
                };
                let values: Vec<DVec3> = (0..elements.len()).map(&mut mean).collect();
                sink.accept(chunk, Group::new(&**receivers, elements).irradiance(&values));
                Ok(())
            })
        }
    }

    #[test]
    fn the_sum_of_bounces_is_the_neumann_series_on_the_same_rows() {
        for name in ["cornell-box", "atrium"] {
            let scene = Arc::new(lumel_builtin::scene(name, 0).unwrap().build().unwrap().0);
            let tracer = Arc::new(Bvh::build(&scene));
            let basis = Arc::new(VertexBasis::new(Arc::clone(&scene)));
            let receivers = Arc::new(PointReceivers::at_vertices(&basis));
            let plan = Plan { direct_samples: 4, indirect_samples: 128, ..Plan::default() };
            let inner = CpuTransport::new(scene, tracer, basis, receivers, plan);
            let cached = CachedTransport::new(inner, None);
            let solved = |transport: &dyn Transport| {
                let applied = |source: Source<'_>, bounce: u32| {
                    let job = Job { source, bounce, pass: SHARED_PASS, active: None };
                    accumulate(transport, &job, &Control::default(), None).unwrap().field
                };
                let mut bounces = vec![applied(Source::Emitters(None), 0)];
                for bounce in 1..=4 {
                    bounces.push(applied(Source::Field(&bounces[bounce as usize - 1]), bounce));
                }
                Field::sum(bounces[0].node_count(), &bounces)
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
