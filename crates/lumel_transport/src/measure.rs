//! Trace, read, project: how every job is measured whose rays are not stored.
//!
//! Rays are [traced](crate::trace), what arrives along each is [read](Reader) from the source, and the mean is
//! projected onto the nodes that the element counts towards. Points and areas differ in their sites: a point has one
//! site for all of its rays, an area has a site for each.

use crate::area_pattern::{AreaChunk, AreaPatterns};
use crate::arrivals::Arrivals;
use crate::direct::Direct;
use crate::direct_area::AreaSites;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::hemisphere;
use crate::hidden;
use crate::job::{Control, Job, Source, TransportError};
use crate::light_points::LightPoints;
use crate::operator::CpuTransport;
use crate::order::CHUNK;
use crate::shadow_batch::Batch;
use crate::shadow_rays::Tally;
use crate::sums::ElementSums;
use crate::trace::{self, Rays};
use crate::{AmbientOcclusion, EmitterMask, Sums};
use glam::{DVec3, DVec4, Vec3, Vec4};
use lumel_basis::{Basis, ElementId, HARMONICS, NodeWeights, Receivers, Sampling, Site};
use lumel_sample::{Dim, StreamKey};
use smallvec::SmallVec;

/// Rays that decide whether an element is valid.
pub(crate) const VALIDITY_RAYS: u32 = 64;

/// What arrives along hemisphere rays from one source.
pub(crate) struct Reader<'a, B, R> {
    op: &'a CpuTransport<B, R>,
    source: Source<'a>,
    weights: NodeWeights,
}

impl<'a, B: Basis, R: Receivers> Reader<'a, B, R> {
    pub(crate) fn new(op: &'a CpuTransport<B, R>, source: Source<'a>) -> Self {
        Self { op, source, weights: NodeWeights::default() }
    }

    /// What a cosine-distributed ray adds to the irradiance, W·m⁻².
    #[inline]
    pub(crate) fn read(&mut self, end: &RayEnd) -> DVec3 {
        let Self { op, source, weights } = self;
        match source {
            Source::Field(field) | Source::Shot(field, _) => {
                hemisphere::reflected(&op.scene, &*op.basis, field, end, weights).0.as_dvec3()
            }
            Source::Reflecting { direct, carried } => {
                let basis: &dyn Basis = op.basis.direct().unwrap_or(&*op.basis);
                let direct = hemisphere::reflected(&op.scene, basis, direct, end, weights).0;
                let carried = carried.map_or(Vec3::ZERO, |field| {
                    hemisphere::reflected(&op.scene, &*op.basis, field, end, weights).0
                });
                (direct + carried).as_dvec3()
            }
            Source::Emitters(mask) => hemisphere::emitted(&op.scene, &op.lights, *mask, end).0.as_dvec3(),
            // Distances tell what that brings.
            Source::Ambient(_) | Source::Nothing => DVec3::ZERO,
        }
    }
}

/// Measures elements at points.
pub(crate) fn at_points<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    job: &Job<'_>,
    group: &Group,
    control: &Control,
) -> Result<Sums, TransportError> {
    let plan = &op.plan;
    let key = |element| op.key(job, element);
    if matches!(job.source, Source::Nothing) {
        let per_element = plan.samples(VALIDITY_RAYS, Sampling::Point, 0);
        let mut back_faces = vec![0u32; group.len()];
        let rays = Rays { per_element, dim: Dim::Validity };
        trace::at_points(op, group, rays, key, control, |i, end, _| {
            back_faces[i] += u32::from(end == RayEnd::BackFace);
        })?;
        let share = |i: usize| f64::from(back_faces[i]) / f64::from(per_element);
        return hidden::at_points(op, group, key, control, share);
    }
    let mut values = vec![DVec3::ZERO; group.len()];
    if let Source::Emitters(mask) = job.source {
        add_direct_at_points(op, job, mask, group, &mut values, control)?;
    }
    if needs_hemisphere(op, job.source) {
        let per_element = plan.samples(plan.indirect_samples, Sampling::Point, 0);
        let (mut sums, mut reader) = (vec![DVec3::ZERO; group.len()], Reader::new(op, job.source));
        let rays = Rays { per_element, dim: Dim::Hemisphere };
        if let Source::Ambient(occlusion) = job.source {
            trace::at_points(op, group, rays, key, control, |i, _, distance| {
                sums[i] += DVec3::splat(occlusion.openness(distance).into());
            })?;
            sums.iter_mut().for_each(|sum| *sum /= f64::from(per_element));
            return Ok(group.irradiance(&sums));
        }
        let mut arrivals = Arrivals::new(op, job.source).map(|arrivals| (arrivals, vec![0; group.len()]));
        if let Some((arrivals, _)) = &mut arrivals {
            arrivals.set_points(op, group, rays, key);
        }
        trace::at_points(op, group, rays, key, control, |i, end, _| {
            sums[i] += reader.read(&end);
            if let Some((arrivals, next)) = &mut arrivals {
                sums[i] += arrivals.arriving(i * per_element as usize + next[i], &end);
                next[i] += 1;
            }
        })?;
        values.iter_mut().zip(sums).for_each(|(value, sum)| *value += sum / f64::from(per_element));
    }
    Ok(group.irradiance(&values))
}

/// Adds to each value what lights send to the site by shadow rays.
pub(crate) fn add_direct_at_points<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    job: &Job<'_>,
    mask: Option<&EmitterMask>,
    group: &Group,
    values: &mut [DVec3],
    control: &Control,
) -> Result<(), TransportError> {
    let (direct, mut points) = (direct(op, mask, control), LightPoints::default());
    for ((&element, site), value) in group.elements.iter().zip(&group.sites).zip(values) {
        control.check()?;
        let mut tally = Tally::default();
        direct.at_point(site, op.key(job, element), &mut points, &mut tally)?;
        *value += tally.sum;
        control.count(0, tally.n_rays);
    }
    Ok(())
}

/// Whether anything may arrive along hemisphere rays.
pub(crate) fn needs_hemisphere<B, R>(op: &CpuTransport<B, R>, source: Source<'_>) -> bool {
    !matches!(source, Source::Emitters(_)) || op.lights.needs_hemisphere()
}

/// The patterns in which areas are sampled for a job.
pub(crate) struct JobPatterns {
    /// Of what arrives along hemisphere rays.
    rays: Option<AreaPatterns>,
    /// Of the light of lights.
    lights: Option<AreaPatterns>,
}

/// The patterns in which areas are sampled for a job.
pub(crate) fn patterns<B: Basis, R: Receivers>(op: &CpuTransport<B, R>, job: &Job<'_>) -> JobPatterns {
    let requested = |n| AreaPatterns::new(&op.plan, &op.order, n, op.shared_key(job));
    let (rays, lights) = match job.source {
        Source::Field(_) | Source::Reflecting { .. } | Source::Shot(..) | Source::Ambient(_) => {
            (Some(op.plan.indirect_samples), None)
        }
        Source::Nothing => (Some(VALIDITY_RAYS), None),
        // Without anything that shines, too, it is to be known what lies inside geometry.
        Source::Emitters(_) if !op.lights.needs_hemisphere() => (None, Some(op.plan.direct_samples)),
        Source::Emitters(_) => {
            (Some(op.plan.indirect_samples), op.lights.has_lights().then_some(op.plan.direct_samples))
        }
    };
    JobPatterns { rays: rays.map(requested), lights: lights.map(requested) }
}

/// Measures elements of a chunk over areas: a ray from each of many sites.
///
/// Position and direction are one 4-D point, and so are position and point on a light. Sites inside geometry are left
/// out, so that what is hidden does not darken what is not.
pub(crate) fn over_areas<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    job: &Job<'_>,
    (elements, chunk): (&[ElementId], u32),
    patterns: &JobPatterns,
    control: &Control,
) -> Result<Sums, TransportError> {
    let parts = |patterns: &Option<AreaPatterns>, sums: &mut [ElementSums], are_lights: bool| {
        for part in patterns.iter().flat_map(|patterns| patterns.parts(&op.order, chunk)) {
            let area = AreaChunk::new(elements, &part, |element| op.key(job, element));
            if let Source::Ambient(occlusion) = job.source {
                add_openness(op, occlusion, &area, sums, control)?;
                continue;
            }
            let ends = trace::over_areas(op, &area, control)?;
            match job.source {
                Source::Emitters(mask) if are_lights => add_lights(op, mask, &area, &ends, sums, control)?,
                source => add_rays(op, source, &area, &ends, sums),
            }
        }
        Ok::<(), TransportError>(())
    };
    let mut sums = ElementSums::some(elements.len());
    let mut by_rays = sums.clone();
    parts(&patterns.lights, &mut sums, true)?;
    parts(&patterns.rays, &mut by_rays, false)?;
    if patterns.lights.is_some() {
        sums.iter_mut().zip(&by_rays).for_each(|(sums, by_rays)| sums.add_means(by_rays));
    } else {
        sums = by_rays;
    }
    Ok(Sums::of_elements(&sums, matches!(job.source, Source::Nothing)))
}

/// Adds what arrives along the rays of each element; of [nothing](Source::Nothing), whether their sites are hidden.
fn add_rays<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    source: Source<'_>,
    area: &AreaChunk<'_>,
    ends: &[Option<RayEnd>],
    sums: &mut [ElementSums],
) {
    let lanes = area.elements.len();
    let all: Vec<usize> = (0..lanes).collect();
    let end = |i: usize, slot: u32| ends[slot as usize * lanes + i];
    if matches!(source, Source::Nothing) {
        return add_samples::<CHUNK, _, _>(op, area, &all, sums, |i, slot| {
            Vec3::splat(f32::from(u8::from(end(i, slot).is_none()))).extend(1.0)
        });
    }
    add_arrivals(op, source, area, &all, sums, end);
}

/// Adds how open the surroundings of each element are, along a ray from each of its sites.
fn add_openness<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    occlusion: AmbientOcclusion,
    area: &AreaChunk<'_>,
    sums: &mut [ElementSums],
    control: &Control,
) -> Result<(), TransportError> {
    let lanes = area.elements.len();
    let mut openness = vec![0.0; lanes * area.pattern.len() as usize];
    let ends = trace::over_areas_with(op, area, control, |at, distance| {
        openness[at] = occlusion.openness(distance)
    })?;
    let all: Vec<usize> = (0..lanes).collect();
    add_samples::<CHUNK, _, _>(op, area, &all, sums, |i, slot| {
        let at = slot as usize * lanes + i;
        ends[at].map_or(Vec4::ZERO, |_| Vec3::splat(openness[at]).extend(1.0))
    });
    Ok(())
}

/// Adds what arrives along the rays of some elements, which end where `end` of element and slot says; `None` for those left
/// out.
pub(crate) fn add_arrivals<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    source: Source<'_>,
    area: &AreaChunk<'_>,
    elements: &[usize],
    sums: &mut [ElementSums],
    end: impl Fn(usize, u32) -> Option<RayEnd>,
) {
    let mut reader = Reader::new(op, source);
    let Some(mut arrivals) = Arrivals::new(op, source) else {
        return add_samples::<CHUNK, _, _>(op, area, elements, sums, |i, slot| {
            end(i, slot).map_or(Vec4::ZERO, |end| reader.read(&end).as_vec3().extend(1.0))
        });
    };
    for &element in elements {
        arrivals.set_area(op, area, element);
        add_samples::<1, _, _>(op, area, &[element], sums, |i, slot| {
            let mut read = |end| reader.read(&end) + arrivals.arriving(slot as usize, &end);
            end(i, slot).map_or(Vec4::ZERO, |end| read(end).as_vec3().extend(1.0))
        });
    }
}

/// Adds what lights send to the sites of each element that do not lie inside geometry, as the ends of their rays tell.
fn add_lights<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    mask: Option<&EmitterMask>,
    area: &AreaChunk<'_>,
    ends: &[Option<RayEnd>],
    sums: &mut [ElementSums],
    control: &Control,
) -> Result<(), TransportError> {
    let (direct, mut scratch) = (direct(op, mask, control), LightScratch::default());
    let lanes = area.elements.len();
    let elements: Vec<usize> = (0..lanes).collect();
    let is_outside =
        |i: usize, number| ends[area.pattern.slot(number, area.keys[i].1) as usize * lanes + i].is_some();
    add_lights_of(op, &direct, (area, &elements), is_outside, &mut scratch, sums)
}

/// Samples whose light is summed in single precision before it goes into a sum in double precision.
const BLOCK: u32 = 16;

/// Adds the samples of at most `N` elements of a chunk to their sums: `value` of element and slot, with 1 as its fourth
/// component; all zero for those left out.
///
/// Slot by slot, with the elements side by side: neighbours' rays through one cell mostly end on the same triangles. The
/// values of a block come first, with nothing between them, so that the processor waits for many of them at once.
#[inline(always)]
pub(crate) fn add_samples<const N: usize, B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    elements: &[usize],
    sums: &mut [ElementSums],
    mut value: impl FnMut(usize, u32) -> Vec4,
) {
    let of_triangle = |&i: &usize| Some((i, op.receivers.corners(chunk.elements[i])?));
    let Some(triangles) = elements.iter().map(of_triangle).collect::<Option<SmallVec<[_; CHUNK]>>>() else {
        return elements
            .iter()
            .for_each(|&i| add_to_nodes(op, chunk, i, &mut sums[i], |slot| value(i, slot)));
    };
    let (pattern, samples) = (chunk.pattern, chunk.pattern.len());
    // By corner: sums of values times weights, and of weights.
    let mut all = [[DVec4::ZERO; 3]; N];
    let mut values = [[Vec4::ZERO; N]; BLOCK as usize];
    for first in (0..samples).step_by(BLOCK as usize) {
        let slots = first..samples.min(first + BLOCK);
        for (slot, values) in slots.clone().zip(&mut values) {
            for (&i, value_of) in elements.iter().zip(values) {
                *value_of = value(i, slot);
            }
        }
        for (k, (&i, all)) in elements.iter().zip(&mut all).enumerate() {
            let (turn, mut block) = (chunk.keys[i].1, [Vec4::ZERO; 3]);
            for (slot, values) in slots.clone().zip(&values) {
                let weights = pattern.corner_weights(slot, turn);
                block[0] += values[k] * weights.x;
                block[1] += values[k] * weights.y;
                block[2] += values[k] * weights.z;
            }
            all.iter_mut().zip(block).for_each(|(all, block)| *all += block.as_dvec4());
        }
    }
    for (&(i, (nodes, area)), all) in triangles.iter().zip(all) {
        let share = chunk.share * f64::from(area);
        for (k, sum) in all.into_iter().enumerate().filter(|(_, sum)| sum.w > 0.0) {
            sums[i].add(k, nodes[k], share * sum.w, sum.truncate() / sum.w);
        }
    }
}

/// Adds the samples of element `i` of a chunk to its sums in all channels: `value` of slot and channel, as [`add_samples`] adds those
/// of one.
pub(crate) fn add_channels<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    i: usize,
    sums: &mut [Vec<ElementSums>],
    value: impl Fn(u32, usize) -> Vec4,
) {
    let Some((nodes, area)) = op.receivers.corners(chunk.elements[i]) else {
        for (channel, sums) in sums.iter_mut().enumerate() {
            add_to_nodes(op, chunk, i, &mut sums[i], |slot| value(slot, channel));
        }
        return;
    };
    let (pattern, turn, samples) = (chunk.pattern, chunk.keys[i].1, chunk.pattern.len());
    let mut all = [[DVec4::ZERO; 3]; 1 + HARMONICS];
    for first in (0..samples).step_by(BLOCK as usize) {
        let mut blocks = [[Vec4::ZERO; 3]; 1 + HARMONICS];
        for slot in first..samples.min(first + BLOCK) {
            // They are the same for all channels.
            let weights = pattern.corner_weights(slot, turn).to_array();
            for (channel, block) in blocks[..sums.len()].iter_mut().enumerate() {
                let value = value(slot, channel);
                block.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += value * weight);
            }
        }
        for (all, block) in all.iter_mut().zip(blocks) {
            all.iter_mut().zip(block).for_each(|(all, block)| *all += block.as_dvec4());
        }
    }
    let share = chunk.share * f64::from(area);
    for (sums, all) in sums.iter_mut().zip(all) {
        for (k, sum) in all.into_iter().enumerate().filter(|(_, sum)| sum.w > 0.0) {
            sums[i].add(k, nodes[k], share * sum.w, sum.truncate() / sum.w);
        }
    }
}

/// Adds the samples of an element that is no triangle to the nodes that it counts towards.
fn add_to_nodes<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    i: usize,
    sums: &mut ElementSums,
    mut value: impl FnMut(u32) -> Vec4,
) {
    let (turn, mut towards) = (chunk.keys[i].1, NodeWeights::default());
    for slot in 0..chunk.pattern.len() {
        let value = value(slot);
        if value.w == 0.0 {
            continue;
        }
        let number = chunk.pattern.number(slot, turn);
        // The weights are those of a rule for triangles.
        let (place, _) = chunk.pattern.place(number);
        towards.clear();
        op.receivers.towards(chunk.elements[i], place, &mut towards);
        let weight = chunk.share;
        for (k, (node, towards)) in towards.iter().enumerate() {
            sums.add(k, node, weight * f64::from(towards), value.truncate().as_dvec3());
        }
    }
}

/// Kept between elements, so that nothing is allocated for each.
#[derive(Default)]
pub(crate) struct LightScratch {
    points: LightPoints,
    batch: Batch,
    /// Of all samples of an element, by number.
    all: Vec<Site>,
    /// Of those outside geometry, element by element.
    sites: Vec<Option<Site>>,
    keys: Vec<(StreamKey, u32)>,
    /// What arrives at each sample.
    lit: Vec<DVec3>,
}

/// Adds what lights send to the samples of some elements of a chunk that are `is_outside` geometry, by element and number.
pub(crate) fn add_lights_of<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    direct: &Direct<'_>,
    (chunk, elements): (&AreaChunk<'_>, &[usize]),
    is_outside: impl Fn(usize, u32) -> bool,
    LightScratch { points, batch, all, sites, keys, lit }: &mut LightScratch,
    sums: &mut [ElementSums],
) -> Result<(), TransportError> {
    let samples = chunk.pattern.len() as usize;
    sites.clear();
    for &i in elements {
        all.clear();
        op.receivers.sites(chunk.elements[i], chunk.pattern.places(), all);
        sites.extend((0..).zip(all.drain(..)).map(|(number, site)| is_outside(i, number).then_some(site)));
    }
    keys.clear();
    keys.extend(elements.iter().map(|&i| chunk.keys[i]));
    lit.clear();
    lit.resize(elements.len() * samples, DVec3::ZERO);
    direct.over_areas(&AreaSites { sites, keys, pattern: chunk.pattern }, (points, batch), lit)?;
    for (k, &i) in elements.iter().enumerate() {
        add_samples::<1, _, _>(op, chunk, &[i], sums, |_, slot| {
            let number = chunk.pattern.number(slot, chunk.keys[i].1);
            let is_outside = is_outside(i, number);
            if is_outside { lit[k * samples + number as usize].as_vec3().extend(1.0) } else { Vec4::ZERO }
        });
    }
    Ok(())
}

pub(crate) fn direct<'a, B, R>(
    op: &'a CpuTransport<B, R>,
    mask: Option<&'a EmitterMask>,
    control: &'a Control,
) -> Direct<'a> {
    Direct {
        scene: &op.scene,
        tracer: &*op.tracer,
        lights: &op.lights,
        mask,
        plan: &op.plan,
        density: op.density,
        control,
    }
}
