//! The area form: light that arrives from lights.

use crate::job::{Cancelled, Control};
use crate::light_view::{LightSample, LightView};
use crate::lights::{AreaLight, LightSet, PointlikeLight};
use crate::plan::{LightSampling, Plan};
use glam::{DVec3, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::Site;
use lumel_sample::{Dim, Sampler, Stream, StreamKey};
use lumel_scene::{Irradiance, Scene};

/// Shadow rays of the pilot that sets the weight of the closed form: at most this many, and a quarter of the samples.
const MAX_PILOT: u32 = 16;

/// The segment beyond which a directional light has no occluders, in units of the scene's diagonal.
const BEYOND_SCENE: f32 = 4.0;

/// Everything that lights shine on a site is estimated from.
pub(crate) struct Direct<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) tracer: &'a dyn RayTracer,
    pub(crate) lights: &'a LightSet,
    pub(crate) plan: &'a Plan,
    pub(crate) control: &'a Control,
}

/// A sum of irradiance and the rays it took.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) sum: DVec3,
    pub(crate) n_rays: u64,
}

impl Direct<'_> {
    /// Irradiance at a site from all lights, each by `direct_samples` shadow rays.
    pub(crate) fn at_point(&self, site: &Site, key: StreamKey, tally: &mut Tally) -> Result<(), Cancelled> {
        self.pointlike(site, tally);
        let samples = self.plan.sampler.sample_count(self.plan.direct_samples);
        let sampler = self.plan.sampler.for_count(samples);
        if self.lights.by_power.is_some() {
            let stream = sampler.stream(key, Dim::LightSelect);
            let mut total = Tally::default();
            for i in 0..samples {
                self.control.check_at(i)?;
                let u = stream.sample_4d(i);
                self.chosen_by_power(site, u[2], [u[0], u[1]], &mut total);
            }
            tally.sum += total.sum / f64::from(samples);
            tally.n_rays += total.n_rays;
            return Ok(());
        }
        for (l, light) in self.lights.area.iter().enumerate() {
            let Some(view) = LightView::new(self.scene, light, site, self.plan.light_sampling) else {
                continue;
            };
            let stream = sampler.stream(key, Dim::Light(l as u32));
            match (self.plan.light_sampling, view.unblocked) {
                (LightSampling::Analytic, Some(unblocked)) => {
                    let beta =
                        self.visible_share(site, &view, (key, Dim::LightPilot(l as u32)), samples / 4, tally);
                    self.minus_blocked(site, &view, unblocked, beta, (stream, samples), tally)?;
                }
                _ => self.plain(site, &view, stream, samples, tally)?,
            }
        }
        Ok(())
    }

    /// One sample of the irradiance at a site that is itself one sample of an area.
    ///
    /// `u` places the point on each light.
    pub(crate) fn one_sample(&self, site: &Site, key: StreamKey, index: u32, u: [f32; 2], tally: &mut Tally) {
        self.pointlike(site, tally);
        if let Some(by_power) = &self.lights.by_power {
            // What is left of the coordinate within its light is uniform again.
            let (_, offset, _) = by_power.sample(u[0]);
            return self.chosen_by_power(site, u[0], [offset, u[1]], tally);
        }
        for (l, light) in self.lights.area.iter().enumerate() {
            let Some(view) = LightView::new(self.scene, light, site, self.plan.light_sampling) else {
                continue;
            };
            match (self.plan.light_sampling, view.unblocked) {
                (LightSampling::Analytic, Some(unblocked)) => {
                    // A weight need not be stratified, only independent.
                    let pilot = view.sample(Sampler::Random.sample_2d(key, index, Dim::LightPilot(l as u32)));
                    let beta = pilot.map_or(1.0, |pilot| self.visibility(site, &pilot, &mut *tally));
                    let sample = view.sample(u);
                    let rest = sample.map_or(DVec3::ZERO, |sample| {
                        sample.unblocked.0.as_dvec3() * (self.visibility(site, &sample, &mut *tally) - beta)
                    });
                    tally.sum += unblocked.0.as_dvec3() * beta + rest;
                }
                _ => self.add_if_seen(site, view.sample(u), 1.0, tally),
            }
        }
    }

    /// The textbook estimator: the mean of `L cos θ V / p`. Unbiased.
    fn plain(
        &self,
        site: &Site,
        view: &LightView<'_>,
        stream: Stream,
        samples: u32,
        tally: &mut Tally,
    ) -> Result<(), Cancelled> {
        let mut total = Tally::default();
        for i in 0..samples {
            self.control.check_at(i)?;
            self.add_if_seen(site, view.sample(stream.sample_2d(i)), 1.0, &mut total);
        }
        tally.sum += total.sum / f64::from(samples);
        tally.n_rays += total.n_rays;
        Ok(())
    }

    /// The closed form as a control variate: `βE + mean of (V − β) L cos θ / p`, where `β` is the share of an
    /// independent pilot that sees the light.
    ///
    /// `β = 1` where the light is seen whole leaves only the closed form; `β = 0` where it is hidden leaves exactly
    /// zero; in a penumbra both terms vary less than the plain estimator. Unbiased, because the pilot's points are
    /// independent of the samples.
    fn minus_blocked(
        &self,
        site: &Site,
        view: &LightView<'_>,
        unblocked: Irradiance,
        beta: f64,
        (stream, samples): (Stream, u32),
        tally: &mut Tally,
    ) -> Result<(), Cancelled> {
        let mut sum = DVec3::ZERO;
        for i in 0..samples {
            self.control.check_at(i)?;
            if let Some(sample) = view.sample(stream.sample_2d(i)) {
                sum += sample.unblocked.0.as_dvec3() * (self.visibility(site, &sample, tally) - beta);
            }
        }
        tally.sum += unblocked.0.as_dvec3() * beta + sum / f64::from(samples);
        Ok(())
    }

    /// The share of a pilot's points on the light that is seen; 1 if none lies above the horizon.
    ///
    /// The pilot is a whole set of points of its own: the first points of a larger one need not cover the light.
    fn visible_share(
        &self,
        site: &Site,
        view: &LightView<'_>,
        (key, dim): (StreamKey, Dim),
        requested: u32,
        tally: &mut Tally,
    ) -> f64 {
        let samples = self.plan.sampler.sample_count(requested.clamp(1, MAX_PILOT));
        let stream = self.plan.sampler.for_count(samples).stream(key, dim);
        let (mut seen, mut tried) = (0.0, 0.0);
        for sample in (0..samples).filter_map(|i| view.sample(stream.sample_2d(i))) {
            seen += self.visibility(site, &sample, tally);
            tried += 1.0;
        }
        if tried > 0.0 { seen / tried } else { 1.0 }
    }

    /// One sample of one area light that is chosen with a probability in proportion to its power.
    fn chosen_by_power(&self, site: &Site, select: f32, u: [f32; 2], tally: &mut Tally) {
        let Some(by_power) = &self.lights.by_power else { return };
        let (chosen, _, probability) = by_power.sample(select);
        let light: &AreaLight = &self.lights.area[chosen];
        if let Some(view) = LightView::new(self.scene, light, site, self.plan.light_sampling) {
            self.add_if_seen(site, view.sample(u), 1.0 / probability, tally);
        }
    }

    fn add_if_seen(&self, site: &Site, sample: Option<LightSample>, weight: f32, tally: &mut Tally) {
        if let Some(sample) = sample
            && !self.blocked(site, sample.target, tally)
        {
            tally.sum += (sample.unblocked.0 * weight).as_dvec3();
        }
    }

    /// 1 if a point of a light is seen, 0 if not.
    fn visibility(&self, site: &Site, sample: &LightSample, tally: &mut Tally) -> f64 {
        if self.blocked(site, sample.target, tally) { 0.0 } else { 1.0 }
    }

    fn blocked(&self, site: &Site, target: Vec3, tally: &mut Tally) -> bool {
        tally.n_rays += 1;
        self.tracer.occluded(&Ray { skip: site.skip, ..Ray::between(site.origin, target) })
    }

    /// Lights without an area: one shadow ray each, nothing random.
    fn pointlike(&self, site: &Site, tally: &mut Tally) {
        let reach = BEYOND_SCENE * self.scene.bounds().diagonal();
        for light in &self.lights.pointlike {
            let (target, arriving) = match light {
                PointlikeLight::Point(point) => {
                    let distance = point.position.distance(site.origin);
                    (point.position, point.normal_irradiance(distance))
                }
                PointlikeLight::Spot(spot) => {
                    let away = site.origin - spot.point.position;
                    let Some(direction) = away.try_normalize() else { continue };
                    let arriving = spot.point.normal_irradiance(away.length()) * spot.falloff(direction);
                    (spot.point.position, arriving)
                }
                PointlikeLight::Directional(sun) => (site.origin - sun.direction * reach, sun.irradiance),
            };
            let Some(direction) = (target - site.origin).try_normalize() else { continue };
            let cos = site.frame.normal.dot(direction);
            if cos > 0.0
                && arriving != Vec3::ZERO
                && arriving.is_finite()
                && !self.blocked(site, target, tally)
            {
                tally.sum += (arriving * cos).as_dvec3();
            }
        }
    }
}
