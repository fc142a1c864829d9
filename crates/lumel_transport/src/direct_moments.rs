//! Moments of the light that arrives from lights.
//!
//! The estimator of light by shadow rays without the cosine of the receiver: `L Y / p` for the same points on the same
//! lights as for [irradiance](crate::direct), though fewer of them.

use crate::direct::Direct;
use crate::direct_area::AreaSites;
use crate::job::TransportError;
use crate::light_points::LightPoints;
use crate::light_view::LightView;
use crate::moments::{self, Moments};
use crate::shadow_batch::Batch;
use glam::{DVec3, Vec3};
use lumel_accel::Ray;
use lumel_basis::Site;
use lumel_sample::{Dim, StreamKey};

/// Where the samples of neighbouring elements lie.
pub(crate) enum LitSites<'a> {
    /// So many at one site of each element; their values are summed by element.
    Points { sites: &'a [Site], keys: &'a [StreamKey], samples: u32 },
    /// Each at a site of its own, and each summed by itself.
    Areas(&'a AreaSites<'a>),
}

impl LitSites<'_> {
    fn elements(&self) -> usize {
        match self {
            Self::Points { keys, .. } => keys.len(),
            Self::Areas(area) => area.keys.len(),
        }
    }

    fn samples(&self) -> u32 {
        match self {
            Self::Points { samples, .. } => *samples,
            Self::Areas(area) => area.pattern.len(),
        }
    }

    fn key(&self, element: usize) -> StreamKey {
        match self {
            Self::Points { keys, .. } => keys[element],
            Self::Areas(area) => area.keys[element].0,
        }
    }

    /// The site of a sample of an element and its place among all sums; `None` for what lies inside geometry.
    fn at(&self, element: usize, slot: u32) -> Option<(usize, &Site)> {
        match self {
            Self::Points { sites, .. } => Some((element, &sites[element])),
            Self::Areas(area) => {
                let at = area.at(element, slot);
                Some((at, area.sites[at].as_ref()?))
            }
        }
    }

    /// The samples of an element that no other shares its site with.
    fn distinct(&self) -> u32 {
        match self {
            Self::Points { .. } => 1,
            Self::Areas(area) => area.pattern.len(),
        }
    }

    /// What one of the samples of a light counts in the sum of its place.
    fn share(&self) -> f64 {
        match self {
            Self::Points { samples, .. } => 1.0 / f64::from(*samples),
            Self::Areas(_) => 1.0,
        }
    }

    fn normal(&self, at: usize) -> Vec3 {
        match self {
            Self::Points { sites, .. } => sites[at].frame.normal,
            Self::Areas(area) => area.sites[at].as_ref().map_or(Vec3::ZERO, |site| site.frame.normal),
        }
    }
}

impl Direct<'_> {
    /// Adds estimates of the moments at some sites: by one shadow ray of each sample to each light, or to one of many.
    pub(crate) fn moments(
        &self,
        sites: &LitSites<'_>,
        (points, batch): (&mut LightPoints, &mut Batch),
        moments: &mut Moments,
    ) -> Result<(), TransportError> {
        self.control.check()?;
        let mut n_rays = 0;
        let mut trace = |batch: &mut Batch| {
            n_rays += batch.trace(self.tracer, |ray: &Ray, at, facing, passed| {
                if let Some(direction) = ray.direction.try_normalize()
                    && passed != Vec3::ZERO
                {
                    let factors = moments::factors(sites.normal(at), direction);
                    moments.add(at, &factors, facing * passed.as_dvec3());
                }
            });
        };
        for element in 0..sites.elements() {
            batch.begin_element();
            for slot in 0..sites.distinct() {
                let Some((at, site)) = sites.at(element, slot) else { continue };
                self.delta_arrivals(site, |target, arriving, _| {
                    batch.add(site, target, (slot, at), arriving.as_dvec3());
                });
            }
        }
        trace(batch);
        if self.lights.tree.is_some() {
            self.choose_for_moments(sites, points, batch);
            trace(batch);
        }
        for l in self.looped_lights() {
            self.control.check()?;
            self.one_light_for_moments(l, sites, points, batch);
            trace(batch);
        }
        self.control.count(0, n_rays as u64);
        Ok(())
    }

    /// Adds one shadow ray of each sample, to a light that is chosen from many.
    fn choose_for_moments(&self, sites: &LitSites<'_>, points: &mut LightPoints, batch: &mut Batch) {
        let Some(tree) = &self.lights.tree else { return };
        for element in 0..sites.elements() {
            batch.begin_element();
            let stream = self.plan.stream(sites.samples(), sites.key(element), Dim::LightSelect);
            for (slot, (u, select)) in (0..).zip(points.fill_by_choice(&stream, sites.samples())) {
                let Some((at, site)) = sites.at(element, slot) else { continue };
                let (origin, normal) = (site.origin.as_dvec3(), site.frame.normal.as_dvec3());
                let Some(choice) = tree.choose(origin, normal, *select) else { continue };
                let shines = self.shines(self.lights.area[choice.light].0);
                let view = shines.then(|| self.view(choice.light, site, choice.probability)).flatten();
                if let Some(sample) = view.and_then(|view| view.sample(*u)) {
                    let facing: DVec3 = sample.facing() * (sites.share() / choice.probability);
                    batch.add(site, sample.target, (slot, at), facing);
                }
            }
        }
    }

    /// Adds one shadow ray of each sample to one light.
    fn one_light_for_moments(
        &self,
        l: usize,
        sites: &LitSites<'_>,
        points: &mut LightPoints,
        batch: &mut Batch,
    ) {
        for element in 0..sites.elements() {
            batch.begin_element();
            let stream = self.plan.stream(sites.samples(), sites.key(element), Dim::Light(l as u32));
            let mut view: Option<(usize, Option<LightView<'_>>)> = None;
            for (slot, &u) in (0..).zip(points.fill(&stream, sites.samples())) {
                let Some((at, site)) = sites.at(element, slot) else { continue };
                // At points, all samples see the light from the same site.
                if view.as_ref().is_none_or(|(of, _)| *of != at) {
                    view = Some((at, self.view(l, site, 1.0)));
                }
                if let Some((_, Some(view))) = &view
                    && let Some(sample) = view.sample(u)
                {
                    batch.add(site, sample.target, (slot, at), sample.facing() * sites.share());
                }
            }
        }
    }
}
