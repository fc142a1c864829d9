//! The tree as a tracer: how rays are handed to the kernels.

use crate::bvh::{Bvh, Child};
use crate::ray::{Bundle, Hit, Ray, RayTracer};
use crate::trace::{AnySingle, ClosestSingle, NO_TRIANGLE, PACKET, Packet, PacketTrace, SHAFT, Shaft, Stack};
use crate::triangle::is_traceable;

/// Fewer rays than this are not worth a packet.
const FEW: usize = 4;

impl RayTracer for Bvh {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let root = self.root?;
        if !is_traceable(ray.origin, ray.direction) {
            return None;
        }
        self.instructions().run(ClosestSingle { bvh: self, ray, root })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.root.is_some_and(|root| {
            is_traceable(ray.origin, ray.direction)
                && self.instructions().run(AnySingle { bvh: self, ray, root })
        })
    }

    fn closest_hits(&self, bundle: &Bundle<'_>, hits: &mut [Option<Hit>]) {
        let rays = |range: std::ops::Range<usize>| range.map(|i| bundle.ray(i));
        self.closest_in_packets::<true, _>(bundle.directions.len(), rays, hits);
    }

    fn closest_hits_of(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let ray = |range: std::ops::Range<usize>| range.map(|i| rays[i]);
        self.closest_in_packets::<false, _>(rays.len(), ray, hits);
    }

    fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
        let Some(root) = self.root else { return occluded.fill(false) };
        let (mut packet, mut stack) = (Packet::new(), Stack::new());
        let shafts = bundle.directions.chunks(SHAFT).zip(occluded.chunks_mut(SHAFT));
        for (shaft, (directions, occluded)) in shafts.enumerate() {
            if directions.len() < FEW {
                for (i, blocked) in occluded.iter_mut().enumerate() {
                    *blocked = self.occluded(&bundle.ray(shaft * SHAFT + i));
                }
                continue;
            }
            let skip = bundle.skip.map_or(NO_TRIANGLE, |tri| tri.0);
            let Some(mut walked) = Shaft::new(self, root, (bundle.origin, bundle.t_max, skip), directions)
            else {
                occluded.fill(false);
                continue;
            };
            let complete = walked.walk(&mut stack);
            for (k, occluded) in occluded.chunks_mut(PACKET).enumerate() {
                let mut free = walked.free(k);
                if !complete && free != 0 {
                    let first = shaft * SHAFT + k * PACKET;
                    packet.fill((first..first + occluded.len()).map(|i| bundle.ray(i)));
                    packet.retain(free);
                    self.trace::<true, true>(root, &mut packet, &mut stack);
                    free = packet.unmet();
                }
                for (i, blocked) in occluded.iter_mut().enumerate() {
                    // Rays that cannot be traced were never free.
                    *blocked = free >> i & 1 == 0 && is_traceable(bundle.origin, directions[k * PACKET + i]);
                }
            }
        }
    }
}

impl Bvh {
    fn closest_in_packets<const TOGETHER: bool, I: Iterator<Item = Ray>>(
        &self,
        count: usize,
        rays: impl Fn(std::ops::Range<usize>) -> I,
        hits: &mut [Option<Hit>],
    ) {
        let Some(root) = self.root else { return hits.fill(None) };
        let (mut packet, mut stack) = (Packet::new(), Stack::new());
        for first in (0..count).step_by(PACKET) {
            let range = first..count.min(first + PACKET);
            let hits = &mut hits[range.clone()];
            if hits.len() < FEW {
                hits.iter_mut().zip(rays(range)).for_each(|(hit, ray)| *hit = self.closest_hit(&ray));
                continue;
            }
            if !packet.fill(rays(range)) {
                hits.fill(None);
                continue;
            }
            self.trace::<TOGETHER, false>(root, &mut packet, &mut stack);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = packet.found(lane).hit();
            }
        }
    }

    fn trace<const TOGETHER: bool, const ANY: bool>(
        &self,
        root: Child,
        packet: &mut Packet,
        stack: &mut Stack,
    ) {
        self.instructions().run(PacketTrace::<TOGETHER, ANY> { bvh: self, root, packet, stack });
    }
}
