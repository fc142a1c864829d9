//! Trace, read, project: how every job is measured whose rays are not stored.
//!
//! Rays are [traced](crate::trace), what arrives along each is [read](Reader) from the source, and the mean is
//! projected onto the nodes that the element counts towards. Points and areas differ in their sites: a point has one
//! site for all of its rays, an area has a site for each.

use crate::direct::Direct;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::hemisphere;
use crate::job::{Control, Job, Source, TransportError};
use crate::light_points::LightPoints;
use crate::operator::CpuTransport;
use crate::shadow_rays::Tally;
use crate::sums::ElementSums;
use crate::trace::{self, Rays};
use crate::{EmitterMask, Sums};
use glam::DVec3;
use lumel_basis::{Basis, ElementId, NodeWeights, Receivers, Sampling};
use lumel_sample::Dim;

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
            Source::Field(field) => {
                hemisphere::reflected(&op.scene, &*op.basis, field, end, weights).0.as_dvec3()
            }
            Source::Emitters(mask) => hemisphere::emitted(&op.scene, &op.lights, *mask, end).0.as_dvec3(),
            Source::Nothing => DVec3::ZERO,
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
        let per_element = plan.samples(VALIDITY_RAYS, Sampling::Point);
        let mut back_faces = vec![0u32; group.len()];
        let rays = Rays { per_element, dim: Dim::Validity };
        trace::at_points(op, group, rays, key, control, |i, end| {
            back_faces[i] += u32::from(end == RayEnd::BackFace);
        })?;
        let share = |&n: &u32| f64::from(n) / f64::from(per_element);
        return Ok(group.back_faces(&back_faces.iter().map(share).collect::<Vec<_>>()));
    }
    let mut values = vec![DVec3::ZERO; group.len()];
    if let Source::Emitters(mask) = job.source {
        add_direct_at_points(op, job, mask, group, &mut values, control)?;
    }
    if needs_hemisphere(op, job.source) {
        let per_element = plan.samples(plan.indirect_samples, Sampling::Point);
        let (mut sums, mut reader) = (vec![DVec3::ZERO; group.len()], Reader::new(op, job.source));
        let rays = Rays { per_element, dim: Dim::Hemisphere };
        trace::at_points(op, group, rays, key, control, |i, end| sums[i] += reader.read(&end))?;
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

/// Measures elements over areas: a ray from each of many sites.
///
/// Position and direction are one 4-D point, and so are position and point on a light: what lights, sky and
/// surfaces send adds up under one integral, so all of them share the point. Points of another stream would not
/// be stratified together with the position. Sites inside geometry are left out, so that what is hidden does
/// not darken what is not.
pub(crate) fn over_areas<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    job: &Job<'_>,
    elements: &[ElementId],
    control: &Control,
) -> Result<Sums, TransportError> {
    let plan = &op.plan;
    let mask = if let Source::Emitters(mask) = job.source { Some(mask) } else { None };
    let requested = if mask.is_some() { plan.direct_samples } else { plan.indirect_samples };
    let samples = plan.samples(requested, Sampling::Area);
    let direct = mask.map(|mask| direct(op, mask, control));
    let (mut sums, mut towards) = (Sums::default(), ElementSums::default());
    let mut reader = Reader::new(op, job.source);
    for &element in elements {
        control.check()?;
        let mut n_rays = 0;
        trace::area_samples(op, element, samples, op.key(job, element), control, |sample| {
            let Some(end) = trace::from_area(op, sample, &mut n_rays) else { return };
            let mut value = reader.read(&end);
            if let Some(direct) = &direct {
                let mut tally = Tally::default();
                direct.one_sample(&sample.site, sample.key, sample.index, sample.u, &mut tally);
                value += tally.sum;
                n_rays += tally.n_rays;
            }
            for (node, weight) in sample.towards.iter() {
                towards.add(node, weight.into(), value);
            }
        })?;
        sums.append(&mut towards);
        control.count(0, n_rays);
    }
    Ok(sums)
}

fn direct<'a, B, R>(
    op: &'a CpuTransport<B, R>,
    mask: Option<&'a EmitterMask>,
    control: &'a Control,
) -> Direct<'a> {
    Direct { scene: &op.scene, tracer: &*op.tracer, lights: &op.lights, mask, plan: &op.plan, control }
}
