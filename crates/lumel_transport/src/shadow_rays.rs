//! Shadow rays of one site, in bundles.

use crate::job::{Control, TransportError};
use glam::{DVec3, Vec3};
use lumel_accel::{Bundle, RayTracer, SHADOW_END};
use lumel_basis::Site;

/// Shadow rays that are traced at once: as many as the tracer's shafts have. Cells of the light that are wider than
/// that are no better.
const BUNDLE: usize = 64;

/// A sum of irradiance and the rays it took.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) sum: DVec3,
    pub(crate) n_rays: u64,
}

/// Collects shadow rays and traces them when there are enough.
pub(crate) struct ShadowRays<'a> {
    tracer: &'a dyn RayTracer,
    site: &'a Site,
    segments: [Vec3; BUNDLE],
    values: [DVec3; BUNDLE],
    waiting: usize,
    visible: Visible,
}

/// What shadow rays have found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Visible {
    /// The sum of the values of all rays.
    pub(crate) all: DVec3,
    /// The sum of what of them arrives; the same bits as `all` if nothing is in the way of any.
    pub(crate) lit: DVec3,
    /// Rays that arrive; of those through transparent surfaces the share that does.
    pub(crate) n_lit: f64,
    /// All rays.
    pub(crate) n_rays: u32,
}

impl<'a> ShadowRays<'a> {
    pub(crate) fn new(tracer: &'a dyn RayTracer, site: &'a Site) -> Self {
        let (segments, values) = ([Vec3::ZERO; BUNDLE], [DVec3::ZERO; BUNDLE]);
        Self { tracer, site, segments, values, waiting: 0, visible: Visible::default() }
    }

    /// Adds the ray to a point from which `value` arrives if nothing is in the way.
    pub(crate) fn add(
        &mut self,
        target: Vec3,
        value: DVec3,
        control: &Control,
    ) -> Result<(), TransportError> {
        self.segments[self.waiting] = target - self.site.origin;
        self.values[self.waiting] = value;
        self.waiting += 1;
        if self.waiting == BUNDLE {
            control.check()?;
            self.trace();
        }
        Ok(())
    }

    /// Traces what is left.
    pub(crate) fn finish(mut self, tally: &mut Tally) -> Visible {
        self.trace();
        tally.n_rays += u64::from(self.visible.n_rays);
        self.visible
    }

    /// Sums in the order in which rays were added, however they are traced.
    fn trace(&mut self) {
        let n = self.waiting;
        let Site { origin, skip, .. } = *self.site;
        let bundle = Bundle { origin, directions: &self.segments[..n], t_max: SHADOW_END, skip };
        if self.tracer.is_see_through() {
            let mut passed = [Vec3::ZERO; BUNDLE];
            self.tracer.transmittances(&bundle, &mut passed[..n]);
            for (value, passed) in self.values[..n].iter().zip(passed) {
                self.visible.all += *value;
                self.visible.lit += *value * passed.as_dvec3();
                self.visible.n_lit += share(passed);
            }
        } else {
            let mut occluded = [false; BUNDLE];
            self.tracer.occlusions(&bundle, &mut occluded[..n]);
            for (value, blocked) in self.values[..n].iter().zip(&occluded) {
                self.visible.all += *value;
                if !blocked {
                    self.visible.lit += *value;
                    self.visible.n_lit += 1.0;
                }
            }
        }
        self.visible.n_rays += n as u32;
        self.waiting = 0;
    }
}

/// The mean of the channels of a transmittance.
pub(crate) fn share(passed: Vec3) -> f64 {
    passed.as_dvec3().element_sum() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_accel::{Hit, Ray};
    use lumel_sample::Frame;
    use std::sync::Mutex;

    /// Notes the sizes of bundles; what goes to negative x is blocked.
    #[derive(Default)]
    struct Notes(Mutex<Vec<usize>>);

    impl RayTracer for Notes {
        fn closest_hit(&self, _: &Ray) -> Option<Hit> {
            None
        }

        fn occluded(&self, ray: &Ray) -> bool {
            ray.direction.x < 0.0
        }

        fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
            self.0.lock().unwrap().push(occluded.len());
            for (i, blocked) in occluded.iter_mut().enumerate() {
                *blocked = self.occluded(&bundle.ray(i));
            }
        }
    }

    #[test]
    fn rays_are_traced_in_bundles_and_each_counts_once() {
        let (notes, mut tally) = (Notes::default(), Tally::default());
        let site = Site { origin: Vec3::ZERO, frame: Frame::from_normal(Vec3::Z), skip: None };
        let mut rays = ShadowRays::new(&notes, &site);
        for i in 0..150 {
            let x = if i % 3 == 0 { -1.0 } else { 1.0 };
            rays.add(Vec3::new(x, 0.0, 1.0), DVec3::ONE, &Control::default()).unwrap();
        }
        let visible = rays.finish(&mut tally);
        let expected =
            Visible { all: DVec3::splat(150.0), lit: DVec3::splat(100.0), n_lit: 100.0, n_rays: 150 };
        assert_eq!((visible, tally.n_rays), (expected, 150));
        assert_eq!(*notes.0.lock().unwrap(), [64, 64, 22]);
    }
}
