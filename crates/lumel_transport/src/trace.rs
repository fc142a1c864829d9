//! From sites to the ends of hemisphere rays: the first step of every measurement, whether ends are read at once or stored.

use crate::area_pattern::AreaChunk;
use crate::ends::RayEnd;
use crate::gather::Gather;
use crate::group::Group;
use crate::hidden::Lookout;
use crate::job::{Control, TransportError};
use crate::operator::CpuTransport;
use lumel_basis::{Basis, ElementId, Receivers};
use lumel_sample::{CellOrder, Dim, StreamKey};

/// The hemisphere rays of an element.
#[derive(Clone, Copy)]
pub(crate) struct Rays {
    pub(crate) per_element: u32,
    pub(crate) dim: Dim,
}

/// Traces the rays of elements that are measured at points: `each(element within the group, end, distance)`, for each element
/// in the order of its strata.
pub(crate) fn at_points<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    group: &Group,
    rays: Rays,
    key: impl Fn(ElementId) -> StreamKey,
    control: &Control,
    mut each: impl FnMut(usize, RayEnd, f32),
) -> Result<(), TransportError> {
    let (mut gather, mut cells) = (Gather::new(op.density), CellOrder::default());
    for (&element, site) in group.elements.iter().zip(&group.sites) {
        control.check()?;
        let stream = op.plan.stream(rays.per_element, key(element), rays.dim);
        gather.add(site, cells.points(&stream, rays.per_element));
    }
    let strata = rays.per_element as usize;
    gather.trace(&*op.tracer, &group.sites, strata, control, |i, hit| {
        each(i, RayEnd::new(&op.scene, hit), hit.map_or(f32::INFINITY, |hit| hit.t));
    })?;
    control.count(0, u64::from(rays.per_element) * group.len() as u64);
    Ok(())
}

/// Traces the ray of every sample of a chunk of areas; where each ends, slot by slot, with the elements side by side.
///
/// `None` for samples that nobody can see: they are left out, so that what is [hidden](crate::hidden) does not darken what is
/// not.
pub(crate) fn over_areas<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    control: &Control,
) -> Result<Vec<Option<RayEnd>>, TransportError> {
    over_areas_with(op, chunk, control, |_, _| {})
}

/// The same, and tells the distance of every end, whether it counts or not: `distance(place among the ends, metres)`.
pub(crate) fn over_areas_with<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    chunk: &AreaChunk<'_>,
    control: &Control,
    mut distance: impl FnMut(usize, f32),
) -> Result<Vec<Option<RayEnd>>, TransportError> {
    let (lanes, samples) = (chunk.elements.len(), chunk.pattern.len());
    let (mut gather, mut cells) = (Gather::new(op.density), CellOrder::default());
    let mut sites = Vec::with_capacity(lanes);
    let mut all = Vec::with_capacity(samples as usize);
    for (&element, &(key, turn)) in chunk.elements.iter().zip(&chunk.keys) {
        control.check()?;
        all.clear();
        op.receivers.sites(element, chunk.pattern.places(), &mut all);
        let stream = op.plan.stream(samples, key, Dim::Hemisphere);
        let in_slot = |slot: u32| &all[chunk.pattern.number(slot, turn) as usize];
        gather.add_sites((0..samples).map(in_slot), cells.points(&stream, samples));
        // Any will do: it tells where the element is and where it faces.
        sites.extend(all.first().cloned());
    }
    let mut ends = vec![None; lanes * samples as usize];
    let (mut next, mut doubtful) = (vec![0; lanes], Vec::new());
    let mut lookout = Lookout::new(op);
    let reach: Vec<f32> = chunk.elements.iter().map(|&element| op.receivers.reach(element)).collect();
    gather.trace(&*op.tracer, &sites, samples as usize, control, |i, hit| {
        let (at, end) = (next[i] * lanes + i, RayEnd::new(&op.scene, hit));
        let is_near = hit.is_some_and(|hit| hit.t < reach[i] && lookout.may_cover(chunk.elements[i], hit));
        if is_near || end == RayEnd::BackFace {
            doubtful.push((at, is_near));
        }
        ends[at] = Some(end);
        distance(at, hit.map_or(f32::INFINITY, |hit| hit.t));
        next[i] += 1;
    })?;
    let place = |at: usize| {
        let (slot, i) = ((at / lanes) as u32, at % lanes);
        let (element, (key, turn)) = (chunk.elements[i], chunk.keys[i]);
        let number = chunk.pattern.number(slot, turn);
        (element, op.receivers.site(element, chunk.pattern.place(number).0), key.pass(number))
    };
    let mut covered = vec![false; lanes];
    let mut behind = vec![Verdict::default(); lanes];
    for (at, is_near) in doubtful {
        control.check()?;
        let (element, site, key) = place(at);
        let is_covered = is_near && lookout.is_covered(element, &site);
        let mut is_behind = || behind[at % lanes].or_ask(|| lookout.is_behind(element, &site, key));
        if is_covered || ends[at] == Some(RayEnd::BackFace) && is_behind() {
            ends[at] = None;
        }
        covered[at % lanes] |= is_covered;
    }
    // A ray that finds the way out of a gap leaves a place that is as covered as those around it.
    for at in (0..ends.len()).filter(|at| covered[at % lanes]) {
        control.check()?;
        let (element, site, _) = place(at);
        if ends[at].is_some() && lookout.is_covered(element, &site) {
            ends[at] = None;
        }
    }
    control.count(0, ends.len() as u64 + lookout.n_rays());
    Ok(ends)
}

/// How often the same answer is needed before it goes for all of an element.
const UNANIMOUS: u32 = 8;

/// What was found of some places of an element: most elements lie on one side of everything with all of their places.
#[derive(Clone, Copy, Default)]
struct Verdict {
    yes: u32,
    no: u32,
}

impl Verdict {
    /// The answer of all places so far, if there are enough; otherwise a new one.
    fn or_ask(&mut self, ask: impl FnOnce() -> bool) -> bool {
        match *self {
            Self { yes, no: 0 } if yes >= UNANIMOUS => return true,
            Self { yes: 0, no } if no >= UNANIMOUS => return false,
            _ => {}
        }
        let answer = ask();
        *if answer { &mut self.yes } else { &mut self.no } += 1;
        answer
    }
}
