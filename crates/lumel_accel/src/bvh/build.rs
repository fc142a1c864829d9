//! Building the binary tree: binned surface area heuristic, top down, to single triangles.

use super::collapse::{Binary, Flat, Subtree, flatten};
use super::item::Item;
use glam::{Vec3, Vec3A};

/// The most nodes that may wait to be visited. A tree that would need more is rebuilt balanced: then 32 levels
/// hold 2^32 triangles, and a step down leaves seven siblings behind.
pub(crate) const MAX_STACK: usize = 256;

/// Cuts tried per axis; ranges of fewer triangles have as many as triangles, but not under [`MIN_BINS`].
const MAX_BINS: usize = 32;
const MIN_BINS: usize = 4;
/// Boxes are this much larger than their triangles, relative to the largest coordinate, and by a step of rounding at least:
/// a ray that runs exactly in the side of a box must count as inside it. It leaves the padding after a million times the
/// length of the scene, as no component of a direction counts as smaller than 1e-18. More would let rays that start just
/// above a triangle start inside its box.
const BOX_PADDING: f32 = 1e-12;
/// Below this a range is not worth another thread.
const MIN_PARALLEL: usize = 4096;

/// How a range of triangles is split.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rule {
    /// Where the expected cost of a ray is least.
    SurfaceArea,
    /// In halves.
    Balanced,
}

/// The wide tree over the finite ones of these triangles; `None` if there are none.
pub(super) fn build(corners: &[[Vec3; 3]]) -> Option<Flat<'_>> {
    let largest = corners
        .as_flattened()
        .iter()
        .filter(|p| p.is_finite())
        .fold(0.0, |m: f32, p| m.max(p.abs().max_element()));
    let padding = Vec3A::splat(BOX_PADDING * largest);
    let mut items: Vec<Item> =
        corners.iter().enumerate().filter_map(|(i, c)| Item::new(i as u32, c, padding)).collect();
    if items.is_empty() {
        return None;
    }
    let mut tree = |rule| {
        let mut inner = vec![Binary::default(); items.len() - 1];
        split(&mut items, &mut inner, rule);
        flatten(Subtree { items: &items, inner: &inner }, corners)
    };
    let mut flat = tree(Rule::SurfaceArea);
    if flat.stack > MAX_STACK {
        // A scene whose triangles shrink again and again can make a list of the tree.
        flat = tree(Rule::Balanced);
    }
    Some(flat)
}

/// Sorts the items into the order of leaves and writes the subtree's inner nodes, of which there is one fewer.
fn split(items: &mut [Item], inner: &mut [Binary], rule: Rule) {
    let [node, inner @ ..] = inner else { return };
    let cut = match rule {
        Rule::SurfaceArea => best_cut(items).map(|cut| partition(items, |item| cut.goes_left(item))),
        Rule::Balanced => None,
    };
    // All centres coincide, or the halves are to be equal.
    let n_left = cut.unwrap_or(items.len() / 2);
    {
        let parallel = items.len() >= MIN_PARALLEL;
        let (left, right) = items.split_at_mut(n_left);
        let (left_inner, right_inner) = inner.split_at_mut(n_left - 1);
        if parallel {
            rayon::join(|| split(left, left_inner, rule), || split(right, right_inner, rule));
        } else {
            split(left, left_inner, rule);
            split(right, right_inner, rule);
        }
    }
    *node = Binary::over(items, inner, n_left);
}

/// A plane that halves a range.
struct Cut {
    axis: usize,
    start: f32,
    scale: f32,
    n_bins: usize,
    /// The first bin on the right.
    bin: usize,
    /// Sum over both sides of half the area times the number of triangles.
    cost: f32,
}

impl Cut {
    fn goes_left(&self, item: &Item) -> bool {
        bin((item.center()[self.axis] - self.start) * self.scale, self.n_bins) < self.bin
    }
}

fn bin(place: f32, n_bins: usize) -> usize {
    (place as usize).min(n_bins - 1)
}

#[derive(Clone, Copy)]
struct Bin {
    min: Vec3A,
    max: Vec3A,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY, count: 0 };

    #[inline]
    fn add(&mut self, min: Vec3A, max: Vec3A, count: u32) {
        self.min = self.min.min(min);
        self.max = self.max.max(max);
        self.count += count;
    }

    #[inline]
    fn cost(&self) -> f32 {
        let d = self.max - self.min;
        (d.x * d.y + d.y * d.z + d.z * d.x) * self.count as f32
    }
}

/// The best plane that has triangles on both sides.
fn best_cut(items: &[Item]) -> Option<Cut> {
    let (mut start, mut end) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for item in items {
        start = start.min(item.center());
        end = end.max(item.center());
    }
    let n_bins = items.len().clamp(MIN_BINS, MAX_BINS);
    let scale = n_bins as f32 / (end - start);
    let mut bins = [[Bin::EMPTY; MAX_BINS]; 3];
    // An axis without extent has an infinite scale: its places are NaN, which is bin 0.
    for item in items {
        let place = (item.center() - start) * scale;
        for axis in 0..3 {
            bins[axis][bin(place[axis], n_bins)].add(item.min, item.max, 1);
        }
    }
    let mut best: Option<Cut> = None;
    for axis in (0..3).filter(|&axis| scale[axis].is_finite()) {
        let (cost, bin) = best_of_axis(&bins[axis][..n_bins]);
        // Of equal planes the first axis and the lowest bin are kept: the tree has one answer.
        if cost.is_finite() && best.as_ref().is_none_or(|b| cost < b.cost) {
            best = Some(Cut { axis, start: start[axis], scale: scale[axis], n_bins, bin, cost });
        }
    }
    best
}

fn best_of_axis(bins: &[Bin]) -> (f32, usize) {
    let mut right_cost = [f32::INFINITY; MAX_BINS];
    let mut right = Bin::EMPTY;
    for k in (1..bins.len()).rev() {
        right.add(bins[k].min, bins[k].max, bins[k].count);
        if right.count > 0 {
            right_cost[k] = right.cost();
        }
    }
    let mut best = (f32::INFINITY, 0);
    let mut left = Bin::EMPTY;
    for k in 1..bins.len() {
        left.add(bins[k - 1].min, bins[k - 1].max, bins[k - 1].count);
        if left.count > 0 {
            let cost = left.cost() + right_cost[k];
            if cost < best.0 {
                best = (cost, k);
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
