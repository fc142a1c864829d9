//! Areas on stored rows.

use crate::area_pattern::{AreaChunk, AreaPart, AreaPatterns};
use crate::cached::{CachedTransport, ChunkRows};
use crate::ends::{RayEnd, StoredEnd};
use crate::job::{Control, Job, TransportError};
use crate::measure::{self, LightScratch};
use crate::order::CHUNK;
use crate::reflectance::Reflected;
use crate::sums::ElementSums;
use crate::{EmitterMask, Sums, trace};
use lumel_basis::{Basis, ElementId, NodeWeights, Receivers};

impl<B: Basis, R: Receivers + 'static> CachedTransport<B, R> {
    /// Traces the rays of some elements of a chunk of areas, part by part.
    pub(crate) fn trace_area_rows(
        &self,
        patterns: &AreaPatterns,
        chunk: u32,
        elements: &[ElementId],
        control: &Control,
    ) -> Result<Box<[StoredEnd]>, TransportError> {
        let mut rows =
            Vec::with_capacity(self.inner.elements(chunk).len() * patterns.samples(&self.inner.order, chunk));
        for part in patterns.parts(&self.inner.order, chunk) {
            let ends = trace::over_areas(&self.inner, &self.area_chunk(&part, elements), control)?;
            let stored = |end: Option<RayEnd>| end.map_or(StoredEnd::INSIDE, |end| StoredEnd::new(&end));
            rows.extend(ends.into_iter().map(stored));
        }
        Ok(rows.into())
    }

    /// A part of the samples that rays are stored of.
    pub(crate) fn area_chunk<'a>(&self, part: &'a AreaPart<'_>, elements: &'a [ElementId]) -> AreaChunk<'a> {
        AreaChunk::new(elements, part, |element| self.row_key(element))
    }

    /// One bounce of the elements of a chunk, at the sites that their rays started from.
    pub(crate) fn bounce_over_areas<'a>(
        &self,
        job: &Job<'_>,
        (patterns, chunk): (&AreaPatterns, u32),
        rows: ChunkRows<'a>,
        (first, others): (&'a Reflected<'a>, &'a [Reflected<'a>]),
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let inner = &self.inner;
        let mut sums = ElementSums::some(rows.elements.len());
        let (measured, mut weights) = (measured(job, rows), NodeWeights::default());
        let with_albedos =
            |reflected: &'a Reflected<'a>| (reflected, reflected.albedos(&inner.scene, chunk, rows.ends));
        let (first, others) = (with_albedos(first), others.iter().map(with_albedos).collect::<Vec<_>>());
        for part in patterns.parts(&inner.order, chunk) {
            control.check()?;
            let area = self.area_chunk(&part, rows.elements);
            measure::add_samples::<CHUNK, _, _>(inner, &area, &measured, &mut sums, |i, slot| {
                let at = rows.at(area.first + slot, i);
                let end = rows.ends[at];
                let mut of = |(reflected, albedos): &(&Reflected<'_>, Option<&[[u16; 3]]>)| {
                    let albedo = albedos.map(|albedos| albedos[at]);
                    reflected.at(&inner.scene, &*inner.basis, end, albedo, &mut weights)
                };
                let mut value = of(&first);
                others.iter().for_each(|other| value += of(other));
                value.truncate().extend(f32::from(u8::from(end != StoredEnd::INSIDE)))
            });
        }
        Ok(Sums::of_elements(&sums, false))
    }

    /// Direct light of the elements of a chunk: of lights by shadow rays from places of `lights`, which are among those that
    /// the stored rays start from, and of sky and emissive surfaces that these meet.
    pub(crate) fn direct_over_areas(
        &self,
        job: &Job<'_>,
        mask: Option<&EmitterMask>,
        (patterns, lights, chunk): (&AreaPatterns, &AreaPatterns, u32),
        rows: ChunkRows<'_>,
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let inner = &self.inner;
        let direct = measure::direct(inner, mask, control);
        let mut scratch = LightScratch::default();
        let mut sums = ElementSums::some(rows.elements.len());
        let (measured, mut by_rays) = (measured(job, rows), sums.clone());
        let mut lights = lights.parts(&inner.order, chunk);
        for part in patterns.parts(&inner.order, chunk) {
            let rays = self.area_chunk(&part, rows.elements);
            let lights = lights.next();
            let lights = lights
                .as_ref()
                .map(|lights| AreaChunk::new(rows.elements, lights, |element| inner.key(job, element)));
            let end = |i: usize, slot: u32| rows.ends[rows.at(rays.first + slot, i)];
            if let Some(lights) = &lights {
                let is_outside =
                    |i: usize, number| end(i, rays.pattern.slot(number, rays.keys[i].1)) != StoredEnd::INSIDE;
                measure::add_lights_of(
                    inner,
                    &direct,
                    (lights, &measured),
                    is_outside,
                    &mut scratch,
                    &mut sums,
                )?;
            }
            if inner.lights.needs_hemisphere() {
                let end = |i, slot| end(i, slot).end();
                measure::add_arrivals(inner, job.source, &rays, &measured, &mut by_rays, end);
            }
        }
        sums.iter_mut().zip(&by_rays).for_each(|(sums, by_rays)| sums.add_means(by_rays));
        Ok(Sums::of_elements(&sums, false))
    }

    /// The patterns of the shadow rays of direct light, if their places are among those of the rows; then no ray is needed
    /// to tell which of them lie inside geometry.
    pub(crate) fn light_patterns(&self, rows: &AreaPatterns) -> Option<AreaPatterns> {
        let plan = &self.inner.plan;
        let lights = AreaPatterns::new(plan, &self.inner.order, plan.direct_samples, self.rows.key.shared());
        lights.are_within(rows).then_some(lights)
    }
}

/// The places in a chunk of the elements that a job measures.
pub(crate) fn measured(job: &Job<'_>, rows: ChunkRows<'_>) -> Vec<usize> {
    (0..rows.elements.len()).filter(|&i| job.measures(rows.elements[i])).collect()
}
