//! What the tree is made of.

use super::aabb::Aabb;
use glam::Vec3;

/// Children of a node: as many boxes as a vector register of AVX2 tests at once.
pub(crate) const WIDTH: usize = 8;

/// Triangles of a block: as many as an SSE or NEON register tests at once.
pub(crate) const BLOCK: usize = 4;

/// The boxes of up to eight children by coordinate, so that they are tested side by side; four cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Smallest coordinates of the children, by axis.
    pub(crate) lower: [[f32; WIDTH]; 3],
    /// Largest coordinates of the children, by axis.
    pub(crate) upper: [[f32; WIDTH]; 3],
    pub(crate) children: [Child; WIDTH],
    orders: [Order; 8],
}

impl Node {
    /// A node of at most eight children.
    pub(super) fn new(children: &[(Aabb, Child)]) -> Self {
        let mut node = Self {
            lower: [[0.0; WIDTH]; 3],
            upper: [[0.0; WIDTH]; 3],
            children: [Child::default(); WIDTH],
            orders: [Order(0); 8],
        };
        for (slot, (bounds, child)) in children.iter().enumerate().take(WIDTH) {
            for axis in 0..3 {
                node.lower[axis][slot] = bounds.min[axis];
                node.upper[axis][slot] = bounds.max[axis];
            }
            node.children[slot] = *child;
        }
        node.orders = std::array::from_fn(|octant| Order::new(children, octant));
        node
    }

    /// The order for directions whose negative components are the bits of `octant`.
    #[inline(always)]
    pub(crate) fn order(&self, octant: usize) -> Order {
        self.orders[octant & 7]
    }
}

/// The children of a node from far to near, by their centres, for directions of one octant.
///
/// Three bits for each slot, and from bit 24 on the number of children.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Order(pub(crate) u32);

impl Order {
    fn new(children: &[(Aabb, Child)], octant: usize) -> Self {
        let signs =
            Vec3::from_array(std::array::from_fn(|axis| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 }));
        let distance = |slot: &usize| {
            let bounds = children[*slot].0;
            (0.5 * bounds.min + 0.5 * bounds.max).dot(signs)
        };
        let mut slots: [usize; WIDTH] = std::array::from_fn(|slot| slot);
        let count = children.len().min(WIDTH);
        slots[..count].sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        let packed = slots.iter().enumerate().fold(0, |bits, (k, slot)| bits | (*slot as u32) << (3 * k));
        Self(packed | (count as u32) << 24)
    }

    /// The slot that comes at place `k`.
    #[inline(always)]
    pub(crate) fn slot(self, k: u32) -> usize {
        (self.0 >> (3 * k) & 7) as usize
    }

    /// A bit for each place that has a child.
    #[inline(always)]
    pub(crate) fn present(self) -> u32 {
        (1 << (self.0 >> 24)) - 1
    }
}

/// The index of an inner node, or with the highest bit set a leaf: its first block and the number of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    /// The node that is made first.
    pub(crate) const ROOT: Self = Self(0);
    const LEAF: u32 = 1 << 31;
    const COUNT_BITS: u32 = 4;

    pub(super) fn inner(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn leaf(first: usize, blocks: usize) -> Self {
        Self((first << Self::COUNT_BITS) as u32 | blocks as u32 | Self::LEAF)
    }

    /// The node, unless it is a leaf.
    #[inline(always)]
    pub(crate) fn node(self) -> Option<usize> {
        (self.0 & Self::LEAF == 0).then_some(self.0 as usize)
    }

    /// The blocks of a leaf.
    #[inline(always)]
    pub(crate) fn blocks(self) -> std::ops::Range<usize> {
        let first = ((self.0 & !Self::LEAF) >> Self::COUNT_BITS) as usize;
        first..first + (self.0 & ((1 << Self::COUNT_BITS) - 1)) as usize
    }
}

/// Four triangles by coordinate. A block that is not full repeats its last one.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// `corners[corner][axis][triangle]`.
    pub(crate) corners: [[[f32; BLOCK]; 3]; 3],
    /// The largest difference of a coordinate along the two edges at corner 0.
    pub(crate) extent: [f32; BLOCK],
    pub(crate) tri: [u32; BLOCK],
}

impl Block {
    /// At least one triangle and at most four.
    pub(super) fn new(triangles: &[([Vec3; 3], u32)]) -> Self {
        let mut block = Self { corners: [[[0.0; BLOCK]; 3]; 3], extent: [0.0; BLOCK], tri: [0; BLOCK] };
        for i in 0..BLOCK {
            let (corners, tri) = triangles[i.min(triangles.len() - 1)];
            for (corner, position) in corners.iter().enumerate() {
                for axis in 0..3 {
                    block.corners[corner][axis][i] = position[axis];
                }
            }
            let [a, b, c] = corners;
            block.extent[i] = (b - a).abs().max((c - a).abs()).max_element();
            block.tri[i] = tri;
        }
        block
    }

    /// The corners of one triangle.
    #[inline]
    pub(crate) fn triangle(&self, i: usize) -> [Vec3; 3] {
        self.corners.map(|corner| Vec3::new(corner[0][i], corner[1][i], corner[2][i]))
    }

    /// Those of the four that are not repeated.
    #[inline(always)]
    pub(crate) fn present(&self) -> u32 {
        (1 << self.count()) - 1
    }

    /// How many of the four are not repeated.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        1 + (1..BLOCK).filter(|&i| self.tri[i] != self.tri[i - 1]).count()
    }
}
