//! Nodes by place, and their kernels.

use super::cells::{BYTES_PER_CELL, CellTable, Grid};
use super::clearance::Clearance;
use glam::Vec3;
use smallvec::SmallVec;

/// The radius of a kernel in spacings. Of the radii and kernels that were compared, this one with this kernel had the least error for its
/// overlap: eight nodes at a place.
pub(crate) const RADIUS: f32 = 2.0;

/// A node counts at a place if the cosine between their normals is at least this (84°), and the less the more they differ.
const LEAST_COSINE: f32 = 0.1;

/// Nodes at a place for which no memory has to be allocated.
const MOST: usize = 24;

/// Bytes of a node, its share of a cell included: a cell of the grid is 4 spacings wide, and of surfaces that are not flat there may be
/// no more than one node in it, and something beside each.
pub(crate) const BYTES_PER_NODE: u64 =
    (size_of::<Node>() + size_of::<u32>() + size_of::<Clearance>()) as u64 + 4 + BYTES_PER_CELL;

/// Where a node is, and which way the surface faces there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
}

/// The number of the clearance of a node that has none.
const OPEN: u32 = u32::MAX;

/// Nodes, sorted by the cells that they lie in, so that those around a place lie together.
#[derive(Clone, Debug)]
pub(crate) struct NodeGrid {
    /// Of their kernels, metres.
    radius: f32,
    grid: Grid,
    nodes: Vec<Node>,
    /// Which of the clearances each node has; empty if all have none.
    hindered: Vec<u32>,
    clearances: Vec<Clearance>,
    /// Where the nodes of each cell that has any end, by a number for each such cell.
    ends: Vec<u32>,
    numbers: CellTable,
}

/// Nodes and what they weigh, not normalised.
type Overlap = SmallVec<[(u32, f32); MOST]>;

impl NodeGrid {
    /// Sorts samples, so that node number `i` is sample number `i` from now on. Kernels have this radius, metres.
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
        Self { radius, grid, nodes, hindered: Vec::new(), clearances: Vec::new(), ends, numbers }
    }

    /// The same with what stands around each node, in their order.
    pub(crate) fn with_clearances(self, clearances: impl Iterator<Item = Option<Clearance>>) -> Self {
        let mut kept = Vec::new();
        let number = |clearance: Option<Clearance>| {
            clearance.map_or(OPEN, |clearance| {
                kept.push(clearance);
                kept.len() as u32 - 1
            })
        };
        let hindered: Vec<u32> = clearances.map(number).collect();
        let hindered = if kept.is_empty() { Vec::new() } else { hindered };
        Self { hindered, clearances: kept, ..self }
    }

    /// What stands around a node.
    pub(crate) fn clearance(&self, node: usize) -> Option<Clearance> {
        self.clearances.get(*self.hindered.get(node)? as usize).copied()
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

    /// How far behind what stands around a node a place is: it is hidden above 1.
    #[inline]
    fn behind(&self, node: u32, position: Vec3) -> f32 {
        let number = self.hindered.get(node as usize).copied().unwrap_or(OPEN);
        self.clearances.get(number as usize).map_or(0.0, |clearance| {
            let Node { position: here, normal } = self.nodes[node as usize];
            clearance.behind(normal, position - here)
        })
    }

    /// The nodes whose kernels overlap a place that faces some way, with weights that sum to 1. None only where no node is near.
    ///
    /// Those from which something hides the place have none, unless all have: then it is read from the one that it is hidden from least.
    #[inline]
    pub(crate) fn weights_at(&self, position: Vec3, normal: Vec3, mut push: impl FnMut(u32, f32)) {
        let (mut overlap, mut sum) = (Overlap::new(), 0.0);
        let mut least_hidden: Option<(u32, f32)> = None;
        self.for_each_around(position, normal, |node, squared, cosine| {
            if cosine >= LEAST_COSINE {
                let behind = self.behind(node, position);
                if behind <= 1.0 {
                    let weight = kernel(squared) * cosine;
                    sum += weight;
                    overlap.push((node, weight));
                } else if least_hidden.is_none_or(|(_, least)| behind < least) {
                    least_hidden = Some((node, behind));
                }
            }
        });
        if sum > 0.0 {
            let scale = 1.0 / sum;
            return overlap.into_iter().for_each(|(node, weight)| push(node, weight * scale));
        }
        if let Some((node, _)) = least_hidden {
            return push(node, 1.0);
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
