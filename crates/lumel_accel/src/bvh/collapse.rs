//! From the binary tree to the wide one.
//!
//! A subtree can stand in a wide node as one child, or as several by leaving out its upper levels. The cheapest way
//! for every number of children is found bottom up; what is built is the cheapest whole.
//!
//! Wald, Benthin, Boulos, *Getting rid of packets*, 2008, for the idea of wide trees; the dynamic program is that of
//! Ylitie, Karras, Laine, *Efficient incoherent ray traversal on GPUs through compressed wide BVHs*, 2017.

use super::aabb::Aabb;
use super::item::Item;
use super::node::{BLOCK, Block, Child, Node, WIDTH};
use glam::Vec3;

/// A leaf has at most two blocks.
const MAX_LEAF: usize = 2 * BLOCK;
/// What it costs to test a block, relative to a node.
const BLOCK_COST: f32 = 1.0;

/// An inner node of the binary tree.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Binary {
    bounds: Option<Aabb>,
    n_left: u32,
    /// `costs[k]`: the expected cost of the subtree as at most `k + 1` children.
    costs: [f32; WIDTH - 1],
    /// `shares[k]`: how many of at most `k + 1` children the left side has; 0 where one fewer is as good.
    shares: [u8; WIDTH],
    is_leaf: bool,
}

impl Binary {
    /// The root over a range that is sorted into leaves, `inner` being the nodes of its two sides.
    pub(super) fn over(items: &[Item], inner: &[Binary], n_left: usize) -> Self {
        let [left, right] = sides(items, inner, n_left);
        let bounds = left.bounds().union(right.bounds());
        let mut node = Self { bounds: Some(bounds), n_left: n_left as u32, ..Self::default() };
        let best_share = |children: usize| {
            let cost = |share: usize| left.cost(share) + right.cost(children - share);
            (1..children)
                .map(|share| (cost(share), share as u8))
                .fold((f32::INFINITY, 1), |best, next| if next.0 < best.0 { next } else { best })
        };
        let whole = best_share(WIDTH);
        node.shares[WIDTH - 1] = whole.1;
        let area = bounds.half_area();
        let as_node = area + whole.0;
        let as_leaf = if items.len() <= MAX_LEAF { leaf_cost(area, items.len()) } else { f32::INFINITY };
        // A tie, or areas that are not finite: the smaller structure if it may be one.
        let node_is_cheaper = as_node < as_leaf;
        node.is_leaf = items.len() <= MAX_LEAF && !node_is_cheaper;
        node.costs[0] = if node.is_leaf { as_leaf } else { as_node };
        for children in 2..WIDTH {
            let (cost, share) = best_share(children);
            let fewer = node.costs[children - 2];
            (node.costs[children - 1], node.shares[children - 1]) =
                if cost < fewer { (cost, share) } else { (fewer, 0) };
        }
        node
    }
}

fn leaf_cost(area: f32, count: usize) -> f32 {
    area * BLOCK_COST * count.div_ceil(BLOCK) as f32
}

/// A range of triangles and the inner nodes over it.
#[derive(Clone, Copy)]
pub(super) struct Subtree<'a> {
    pub(super) items: &'a [Item],
    pub(super) inner: &'a [Binary],
}

fn sides<'a>(items: &'a [Item], inner: &'a [Binary], n_left: usize) -> [Subtree<'a>; 2] {
    let (left, right) = items.split_at(n_left);
    let (left_inner, right_inner) = inner.split_at(n_left - 1);
    [Subtree { items: left, inner: left_inner }, Subtree { items: right, inner: right_inner }]
}

impl<'a> Subtree<'a> {
    fn bounds(self) -> Aabb {
        let of_root = self.inner.first().and_then(|root| root.bounds);
        of_root.unwrap_or_else(|| self.items[0].bounds())
    }

    /// The expected cost as at most so many children.
    fn cost(self, children: usize) -> f32 {
        match self.inner.first() {
            Some(root) => root.costs[children - 1],
            None => leaf_cost(self.items[0].bounds().half_area(), 1),
        }
    }

    /// Lists what stands for this subtree in a node that has room for so many children.
    fn children(self, room: usize, list: &mut Vec<Subtree<'a>>) {
        let [root, inner @ ..] = self.inner else { return list.push(self) };
        let mut room = room;
        while room > 1 && root.shares[room - 1] == 0 {
            room -= 1;
        }
        if room == 1 {
            return list.push(self);
        }
        let left_room = usize::from(root.shares[room - 1]);
        let [left, right] = sides(self.items, inner, root.n_left as usize);
        left.children(left_room, list);
        right.children(room - left_room, list);
    }

    fn is_leaf(self) -> bool {
        self.inner.first().is_none_or(|root| root.is_leaf)
    }
}

/// The tree in lists.
pub(super) struct Flat<'a> {
    corners: &'a [[Vec3; 3]],
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    pub(super) root: Child,
    /// Nodes that may have to wait on the stack.
    pub(super) stack: usize,
}

/// Puts the cheapest wide tree into lists.
pub(super) fn flatten<'a>(tree: Subtree<'_>, corners: &'a [[Vec3; 3]]) -> Flat<'a> {
    let (nodes, blocks) = (Vec::new(), Vec::with_capacity(tree.items.len() / 2));
    let mut flat = Flat { corners, nodes, blocks, root: Child::default(), stack: 0 };
    (flat.root, flat.stack) = flat.add(tree);
    flat
}

impl Flat<'_> {
    /// Adds a subtree; returns it and the stack that its traversal needs at most.
    fn add(&mut self, tree: Subtree<'_>) -> (Child, usize) {
        if tree.is_leaf() {
            return (self.add_leaf(tree.items), 0);
        }
        let mut parts = Vec::with_capacity(WIDTH);
        // A node is made of its two sides with all the room there is.
        let [root, inner @ ..] = tree.inner else { return (self.add_leaf(tree.items), 0) };
        let left_room = usize::from(root.shares[WIDTH - 1]);
        let [left, right] = sides(tree.items, inner, root.n_left as usize);
        left.children(left_room, &mut parts);
        right.children(WIDTH - left_room, &mut parts);

        let index = self.nodes.len();
        self.nodes.push(Node::new(&[]));
        let mut deepest = 0;
        let children: Vec<(Aabb, Child)> = parts
            .into_iter()
            .map(|part| {
                let (child, stack) = self.add(part);
                deepest = deepest.max(stack);
                (part.bounds(), child)
            })
            .collect();
        self.nodes[index] = Node::new(&children);
        // All children are pushed before the nearest is taken off again.
        (Child::inner(index), children.len().max(children.len() - 1 + deepest))
    }

    fn add_leaf(&mut self, items: &[Item]) -> Child {
        let first = self.blocks.len();
        let corners = self.corners;
        for four in items.chunks(BLOCK) {
            let triangles: Vec<_> = four.iter().map(|item| (corners[item.tri as usize], item.tri)).collect();
            self.blocks.push(Block::new(&triangles));
        }
        Child::leaf(first, self.blocks.len() - first)
    }
}
