//! The operator that measures light by direction: moments of what arrives, for all light at once at the end of a solve.

use crate::Sums;
use crate::area_pattern::{AreaChunk, AreaPatterns};
use crate::arrivals::Arrivals;
use crate::cached::{AreaRows, CachedTransport, ChunkRows, DIRECTIONAL_PASS, Stored};
use crate::cached_area::measured;
use crate::direct_area::{AreaSites, GROUP};
use crate::direct_moments::LitSites;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::hemisphere::HemisphereDensity;
use crate::job::{ChunkSink, Control, Job, Shape, Source, Transport, TransportError};
use crate::light_points::LightPoints;
use crate::measure::{self, Reader};
use crate::moments::{self, Moments};
use crate::operator::CpuTransport;
use crate::scatter::scattered;
use crate::shadow_batch::Batch;
use crate::sums::ElementSums;
use crate::trace::{self, Rays};
use glam::{DVec3, Vec3, Vec4};
use lumel_basis::{Basis, Directional, ElementId, HARMONICS, Receivers, Sampling, Site};
use lumel_sample::{CellOrder, Dim, StreamKey};
use rayon::prelude::*;
use std::ops::Range;

/// An operator whose results have the channels of a [`Directional`] field: irradiance, and the coefficients `∫ L Y dω` of the
/// light that arrives.
///
/// Its hemisphere rays lie half by the cosine and half evenly, so that coefficients have a finite variance, and shadow rays
/// count without the cosine of the receiver. Light of one channel is read, as every operator does. Unbiased.
///
/// Bounces need none of it: light is carried as irradiance, and its moments are measured once, from all of it. If it is asked
/// for, hemisphere rays are stored, for all jobs of [their pass](DIRECTIONAL_PASS) and to be used under other lights.
pub struct DirectionalTransport<B, R> {
    cached: CachedTransport<B, R>,
    kind: Directional,
    stores_rays: bool,
}

impl<B: Basis, R: Receivers + 'static> DirectionalTransport<B, R> {
    /// With the sites, lights and samples of another operator.
    pub fn new(mut inner: CpuTransport<B, R>, kind: Directional) -> Self {
        inner.density = HemisphereDensity::Mixed;
        Self { cached: CachedTransport::new(inner, None), kind, stores_rays: false }
    }

    /// The same, which stores its rays, or takes those that another one has stored where they are the same.
    pub fn storing(mut inner: CpuTransport<B, R>, kind: Directional, shared: Option<&Stored>) -> Self {
        inner.density = HemisphereDensity::Mixed;
        Self { cached: CachedTransport::new(inner, shared), kind, stores_rays: true }
    }

    /// What it stores, to be shared.
    pub fn stored(&self) -> Option<Stored> {
        self.stores_rays.then(|| self.cached.stored())
    }

    fn measure_chunk(
        &self,
        job: &Job<'_>,
        chunk: u32,
        patterns: Option<&Patterns>,
        scratch: &mut Scratch,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        control.check()?;
        let stores = self.stores_rays && job.pass == DIRECTIONAL_PASS;
        let rows = if stores { Some(self.cached.chunk_rows(chunk, control)?) } else { None };
        let sums = match (patterns, rows) {
            (None, rows) => self.at_points(job, (chunk, rows), scratch, control)?,
            (Some(patterns), None) => self.over_areas(job, (patterns, chunk), scratch, control)?,
            (Some(patterns), Some(rows)) => {
                self.on_area_rows(job, (patterns, chunk, rows), scratch, control)?
            }
        };
        control.count(self.cached.inner.elements(chunk).len() as u64, 0);
        Ok(sums)
    }

    fn at_points(
        &self,
        job: &Job<'_>,
        (chunk, rows): (u32, Option<ChunkRows<'_>>),
        scratch: &mut Scratch,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let op = &self.cached.inner;
        let elements = op.active(job, chunk);
        let group = Group::new(&*op.receivers, &elements);
        let Rest { points, batch, moments, rays: ray_scratch, .. } = &mut scratch.rest;
        moments.reset(self.kind, group.len());
        if let Source::Emitters(mask) = job.source {
            let keys: Vec<StreamKey> = elements.iter().map(|&element| op.key(job, element)).collect();
            let samples = op.plan.sampler.sample_count(op.plan.direct_samples);
            let sites = LitSites::Points { sites: &group.sites, keys: &keys, samples };
            measure::direct(op, mask, control).moments(&sites, (points, batch), moments)?;
        }
        if measure::needs_hemisphere(op, job.source) {
            let per_element = op.plan.samples(op.plan.indirect_samples, Sampling::Point, 0);
            let rays = Rays { per_element, dim: Dim::Hemisphere };
            let key = |element| match rows {
                Some(_) => self.cached.row_key(element),
                None => op.key(job, element),
            };
            let mut reader = Arriving::new(op, job.source, ray_scratch);
            reader.set_points(&group, rays, key);
            let mut next = vec![0; group.len()];
            let mut add = |i: usize, end: &RayEnd| {
                let at = i * per_element as usize + next[i];
                next[i] += 1;
                let arrived = reader.arrived(at, end);
                let facing = arrived.facing.truncate().as_dvec3() / f64::from(per_element);
                moments.add(i, &arrived.factors, facing);
            };
            match rows {
                None => trace::at_points(op, &group, rays, key, control, |i, end, _| add(i, &end))?,
                Some(rows) => {
                    for (i, lane) in measured(job, rows).into_iter().enumerate() {
                        let row = rows.ends.iter().skip(lane).step_by(rows.elements.len());
                        row.for_each(|end| add(i, &end.end().unwrap_or(RayEnd::BackFace)));
                    }
                }
            }
        }
        Ok(group.moments(|i| moments.of(i)))
    }

    fn over_areas(
        &self,
        job: &Job<'_>,
        (patterns, chunk): (&Patterns, u32),
        scratch: &mut Scratch,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let op = &self.cached.inner;
        let elements = op.active(job, chunk);
        let Scratch { found, rest: scratch } = scratch;
        found.reset(self.kind, elements.len(), patterns);
        let all: Vec<usize> = (0..elements.len()).collect();
        for part in patterns.lights.iter().flat_map(|patterns| patterns.parts(&op.order, chunk)) {
            let area = AreaChunk::new(&elements, &part, |element| op.key(job, element));
            let ends = trace::over_areas(op, &area, control)?;
            let is_outside = |i: usize, number| ends[area.place(i, number)].is_some();
            self.add_lights(job.source, (&area, &all), &is_outside, (found, scratch), control)?;
        }
        for part in patterns.rays.iter().flat_map(|patterns| patterns.parts(&op.order, chunk)) {
            let area = AreaChunk::new(&elements, &part, |element| op.key(job, element));
            let ends = trace::over_areas(op, &area, control)?;
            self.add_rays(job.source, (&area, &all), |at| ends[at], (found, scratch));
        }
        Ok(found.sums())
    }

    /// Over areas, by stored rays: they also tell which places lie inside geometry.
    fn on_area_rows(
        &self,
        job: &Job<'_>,
        (patterns, chunk, rows): (&Patterns, u32, ChunkRows<'_>),
        scratch: &mut Scratch,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let op = &self.cached.inner;
        let Scratch { found, rest: scratch } = scratch;
        found.reset(self.kind, rows.elements.len(), patterns);
        let measured = measured(job, rows);
        let Some(AreaRows { rays, lights, .. }) = &self.cached.areas else { return Ok(Sums::default()) };
        let mut lights = lights.as_ref().map(|lights| lights.parts(&op.order, chunk));
        for part in rays.parts(&op.order, chunk) {
            control.check()?;
            let area = self.cached.area_chunk(&part, rows.elements);
            let end = |at: usize| rows.ends[area.first as usize * rows.elements.len() + at].end();
            let lights = lights.as_mut().filter(|_| patterns.lights.is_some()).and_then(Iterator::next);
            if let Some(lights) = &lights {
                let lit = AreaChunk::new(rows.elements, lights, |element| op.key(job, element));
                let is_outside = |i: usize, number| end(area.place(i, number)).is_some();
                self.add_lights(job.source, (&lit, &measured), &is_outside, (found, scratch), control)?;
            }
            if patterns.rays.is_some() {
                self.add_rays(job.source, (&area, &measured), end, (found, scratch));
            }
        }
        Ok(found.sums())
    }

    /// Adds what arrives along the rays of each element.
    fn add_rays(
        &self,
        source: Source<'_>,
        (area, elements): (&AreaChunk<'_>, &[usize]),
        end: impl Fn(usize) -> Option<RayEnd>,
        (found, scratch): (&mut Found, &mut Rest),
    ) {
        let (op, lanes) = (&self.cached.inner, area.elements.len());
        let Rest { rays, arrived, .. } = scratch;
        let mut reader = Arriving::new(op, source, rays);
        for &i in elements {
            reader.set_area(area, i);
            arrived.clear();
            arrived.extend((0..area.pattern.len() as usize).map(|slot| {
                end(slot * lanes + i).map_or(Arrived::LEFT_OUT, |end| reader.arrived(slot, &end))
            }));
            measure::add_channels(op, area, i, &mut found.by_rays, |slot, channel| {
                arrived[slot as usize].in_channel(channel)
            });
        }
    }

    /// Adds what lights send to the samples of some elements that are `is_outside` geometry, by element and number.
    fn add_lights(
        &self,
        source: Source<'_>,
        (area, elements): (&AreaChunk<'_>, &[usize]),
        is_outside: &dyn Fn(usize, u32) -> bool,
        (found, scratch): (&mut Found, &mut Rest),
        control: &Control,
    ) -> Result<(), TransportError> {
        let Source::Emitters(mask) = source else { return Ok(()) };
        let op = &self.cached.inner;
        let Rest { points, batch, moments, all, sites, keys, .. } = scratch;
        for elements in elements.chunks((GROUP / area.pattern.len() as usize).max(1)) {
            sites.clear();
            keys.clear();
            for &i in elements {
                op.receivers.sites(area.elements[i], area.pattern.places(), all);
                let outside = |(number, site)| is_outside(i, number).then_some(site);
                sites.extend((0..).zip(all.drain(..)).map(outside));
                keys.push(area.keys[i]);
            }
            moments.reset(self.kind, sites.len());
            let lit = AreaSites { sites, keys, pattern: area.pattern };
            let direct = measure::direct(op, mask, control);
            direct.moments(&LitSites::Areas(&lit), (&mut *points, &mut *batch), moments)?;
            for (k, &i) in elements.iter().enumerate() {
                measure::add_channels(op, area, i, &mut found.by_lights, |slot, channel| {
                    let at = lit.at(k, slot);
                    let value = || moments.of(at)[channel].as_vec3().extend(1.0);
                    lit.sites[at].as_ref().map_or(Vec4::ZERO, |_| value())
                });
            }
        }
        Ok(())
    }
}

/// Memory that is kept from one chunk to the next.
#[derive(Default)]
struct Scratch {
    found: Found,
    rest: Rest,
}

/// What measuring takes beside what is found.
#[derive(Default)]
struct Rest {
    points: LightPoints,
    batch: Batch,
    moments: Moments,
    /// The sites of an element.
    all: Vec<Site>,
    /// Those of some elements that lie outside geometry, with what names their streams.
    sites: Vec<Option<Site>>,
    keys: Vec<(StreamKey, u32)>,
    rays: RayScratch,
    arrived: Vec<Arrived>,
}

/// That of hemisphere rays.
#[derive(Default)]
struct RayScratch {
    cells: CellOrder,
    sites: Vec<Site>,
    /// The normal at the site of each ray, and its direction.
    rays: Vec<[Vec3; 2]>,
}

/// What was found of some elements, by channel; nothing by what is not asked.
#[derive(Default)]
struct Found {
    by_lights: Vec<Vec<ElementSums>>,
    by_rays: Vec<Vec<ElementSums>>,
}

impl Found {
    /// Nothing yet, in the memory that there is.
    fn reset(&mut self, kind: Directional, elements: usize, patterns: &Patterns) {
        for (sums, patterns) in [(&mut self.by_lights, &patterns.lights), (&mut self.by_rays, &patterns.rays)]
        {
            sums.resize_with(patterns.as_ref().map_or(0, |_| kind.channels()), Vec::new);
            sums.iter_mut().for_each(|sums| ElementSums::reset(sums, elements));
        }
    }

    /// An entry for each node of each element: the mean of what lights and rays bring.
    fn sums(&mut self) -> Sums {
        let no_lights = || self.by_lights.iter().flatten().all(ElementSums::is_empty);
        if !self.by_rays.is_empty() && no_lights() {
            return Sums::of_channels(&self.by_rays);
        }
        for (sums, by_rays) in self.by_lights.iter_mut().zip(&self.by_rays) {
            sums.iter_mut().zip(by_rays).for_each(|(sums, by_rays)| sums.add_means(by_rays));
        }
        Sums::of_channels(&self.by_lights)
    }
}

/// What a ray brings: the irradiance of a surface that faces it, with 1 as its fourth component, and what it counts in each
/// channel.
struct Arrived {
    facing: Vec4,
    factors: [f32; 1 + HARMONICS],
}

impl Arrived {
    /// Of a ray that does not count.
    const LEFT_OUT: Self = Self { facing: Vec4::ZERO, factors: [0.0; 1 + HARMONICS] };

    fn in_channel(&self, channel: usize) -> Vec4 {
        (self.facing.truncate() * self.factors[channel]).extend(self.facing.w)
    }
}

/// What arrives along hemisphere rays, and where from: directions follow from the sample points.
struct Arriving<'a, B, R> {
    op: &'a CpuTransport<B, R>,
    reader: Reader<'a, B, R>,
    arrivals: Option<Arrivals<'a>>,
    scratch: &'a mut RayScratch,
}

impl<'a, B: Basis, R: Receivers> Arriving<'a, B, R> {
    fn new(op: &'a CpuTransport<B, R>, source: Source<'a>, scratch: &'a mut RayScratch) -> Self {
        let (reader, arrivals) = (Reader::new(op, source), Arrivals::new(op, source));
        Self { op, reader, arrivals, scratch }
    }

    /// Takes the rays of [`trace::at_points`], element by element.
    fn set_points(&mut self, group: &Group, rays: Rays, key: impl Fn(ElementId) -> StreamKey + Copy) {
        let scratch = &mut *self.scratch;
        scratch.rays.clear();
        for (&element, site) in group.elements.iter().zip(&group.sites) {
            let stream = self.op.plan.stream(rays.per_element, key(element), rays.dim);
            let points = scratch.cells.points(&stream, rays.per_element);
            let ray = |&u| [site.frame.normal, self.op.density.direction(site, u)];
            scratch.rays.extend(points.iter().map(ray));
        }
        if let Some(arrivals) = &mut self.arrivals {
            arrivals.set_points(self.op, group, rays, key);
        }
    }

    /// Takes the rays of [`trace::over_areas`] of element `i`, slot by slot.
    fn set_area(&mut self, area: &AreaChunk<'_>, i: usize) {
        let (samples, (key, turn)) = (area.pattern.len(), area.keys[i]);
        let RayScratch { cells, sites, rays } = &mut *self.scratch;
        sites.clear();
        self.op.receivers.sites(area.elements[i], area.pattern.places(), sites);
        let stream = self.op.plan.stream(samples, key, Dim::Hemisphere);
        let points = (0..).zip(cells.points(&stream, samples));
        rays.clear();
        rays.extend(points.map(|(slot, &u)| {
            let site = &sites[area.pattern.number(slot, turn) as usize];
            [site.frame.normal, self.op.density.direction(site, u)]
        }));
        if let Some(arrivals) = &mut self.arrivals {
            arrivals.set_area(self.op, area, i);
        }
    }

    /// What ray number `at` brings if it ends there: what it counts in each channel, and the irradiance of a surface that
    /// faces it, divided by its density.
    fn arrived(&mut self, at: usize, end: &RayEnd) -> Arrived {
        let [normal, direction] = self.scratch.rays[at];
        let arriving = self.arrivals.as_ref().map_or(DVec3::ZERO, |arrivals| arrivals.arriving(at, end));
        let by_cosine = (self.reader.read(end) + arriving).as_vec3();
        if by_cosine == Vec3::ZERO {
            return Arrived { facing: Vec4::W, ..Arrived::LEFT_OUT };
        }
        // What a ray of the cosine density brings is L π.
        let facing = by_cosine * self.op.density.per_cosine_sample(normal.dot(direction));
        Arrived { facing: facing.extend(1.0), factors: moments::factors(normal, direction) }
    }
}

/// The patterns in which areas are sampled for a job.
struct Patterns {
    rays: Option<AreaPatterns>,
    lights: Option<AreaPatterns>,
}

impl Patterns {
    fn new<B: Basis, R: Receivers>(op: &CpuTransport<B, R>, job: &Job<'_>) -> Self {
        let requested = |n| AreaPatterns::new(&op.plan, &op.order, n, op.shared_key(job));
        let rays = measure::needs_hemisphere(op, job.source);
        // Without anything that shines, too, it is to be known what lies inside geometry.
        let lights = matches!(job.source, Source::Emitters(_)) && (op.lights.has_lights() || !rays);
        Self {
            rays: rays.then(|| requested(op.plan.indirect_samples)),
            lights: lights.then(|| requested(op.plan.direct_samples)),
        }
    }
}

impl<B: Basis, R: Receivers + 'static> Transport for DirectionalTransport<B, R> {
    fn shape(&self) -> Shape {
        Shape { channels: self.kind.channels(), ..self.cached.inner.sizes() }
    }

    /// Measures emitters and fields alone.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        if matches!(job.source, Source::Nothing | Source::Ambient(_)) {
            let cause = "it measures the light of emitters and fields alone".to_owned();
            return Err(TransportError::Failed { worker: "the operator of directional light".into(), cause });
        }
        let op = &self.cached.inner;
        let is_over_areas = op.receivers.sampling() == Sampling::Area;
        let patterns = is_over_areas.then(|| Patterns::new(op, job));
        scattered(chunks).into_par_iter().try_for_each_init(Scratch::default, |scratch, chunk| {
            sink.accept(chunk, self.measure_chunk(job, chunk, patterns.as_ref(), scratch, control)?);
            Ok(())
        })
    }
}
