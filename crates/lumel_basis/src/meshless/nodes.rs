//! Nodes by place, and their kernels.

use super::cells::{BYTES_PER_CELL, CellTable, Grid};
use super::scatter::SurfaceSample;
use glam::Vec3;
use smallvec::SmallVec;

/// The radius of a kernel in spacings. Of the radii and kernels that were compared, this one with this kernel had the least error for its
/// overlap: eight nodes at a place.
const RADIUS: f32 = 2.0;

/// A node counts at a place if the cosine between their normals is at least this (84°), and the less the more they differ.
const LEAST_COSINE: f32 = 0.1;

/// Nodes at a place for which no memory has to be allocated.
const MOST: usize = 24;

/// Bytes of a node, its share of a cell included: a cell of the grid is 4 spacings wide, and of surfaces that are not flat there may be
/// no more than one node in it.
pub(crate) const BYTES_PER_NODE: u64 = size_of::<Node>() as u64 + 4 + BYTES_PER_CELL;

/// Where a node is, and which way the surface faces there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
}

/// Nodes, sorted by the cells that they lie in, so that those around a place lie together.
#[derive(Clone, Debug)]
pub(crate) struct NodeGrid {
    /// Of their kernels, metres.
    radius: f32,
    grid: Grid,
    nodes: Vec<Node>,
    /// Where the nodes of each cell that has any end, by a number for each such cell.
    ends: Vec<u32>,
    numbers: CellTable,
}

/// Nodes and what they weigh, not normalised.
type Overlap = SmallVec<[(u32, f32); MOST]>;

impl NodeGrid {
    /// Sorts samples, so that node number `i` is sample number `i` from now on.
    pub(crate) fn new(origin: Vec3, spacing: f32, samples: &mut [SurfaceSample]) -> Self {
        let node = |sample: &SurfaceSample| Node { position: sample.position, normal: sample.normal };
        Self::of_radius(origin, RADIUS * spacing, samples, node)
    }

    /// The same of anything that is a node, with kernels of a radius.
    pub(crate) fn of_radius<T>(
        origin: Vec3,
        radius: f32,
        samples: &mut [T],
        node: impl Fn(&T) -> Node,
    ) -> Self {
        let grid = Grid::new(origin, radius);
        // Stable, so that nodes of a cell keep their order.
        samples.sort_by_cached_key(|sample| grid.cell(node(sample).position));
        let nodes: Vec<Node> = samples.iter().map(node).collect();
        let (mut ends, mut numbers) = (Vec::new(), CellTable::default());
        let mut end = 0;
        for same in nodes.chunk_by(|a, b| grid.cell(a.position) == grid.cell(b.position)) {
            numbers.insert(grid.cell(same[0].position), ends.len() as u32);
            end += same.len() as u32;
            ends.push(end);
        }
        Self { radius, grid, nodes, ends, numbers }
    }

    /// The radius of kernels, metres.
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// Calls back with each node within the radius of a kernel of a place, its squared distance over that of the radius, and the
    /// cosine between its normal and another.
    #[inline]
    fn for_each_around(&self, position: Vec3, normal: Vec3, mut each: impl FnMut(u32, f32, f32)) {
        let per_radius = 1.0 / (self.radius * self.radius);
        for number in self.grid.around(position).into_iter().filter_map(|cell| self.numbers.get(cell)) {
            let number = number as usize;
            let begin = if number == 0 { 0 } else { self.ends[number - 1] };
            for (i, node) in (begin..).zip(&self.nodes[begin as usize..self.ends[number] as usize]) {
                let squared = node.position.distance_squared(position) * per_radius;
                if squared < 1.0 {
                    each(i, squared, node.normal.dot(normal));
                }
            }
        }
    }

    /// The nodes whose kernels overlap a place that faces some way, with weights that sum to 1. None only where no node is near.
    #[inline]
    pub(crate) fn weights_at(&self, position: Vec3, normal: Vec3, mut push: impl FnMut(u32, f32)) {
        let (mut overlap, mut sum) = (Overlap::new(), 0.0);
        self.for_each_around(position, normal, |node, squared, cosine| {
            if cosine >= LEAST_COSINE {
                let weight = kernel(squared) * cosine;
                sum += weight;
                overlap.push((node, weight));
            }
        });
        if sum > 0.0 {
            let scale = 1.0 / sum;
            return overlap.into_iter().for_each(|(node, weight)| push(node, weight * scale));
        }
        // Where normals turn within a spacing: the node that faces most alike.
        let mut nearest = None;
        self.for_each_around(position, normal, |node, _, cosine| {
            if nearest.is_none_or(|(_, most)| cosine > most) {
                nearest = Some((node, cosine));
            }
        });
        nearest.into_iter().for_each(|(node, _)| push(node, 1.0));
    }

    /// The pairs of nodes whose kernels overlap at both, each once.
    pub(crate) fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for (i, node) in (0..).zip(&self.nodes) {
            self.for_each_around(node.position, node.normal, |other, _, cosine| {
                if i < other && cosine >= LEAST_COSINE {
                    pairs.push([i, other]);
                }
            });
        }
        pairs
    }
}

/// The cubic kernel 1 − 3t² + 2t³ of t², from 1 at the node to 0 at its radius.
#[inline]
fn kernel(squared: f32) -> f32 {
    squared * (2.0 * squared.sqrt() - 3.0) + 1.0
}
