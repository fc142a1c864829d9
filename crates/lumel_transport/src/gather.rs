//! Hemisphere rays of neighbours, in bundles.
//!
//! Two ways to make bundles of similar rays: those of one origin through neighbouring cells of its hemisphere, or those
//! of neighbouring origins through one cell of theirs. The second spreads less where neighbours are close to each
//! other compared with what they look at. Which is taken has no influence on the result.

use crate::hemisphere::{self, HemisphereDensity};
use crate::job::{Control, TransportError};
use crate::order::CHUNK;
use glam::Vec3;
use lumel_accel::{Hit, Ray, RayTracer};
use lumel_basis::Site;

/// Strata that are traced at once; between them the cancel flag is looked at.
const BLOCK: usize = 256;

/// Rays that find out how far away surfaces are.
const PROBES: usize = 8;

/// Neighbours within this many widths of a cell, at the distance of what they see, look through a cell together. The
/// cells of N strata are √(π/N) wide; twice that, as measured.
const NEAR: f32 = 3.5;

/// Normals that agree to this cosine (18°) have cells that point the same way.
const SAME_FACING: f32 = 0.95;

/// The hemisphere rays of a group.
#[derive(Default)]
pub(crate) struct Gather {
    density: HemisphereDensity,
    directions: Vec<Vec3>,
    /// Where each ray starts; empty where all of a site start there.
    origins: Vec<Vec3>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
}

impl Gather {
    /// No rays yet, of a density.
    pub(crate) fn new(density: HemisphereDensity) -> Self {
        Self { density, ..Self::default() }
    }

    /// Adds the rays of a site through points of the unit square, in the order of their cells.
    pub(crate) fn add(&mut self, site: &Site, points: &[[f32; 2]]) {
        self.directions.extend(points.iter().map(|&u| self.density.direction(site, u)));
    }

    /// Adds the rays of an area, each from a site of its own, through points in the order of their cells.
    pub(crate) fn add_sites<'a>(&mut self, sites: impl Iterator<Item = &'a Site>, points: &[[f32; 2]]) {
        for (site, &u) in sites.zip(points) {
            self.origins.push(site.origin);
            self.directions.push(self.density.direction(site, u));
        }
    }

    /// Traces the rays of the sites that were added, `strata` each, and tells where they end: `each(site, hit)`, for
    /// each site in the order of its strata.
    pub(crate) fn trace(
        &mut self,
        tracer: &dyn RayTracer,
        sites: &[Site],
        strata: usize,
        control: &Control,
        mut each: impl FnMut(usize, Option<Hit>),
    ) -> Result<(), TransportError> {
        let together = self.look_through_cells_together(tracer, sites, strata);
        for first in (0..strata).step_by(BLOCK) {
            control.check()?;
            let block = first..strata.min(first + BLOCK);
            if together {
                self.rays.clear();
                let Self { rays, directions, origins, .. } = self;
                for k in block {
                    let of_site = |(i, site)| ray(site, origins, directions, i * strata + k);
                    rays.extend(sites.iter().enumerate().map(of_site));
                }
                self.hits.resize(self.rays.len(), None);
                tracer.closest_hits_of(&self.rays, &mut self.hits);
                self.hits.iter().enumerate().for_each(|(k, hit)| each(k % sites.len(), *hit));
            } else if !self.origins.is_empty() {
                for (i, site) in sites.iter().enumerate() {
                    self.rays.clear();
                    let Self { rays, directions, origins, .. } = self;
                    rays.extend(block.clone().map(|k| ray(site, origins, directions, i * strata + k)));
                    self.hits.resize(self.rays.len(), None);
                    tracer.closest_hits_of(&self.rays, &mut self.hits);
                    self.hits.iter().for_each(|hit| each(i, *hit));
                }
            } else {
                for (i, site) in sites.iter().enumerate() {
                    let directions = &self.directions[i * strata..][block.clone()];
                    self.hits.resize(directions.len(), None);
                    tracer.closest_hits(&hemisphere::bundle(site, directions), &mut self.hits);
                    self.hits.iter().for_each(|hit| each(i, *hit));
                }
            }
        }
        Ok(())
    }

    /// Whether the sites are near enough to each other for bundles of one stratum.
    fn look_through_cells_together(&self, tracer: &dyn RayTracer, sites: &[Site], strata: usize) -> bool {
        let [first, others @ ..] = sites else { return false };
        let facing = |site: &Site| site.frame.normal.dot(first.frame.normal) > SAME_FACING;
        if sites.len() < CHUNK / 2 || !others.iter().all(facing) {
            return false;
        }
        // Over areas, the first rays of all tell as well as any how far apart origins are.
        let origin = |i: usize| self.origins.get(i * strata).map_or(sites[i].origin, |&origin| origin);
        let distance = |i: usize| origin(i).distance(first.origin);
        let radius = 0.5 * (1..sites.len()).map(distance).fold(0.0, f32::max);
        let probe = |i: usize| {
            let ray = hemisphere::ray(first, self.directions[i * strata / PROBES]);
            tracer.closest_hit(&ray).map_or(f32::INFINITY, |hit| hit.t)
        };
        // The harmonic mean: what is near decides how much a bundle spreads.
        let nearness =
            (0..PROBES.min(strata)).map(|i| 1.0 / probe(i)).sum::<f32>() / PROBES.min(strata) as f32;
        radius * nearness < NEAR / (strata as f32).sqrt()
    }
}

/// Ray number `at`, from a site or an origin of its own.
#[inline]
fn ray(site: &Site, origins: &[Vec3], directions: &[Vec3], at: usize) -> Ray {
    let ray = hemisphere::ray(site, directions[at]);
    origins.get(at).map_or(ray, |&origin| Ray { origin, ..ray })
}
