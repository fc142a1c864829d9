//! What hemisphere rays bring from a sky that is not the same all around.
//!
//! Where rays end is stored without their directions; these follow from the sample points.

use crate::Emitter;
use crate::area_pattern::AreaChunk;
use crate::balance::Balance;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::hemisphere::HemisphereDensity;
use crate::job::Source;
use crate::operator::CpuTransport;
use crate::plan::Plan;
use crate::sky_light::SkyLight;
use crate::trace::Rays;
use glam::{DVec3, Vec3};
use lumel_basis::{Basis, ElementId, Receivers, Site};
use lumel_sample::{CellOrder, Dim, StreamKey};
use lumel_scene::Sky;

/// The sky, and the hemisphere rays of some sites.
pub(crate) struct SkyRays<'a> {
    sky: &'a Sky,
    light: Option<&'a SkyLight>,
    plan: &'a Plan,
    density: HemisphereDensity,
    rays: Vec<Outgoing>,
}

/// A hemisphere ray.
struct Outgoing {
    direction: Vec3,
    /// To the normal.
    cos: f32,
}

impl<'a> SkyRays<'a> {
    /// `None` where the sky does not shine, or shines the same from everywhere and so needs no directions.
    pub(crate) fn new<B, R>(op: &'a CpuTransport<B, R>, source: Source<'_>) -> Option<Self> {
        let Source::Emitters(mask) = source else { return None };
        let sky = op.scene.sky();
        let varies = sky.uniform().is_none() && mask.is_none_or(|mask| mask.shines(Emitter::Sky));
        varies.then(|| Self {
            sky,
            light: op.lights.sky_light(),
            plan: &op.plan,
            density: op.density,
            rays: Vec::new(),
        })
    }

    /// Adds the rays of [`trace::at_points`](crate::trace::at_points), element by element.
    pub(crate) fn add_at_points<B: Basis, R: Receivers>(
        &mut self,
        op: &CpuTransport<B, R>,
        group: &Group,
        rays: Rays,
        key: impl Fn(ElementId) -> StreamKey,
    ) {
        for (&element, site) in group.elements.iter().zip(&group.sites) {
            let stream = op.plan.stream(rays.per_element, key(element), rays.dim);
            let mut cells = CellOrder::default();
            self.add(std::iter::repeat(site), cells.points(&stream, rays.per_element));
        }
    }

    /// Takes the rays of [`trace::over_areas`](crate::trace::over_areas) of element `i`, from these sites, instead of those
    /// before, slot by slot.
    pub(crate) fn set_area<'s, B: Basis, R: Receivers>(
        &mut self,
        op: &CpuTransport<B, R>,
        chunk: &AreaChunk<'_>,
        i: usize,
        sites: impl Iterator<Item = &'s Site>,
    ) {
        let samples = chunk.pattern.len();
        let stream = op.plan.stream(samples, chunk.keys[i].0, Dim::Hemisphere);
        let mut cells = CellOrder::default();
        self.rays.clear();
        self.add(sites, cells.points(&stream, samples));
    }

    fn add<'s>(&mut self, sites: impl Iterator<Item = &'s Site>, points: &[[f32; 2]]) {
        self.rays.extend(sites.zip(points).map(|(site, &u)| {
            let direction = self.density.direction(site, u);
            Outgoing { direction, cos: site.frame.normal.dot(direction) }
        }));
    }

    /// What ray number `at` adds to the irradiance if it ends there, W·m⁻².
    pub(crate) fn arriving(&self, at: usize, end: &RayEnd) -> DVec3 {
        if *end != RayEnd::Sky {
            return DVec3::ZERO;
        }
        let Outgoing { direction, cos } = self.rays[at];
        let whole = self.sky.radiance(direction).cosine_sample();
        let share = self
            .light
            .map_or(1.0, |light| Balance::new(self.plan, self.density).ray_share(light.pdf(direction), cos));
        (whole.0 * share).as_dvec3()
    }
}
