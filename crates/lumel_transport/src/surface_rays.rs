//! What hemisphere rays bring from emissive surfaces that shadow rays sample too.

use crate::balance::Balance;
use crate::emitters::{Emitter, EmitterMask};
use crate::ends::RayEnd;
use crate::hemisphere::HemisphereDensity;
use crate::job::Source;
use crate::lights::LightSet;
use crate::operator::CpuTransport;
use crate::plan::Plan;
use glam::{DVec3, Vec3};
use lumel_basis::Site;
use lumel_scene::{Scene, SurfacePoint};

/// The emissive surfaces, and where some hemisphere rays start.
pub(crate) struct SurfaceRays<'a> {
    scene: &'a Scene,
    lights: &'a LightSet,
    mask: Option<&'a EmitterMask>,
    plan: &'a Plan,
    density: HemisphereDensity,
    sites: Vec<Site>,
    rays_per_site: usize,
}

impl<'a> SurfaceRays<'a> {
    /// `None` where hemisphere rays bring nothing from these surfaces.
    pub(crate) fn new<B, R>(op: &'a CpuTransport<B, R>, source: Source<'a>) -> Option<Self> {
        let Source::Emitters(mask) = source else { return None };
        let CpuTransport { scene, lights, plan, density, .. } = op;
        let new =
            || Self { scene, lights, mask, plan, density: *density, sites: Vec::new(), rays_per_site: 1 };
        lights.combines().then(new)
    }

    /// Takes the rays of some sites, as many of each, instead of those before.
    pub(crate) fn set<'s>(&mut self, sites: impl Iterator<Item = &'s Site>, rays_per_site: usize) {
        self.sites.clear();
        self.sites.extend(sites.cloned());
        self.rays_per_site = rays_per_site;
    }

    /// What ray number `at` adds to the irradiance if it ends there, W·m⁻².
    pub(crate) fn arriving(&self, at: usize, end: &RayEnd) -> DVec3 {
        let RayEnd::Surface(point) = *end else { return DVec3::ZERO };
        let material = self.scene.material_id(point.tri);
        if !self.mask.is_none_or(|mask| mask.shines(Emitter::Surfaces(material))) {
            return DVec3::ZERO;
        }
        let whole = self.scene.emission(point).cosine_sample().0;
        if whole == Vec3::ZERO {
            return DVec3::ZERO;
        }
        (whole * self.share(&self.sites[at / self.rays_per_site], point)).as_dvec3()
    }

    /// The share that a ray from a site to a point keeps of what it brings.
    fn share(&self, site: &Site, point: SurfacePoint) -> f32 {
        // What no shadow ray finds is left to hemisphere rays.
        let Some(l) = self.lights.emissive_light(point.tri) else { return 1.0 };
        if !self.lights.is_combined(l) {
            return 0.0;
        }
        let probability = self.lights.probability(l, site);
        if probability <= 0.0 {
            return 1.0;
        }
        let Some(view) = self.lights.view(self.scene, l, site, self.plan.light_sampling) else {
            return 1.0;
        };
        let direction = (self.scene.position(point) - site.origin).normalize_or_zero();
        let balance = Balance::new(self.plan, self.density).when_chosen(probability);
        balance.ray_share(view.pdf(point, direction), site.frame.normal.dot(direction))
    }
}
