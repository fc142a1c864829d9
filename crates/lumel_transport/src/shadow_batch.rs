//! Shadow rays of neighbouring areas, in bundles.
//!
//! As with [hemisphere rays](crate::gather), there are two ways to make bundles of similar rays: those of one element to
//! neighbouring parts of a light, or those of neighbouring elements to one part of it. Elements that are small compared with
//! such a part, as lumels are, go the second way. Which is taken has no influence on the result.

use crate::order::CHUNK;
use glam::{DVec3, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::Site;
use lumel_scene::Bounds;

/// Shadow rays of samples, to be traced together; kept between elements, so that nothing is allocated for each.
#[derive(Default)]
pub(crate) struct Batch {
    /// Element by element.
    rays: Vec<Ray>,
    /// Of each ray, where its sample stands and what arrives there if nothing is in the way.
    values: Vec<(usize, DVec3)>,
    /// Of each ray, its slot, ascending within an element: rays of one slot go to about the same part of a light.
    slots: Vec<u32>,
    /// Where the rays of each element begin.
    elements: Vec<usize>,
    /// Slot by slot, with the elements side by side.
    transposed: Vec<usize>,
    arranged: Vec<Ray>,
    occluded: Vec<bool>,
    passed: Vec<Vec3>,
}

impl Batch {
    /// The rays that follow are those of another element.
    pub(crate) fn begin_element(&mut self) {
        self.elements.push(self.rays.len());
    }

    /// Adds the ray in a slot of the element, of the sample at a place.
    #[inline]
    pub(crate) fn add(&mut self, site: &Site, target: Vec3, (slot, at): (u32, usize), value: DVec3) {
        self.rays.push(Ray { skip: site.skip, ..Ray::between(site.origin, target) });
        self.values.push((at, value));
        self.slots.push(slot);
    }

    /// Traces the rays, tells which share of its value each lets arrive, those of one sample in the order in which they were
    /// added, and forgets them. Returns how many.
    pub(crate) fn trace(
        &mut self,
        tracer: &dyn RayTracer,
        mut each: impl FnMut(&Ray, usize, DVec3, Vec3),
    ) -> usize {
        self.transpose();
        let is_transposed = self.is_narrower_transposed();
        let Self { rays, values, transposed, arranged, occluded, passed, .. } = self;
        if is_transposed {
            arranged.clear();
            arranged.extend(transposed.iter().map(|&ray| rays[ray]));
        }
        let (n_rays, traced) = (rays.len(), if is_transposed { &*arranged } else { &*rays });
        let mut tell = |k: usize, passed| {
            let (at, value) = values[if is_transposed { transposed[k] } else { k }];
            each(&traced[k], at, value, passed);
        };
        if tracer.is_see_through() {
            passed.clear();
            passed.resize(n_rays, Vec3::ZERO);
            tracer.transmittances_of(traced, passed);
            passed.iter().enumerate().for_each(|(k, passed)| tell(k, *passed));
        } else {
            occluded.clear();
            occluded.resize(n_rays, false);
            tracer.occlusions_of(traced, occluded);
            let passed = |blocked: bool| if blocked { Vec3::ZERO } else { Vec3::ONE };
            occluded.iter().enumerate().for_each(|(k, blocked)| tell(k, passed(*blocked)));
        }
        self.rays.clear();
        self.values.clear();
        self.slots.clear();
        self.elements.clear();
        n_rays
    }

    /// Finds the order slot by slot.
    fn transpose(&mut self) {
        let Self { rays, slots, elements, transposed, .. } = self;
        transposed.clear();
        if elements.len() < 2 {
            return;
        }
        let ends = elements.iter().copied().skip(1).chain([rays.len()]);
        let mut rows: Vec<_> = elements.iter().zip(ends).map(|(begin, end)| *begin..end).collect();
        let mut slot = 0;
        while transposed.len() < rays.len() {
            for row in &mut rows {
                while row.start < row.end && slots[row.start] == slot {
                    transposed.push(row.start);
                    row.start += 1;
                }
            }
            slot += 1;
        }
    }

    /// Whether bundles are narrower slot by slot than element by element, as a few of them tell.
    fn is_narrower_transposed(&self) -> bool {
        let n = self.transposed.len();
        if n < 2 * CHUNK {
            return false;
        }
        let spread = |ray_at: &dyn Fn(usize) -> usize| -> f32 {
            let bundle = |first: usize| spread((first..first + CHUNK).map(|k| &self.rays[ray_at(k)]));
            [0, n / 2 - CHUNK / 2, n - CHUNK].map(bundle).iter().sum()
        };
        spread(&|k| self.transposed[k]) < spread(&|k| k)
    }
}

/// How far the ends of rays are apart, on both sides.
fn spread<'a>(rays: impl Iterator<Item = &'a Ray> + Clone) -> f32 {
    let origins = Bounds::around(rays.clone().map(|ray| ray.origin));
    let targets = Bounds::around(rays.map(|ray| ray.origin + ray.direction));
    origins.diagonal() + targets.diagonal()
}
