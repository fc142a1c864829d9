//! What hemisphere rays bring that depends on where they come from: where they end is stored alone.

use crate::area_pattern::AreaChunk;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::job::Source;
use crate::operator::CpuTransport;
use crate::sky_rays::SkyRays;
use crate::surface_rays::SurfaceRays;
use crate::trace::Rays;
use glam::DVec3;
use lumel_basis::{Basis, ElementId, Receivers};
use lumel_sample::StreamKey;

/// The hemisphere rays of some sites, and what arrives along them of a sky that varies and of emissive surfaces that shadow
/// rays sample too.
pub(crate) struct Arrivals<'a> {
    sky: Option<SkyRays<'a>>,
    surfaces: Option<SurfaceRays<'a>>,
}

impl<'a> Arrivals<'a> {
    /// `None` where all that arrives is known from where rays end.
    pub(crate) fn new<B, R>(op: &'a CpuTransport<B, R>, source: Source<'a>) -> Option<Self> {
        let new = Self { sky: SkyRays::new(op, source), surfaces: SurfaceRays::new(op, source) };
        (new.sky.is_some() || new.surfaces.is_some()).then_some(new)
    }

    /// Takes the rays of [`trace::at_points`](crate::trace::at_points), element by element.
    pub(crate) fn set_points<B: Basis, R: Receivers>(
        &mut self,
        op: &CpuTransport<B, R>,
        group: &Group,
        rays: Rays,
        key: impl Fn(ElementId) -> StreamKey,
    ) {
        if let Some(sky) = &mut self.sky {
            sky.add_at_points(op, group, rays, key);
        }
        if let Some(surfaces) = &mut self.surfaces {
            surfaces.set(group.sites.iter(), rays.per_element as usize);
        }
    }

    /// Takes the rays of [`trace::over_areas`](crate::trace::over_areas) of element `i` instead of those before, slot by slot.
    pub(crate) fn set_area<B: Basis, R: Receivers>(
        &mut self,
        op: &CpuTransport<B, R>,
        chunk: &AreaChunk<'_>,
        i: usize,
    ) {
        let (samples, turn) = (chunk.pattern.len(), chunk.keys[i].1);
        let mut sites = Vec::with_capacity(samples as usize);
        op.receivers.sites(chunk.elements[i], chunk.pattern.places(), &mut sites);
        let in_slot = (0..samples).map(|slot| &sites[chunk.pattern.number(slot, turn) as usize]);
        if let Some(sky) = &mut self.sky {
            sky.set_area(op, chunk, i, in_slot.clone());
        }
        if let Some(surfaces) = &mut self.surfaces {
            surfaces.set(in_slot, 1);
        }
    }

    /// What ray number `at` adds to the irradiance if it ends there, W·m⁻².
    pub(crate) fn arriving(&self, at: usize, end: &RayEnd) -> DVec3 {
        let sky = self.sky.as_ref().map_or(DVec3::ZERO, |sky| sky.arriving(at, end));
        let surfaces = self.surfaces.as_ref().map_or(DVec3::ZERO, |surfaces| surfaces.arriving(at, end));
        sky + surfaces
    }
}
