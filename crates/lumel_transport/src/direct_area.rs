//! Light that arrives from lights at the samples of areas.

use crate::area_pattern::AreaPattern;
use crate::direct::{Direct, MAX_PILOT};
use crate::job::TransportError;
use crate::light_points::LightPoints;
use crate::light_tree::LightTree;
use crate::light_view::LightView;
use crate::order::CHUNK;
use crate::plan::LightSampling;
use crate::shadow_batch::Batch;
use crate::shadow_rays::share;
use glam::{DVec3, Vec3};
use lumel_accel::Ray;
use lumel_basis::Site;
use lumel_sample::{Dim, StreamKey};
use smallvec::{SmallVec, smallvec};

/// The samples of neighbouring elements with an area, all by the same pattern.
pub(crate) struct AreaSites<'a> {
    /// Element by element, by number; `None` for what lies inside geometry.
    pub(crate) sites: &'a [Option<Site>],
    /// Of each element: what names its streams, and how the pattern is turned.
    pub(crate) keys: &'a [(StreamKey, u32)],
    pub(crate) pattern: &'a AreaPattern,
}

/// Samples that are looked at together at most: what is prepared of a light for each of them stays in the cache.
pub(crate) const GROUP: usize = 1024;

impl<'a> AreaSites<'a> {
    fn samples(&self) -> usize {
        self.pattern.len() as usize
    }

    /// Where the sample in a slot of an element stands.
    pub(crate) fn at(&self, element: usize, slot: u32) -> usize {
        let number = self.pattern.number(slot, self.keys[element].1);
        element * self.samples() + number as usize
    }

    /// Parts of few enough samples, with the place of their first one.
    fn groups(&self) -> impl Iterator<Item = (usize, AreaSites<'a>)> {
        let (samples, pattern) = (self.samples(), self.pattern);
        let per_group = (GROUP / samples).max(1);
        let parts = self.keys.chunks(per_group).zip(self.sites.chunks(per_group * samples));
        (0..).zip(parts).map(move |(group, (keys, sites))| {
            (group * per_group * samples, AreaSites { sites, keys, pattern })
        })
    }
}

impl Direct<'_> {
    /// Adds to each sample of some elements one estimate of the irradiance there: by one shadow ray to each light, or to one
    /// of many.
    ///
    /// Every sample has a point on each light of its own, which together cover the light; the same estimators as
    /// [at points](Self::at_point).
    pub(crate) fn over_areas(
        &self,
        area: &AreaSites<'_>,
        (points, batch): (&mut LightPoints, &mut Batch),
        values: &mut [DVec3],
    ) -> Result<(), TransportError> {
        for (first, group) in area.groups() {
            let values = &mut values[first..][..group.sites.len()];
            self.over_group(&group, (&mut *points, &mut *batch), values)?;
        }
        Ok(())
    }

    fn over_group(
        &self,
        area: &AreaSites<'_>,
        (points, batch): (&mut LightPoints, &mut Batch),
        values: &mut [DVec3],
    ) -> Result<(), TransportError> {
        self.control.check()?;
        for (element, sites) in area.sites.chunks(area.samples()).enumerate() {
            batch.begin_element();
            for (number, site) in sites.iter().enumerate() {
                let (Some(site), at) = (site, element * area.samples() + number) else { continue };
                self.delta_arrivals(site, |target, arriving, cos| {
                    batch.add(site, target, (number as u32, at), (arriving * cos).as_dvec3())
                });
            }
        }
        let mut add_lit = |_: &Ray, at: usize, value: DVec3, passed: Vec3| {
            if passed != Vec3::ZERO {
                values[at] += value * passed.as_dvec3();
            }
        };
        let mut n_rays = batch.trace(self.tracer, &mut add_lit);
        if let Some(tree) = &self.lights.tree {
            self.choose_over_areas(tree, area, points, batch);
            n_rays += batch.trace(self.tracer, &mut add_lit);
        }
        for l in self.looped_lights() {
            self.control.check()?;
            n_rays += self.one_light_over_areas(l, area, (&mut *points, &mut *batch), values);
        }
        self.control.count(0, n_rays as u64);
        Ok(())
    }

    /// A light that is chosen from many, as a site sees it, and how likely that was.
    pub(crate) fn choose<'a>(
        &'a self,
        tree: &LightTree,
        site: &'a Site,
        select: f32,
    ) -> Option<(f64, LightView<'a>)> {
        let (origin, normal) = (site.origin.as_dvec3(), site.frame.normal.as_dvec3());
        let choice = tree.choose(origin, normal, select)?;
        let shines = self.shines(self.lights.area[choice.light].0);
        let view = shines.then(|| self.view(choice.light, site, choice.probability)).flatten()?;
        Some((choice.probability, view))
    }

    /// Of so many samples of an element, how many its pilot has.
    pub(crate) fn pilot_samples(&self, samples: u32) -> u32 {
        self.plan.sampler.sample_count((samples / 4).clamp(1, MAX_PILOT)).min(samples)
    }

    /// Traces the rays of pilots and sets the share of each element that sees the light; 1 if none of its points lies above the
    /// horizon. Returns the number of rays.
    pub(crate) fn visible_shares(
        &self,
        batch: &mut Batch,
        element: impl Fn(usize) -> usize,
        shares: &mut [f64],
    ) -> usize {
        let mut seen: SmallVec<[(f64, u32); CHUNK]> = smallvec![(0.0, 0); shares.len()];
        let n_rays = batch.trace(self.tracer, |_, at, _, passed| {
            let (n_lit, n) = &mut seen[element(at)];
            *n_lit += share(passed);
            *n += 1;
        });
        for (share, (n_lit, n)) in shares.iter_mut().zip(seen) {
            *share = if n > 0 { n_lit / f64::from(n) } else { 1.0 };
        }
        n_rays
    }

    /// Adds one shadow ray of each sample, to a light that is chosen from many.
    fn choose_over_areas(
        &self,
        tree: &LightTree,
        area: &AreaSites<'_>,
        points: &mut LightPoints,
        batch: &mut Batch,
    ) {
        let samples = area.pattern.len();
        for (element, (key, _)) in area.keys.iter().enumerate() {
            batch.begin_element();
            let stream = self.plan.stream(samples, *key, Dim::LightSelect);
            for (slot, (u, select)) in (0..).zip(points.fill_by_choice(&stream, samples)) {
                let at = area.at(element, slot);
                let Some(site) = &area.sites[at] else { continue };
                if let Some((probability, view)) = self.choose(tree, site, *select)
                    && let Some(sample) = view.sample(*u)
                {
                    batch.add(site, sample.target, (slot, at), sample.unblocked.0.as_dvec3() / probability);
                }
            }
        }
    }

    /// The light of one light. Returns the number of rays.
    fn one_light_over_areas(
        &self,
        l: usize,
        area: &AreaSites<'_>,
        (points, batch): (&mut LightPoints, &mut Batch),
        values: &mut [DVec3],
    ) -> usize {
        let samples = area.pattern.len();
        let view = |site| Some((site, self.view(l, site, 1.0)?));
        let views: Vec<Option<(&Site, LightView<'_>)>> =
            area.sites.iter().map(|site| site.as_ref().and_then(view)).collect();
        let Some((_, example)) = views.iter().flatten().next() else { return 0 };
        let mut n_rays = 0;
        let add = |batch: &mut Batch, (slot, at): (u32, usize), u: [f32; 2]| {
            if let Some((site, view)) = &views[at]
                && let Some(sample) = view.sample(u)
            {
                batch.add(site, sample.target, (slot, at), sample.unblocked.0.as_dvec3());
            }
        };
        // Where nothing is known of a closed form, all that is seen is counted.
        let mut betas: SmallVec<[f64; CHUNK]> = smallvec![0.0; area.keys.len()];
        if self.plan.light_sampling == LightSampling::Analytic && example.has_closed_form() {
            let pilot = self.pilot_samples(samples);
            for (element, (key, _)) in area.keys.iter().enumerate() {
                batch.begin_element();
                let stream = self.plan.sampler.for_count(pilot).stream(*key, Dim::LightPilot(l as u32));
                for (number, &u) in (0..).zip(points.fill(&stream, pilot)) {
                    add(batch, (number, element * area.samples() + number as usize), u);
                }
            }
            n_rays += self.visible_shares(batch, |at| at / area.samples(), &mut betas);
            for (at, (value, view)) in values.iter_mut().zip(&views).enumerate() {
                let beta = betas[at / area.samples()];
                if let Some((_, view)) = view
                    && beta > 0.0
                {
                    *value += view.unblocked().0.as_dvec3() * beta;
                }
            }
        }
        for (element, (key, _)) in area.keys.iter().enumerate() {
            batch.begin_element();
            let stream = self.plan.stream(samples, *key, Dim::Light(l as u32));
            for (slot, &u) in (0..).zip(points.fill(&stream, samples)) {
                add(batch, (slot, area.at(element, slot)), u);
            }
        }
        n_rays
            + batch.trace(self.tracer, |_, at, value, passed| {
                values[at] += value * (passed.as_dvec3() - betas[at / area.samples()]);
            })
    }
}
