//! Sixteen rays at once.

use super::beam::Beam;
use super::extent::Interval;
use super::leaf::{Edges, EdgesOfBlock, PlanesOfBlock, V3, each, load, splat};
use super::single::{Follow, Line};
use super::stack::{Entry, Stack};
use super::{Found, LATER, NO_TRIANGLE, PACKET, bits, code};
use crate::bvh::{Block, Bvh, Child};
use crate::ray::Ray;
use crate::simd::{Kernel, Lanes, Permute, Quads, Simd};
use crate::triangle::is_traceable;
use glam::Vec3;

/// Up to this many rays that are left in a subtree go on one by one: apart, together, and for any hit.
const FEW_APART: u32 = 1;
const FEW_TOGETHER: u32 = 2;
const FEW_ANY: u32 = 1;

/// Sixteen rays by coordinate, and the best hit of each so far.
#[derive(Clone)]
#[repr(align(64))]
pub(crate) struct Packet {
    origin: [[f32; PACKET]; 3],
    direction: [[f32; PACKET]; 3],
    /// One over the directions, filled in when the trace begins.
    inverse: [[f32; PACKET]; 3],
    t: [f32; PACKET],
    weights: [[f32; PACKET]; 2],
    code: [u32; PACKET],
    skip: [u32; PACKET],
    /// Rays that still look for a hit; those of no use have been left out from the start.
    active: u32,
}

impl Packet {
    pub(crate) fn new() -> Self {
        Self {
            origin: [[0.0; PACKET]; 3],
            direction: [[0.0; PACKET]; 3],
            inverse: [[0.0; PACKET]; 3],
            t: [0.0; PACKET],
            weights: [[0.0; PACKET]; 2],
            code: [NO_TRIANGLE; PACKET],
            skip: [NO_TRIANGLE; PACKET],
            active: 0,
        }
    }

    /// Fills the packet with at most sixteen rays. Whether any of them can be traced.
    pub(crate) fn fill(&mut self, rays: impl Iterator<Item = Ray>) -> bool {
        self.active = 0;
        let mut count = 0;
        for (lane, ray) in rays.take(PACKET).enumerate() {
            for axis in 0..3 {
                self.origin[axis][lane] = ray.origin[axis];
                self.direction[axis][lane] = ray.direction[axis];
            }
            self.t[lane] = ray.t_max.next_down();
            self.skip[lane] = ray.skip.map_or(NO_TRIANGLE, |tri| tri.0);
            self.active |= u32::from(is_traceable(ray.origin, ray.direction)) << lane;
            count = lane + 1;
        }
        self.code = [NO_TRIANGLE; PACKET];
        if self.active == 0 {
            return false;
        }
        // Lanes of no use repeat one that is, so that they do not widen the intervals.
        let example = self.active.trailing_zeros() as usize;
        if self.active.count_ones() < PACKET as u32 {
            for lane in (0..PACKET).filter(|&lane| lane >= count || self.active >> lane & 1 == 0) {
                for axis in 0..3 {
                    self.origin[axis][lane] = self.origin[axis][example];
                    self.direction[axis][lane] = self.direction[axis][example];
                }
                self.t[lane] = f32::NEG_INFINITY;
            }
        }
        true
    }

    /// Leaves only some rays active.
    pub(crate) fn retain(&mut self, lanes: u32) {
        self.active &= lanes;
    }

    /// After a trace for any hit: the rays that met nothing.
    pub(crate) fn unmet(&self) -> u32 {
        self.active
    }

    /// The closest hit of a ray.
    pub(crate) fn found(&self, lane: usize) -> Found {
        let weights = [self.weights[0][lane], self.weights[1][lane]];
        Found { t: self.t[lane], code: self.code[lane], weights }
    }

    #[inline(always)]
    fn ray(&self, lane: usize) -> (Vec3, Vec3) {
        let lane = lane & 15;
        let at = |v: &[[f32; PACKET]; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
        (at(&self.origin), at(&self.direction))
    }

    #[inline(always)]
    fn offer(&mut self, lane: usize, new: Found) {
        let lane = lane & 15;
        let mut found = self.found(lane);
        found.offer(new);
        (self.t[lane], self.code[lane]) = (found.t, found.code);
        (self.weights[0][lane], self.weights[1][lane]) = (found.weights[0], found.weights[1]);
    }

    /// Of some lanes, those that see a triangle at all.
    #[inline(always)]
    fn seeing(&self, tri: u32, lanes: u32) -> u32 {
        let mut seeing = lanes;
        for lane in bits(lanes) {
            seeing &= !(u32::from(self.skip[lane & 15] == tri) << lane);
        }
        seeing
    }
}

/// Follows a packet through the tree.
///
/// - `TOGETHER`: all rays start at one point, and skip the same triangle
/// - `ANY`: a ray is done once it has met anything; otherwise it looks for its closest hit
pub(crate) struct PacketTrace<'a, const TOGETHER: bool, const ANY: bool> {
    pub(crate) bvh: &'a Bvh,
    /// What to visit, the first one last.
    pub(crate) roots: &'a [Child],
    pub(crate) packet: &'a mut Packet,
    pub(crate) stack: &'a mut Stack,
}

impl<const TOGETHER: bool, const ANY: bool> Kernel for PacketTrace<'_, TOGETHER, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) {
        let state = Traversal::<S, TOGETHER, ANY>::new(isa, self.bvh, self.packet);
        if state.beam.one_octant {
            state.run::<true>(self.roots, self.packet, self.stack);
        } else {
            state.run::<false>(self.roots, self.packet, self.stack);
        }
    }
}

/// One over the components of directions, those near zero kept away from it.
#[inline(always)]
fn inverse<L: Lanes>(isa: L::Isa, direction: L, smallest: L) -> L {
    let tiny = direction.abs().lt(smallest);
    L::splat(isa, 1.0).div(direction.replace(smallest, tiny))
}

/// What stays the same on the way through the tree.
struct Traversal<'a, S: Simd, const TOGETHER: bool, const ANY: bool> {
    isa: S,
    bvh: &'a Bvh,
    beam: Beam<S>,
    origin: V3<S::F16>,
    direction: V3<S::F16>,
    inverse: V3<S::F16>,
}

impl<'a, S: Simd, const TOGETHER: bool, const ANY: bool> Traversal<'a, S, TOGETHER, ANY> {
    const FEW: u32 = if ANY {
        FEW_ANY
    } else if TOGETHER {
        FEW_TOGETHER
    } else {
        FEW_APART
    };

    #[inline(always)]
    fn new(isa: S, bvh: &'a Bvh, packet: &mut Packet) -> Self {
        let origin: V3<S::F16> = load(isa, &packet.origin);
        let direction: V3<S::F16> = load(isa, &packet.direction);
        let interval =
            |v: V3<S::F16>| Interval { min: each(v, Lanes::smallest), max: each(v, Lanes::largest) };
        let origins = if TOGETHER {
            let one = packet.ray(0).0.to_array();
            Interval { min: one, max: one }
        } else {
            interval(origin)
        };
        let beam = Beam::new(isa, origins, interval(direction));
        let smallest = S::F16::splat(isa, beam.smallest);
        let [x, y, z] = direction;
        let inverse = [inverse(isa, x, smallest), inverse(isa, y, smallest), inverse(isa, z, smallest)];
        for (axis, inverse) in inverse.iter().enumerate() {
            inverse.store(&mut packet.inverse[axis]);
        }
        Self { isa, bvh, beam, origin, direction, inverse }
    }

    #[inline(always)]
    fn run<const ONE: bool>(&self, roots: &[Child], packet: &mut Packet, stack: &mut Stack) {
        stack.clear();
        if ANY && !self.meet_what_was_in_the_way(packet, stack) {
            return;
        }
        for &child in roots {
            stack.push(Entry { near: 0.0, child, lanes: packet.active });
        }
        let mut limit = self.limit(packet);
        let Some(mut current) = stack.pop_above(0) else { return };
        loop {
            let lanes = if ANY { current.lanes & packet.active } else { current.lanes };
            let met = match current.child.node() {
                Some(_) if lanes.count_ones() <= Self::FEW => {
                    self.one_by_one(current.child, lanes, packet, stack)
                }
                Some(node) => {
                    self.enter::<ONE>(node, lanes, limit, packet, stack);
                    false
                }
                None => self.leaf(current.child, lanes, packet, stack),
            };
            if met {
                if ANY && packet.active == 0 {
                    return;
                }
                limit = self.limit(packet);
            }
            current = loop {
                match stack.pop_above(0) {
                    None => return,
                    Some(entry) if ANY && entry.lanes & packet.active == 0 => {}
                    Some(entry) if entry.near <= limit => break entry,
                    Some(_) => {}
                }
            };
        }
    }

    /// The farthest that any ray still looks.
    #[inline(always)]
    fn limit(&self, packet: &Packet) -> f32 {
        S::F16::load(self.isa, &packet.t).largest()
    }

    /// Pushes the children of a node that rays enter, the nearest last.
    #[inline(always)]
    fn enter<const ONE: bool>(
        &self,
        node: usize,
        lanes: u32,
        limit: f32,
        packet: &Packet,
        stack: &mut Stack,
    ) {
        let node = &self.bvh.nodes[node];
        let entered = self.beam.enter::<ONE>(self.isa, node, limit);
        let order = node.order(self.beam.octant);
        let near = entered.near.permute(order.0);
        let places = near.le(entered.far.permute(order.0)) & order.present();
        let mut nears = [0.0; 8];
        near.store(&mut nears);
        let t = S::F16::load(self.isa, &packet.t);
        for place in bits(places) {
            let slot = order.slot(place as u32);
            let sides = if TOGETHER { (&entered.lower, &entered.upper) } else { (&node.lower, &node.upper) };
            let lanes = self.entering::<ONE>(sides, slot, t) & lanes;
            stack.push_if(lanes != 0, Entry { near: nears[place & 7], child: node.children[slot], lanes });
        }
    }

    /// The rays that enter one box before they end. With one origin, `sides` are relative to it.
    #[inline(always)]
    fn entering<const ONE: bool>(
        &self,
        sides: (&[[f32; 8]; 3], &[[f32; 8]; 3]),
        slot: usize,
        t: S::F16,
    ) -> u32 {
        let isa = self.isa;
        let mut near = S::F16::splat(isa, 0.0);
        let mut far = t;
        for axis in 0..3 {
            let lower = self.distance(axis, sides.0[axis][slot & 7]);
            let upper = self.distance(axis, sides.1[axis][slot & 7]);
            if ONE {
                let reversed = self.beam.octant >> axis & 1 == 1;
                let (first, last) = if reversed { (upper, lower) } else { (lower, upper) };
                near = near.max(first);
                far = far.min(last);
            } else {
                near = near.max(lower.min(upper));
                far = far.min(lower.max(upper));
            }
        }
        near.le(far.mul(S::F16::splat(isa, LATER)))
    }

    /// Where rays pass a side of a box. A closure within [`entering`](Self::entering) would not surely be inlined.
    #[inline(always)]
    fn distance(&self, axis: usize, side: f32) -> S::F16 {
        let side = S::F16::splat(self.isa, side);
        let relative = if TOGETHER { side } else { side.sub(self.origin[axis]) };
        relative.mul(self.inverse[axis])
    }

    /// Follows the few rays that are left in a subtree. Whether any met something.
    #[inline(always)]
    fn one_by_one(&self, start: Child, lanes: u32, packet: &mut Packet, stack: &mut Stack) -> bool {
        let mut any = false;
        for lane in bits(lanes) {
            let (origin, direction) = packet.ray(lane);
            let inverse = each([0, 1, 2], |axis: usize| packet.inverse[axis][lane & 15]);
            let line = Line { origin, direction, inverse, skip: packet.skip[lane & 15] };
            let mut found = packet.found(lane & 15);
            let follow = Follow::<ANY> { bvh: self.bvh, line, start, stack: &mut *stack, found: &mut found };
            if self.isa.call(follow) {
                any = true;
                if ANY {
                    packet.active &= !(1 << lane);
                } else {
                    packet.offer(lane, found);
                }
            }
        }
        any
    }

    /// Tests the triangles that were in the way of other rays last. Whether any ray is still free.
    #[inline(always)]
    fn meet_what_was_in_the_way(&self, packet: &mut Packet, stack: &mut Stack) -> bool {
        let mut any = false;
        for guess in stack.guesses() {
            if let Some(block) = self.bvh.blocks.get(guess)
                && self.meet(block, packet.active, packet)
            {
                any = true;
                stack.is_in_the_way(guess);
                if packet.active == 0 {
                    return false;
                }
            }
        }
        if !any {
            stack.forget_guesses();
        }
        true
    }

    /// Whether any of the rays met one of a leaf's triangles.
    #[inline(always)]
    fn leaf(&self, leaf: Child, lanes: u32, packet: &mut Packet, stack: &mut Stack) -> bool {
        let mut any = false;
        for i in leaf.blocks() {
            let lanes = if ANY { lanes & packet.active } else { lanes };
            if self.meet(&self.bvh.blocks[i], lanes, packet) {
                any = true;
                if ANY {
                    stack.is_in_the_way(i);
                }
            }
        }
        any
    }

    /// Whether any of the rays met one of a block's triangles.
    #[inline(always)]
    fn meet(&self, block: &Block, lanes: u32, packet: &mut Packet) -> bool {
        let edges = Edges::<S::F4>::new(self.isa, block, &self.beam.from);
        match lanes.count_ones() {
            0 => false,
            1..=4 => self.four_by_four(block, edges, lanes, packet),
            _ => self.each_triangle(block, edges, lanes, packet),
        }
    }

    /// At most four rays and four triangles, in all pairs.
    #[inline(always)]
    fn four_by_four(&self, block: &Block, edges: Edges<S::F4>, lanes: u32, packet: &mut Packet) -> bool {
        let isa = self.isa;
        let mut rays = [0u8; 4];
        for (place, lane) in rays.iter_mut().zip(bits(lanes)) {
            *place = lane as u8;
        }
        let spread = |v: S::F16| v.spread(rays);
        let planes = if TOGETHER {
            let origin = splat(isa, self.beam.from.center);
            edges.planes(origin).repeated::<S::F16>(isa)
        } else {
            edges.repeated::<S::F16>(isa).planes(each(self.origin, spread))
        };
        let limit = S::F16::load(isa, &packet.t).spread(rays);
        let met = planes.test(isa, each(self.direction, spread), limit);
        if met.lanes == 0 {
            return false;
        }
        let mut among = (1 << (4 * lanes.count_ones())) - 1;
        for pair in bits(met.lanes & among) {
            if packet.skip[usize::from(rays[pair / 4]) & 15] == block.tri[pair & 3] {
                among &= !(1 << pair);
            }
        }
        let pairs = met.decided(among, |pair| {
            let (origin, direction) = packet.ray(usize::from(rays[pair / 4]));
            (block.triangle(pair & 3), origin, direction)
        });
        if pairs == 0 {
            return false;
        }
        if ANY {
            bits(pairs).for_each(|pair| packet.active &= !(1 << rays[pair / 4]));
            return true;
        }
        let back = planes.back();
        let (mut t, mut second, mut third) = ([0.0; PACKET], [0.0; PACKET], [0.0; PACKET]);
        met.t.store(&mut t);
        met.weights[0].store(&mut second);
        met.weights[1].store(&mut third);
        for pair in bits(pairs) {
            let pair = pair & 15;
            let code = code(block.tri[pair & 3], back >> pair & 1 == 1);
            let new = Found { t: t[pair], code, weights: [second[pair], third[pair]] };
            packet.offer(usize::from(rays[pair / 4]), new);
        }
        true
    }

    /// One triangle after the other, in all rays.
    #[inline(always)]
    fn each_triangle(&self, block: &Block, edges: Edges<S::F4>, lanes: u32, packet: &mut Packet) -> bool {
        let isa = self.isa;
        let mut any = false;
        if TOGETHER {
            let planes = edges.planes(splat(isa, self.beam.from.center));
            let within = planes.within_reach(isa, &self.beam.directions) & block.present();
            if within == 0 {
                return false;
            }
            let planes = PlanesOfBlock::new(planes);
            for i in bits(within) {
                let back = if planes.shows_back(i) { u32::MAX } else { 0 };
                any |= self.triangle(block, i, planes.triangle(isa, i), back, lanes, packet);
            }
        } else {
            let edges = EdgesOfBlock::new(edges);
            for i in 0..block.count() {
                let planes = edges.triangle::<S::F16>(isa, i).planes(self.origin);
                any |= self.triangle(block, i, planes, planes.back(), lanes, packet);
            }
        }
        any
    }

    #[inline(always)]
    fn triangle(
        &self,
        block: &Block,
        i: usize,
        planes: super::leaf::Planes<S::F16>,
        back: u32,
        lanes: u32,
        packet: &mut Packet,
    ) -> bool {
        let isa = self.isa;
        let limit = S::F16::load(isa, &packet.t);
        let met = planes.test(isa, self.direction, limit);
        let lanes = met.lanes & if ANY { lanes & packet.active } else { lanes };
        if lanes == 0 {
            return false;
        }
        let tri = block.tri[i & 3];
        let lanes = met.decided(packet.seeing(tri, lanes), |lane| {
            let (origin, direction) = packet.ray(lane);
            (block.triangle(i & 3), origin, direction)
        });
        if lanes == 0 {
            return false;
        }
        if ANY {
            packet.active &= !lanes;
            return true;
        }
        let closer = met.t.lt(limit) & lanes;
        let ties = bits(lanes & !closer).fold(0, |mask, lane| {
            let wins = code(tri, back >> lane & 1 == 1) < packet.code[lane & 15];
            mask | u32::from(wins) << lane
        });
        let better = closer | ties;
        limit.replace(met.t, better).store(&mut packet.t);
        for k in 0..2 {
            S::F16::load(isa, &packet.weights[k])
                .replace(met.weights[k], better)
                .store(&mut packet.weights[k]);
        }
        for lane in bits(better) {
            packet.code[lane & 15] = code(tri, back >> lane & 1 == 1);
        }
        better != 0
    }
}
