//! One ray at a time: eight boxes, then four triangles, side by side.

use super::extent::Origins;
use super::leaf::{Edges, V3, splat};
use super::stack::{Entry, Stack};
use super::{EARLIER, Found, LATER, NO_TRIANGLE, bits, code, smallest_component};
use crate::bvh::{Block, Bvh, Child, Node};
use crate::ray::{Hit, Ray};
use crate::simd::{Kernel, Lanes, Permute, Simd};
use glam::Vec3;

/// A ray as the kernel needs it.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
    /// One over each component of the direction; of those near zero, over something not so near.
    pub(super) inverse: [f32; 3],
    pub(super) skip: u32,
}

/// What the triangles that a ray meets are offered to.
pub(super) trait Offers {
    /// Up to where triangles are looked for, that distance included.
    fn limit(&self) -> f32;

    fn offer(&mut self, found: Found);
}

impl Offers for Found {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t
    }

    #[inline(always)]
    fn offer(&mut self, found: Found) {
        Found::offer(self, found);
    }
}

/// Vectors of one ray.
struct Prepared<S: Simd> {
    line: Line,
    /// Bits are set for axes along which it goes down.
    octant: usize,
    origin8: V3<S::F8>,
    inverse8: V3<S::F8>,
    origin4: V3<S::F4>,
    direction4: V3<S::F4>,
    from: Origins,
}

impl<S: Simd> Prepared<S> {
    #[inline(always)]
    fn new(isa: S, line: Line) -> Self {
        let (o, d) = (line.origin.to_array(), line.direction.to_array());
        let reach = line.direction.abs().max_element();
        let inverse = line.inverse;
        let octant = (0..3).fold(0, |bits, axis| bits | usize::from(inverse[axis] < 0.0) << axis);
        Self {
            line,
            octant,
            origin8: splat(isa, o),
            inverse8: splat(isa, inverse),
            origin4: splat(isa, o),
            direction4: splat(isa, d),
            from: Origins { center: o, spread: 0.0, reach },
        }
    }

    /// Pushes the children whose boxes it enters before `limit`, the nearest last.
    #[inline(always)]
    fn enter(&self, isa: S, node: &Node, limit: f32, stack: &mut Stack) {
        let mut near = S::F8::splat(isa, 0.0);
        let mut far = S::F8::splat(isa, limit);
        for axis in 0..3 {
            let (first, last) = if self.octant >> axis & 1 == 0 {
                (&node.lower[axis], &node.upper[axis])
            } else {
                (&node.upper[axis], &node.lower[axis])
            };
            // Subtract first: a fused lo * inverse - o * inverse loses rays far from the origin.
            let slab = |side| S::F8::load(isa, side).sub(self.origin8[axis]).mul(self.inverse8[axis]);
            near = near.max(slab(first));
            far = far.min(slab(last));
        }
        near = near.mul(S::F8::splat(isa, EARLIER));
        far = far.mul(S::F8::splat(isa, LATER));
        let order = node.order(self.octant);
        let near = near.permute(order.0);
        let entered = near.le(far.permute(order.0)) & order.present();
        let mut nears = [0.0; 8];
        near.store(&mut nears);
        for place in bits(entered) {
            let child = node.children[order.slot(place as u32)];
            stack.push(Entry { near: nears[place & 7], child, lanes: 1 });
        }
    }

    /// Offers those of a block's triangles that it meets; whether there was any.
    #[inline(always)]
    fn meet(&self, isa: S, block: &Block, found: &mut impl Offers) -> bool {
        let planes = Edges::<S::F4>::new(isa, block, &self.from).planes(self.origin4);
        let met = planes.test(isa, self.direction4, S::F4::splat(isa, found.limit()));
        if met.lanes == 0 {
            return false;
        }
        let mut seen = met.lanes;
        for i in bits(met.lanes) {
            seen &= !(u32::from(block.tri[i & 3] == self.line.skip) << i);
        }
        let ray = |i: usize| (block.triangle(i), self.line.origin, self.line.direction);
        let lanes = met.decided(seen, ray);
        if lanes == 0 {
            return false;
        }
        let back = planes.back();
        let (mut t, mut second, mut third) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        met.t.store(&mut t);
        met.weights[0].store(&mut second);
        met.weights[1].store(&mut third);
        for i in bits(lanes) {
            let i = i & 3;
            let code = code(block.tri[i], back >> i & 1 == 1);
            found.offer(Found { t: t[i], code, weights: [second[i], third[i]] });
        }
        true
    }
}

/// Follows a ray through the subtree of `start`; with `ANY` only until something is met. Whether anything was.
#[inline(always)]
pub(super) fn follow<S: Simd, const ANY: bool, O: Offers>(
    isa: S,
    bvh: &Bvh,
    line: Line,
    start: Child,
    stack: &mut Stack,
    found: &mut O,
) -> bool {
    let ray = Prepared::new(isa, line);
    let bottom = stack.len();
    let mut current = start;
    let mut met = false;
    loop {
        if let Some(node) = current.node() {
            ray.enter(isa, &bvh.nodes[node], found.limit(), stack);
        } else {
            for block in &bvh.blocks[current.blocks()] {
                met |= ray.meet(isa, block, found);
            }
            if ANY && met {
                while stack.pop_above(bottom).is_some() {}
                return true;
            }
        }
        // What lies exactly at the best distance is still visited: a tie may be won by a lower triangle.
        current = loop {
            match stack.pop_above(bottom) {
                None => return met,
                Some(entry) if entry.near <= found.limit() => break entry.child,
                Some(_) => {}
            }
        };
    }
}

/// A subtree of a packet's ray; apart, so that it is compiled once.
pub(super) struct Follow<'a, const ANY: bool> {
    pub(super) bvh: &'a Bvh,
    pub(super) line: Line,
    pub(super) start: Child,
    pub(super) stack: &'a mut Stack,
    pub(super) found: &'a mut Found,
}

impl<const ANY: bool> Kernel for Follow<'_, ANY> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) -> bool {
        follow::<S, ANY, _>(isa, self.bvh, self.line, self.start, self.stack, self.found)
    }
}

/// A ray that comes alone: its closest hit, or with `ANY` the first that is found.
pub(crate) struct Alone<'a, const ANY: bool> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: &'a Ray,
    pub(crate) root: Child,
    pub(crate) stack: &'a mut Stack,
}

impl<const ANY: bool> Kernel for Alone<'_, ANY> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) -> Option<Hit> {
        let mut found = Found::nothing(self.ray.t_max);
        follow::<S, ANY, _>(isa, self.bvh, line(self.ray), self.root, self.stack, &mut found);
        found.hit()
    }
}

/// All that a ray meets, in no particular order: `each` is told, and tells up to where more is looked for.
pub(crate) struct Crossings<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: &'a Ray,
    pub(crate) root: Child,
    pub(crate) stack: &'a mut Stack,
    pub(crate) each: &'a mut dyn FnMut(Hit) -> f32,
}

struct Crossed<'a> {
    limit: f32,
    /// The triangle that was met last.
    last: u32,
    each: &'a mut dyn FnMut(Hit) -> f32,
}

impl Offers for Crossed<'_> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn offer(&mut self, found: Found) {
        // A block that is not full repeats its last triangle. Those of a block are tested together, and one may have
        // brought the limit nearer.
        let is_new = std::mem::replace(&mut self.last, found.code) != found.code;
        if is_new
            && found.t <= self.limit
            && let Some(hit) = found.hit()
        {
            self.limit = (self.each)(hit);
        }
    }
}

impl Kernel for Crossings<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) {
        let limit = self.ray.t_max.next_down();
        let mut crossed = Crossed { limit, last: NO_TRIANGLE, each: self.each };
        follow::<S, false, _>(isa, self.bvh, line(self.ray), self.root, self.stack, &mut crossed);
    }
}

fn line(ray: &Ray) -> Line {
    let skip = ray.skip.map_or(NO_TRIANGLE, |tri| tri.0);
    let smallest = smallest_component(ray.direction.abs().max_element());
    let away_from_zero = |d: f32| if d.abs() < smallest { smallest.copysign(d) } else { d };
    let inverse = ray.direction.to_array().map(|d| 1.0 / away_from_zero(d));
    Line { origin: ray.origin, direction: ray.direction, inverse, skip }
}
