//! Building the tree: binned surface area heuristic, top down.

use super::{Bvh, Child, Leaf, LeafTriangle, MAX_STACK, Node, WIDTH};
use glam::{Vec3, Vec4};
use lumel_scene::TriId;

const N_BINS: usize = 32;
/// Relative to the cost of testing one triangle.
const STEP_COST: f32 = 1.0;
const MAX_LEAF: usize = 8;
/// Boxes are this much larger than their triangles, relative to the largest coordinate: a ray that runs exactly in
/// the side of a box must count as inside it.
const BOX_PADDING: f32 = f32::EPSILON;
/// Below this a range is not worth another thread.
const MIN_PARALLEL: usize = 4096;

#[derive(Clone, Copy)]
struct Item {
    bounds: Aabb,
    /// Twice the centre of the bounds.
    center: Vec3,
    tri: u32,
}

/// How a range of triangles is split.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rule {
    /// Where the expected cost of a ray is least.
    SurfaceArea,
    /// In halves.
    Balanced,
}

enum Tree {
    Leaf { bounds: Aabb, first: usize, count: usize },
    Inner { bounds: Aabb, children: Box<[Tree; 2]> },
}

impl Tree {
    fn bounds(&self) -> Aabb {
        match self {
            Self::Leaf { bounds, .. } | Self::Inner { bounds, .. } => *bounds,
        }
    }
}

pub(super) fn build(corners: &[[Vec3; 3]]) -> Bvh {
    let largest = corners
        .as_flattened()
        .iter()
        .filter(|p| p.is_finite())
        .fold(0.0, |m: f32, p| m.max(p.abs().max_element()));
    let padding = BOX_PADDING * largest;
    let mut items: Vec<Item> =
        corners.iter().enumerate().filter_map(|(i, c)| item(i as u32, c, padding)).collect();
    if items.is_empty() {
        return Bvh { nodes: Vec::new(), leaves: Vec::new(), root: Child::default(), triangles: Vec::new() };
    }
    let mut flat = flatten(&subtree(&mut items, 0, Rule::SurfaceArea));
    if flat.stack > MAX_STACK {
        // A scene whose triangles shrink again and again can make a list of the tree.
        flat = flatten(&subtree(&mut items, 0, Rule::Balanced));
    }
    let leaf = |item: &Item| LeafTriangle { corners: corners[item.tri as usize], tri: TriId(item.tri) };
    Bvh {
        nodes: flat.nodes,
        leaves: flat.leaves,
        root: flat.root,
        triangles: items.iter().map(leaf).collect(),
    }
}

/// Triangles that are not finite cannot be met, and their boxes would spoil the tree.
fn item(tri: u32, corners: &[Vec3; 3], padding: f32) -> Option<Item> {
    corners.iter().all(|p| p.is_finite()).then(|| {
        let around = |p: Vec3| Aabb { min: p - padding, max: p + padding };
        let bounds = corners.iter().fold(Aabb::EMPTY, |b, &p| b.union(around(p)));
        // Halved first: doubled coordinates could overflow.
        Item { bounds, center: 0.5 * bounds.min + 0.5 * bounds.max, tri }
    })
}

/// Builds the subtree of `items`, which start at `first` in the whole list, and sorts them into leaf order.
fn subtree(items: &mut [Item], first: usize, rule: Rule) -> Tree {
    let bounds = items.iter().fold(Aabb::EMPTY, |b, item| b.union(item.bounds));
    let Some(middle) = split(items, bounds, rule) else {
        return Tree::Leaf { bounds, first, count: items.len() };
    };
    let parallel = items.len() >= MIN_PARALLEL;
    let (left, right) = items.split_at_mut(middle);
    let build = |items: &mut [Item], first| subtree(items, first, rule);
    let (left, right) = if parallel {
        rayon::join(|| build(left, first), || build(right, first + middle))
    } else {
        (build(left, first), build(right, first + middle))
    };
    Tree::Inner { bounds, children: Box::new([left, right]) }
}

/// Partitions the items in two and returns where, or `None` for a leaf.
fn split(items: &mut [Item], bounds: Aabb, rule: Rule) -> Option<usize> {
    if items.len() <= 1 {
        return None;
    }
    let best = if rule == Rule::SurfaceArea { best_plane(items) } else { None };
    let leaf_cost = items.len() as f32;
    if let Some(plane) = best {
        let cost = STEP_COST + plane.cost / bounds.half_area().max(f32::MIN_POSITIVE);
        if cost < leaf_cost || items.len() > MAX_LEAF {
            return Some(partition(items, |item| plane.bins.of(item) < plane.bin));
        }
        return None;
    }
    // All centres coincide, or the halves are to be equal.
    (items.len() > MAX_LEAF).then_some(items.len() / 2)
}

/// How one axis is cut into bins.
struct Bins {
    axis: usize,
    start: f32,
    scale: f32,
}

impl Bins {
    fn of(&self, item: &Item) -> usize {
        (((item.center[self.axis] - self.start) * self.scale) as usize).min(N_BINS - 1)
    }
}

struct Plane {
    bins: Bins,
    /// The first bin on the right.
    bin: usize,
    /// Sum over both sides of half the area times the number of triangles.
    cost: f32,
}

fn best_plane(items: &[Item]) -> Option<Plane> {
    let centers = items.iter().fold(Aabb::EMPTY, |b, i| b.union(Aabb { min: i.center, max: i.center }));
    let mut best: Option<Plane> = None;
    for axis in 0..3 {
        let extent = centers.max[axis] - centers.min[axis];
        let bins = Bins { axis, start: centers.min[axis], scale: N_BINS as f32 / extent };
        if !(extent > 0.0 && bins.scale.is_finite()) {
            continue;
        }
        let (cost, bin) = best_cut(items, &bins);
        // Of equal planes the first axis and the lowest bin are kept: the tree has one answer.
        if cost.is_finite() && best.as_ref().is_none_or(|b| cost < b.cost) {
            best = Some(Plane { bins, bin, cost });
        }
    }
    best
}

fn best_cut(items: &[Item], bins: &Bins) -> (f32, usize) {
    let mut bounds = [Aabb::EMPTY; N_BINS];
    let mut counts = [0usize; N_BINS];
    for item in items {
        let bin = bins.of(item);
        bounds[bin] = bounds[bin].union(item.bounds);
        counts[bin] += 1;
    }
    let mut right_cost = [0.0; N_BINS];
    let (mut area, mut count) = (Aabb::EMPTY, 0);
    for bin in (1..N_BINS).rev() {
        area = area.union(bounds[bin]);
        count += counts[bin];
        right_cost[bin] = if count > 0 { area.half_area() * count as f32 } else { f32::INFINITY };
    }
    let mut best = (f32::INFINITY, 0);
    let (mut area, mut count) = (Aabb::EMPTY, 0);
    for bin in 1..N_BINS {
        area = area.union(bounds[bin - 1]);
        count += counts[bin - 1];
        if count > 0 {
            let cost = area.half_area() * count as f32 + right_cost[bin];
            if cost < best.0 {
                best = (cost, bin);
            }
        }
    }
    best
}

/// Moves items for which `goes_left` holds to the front and returns their number.
fn partition(items: &mut [Item], goes_left: impl Fn(&Item) -> bool) -> usize {
    let mut n_left = 0;
    for i in 0..items.len() {
        if goes_left(&items[i]) {
            items.swap(n_left, i);
            n_left += 1;
        }
    }
    n_left
}

/// The tree in lists.
struct Flat {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    root: Child,
    /// Nodes that may have to wait on the stack.
    stack: usize,
}

/// Collapses the binary tree into nodes of four and puts them into lists.
fn flatten(tree: &Tree) -> Flat {
    let mut flat = Flat { nodes: Vec::new(), leaves: Vec::new(), root: Child::default(), stack: 0 };
    (flat.root, flat.stack) = flat.add(tree);
    flat
}

impl Flat {
    /// Adds a subtree; returns it and the stack that its traversal needs at most.
    fn add(&mut self, tree: &Tree) -> (Child, usize) {
        match tree {
            Tree::Leaf { first, count, .. } => {
                self.leaves.push(Leaf { first: *first as u32, count: *count as u32 });
                (Child::leaf(self.leaves.len() - 1), 0)
            }
            Tree::Inner { children, .. } => {
                let children = widest(children);
                let index = self.nodes.len();
                self.nodes.push(Node::EMPTY);
                let mut deepest = 0;
                for (lane, child) in children.iter().enumerate() {
                    let (flat, stack) = self.add(child);
                    self.nodes[index].set_bounds(lane, child.bounds());
                    self.nodes[index].children[lane] = flat;
                    deepest = deepest.max(stack);
                }
                // All children are pushed before the nearest is taken off again.
                (Child(index as u32), children.len().max(children.len() - 1 + deepest))
            }
        }
    }
}

/// Replaces the largest inner child by its own two children until there are enough.
///
/// What a ray is most likely to meet is what is worth testing a level earlier.
fn widest(children: &[Tree; 2]) -> Vec<&Tree> {
    let mut wide: Vec<&Tree> = children.iter().collect();
    while wide.len() < WIDTH {
        let inner = wide.iter().enumerate().filter(|(_, tree)| matches!(tree, Tree::Inner { .. }));
        let largest = inner.max_by(|a, b| a.1.bounds().half_area().total_cmp(&b.1.bounds().half_area()));
        let Some((lane, Tree::Inner { children, .. })) = largest else { break };
        wide[lane] = &children[0];
        wide.push(&children[1]);
    }
    wide
}

impl Node {
    /// Boxes turned inside out: entered after they are left, by any ray. Finite, so that no slab distance is NaN.
    const EMPTY: Self =
        Self { bounds: [[Vec4::splat(1e30), Vec4::splat(-1e30)]; 3], children: [Child(0); WIDTH] };

    fn set_bounds(&mut self, lane: usize, bounds: Aabb) {
        for axis in 0..3 {
            self.bounds[axis][0][lane] = bounds.min[axis];
            self.bounds[axis][1][lane] = bounds.max[axis];
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Aabb {
    min: Vec3,
    max: Vec3,
}

impl Aabb {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn half_area(self) -> f32 {
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}
