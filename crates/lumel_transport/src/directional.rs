//! The operator that measures light by direction: moments of what arrives, for all light at once at the end of a solve.

use crate::area_pattern::{AreaChunk, AreaPatterns};
use crate::arrivals::Arrivals;
use crate::direct_area::AreaSites;
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
use crate::{EmitterMask, Sums};
use glam::{DVec3, Vec3, Vec4};
use lumel_basis::{Basis, Directional, ElementId, HARMONICS, Receivers, Sampling, Site};
use lumel_sample::{CellOrder, Dim, StreamKey};
use rayon::prelude::*;
use std::ops::Range;

/// A [`CpuTransport`] whose results have the channels of a [`Directional`] field: irradiance, and the coefficients
/// `∫ L Y dω` of the light that arrives.
///
/// Its hemisphere rays lie half by the cosine and half evenly, so that coefficients have a finite variance, and shadow rays
/// count without the cosine of the receiver. Light of one channel is read, as every operator does. Unbiased.
///
/// Bounces need none of it: light is carried as irradiance, and its moments are measured once, from all of it.
pub struct DirectionalTransport<B, R> {
    inner: CpuTransport<B, R>,
    kind: Directional,
}

impl<B: Basis, R: Receivers> DirectionalTransport<B, R> {
    /// With the sites, lights and samples of another operator.
    pub fn new(mut inner: CpuTransport<B, R>, kind: Directional) -> Self {
        inner.density = HemisphereDensity::Mixed;
        Self { inner, kind }
    }

    fn measure_chunk(
        &self,
        job: &Job<'_>,
        chunk: u32,
        patterns: Option<&Patterns>,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        control.check()?;
        let active = self.inner.active(job, chunk);
        let sums = match patterns {
            None => self.at_points(job, &active, control)?,
            Some(patterns) => self.over_areas(job, (&active, chunk), patterns, control)?,
        };
        control.count(self.inner.elements(chunk).len() as u64, 0);
        Ok(sums)
    }

    fn at_points(
        &self,
        job: &Job<'_>,
        elements: &[ElementId],
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let (op, group) = (&self.inner, Group::new(&*self.inner.receivers, elements));
        let key = |element| op.key(job, element);
        let mut moments = Moments::new(self.kind, group.len());
        if let Source::Emitters(mask) = job.source {
            let keys: Vec<StreamKey> = elements.iter().map(|&element| key(element)).collect();
            let samples = op.plan.sampler.sample_count(op.plan.direct_samples);
            let sites = LitSites::Points { sites: &group.sites, keys: &keys, samples };
            let scratch = (&mut LightPoints::default(), &mut Batch::default());
            measure::direct(op, mask, control).moments(&sites, scratch, &mut moments)?;
        }
        if measure::needs_hemisphere(op, job.source) {
            let per_element = op.plan.samples(op.plan.indirect_samples, Sampling::Point, 0);
            let rays = Rays { per_element, dim: Dim::Hemisphere };
            let mut reader = Arriving::new(op, job.source);
            reader.set_points(&group, rays, key);
            let mut next = vec![0; group.len()];
            trace::at_points(op, &group, rays, key, control, |i, end, _| {
                let at = i * per_element as usize + next[i];
                next[i] += 1;
                let arrived = reader.arrived(at, &end);
                let facing = arrived.facing.truncate().as_dvec3() / f64::from(per_element);
                moments.add(i, &arrived.factors, facing);
            })?;
        }
        Ok(group.moments(|i| moments.of(i)))
    }

    fn over_areas(
        &self,
        job: &Job<'_>,
        (elements, chunk): (&[ElementId], u32),
        patterns: &Patterns,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let op = &self.inner;
        let none = || vec![ElementSums::some(elements.len()); self.kind.channels()];
        let (mut sums, mut by_rays) = (none(), none());
        let parts = |patterns: &Option<AreaPatterns>, each: EachPart<'_>| {
            for part in patterns.iter().flat_map(|patterns| patterns.parts(&op.order, chunk)) {
                let area = AreaChunk::new(elements, &part, |element| op.key(job, element));
                each(&area, &trace::over_areas(op, &area, control)?)?;
            }
            Ok::<(), TransportError>(())
        };
        if let Source::Emitters(mask) = job.source {
            parts(&patterns.lights, &mut |area, ends| self.add_lights(mask, area, ends, &mut sums, control))?;
        }
        parts(&patterns.rays, &mut |area, ends| {
            self.add_rays(job.source, area, ends, &mut by_rays);
            Ok(())
        })?;
        if patterns.lights.is_some() {
            for (sums, by_rays) in sums.iter_mut().zip(&by_rays) {
                sums.iter_mut().zip(by_rays).for_each(|(sums, by_rays)| sums.add_means(by_rays));
            }
        } else {
            sums = by_rays;
        }
        Ok(Sums::of_channels(&sums))
    }

    /// Adds what arrives along the rays of each element.
    fn add_rays(
        &self,
        source: Source<'_>,
        area: &AreaChunk<'_>,
        ends: &[Option<RayEnd>],
        sums: &mut [Vec<ElementSums>],
    ) {
        let (op, lanes) = (&self.inner, area.elements.len());
        let mut reader = Arriving::new(op, source);
        let mut arrived = Vec::with_capacity(area.pattern.len() as usize);
        for i in 0..lanes {
            reader.set_area(area, i);
            arrived.clear();
            arrived.extend((0..area.pattern.len() as usize).map(|slot| {
                let end = &ends[slot * lanes + i];
                end.as_ref().map_or(Arrived::LEFT_OUT, |end| reader.arrived(slot, end))
            }));
            for (channel, sums) in sums.iter_mut().enumerate() {
                measure::add_samples::<1, _, _>(op, area, &[i], sums, |_, slot| {
                    arrived[slot as usize].in_channel(channel)
                });
            }
        }
    }

    /// Adds what lights send to the sites of each element that do not lie inside geometry.
    fn add_lights(
        &self,
        mask: Option<&EmitterMask>,
        area: &AreaChunk<'_>,
        ends: &[Option<RayEnd>],
        sums: &mut [Vec<ElementSums>],
        control: &Control,
    ) -> Result<(), TransportError> {
        let (op, lanes) = (&self.inner, area.elements.len());
        let samples = area.pattern.len();
        let is_outside =
            |i: usize, number| ends[area.pattern.slot(number, area.keys[i].1) as usize * lanes + i].is_some();
        let mut sites: Vec<Option<Site>> = Vec::with_capacity(lanes * samples as usize);
        let mut all = Vec::with_capacity(samples as usize);
        for (i, &element) in area.elements.iter().enumerate() {
            all.clear();
            op.receivers.sites(element, area.pattern.places(), &mut all);
            let outside = |(number, site)| is_outside(i, number).then_some(site);
            sites.extend((0..).zip(all.drain(..)).map(outside));
        }
        let mut moments = Moments::new(self.kind, sites.len());
        let lit = AreaSites { sites: &sites, keys: &area.keys, pattern: area.pattern };
        let scratch = (&mut LightPoints::default(), &mut Batch::default());
        measure::direct(op, mask, control).moments(&LitSites::Areas(&lit), scratch, &mut moments)?;
        for i in 0..lanes {
            for (channel, sums) in sums.iter_mut().enumerate() {
                measure::add_samples::<1, _, _>(op, area, &[i], sums, |_, slot| {
                    let at = lit.at(i, slot);
                    let value = || moments.of(at)[channel].as_vec3().extend(1.0);
                    sites[at].as_ref().map_or(Vec4::ZERO, |_| value())
                });
            }
        }
        Ok(())
    }
}

/// Takes a part of the samples and the ends of their rays.
type EachPart<'a> = &'a mut dyn FnMut(&AreaChunk<'_>, &[Option<RayEnd>]) -> Result<(), TransportError>;

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
    cells: CellOrder,
    /// The normal at the site of each ray, and its direction.
    rays: Vec<[Vec3; 2]>,
}

impl<'a, B: Basis, R: Receivers> Arriving<'a, B, R> {
    fn new(op: &'a CpuTransport<B, R>, source: Source<'a>) -> Self {
        let (reader, arrivals) = (Reader::new(op, source), Arrivals::new(op, source));
        Self { op, reader, arrivals, cells: CellOrder::default(), rays: Vec::new() }
    }

    /// Takes the rays of [`trace::at_points`], element by element.
    fn set_points(&mut self, group: &Group, rays: Rays, key: impl Fn(ElementId) -> StreamKey + Copy) {
        self.rays.clear();
        for (&element, site) in group.elements.iter().zip(&group.sites) {
            let stream = self.op.plan.stream(rays.per_element, key(element), rays.dim);
            let points = self.cells.points(&stream, rays.per_element);
            let ray = |&u| [site.frame.normal, self.op.density.direction(site, u)];
            self.rays.extend(points.iter().map(ray));
        }
        if let Some(arrivals) = &mut self.arrivals {
            arrivals.set_points(self.op, group, rays, key);
        }
    }

    /// Takes the rays of [`trace::over_areas`] of element `i`, slot by slot.
    fn set_area(&mut self, area: &AreaChunk<'_>, i: usize) {
        let (samples, (key, turn)) = (area.pattern.len(), area.keys[i]);
        let mut sites = Vec::with_capacity(samples as usize);
        self.op.receivers.sites(area.elements[i], area.pattern.places(), &mut sites);
        let stream = self.op.plan.stream(samples, key, Dim::Hemisphere);
        let points = (0..).zip(self.cells.points(&stream, samples));
        self.rays.clear();
        self.rays.extend(points.map(|(slot, &u)| {
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
        let [normal, direction] = self.rays[at];
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

impl<B: Basis, R: Receivers> Transport for DirectionalTransport<B, R> {
    fn shape(&self) -> Shape {
        Shape { channels: self.kind.channels(), ..self.inner.sizes() }
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
        let is_over_areas = self.inner.receivers.sampling() == Sampling::Area;
        let patterns = is_over_areas.then(|| Patterns::new(&self.inner, job));
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            sink.accept(chunk, self.measure_chunk(job, chunk, patterns.as_ref(), control)?);
            Ok(())
        })
    }
}
