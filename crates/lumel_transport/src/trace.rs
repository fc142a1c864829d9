//! From sites to the ends of hemisphere rays: the first step of every measurement, whether ends are read at once or stored.

use crate::area_pattern::AreaChunk;
use crate::ends::RayEnd;
use crate::gather::Gather;
use crate::group::Group;
use crate::hemisphere;
use crate::job::{Control, TransportError};
use crate::operator::CpuTransport;
use lumel_basis::{Basis, ElementId, Receivers, Site};
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

/// Traces the ray of every sample of a chunk of areas; where each ends, slot by slot, with the elements side by side.
///
/// `None` for samples inside geometry: they are left out, so that what is hidden does not darken what is not.
pub(crate) fn over_areas<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    control: &Control,
) -> Result<Vec<Option<RayEnd>>, TransportError> {
    let (lanes, samples) = (chunk.elements.len(), chunk.pattern.len());
    let (mut gather, mut cells) = (Gather::default(), CellOrder::default());
    let mut sites = Vec::with_capacity(lanes);
    let mut all = Vec::with_capacity(samples as usize);
    for (&element, &(key, turn)) in chunk.elements.iter().zip(&chunk.keys) {
        control.check()?;
        all.clear();
        op.receivers.sites(element, chunk.pattern.places(), &mut all);
        let stream = op.plan.stream(samples, key, Dim::Hemisphere);
        let in_slot = |slot: u32| &all[chunk.pattern.number(slot, turn) as usize];
        gather.add_sites((0..samples).map(in_slot), cells.points(&stream, samples));
        sites.push(op.receivers.central_site(element));
    }
    let mut ends = vec![None; lanes * samples as usize];
    let mut next = vec![0; lanes];
    gather.trace(&*op.tracer, &sites, samples as usize, control, |i, hit| {
        ends[next[i] * lanes + i] = Some(RayEnd::new(&op.scene, hit));
        next[i] += 1;
    })?;
    let mut n_rays = ends.len() as u64;
    for (at, end) in ends.iter_mut().enumerate().filter(|(_, end)| **end == Some(RayEnd::BackFace)) {
        control.check()?;
        let (slot, i) = ((at / lanes) as u32, at % lanes);
        let (key, turn) = chunk.keys[i];
        n_rays += u64::from(INSIDE_RAYS);
        let number = chunk.pattern.number(slot, turn);
        let site = op.receivers.site(chunk.elements[i], chunk.pattern.place(number).0);
        if is_inside(op, &site, key.pass(number)) {
            *end = None;
        }
    }
    control.count(0, n_rays);
    Ok(ends)
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
