//! Light that arrives from lights at the samples of areas.

use crate::direct::{Direct, MAX_PILOT};
use crate::job::TransportError;
use crate::light_points::LightPoints;
use crate::light_tree::LightTree;
use crate::light_view::LightView;
use crate::plan::LightSampling;
use crate::shadow_rays::share;
use glam::{DVec3, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::Site;
use lumel_sample::{Dim, StreamKey};
use smallvec::SmallVec;

/// The samples of one element with an area.
pub(crate) struct AreaSites<'a, N> {
    /// By number; `None` for what lies inside geometry.
    pub(crate) sites: &'a [Option<Site>],
    /// Names the streams of the element.
    pub(crate) key: StreamKey,
    /// The sample that goes with a place in the order of cells.
    pub(crate) number: N,
}

/// Shadow rays of samples, to be traced together; kept between elements, so that nothing is allocated for each.
#[derive(Default)]
pub(crate) struct Batch {
    rays: Vec<Ray>,
    /// The sample and what arrives there if nothing is in the way.
    values: Vec<(usize, DVec3)>,
    occluded: Vec<bool>,
    passed: Vec<Vec3>,
}

impl Batch {
    fn add(&mut self, site: &Site, target: Vec3, number: usize, value: DVec3) {
        self.rays.push(Ray { skip: site.skip, ..Ray::between(site.origin, target) });
        self.values.push((number, value));
    }

    /// Traces the rays, tells which share of its value each lets arrive, in the order in which they were added, and
    /// forgets them. Returns how many.
    fn trace(&mut self, tracer: &dyn RayTracer, mut each: impl FnMut(usize, DVec3, Vec3)) -> usize {
        let n_rays = self.rays.len();
        if tracer.is_see_through() {
            self.passed.clear();
            self.passed.resize(n_rays, Vec3::ZERO);
            tracer.transmittances_of(&self.rays, &mut self.passed);
            for (&(number, value), &passed) in self.values.iter().zip(&self.passed) {
                each(number, value, passed);
            }
        } else {
            self.occluded.clear();
            self.occluded.resize(n_rays, false);
            tracer.occlusions_of(&self.rays, &mut self.occluded);
            for (&(number, value), &blocked) in self.values.iter().zip(&self.occluded) {
                each(number, value, if blocked { Vec3::ZERO } else { Vec3::ONE });
            }
        }
        self.rays.clear();
        self.values.clear();
        n_rays
    }
}

impl Direct<'_> {
    /// Adds to each sample of an element one estimate of the irradiance there: by one shadow ray to each light, or to one of
    /// many.
    ///
    /// Every sample has a point on each light of its own, which together cover the light; the same estimators as
    /// [at points](Self::at_point).
    pub(crate) fn over_area<N: Fn(u32) -> u32>(
        &self,
        area: &AreaSites<'_, N>,
        (points, batch): (&mut LightPoints, &mut Batch),
        values: &mut [DVec3],
    ) -> Result<(), TransportError> {
        let mut n_rays = 0;
        for (number, site) in area.sites.iter().enumerate() {
            let Some(site) = site else { continue };
            self.delta_arrivals(site, |target, value| batch.add(site, target, number, value));
        }
        let mut add_lit = |number: usize, value: DVec3, passed: Vec3| {
            if passed != Vec3::ZERO {
                values[number] += value * passed.as_dvec3();
            }
        };
        if let Some(tree) = &self.lights.tree {
            self.choose_over_area(tree, area, points, batch);
        }
        n_rays += batch.trace(self.tracer, &mut add_lit);
        for l in self.looped_lights() {
            self.control.check()?;
            n_rays += self.one_light_over_area(l, area, (points, batch), values);
        }
        self.control.count(0, n_rays as u64);
        Ok(())
    }

    /// Adds one shadow ray of each sample, to a light that is chosen from many.
    fn choose_over_area<N: Fn(u32) -> u32>(
        &self,
        tree: &LightTree,
        area: &AreaSites<'_, N>,
        points: &mut LightPoints,
        batch: &mut Batch,
    ) {
        let samples = area.sites.len() as u32;
        let stream = self.plan.stream(samples, area.key, Dim::LightSelect);
        for (slot, (u, select)) in (0..).zip(points.fill_by_choice(&stream, samples)) {
            let number = (area.number)(slot) as usize;
            let Some(site) = &area.sites[number] else { continue };
            let (origin, normal) = (site.origin.as_dvec3(), site.frame.normal.as_dvec3());
            let Some(choice) = tree.choose(origin, normal, *select) else { continue };
            let shines = self.shines(self.lights.area[choice.light].0);
            let view = shines.then(|| self.view(choice.light, site, choice.probability)).flatten();
            if let Some(sample) = view.and_then(|view| view.sample(*u)) {
                let value = sample.unblocked.0.as_dvec3() / choice.probability;
                batch.add(site, sample.target, number, value);
            }
        }
    }

    /// The light of one light. Returns the number of rays.
    fn one_light_over_area<N: Fn(u32) -> u32>(
        &self,
        l: usize,
        area: &AreaSites<'_, N>,
        (points, batch): (&mut LightPoints, &mut Batch),
        values: &mut [DVec3],
    ) -> usize {
        let samples = area.sites.len() as u32;
        let views: SmallVec<[Option<(&Site, LightView<'_>)>; 16]> = area
            .sites
            .iter()
            .map(|site| site.as_ref().and_then(|site| Some((site, self.view(l, site, 1.0)?))))
            .collect();
        let Some((_, example)) = views.iter().flatten().next() else { return 0 };
        let mut n_rays = 0;
        let add = |batch: &mut Batch, number: u32, u: [f32; 2]| {
            let number = number as usize;
            if let Some((site, view)) = &views[number]
                && let Some(sample) = view.sample(u)
            {
                batch.add(site, sample.target, number, sample.unblocked.0.as_dvec3());
            }
        };
        // Where nothing is known of a closed form, all that is seen is counted.
        let mut beta = 0.0;
        if self.plan.light_sampling == LightSampling::Analytic && example.has_closed_form() {
            let pilot = self.plan.sampler.sample_count((samples / 4).clamp(1, MAX_PILOT)).min(samples);
            let stream = self.plan.sampler.for_count(pilot).stream(area.key, Dim::LightPilot(l as u32));
            for (slot, &u) in (0..).zip(points.fill(&stream, pilot)) {
                add(batch, slot, u);
            }
            let mut n_lit = 0.0;
            let n = batch.trace(self.tracer, |_, _, passed| n_lit += share(passed));
            beta = if n > 0 { n_lit / n as f64 } else { 1.0 };
            n_rays += n;
            let seen = values.iter_mut().zip(&views).filter(|_| beta > 0.0);
            for (value, (_, view)) in seen.filter_map(|(value, view)| Some((value, view.as_ref()?))) {
                *value += view.unblocked().0.as_dvec3() * beta;
            }
        }
        let stream = self.plan.stream(samples, area.key, Dim::Light(l as u32));
        for (slot, &u) in (0..).zip(points.fill(&stream, samples)) {
            add(batch, (area.number)(slot), u);
        }
        n_rays += batch.trace(self.tracer, |number, value, passed| {
            values[number] += value * (passed.as_dvec3() - beta);
        });
        n_rays
    }
}
