//! The tree as a tracer: how rays are handed to the kernels.

use crate::bvh::{Bvh, Child};
use crate::ray::{Bundle, Hit, Ray, RayTracer};
use crate::trace::{Alone, Crossings, NO_TRIANGLE, PACKET, Packet, PacketTrace, SHAFT, Shaft, Stack};
use crate::triangle::is_traceable;

/// Fewer rays than this are not worth a packet.
const FEW: usize = 4;

/// As many nodes as a shaft may leave to packets; usually there are about twenty.
const MAX_REST: usize = 64;

/// The nodes that a shaft has not visited, the next one last.
struct Rest {
    nodes: [Child; MAX_REST],
    count: usize,
}

impl Rest {
    /// Those on its stack; all from the root again where there are too many of them.
    fn new(stack: &Stack, root: Child) -> Self {
        let mut rest = Self { nodes: [root; MAX_REST], count: 1 };
        let left = stack.children();
        if left.len() <= MAX_REST {
            rest.count = left.len();
            rest.nodes.iter_mut().zip(left).for_each(|(node, child)| *node = child);
        }
        rest
    }
}

impl RayTracer for Bvh {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.follow::<false>(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.follow::<true>(ray).is_some()
    }

    fn closest_hits(&self, bundle: &Bundle<'_>, hits: &mut [Option<Hit>]) {
        let rays = |range: std::ops::Range<usize>| range.map(|i| bundle.ray(i));
        self.closest_in_packets::<true, _>(bundle.directions.len(), rays, hits);
    }

    fn closest_hits_of(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let ray = |range: std::ops::Range<usize>| range.map(|i| rays[i]);
        self.closest_in_packets::<false, _>(rays.len(), ray, hits);
    }

    fn occlusions_of(&self, rays: &[Ray], occluded: &mut [bool]) {
        let Some(root) = self.root else { return occluded.fill(false) };
        let mut packet = Packet::new();
        for (rays, occluded) in rays.chunks(PACKET).zip(occluded.chunks_mut(PACKET)) {
            if rays.len() < FEW {
                rays.iter().zip(occluded).for_each(|(ray, blocked)| *blocked = self.occluded(ray));
                continue;
            }
            if !packet.fill(rays.iter().copied()) {
                occluded.fill(false);
                continue;
            }
            // Without those that cannot be traced.
            let looking = packet.unmet();
            self.trace::<false, true>(&[root], &mut packet);
            tell_met(looking & !packet.unmet(), occluded);
        }
    }

    fn occlusions(&self, bundle: &Bundle<'_>, occluded: &mut [bool]) {
        let Some(root) = self.root else { return occluded.fill(false) };
        let skip = bundle.skip.map_or(NO_TRIANGLE, |tri| tri.0);
        for (directions, occluded) in bundle.directions.chunks(SHAFT).zip(occluded.chunks_mut(SHAFT)) {
            let part = Bundle { directions, ..*bundle };
            if directions.len() < FEW {
                for (i, blocked) in occluded.iter_mut().enumerate() {
                    *blocked = self.occluded(&part.ray(i));
                }
            } else if let Some(shaft) = Shaft::new(self, root, (part.origin, part.t_max, skip), directions) {
                self.occluded_in_shaft(root, shaft, &part, occluded);
            } else {
                occluded.fill(false);
            }
        }
    }
}

impl Bvh {
    /// What a ray meets, the closest or with `ANY` any.
    #[inline]
    fn follow<const ANY: bool>(&self, ray: &Ray) -> Option<Hit> {
        let root = self.root.filter(|_| is_traceable(ray.origin, ray.direction))?;
        Stack::lend(|stack| self.instructions().run(Alone::<ANY> { bvh: self, ray, root, stack }))
    }

    /// Tells `each` of all that a ray meets, in no particular order; it tells up to which distance more is looked for,
    /// that distance included, and must not trace.
    pub(crate) fn cross(&self, ray: &Ray, each: &mut dyn FnMut(Hit) -> f32) {
        let Some(root) = self.root.filter(|_| is_traceable(ray.origin, ray.direction)) else { return };
        Stack::lend(|stack| self.instructions().run(Crossings { bvh: self, ray, root, stack, each }));
    }

    fn closest_in_packets<const TOGETHER: bool, I: Iterator<Item = Ray>>(
        &self,
        count: usize,
        rays: impl Fn(std::ops::Range<usize>) -> I,
        hits: &mut [Option<Hit>],
    ) {
        let Some(root) = self.root else { return hits.fill(None) };
        let mut packet = Packet::new();
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
            self.trace::<TOGETHER, false>(&[root], &mut packet);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = packet.found(lane).hit();
            }
        }
    }

    /// Walks the tree with a shaft, then with packets of the rays that are undecided.
    fn occluded_in_shaft(
        &self,
        root: Child,
        mut shaft: Shaft<'_>,
        bundle: &Bundle<'_>,
        occluded: &mut [bool],
    ) {
        // Without those that cannot be traced.
        let looking: [u32; SHAFT / PACKET] = std::array::from_fn(|k| shaft.free(k));
        let rest = Stack::lend(|stack| (!shaft.walk(stack)).then(|| Rest::new(stack, root)));
        let mut packet = None;
        for (k, occluded) in occluded.chunks_mut(PACKET).enumerate() {
            let rays = k * PACKET..k * PACKET + occluded.len();
            let mut free = shaft.free(k);
            if let Some(rest) = rest.as_ref().filter(|_| free != 0) {
                let packet = packet.get_or_insert_with(Packet::new);
                packet.fill(rays.map(|i| bundle.ray(i)));
                packet.retain(free);
                self.trace::<true, true>(&rest.nodes[..rest.count], packet);
                free = packet.unmet();
            }
            tell_met(looking[k] & !free, occluded);
        }
    }

    fn trace<const TOGETHER: bool, const ANY: bool>(&self, roots: &[Child], packet: &mut Packet) {
        Stack::lend(|stack| {
            self.instructions().run(PacketTrace::<TOGETHER, ANY> { bvh: self, roots, packet, stack });
        });
    }
}

/// Writes out the mask of a packet's rays that have met something.
fn tell_met(met: u32, occluded: &mut [bool]) {
    occluded.iter_mut().enumerate().for_each(|(i, blocked)| *blocked = met >> i & 1 == 1);
}
