//! The area form: light that arrives from lights.

use crate::balance::Balance;
use crate::emitters::{Emitter, EmitterMask};
use crate::hemisphere::HemisphereDensity;
use crate::job::{Control, TransportError};
use crate::light_points::LightPoints;
use crate::light_tree::LightTree;
use crate::light_view::{LightView, beyond};
use crate::lights::{DeltaLight, LightSet};
use crate::plan::{LightSampling, Plan};
use crate::shadow_rays::{ShadowRays, Tally, Visible};
use glam::{DVec3, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::Site;
use lumel_sample::{Dim, StreamKey};
use lumel_scene::{Irradiance, Scene};

/// Shadow rays of the pilot that sets the weight of the closed form: at most this many, and a quarter of the samples.
pub(crate) const MAX_PILOT: u32 = 16;

/// Everything that lights shine on a site is estimated from.
pub(crate) struct Direct<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) tracer: &'a dyn RayTracer,
    pub(crate) lights: &'a LightSet,
    /// The lights that shine; `None` for all.
    pub(crate) mask: Option<&'a EmitterMask>,
    pub(crate) plan: &'a Plan,
    /// Of the hemisphere rays that find some lights too.
    pub(crate) density: HemisphereDensity,
    pub(crate) control: &'a Control,
}

impl Direct<'_> {
    /// Irradiance at a site from all lights, each by `direct_samples` shadow rays.
    pub(crate) fn at_point(
        &self,
        site: &Site,
        key: StreamKey,
        points: &mut LightPoints,
        tally: &mut Tally,
    ) -> Result<(), TransportError> {
        self.delta_lights(site, tally);
        let samples = self.plan.sampler.sample_count(self.plan.direct_samples);
        if let Some(tree) = &self.lights.tree {
            let points = points.fill_by_choice(&self.plan.stream(samples, key, Dim::LightSelect), samples);
            let sum = self.chosen(tree, site, points, tally)?;
            tally.sum += sum / f64::from(samples);
        }
        for l in self.looped_lights() {
            let Some(view) = self.view(l, site, 1.0) else { continue };
            let stream = self.plan.stream(samples, key, Dim::Light(l as u32));
            if self.plan.light_sampling == LightSampling::Analytic && view.has_closed_form() {
                let pilot = (key, Dim::LightPilot(l as u32));
                let beta = self.visible_share(site, &view, pilot, samples / 4, (points, tally))?;
                let visible = self.visible(site, &view, points.fill(&stream, samples), tally)?;
                tally.sum += minus_blocked(|| view.unblocked(), beta, &visible, samples);
            } else {
                let visible = self.visible(site, &view, points.fill(&stream, samples), tally)?;
                tally.sum += visible.lit / f64::from(samples);
            }
        }
        Ok(())
    }

    pub(crate) fn shines(&self, emitter: Emitter) -> bool {
        self.mask.is_none_or(|mask| mask.shines(emitter))
    }

    /// The lights with an area that shine and are not chosen from a tree. Each keeps the sample points of its place among
    /// all.
    pub(crate) fn looped_lights(&self) -> impl Iterator<Item = usize> {
        let all = self.lights.area.iter().enumerate();
        let looped = all.filter(|(_, (_, light))| self.lights.tree.is_none() || light.is_far());
        looped.filter(|(_, (emitter, _))| self.shines(*emitter)).map(|(l, _)| l)
    }

    /// A light as a site sees it that samples it with this probability.
    pub(crate) fn view<'a>(&'a self, l: usize, site: &'a Site, probability: f64) -> Option<LightView<'a>> {
        let view = self.lights.view(self.scene, l, site, self.plan.light_sampling)?;
        let balance = || Balance::new(self.plan, self.density).when_chosen(probability);
        Some(if self.lights.is_combined(l) { view.combined(balance()) } else { view })
    }

    /// The light of points of one light: in all, and what of it is seen.
    fn visible(
        &self,
        site: &Site,
        view: &LightView<'_>,
        points: &[[f32; 2]],
        tally: &mut Tally,
    ) -> Result<Visible, TransportError> {
        let mut rays = ShadowRays::new(self.tracer, site);
        for u in points {
            if let Some(sample) = view.sample(*u) {
                rays.add(sample.target, sample.unblocked.0.as_dvec3(), self.control)?;
            }
        }
        Ok(rays.finish(tally))
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
        (points, tally): (&mut LightPoints, &mut Tally),
    ) -> Result<f64, TransportError> {
        let samples = self.plan.sampler.sample_count(requested.clamp(1, MAX_PILOT));
        let stream = self.plan.sampler.for_count(samples).stream(key, dim);
        let visible = self.visible(site, view, points.fill(&stream, samples), tally)?;
        Ok(if visible.n_rays > 0 { visible.n_lit / f64::from(visible.n_rays) } else { 1.0 })
    }

    /// The sum over samples of lights that are chosen one by one.
    ///
    /// Points in the order of the choice: those of one light, and of neighbours in the tree, follow each other.
    fn chosen(
        &self,
        tree: &LightTree,
        site: &Site,
        points: &[([f32; 2], f32)],
        tally: &mut Tally,
    ) -> Result<DVec3, TransportError> {
        let (origin, normal) = (site.origin.as_dvec3(), site.frame.normal.as_dvec3());
        let mut rays = ShadowRays::new(self.tracer, site);
        let mut view = None;
        for (u, select) in points {
            let Some(choice) = tree.choose(origin, normal, *select) else { continue };
            if view.as_ref().is_none_or(|(light, _)| *light != choice.light) {
                let new = || self.view(choice.light, site, choice.probability);
                view =
                    Some((choice.light, self.shines(self.lights.area[choice.light].0).then(new).flatten()));
            }
            if let Some((_, Some(view))) = &view
                && let Some(sample) = view.sample(*u)
            {
                let value = sample.unblocked.0.as_dvec3() / choice.probability;
                rays.add(sample.target, value, self.control)?;
            }
        }
        Ok(rays.finish(tally).lit)
    }

    fn passed(&self, site: &Site, target: Vec3, tally: &mut Tally) -> Vec3 {
        tally.n_rays += 1;
        self.tracer.transmittance(&Ray { skip: site.skip, ..Ray::between(site.origin, target) })
    }

    /// Lights without an area: one shadow ray each, nothing random.
    fn delta_lights(&self, site: &Site, tally: &mut Tally) {
        self.delta_arrivals(site, |target, arriving, cos| {
            let passed = self.passed(site, target, tally);
            if passed != Vec3::ZERO {
                tally.sum += (arriving * cos).as_dvec3() * passed.as_dvec3();
            }
        });
    }

    /// What lights without an area send to a site if nothing is in the way: where from, the irradiance of a surface that faces
    /// it, and the cosine to the site's normal.
    pub(crate) fn delta_arrivals(&self, site: &Site, mut each: impl FnMut(Vec3, Vec3, f32)) {
        for (_, light) in self.lights.delta.iter().filter(|(emitter, _)| self.shines(*emitter)) {
            let (target, arriving) = match light {
                DeltaLight::Point(point) => {
                    let distance = point.position.distance(site.origin);
                    (point.position, point.normal_irradiance(distance))
                }
                DeltaLight::Spot(spot) => {
                    let away = site.origin - spot.point.position;
                    let Some(direction) = away.try_normalize() else { continue };
                    let arriving = spot.point.normal_irradiance(away.length()) * spot.falloff(direction);
                    (spot.point.position, arriving)
                }
                DeltaLight::Directional(sun) => {
                    (beyond(self.scene, site.origin, -sun.direction), sun.irradiance)
                }
            };
            let Some(direction) = (target - site.origin).try_normalize() else { continue };
            let cos = site.frame.normal.dot(direction);
            if cos > 0.0 && arriving != Vec3::ZERO && arriving.is_finite() {
                each(target, arriving, cos);
            }
        }
    }
}

/// The closed form as a control variate: `βE + mean of (V − β) L cos θ / p`, where `β` is the share of an independent
/// pilot that sees the light.
///
/// `β = 1` where the light is seen whole leaves only the closed form; `β = 0` where it is hidden leaves exactly zero;
/// in a penumbra both terms vary less than the plain estimator. Unbiased, because the pilot's points are independent
/// of the samples.
fn minus_blocked(unblocked: impl Fn() -> Irradiance, beta: f64, visible: &Visible, samples: u32) -> DVec3 {
    let closed = if beta > 0.0 { unblocked().0.as_dvec3() * beta } else { DVec3::ZERO };
    closed + (visible.lit - visible.all * beta) / f64::from(samples)
}
