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
use crate::plan::LightSampling;
use crate::shadow_batch::Batch;
use glam::{DVec3, Vec3};
use lumel_basis::Site;
use lumel_sample::{Dim, Stream, StreamKey};

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
            Self::Points { .. } => Some((element, self.site(element)?)),
            Self::Areas(area) => {
                let at = area.at(element, slot);
                Some((at, self.site(at)?))
            }
        }
    }

    /// How many places have sums of their own.
    fn places(&self) -> usize {
        match self {
            Self::Points { sites, .. } => sites.len(),
            Self::Areas(area) => area.sites.len(),
        }
    }

    /// The site at a place; `None` for what lies inside geometry.
    fn site(&self, at: usize) -> Option<&Site> {
        match self {
            Self::Points { sites, .. } => Some(&sites[at]),
            Self::Areas(area) => area.sites[at].as_ref(),
        }
    }

    /// The samples of an element that no other shares its site with.
    fn distinct(&self) -> u32 {
        match self {
            Self::Points { .. } => 1,
            Self::Areas(area) => area.pattern.len(),
        }
    }

    /// The element of a sum.
    fn element(&self, at: usize) -> usize {
        match self {
            Self::Points { .. } => at,
            Self::Areas(area) => at / area.pattern.len() as usize,
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
        self.site(at).map_or(Vec3::ZERO, |site| site.frame.normal)
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
        let all = |_: usize| 0.0;
        for element in 0..sites.elements() {
            batch.begin_element();
            for slot in 0..sites.distinct() {
                let Some((at, site)) = sites.at(element, slot) else { continue };
                self.delta_arrivals(site, |target, arriving, _| {
                    batch.add(site, target, (slot, at), arriving.as_dvec3());
                });
            }
        }
        let mut n_rays = self.add_moments(sites, batch, all, moments);
        if self.lights.tree.is_some() {
            self.choose_for_moments(sites, points, batch);
            n_rays += self.add_moments(sites, batch, all, moments);
        }
        for l in self.looped_lights() {
            self.control.check()?;
            n_rays += self.one_light_for_moments(l, sites, (&mut *points, &mut *batch), moments);
        }
        self.control.count(0, n_rays as u64);
        Ok(())
    }

    /// Traces the rays of a batch and adds what they bring beyond the share of it that `beta` of the element has brought already.
    /// Returns how many.
    fn add_moments(
        &self,
        sites: &LitSites<'_>,
        batch: &mut Batch,
        beta: impl Fn(usize) -> f64,
        moments: &mut Moments,
    ) -> usize {
        batch.trace(self.tracer, |ray, at, facing, passed| {
            let share = passed.as_dvec3() - beta(sites.element(at));
            if let Some(direction) = ray.direction.try_normalize()
                && share != DVec3::ZERO
            {
                let factors = moments::factors(sites.normal(at), direction);
                moments.add(at, &factors, facing * share);
            }
        })
    }

    /// Adds one shadow ray of each sample, to a light that is chosen from many.
    fn choose_for_moments(&self, sites: &LitSites<'_>, points: &mut LightPoints, batch: &mut Batch) {
        let Some(tree) = &self.lights.tree else { return };
        for element in 0..sites.elements() {
            batch.begin_element();
            let stream = self.plan.stream(sites.samples(), sites.key(element), Dim::LightSelect);
            for (slot, (u, select)) in (0..).zip(points.fill_by_choice(&stream, sites.samples())) {
                let Some((at, site)) = sites.at(element, slot) else { continue };
                if let Some((probability, view)) = self.choose(tree, site, *select)
                    && let Some(sample) = view.sample(*u)
                {
                    let facing: DVec3 = sample.facing() * (sites.share() / probability);
                    batch.add(site, sample.target, (slot, at), facing);
                }
            }
        }
    }

    /// Adds the light of one light. Where the closed form of what would arrive unblocked is known, it is a control variate, as it is
    /// of [irradiance](crate::direct). Returns the number of rays.
    fn one_light_for_moments(
        &self,
        l: usize,
        sites: &LitSites<'_>,
        (points, batch): (&mut LightPoints, &mut Batch),
        moments: &mut Moments,
    ) -> usize {
        let views: Vec<Option<LightView<'_>>> =
            (0..sites.places()).map(|at| self.view(l, sites.site(at)?, 1.0)).collect();
        if views.iter().all(Option::is_none) {
            return 0;
        }
        let mut betas = vec![0.0; sites.elements()];
        let mut n_rays = 0;
        let has_closed_form =
            self.plan.light_sampling == LightSampling::Analytic && self.lights.has_unblocked_moments(l);
        if has_closed_form {
            let pilot = self.pilot_samples(sites.samples());
            let sampler = self.plan.sampler.for_count(pilot);
            add_rays_to(&views, sites, pilot, (&mut *points, &mut *batch), |key| {
                sampler.stream(key, Dim::LightPilot(l as u32))
            });
            n_rays += self.visible_shares(batch, |at| sites.element(at), &mut betas);
            for (element, &share) in betas.iter().enumerate() {
                add_unblocked(&views, sites, (element, share), moments);
            }
        }
        let samples = sites.samples();
        add_rays_to(&views, sites, samples, (points, &mut *batch), |key| {
            self.plan.stream(samples, key, Dim::Light(l as u32))
        });
        n_rays + self.add_moments(sites, batch, |element| betas[element], moments)
    }
}

/// Adds the closed form of a light, as each place sees it, times a share at the sites of an element.
fn add_unblocked(
    views: &[Option<LightView<'_>>],
    sites: &LitSites<'_>,
    (element, share): (usize, f64),
    moments: &mut Moments,
) {
    for slot in (0..sites.distinct()).filter(|_| share > 0.0) {
        let Some((at, _)) = sites.at(element, slot) else { continue };
        if let Some((radiance, unit)) = views[at].as_ref().and_then(LightView::unblocked_moments) {
            moments.add(at, &unit, radiance * share);
        }
    }
}

/// Adds to the batch one shadow ray of each of so many samples to a light, as each place sees it.
fn add_rays_to(
    views: &[Option<LightView<'_>>],
    sites: &LitSites<'_>,
    samples: u32,
    (points, batch): (&mut LightPoints, &mut Batch),
    stream: impl Fn(StreamKey) -> Stream,
) {
    for element in 0..sites.elements() {
        batch.begin_element();
        for (slot, &u) in (0..).zip(points.fill(&stream(sites.key(element)), samples)) {
            let Some((at, site)) = sites.at(element, slot) else { continue };
            if let Some(sample) = views[at].as_ref().and_then(|view| view.sample(u)) {
                batch.add(site, sample.target, (slot, at), sample.facing() * sites.share());
            }
        }
    }
}
