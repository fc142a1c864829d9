//! Shadow rays from one point: a shaft of sixty-four at a time.
//!
//! Most shafts between a point and a part of a light are wholly free or wholly blocked, and then the tree is walked
//! once for all: nodes are tested against the shaft alone, triangles against every ray. In a penumbra the shaft would
//! visit everything between its rays, so it has a budget; what is left when that is spent goes on in packets, from where
//! the shaft got to. Neighbours mostly lie in the shadow of the same triangles: those that were in the way last are tried
//! first. Blocked is blocked whoever found it, so the result is the same.

use super::beam::Beam;
use super::extent::Interval;
use super::leaf::{Edges, PlanesOfBlock, load, splat};
use super::stack::{Entry, Stack};
use super::{PACKET, bits};
use crate::bvh::{Block, Bvh, Child};
use crate::simd::{Kernel, Lanes, Permute, Simd};
use crate::triangle::is_traceable;
use glam::Vec3;

/// Rays of a shaft.
pub(crate) const SHAFT: usize = 4 * PACKET;

/// Nodes a shaft may visit, a block of triangles counting as two.
const BUDGET: i32 = 32;

/// Segments from one point.
#[derive(Clone)]
#[repr(align(64))]
pub(crate) struct Shaft<'a> {
    bvh: &'a Bvh,
    root: Child,
    origin: Vec3,
    t_max: f32,
    skip: u32,
    direction: [[[f32; PACKET]; 3]; SHAFT / PACKET],
    /// Rays that have met nothing yet.
    free: [u32; SHAFT / PACKET],
}

impl<'a> Shaft<'a> {
    /// A shaft of at most sixty-four directions; `None` if none of them can be traced.
    pub(crate) fn new(
        bvh: &'a Bvh,
        root: Child,
        (origin, t_max, skip): (Vec3, f32, u32),
        directions: &[Vec3],
    ) -> Option<Self> {
        let traceable = |d: &&Vec3| is_traceable(origin, **d);
        let example = *directions.iter().find(traceable)?;
        let mut shaft = Self {
            bvh,
            root,
            origin,
            t_max,
            skip,
            direction: [[[0.0; PACKET]; 3]; SHAFT / PACKET],
            free: [0; SHAFT / PACKET],
        };
        for i in 0..SHAFT {
            let given = directions.get(i).filter(traceable);
            let direction = given.copied().unwrap_or(example);
            for axis in 0..3 {
                shaft.direction[i / PACKET][axis][i % PACKET] = direction[axis];
            }
            shaft.free[i / PACKET] |= u32::from(given.is_some()) << (i % PACKET);
        }
        Some(shaft)
    }

    /// The rays of one packet that have met nothing yet.
    pub(crate) fn free(&self, packet: usize) -> u32 {
        self.free[packet]
    }

    /// Walks the tree; whether it got to the end, so that what is free is free indeed. Otherwise what is still to be
    /// visited is on the stack.
    pub(crate) fn walk(&mut self, stack: &mut Stack) -> bool {
        let instructions = self.bvh.instructions();
        instructions.run(Walk { shaft: self, stack })
    }

    #[inline(always)]
    fn is_blocked(&self) -> bool {
        self.free.iter().all(|&free| free == 0)
    }

    /// Tests a block's triangles against all rays that are free. Whether any is in the way.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, isa: S, block: &Block, beam: &Beam<S>) -> bool {
        let free = self.free;
        let edges = Edges::<S::F4>::new(isa, block, &beam.from);
        let planes = edges.planes(splat(isa, self.origin.to_array()));
        let within = planes.within_reach(isa, &beam.directions) & block.present();
        if within == 0 {
            return false;
        }
        let planes = PlanesOfBlock::new(planes);
        let limit = S::F16::splat(isa, self.t_max.next_down());
        for i in bits(within) {
            if block.tri[i & 3] == self.skip {
                continue;
            }
            let planes = planes.triangle::<S::F16>(isa, i);
            for k in 0..SHAFT / PACKET {
                if self.free[k] == 0 {
                    continue;
                }
                let direction = load::<S::F16>(isa, &self.direction[k]);
                let met = planes.test(isa, direction, limit);
                if met.lanes & self.free[k] != 0 {
                    let of = |lane: usize| {
                        let d = &self.direction[k];
                        let direction = Vec3::new(d[0][lane & 15], d[1][lane & 15], d[2][lane & 15]);
                        (block.triangle(i & 3), self.origin, direction)
                    };
                    self.free[k] &= !met.decided(self.free[k], of);
                }
            }
        }
        self.free != free
    }
}

struct Walk<'a, 'b> {
    shaft: &'b mut Shaft<'a>,
    stack: &'b mut Stack,
}

impl Kernel for Walk<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) -> bool {
        let Self { shaft, stack } = self;
        let bvh = shaft.bvh;
        let beam = beam(isa, shaft);
        let limit = shaft.t_max.next_down();
        let mut budget = BUDGET;
        stack.clear();
        let mut any = false;
        for guess in stack.guesses() {
            if let Some(block) = bvh.blocks.get(guess)
                && shaft.meet(isa, block, &beam)
            {
                any = true;
                stack.is_in_the_way(guess);
                if shaft.is_blocked() {
                    return true;
                }
            }
        }
        if !any {
            stack.forget_guesses();
        }
        let mut current = shaft.root;
        loop {
            if let Some(node) = current.node() {
                budget -= 1;
                if budget < 0 {
                    stack.push(Entry { near: 0.0, child: current, lanes: 0 });
                    return false;
                }
                let node = &bvh.nodes[node];
                let entered = beam.enter::<false>(isa, node, limit);
                let order = node.order(beam.octant);
                let near = entered.near.permute(order.0);
                let places = near.le(entered.far.permute(order.0)) & order.present();
                for place in bits(places) {
                    let child = node.children[order.slot(place as u32)];
                    stack.push(Entry { near: 0.0, child, lanes: 0 });
                }
            } else {
                let blocks = current.blocks();
                budget -= 2 * blocks.len() as i32;
                if budget < 0 {
                    stack.push(Entry { near: 0.0, child: current, lanes: 0 });
                    return false;
                }
                for i in blocks {
                    if shaft.meet(isa, &bvh.blocks[i], &beam) {
                        stack.is_in_the_way(i);
                    }
                }
                if shaft.is_blocked() {
                    return true;
                }
            }
            let Some(next) = stack.pop_above(0) else { return true };
            current = next.child;
        }
    }
}

#[inline(always)]
fn beam<S: Simd>(isa: S, shaft: &Shaft<'_>) -> Beam<S> {
    let origin = shaft.origin.to_array();
    let mut directions = Interval { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };
    for axis in 0..3 {
        let [a, b, c, d] = &shaft.direction;
        let load = |packet: &[[f32; PACKET]; 3]| S::F16::load(isa, &packet[axis]);
        let (a, b, c, d) = (load(a), load(b), load(c), load(d));
        directions.min[axis] = a.min(b).min(c.min(d)).smallest();
        directions.max[axis] = a.max(b).max(c.max(d)).largest();
    }
    Beam::new(isa, Interval { min: origin, max: origin }, directions)
}
