//! From sites to the ends of hemisphere rays: the first step of every measurement, whether ends are read at once or stored.

use crate::ends::RayEnd;
use crate::gather::Gather;
use crate::group::Group;
use crate::hemisphere;
use crate::job::{Control, TransportError};
use crate::operator::CpuTransport;
use lumel_basis::{Basis, ElementId, NodeWeights, Receivers, Site};
use lumel_sample::{CellOrder, Dim, Sampler, StreamKey};

/// Rays that decide whether an origin on an area lies inside geometry, and how many must meet the back of a surface:
/// three quarters, which an origin that sees back faces in a third of its hemisphere reaches once in fifty times.
const INSIDE_RAYS: u32 = 8;
const INSIDE_BACK_FACES: usize = 6;

/// The hemisphere rays of an element.
#[derive(Clone, Copy)]
pub(crate) struct Rays {
    pub(crate) per_element: u32,
    pub(crate) dim: Dim,
}

/// Traces the rays of elements that are measured at points: `each(element within the group, end)`, for each element in
/// the order of its strata.
pub(crate) fn at_points<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    group: &Group,
    rays: Rays,
    key: impl Fn(ElementId) -> StreamKey,
    control: &Control,
    mut each: impl FnMut(usize, RayEnd),
) -> Result<(), TransportError> {
    let (mut gather, mut cells) = (Gather::default(), CellOrder::default());
    for (&element, site) in group.elements.iter().zip(&group.sites) {
        control.check()?;
        let stream = op.plan.stream(rays.per_element, key(element), rays.dim);
        gather.add(site, cells.points(&stream, rays.per_element));
    }
    let strata = rays.per_element as usize;
    gather.trace(&*op.tracer, &group.sites, strata, control, |i, hit| {
        each(i, RayEnd::new(&op.scene, hit));
    })?;
    control.count(0, u64::from(rays.per_element) * group.len() as u64);
    Ok(())
}

/// One sample of an area: a place and a direction that are one 4-D point.
pub(crate) struct AreaSample<'a> {
    /// Its number within the element.
    pub(crate) index: u32,
    pub(crate) site: Site,
    /// The nodes it counts towards.
    pub(crate) towards: &'a NodeWeights,
    /// The half of the point that chooses the direction.
    pub(crate) u: [f32; 2],
    /// Names the streams of the element.
    pub(crate) key: StreamKey,
}

/// The samples of an element with an area.
#[inline]
pub(crate) fn area_samples<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    element: ElementId,
    samples: u32,
    key: StreamKey,
    control: &Control,
    mut each: impl FnMut(&AreaSample<'_>),
) -> Result<(), TransportError> {
    let stream = op.plan.stream(samples, key, Dim::Area);
    let mut towards = NodeWeights::default();
    for index in 0..samples {
        control.check_at(index)?;
        let [s, t, u @ ..] = stream.sample_4d(index);
        towards.clear();
        let site = op.receivers.site(element, [s, t], &mut towards);
        each(&AreaSample { index, site, towards: &towards, u, key });
    }
    Ok(())
}

/// Where the ray of a sample ends, and how many rays that took; `None` if the sample lies inside geometry.
#[inline]
pub(crate) fn from_area<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    sample: &AreaSample<'_>,
    n_rays: &mut u64,
) -> Option<RayEnd> {
    let end = in_direction(op, &sample.site, sample.u);
    *n_rays += 1;
    if end == RayEnd::BackFace {
        *n_rays += u64::from(INSIDE_RAYS);
        if is_inside(op, &sample.site, sample.key.pass(sample.index)) {
            return None;
        }
    }
    Some(end)
}

/// Where the ray from a site in the direction of `u` ends.
#[inline]
fn in_direction<B: Basis, R: Receivers>(op: &CpuTransport<B, R>, site: &Site, u: [f32; 2]) -> RayEnd {
    let ray = hemisphere::ray(site, hemisphere::direction(site, u));
    RayEnd::new(&op.scene, op.tracer.closest_hit(&ray))
}

/// Whether a site of which one ray has met the back of a surface lies inside geometry; traces [`INSIDE_RAYS`].
///
/// Inside a closed solid all rays do. One ray alone must not decide: in front of a one-sided wall that shows its
/// back, leaving out what is dark would make the rest too bright.
fn is_inside<B: Basis, R: Receivers>(op: &CpuTransport<B, R>, site: &Site, key: StreamKey) -> bool {
    let stream = Sampler::Sobol.stream(key, Dim::Validity);
    let met_back_face = |i: &u32| in_direction(op, site, stream.sample_2d(*i)) == RayEnd::BackFace;
    (0..INSIDE_RAYS).filter(met_back_face).count() >= INSIDE_BACK_FACES
}
