//! Which nodes are next to each other.

use crate::{Field, NodeId};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// So many nodes of a ring are computed at a time.
const AT_A_TIME: usize = 1024;

/// The nodes next to each node, symmetric, in compressed rows.
///
/// One graph serves everything that looks beside a node: extrapolation, pooled variance, previews. The weight of two
/// neighbours is the number of cells (triangles, for vertices) that they share.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjacency {
    /// Where the row of each node ends.
    ends: Vec<u32>,
    /// Each row in ascending order, the node itself included.
    nodes: Vec<NodeId>,
    weights: Vec<u16>,
}

impl Adjacency {
    /// The graph of `n_nodes` nodes in which all nodes of a cell are neighbours.
    pub fn from_cells<const N: usize>(
        n_nodes: usize,
        cells: impl Iterator<Item = [NodeId; N]> + Clone,
    ) -> Self {
        let pairs =
            || cells.clone().flat_map(|cell| cell.into_iter().flat_map(move |a| cell.map(|b| (a, b))));
        let pairs = || pairs().filter(|(a, b)| a != b);
        // Every node is in its own row, with or without cells.
        let mut lengths = vec![1u32; n_nodes];
        pairs().for_each(|(node, _)| lengths[node.index()] += 1);
        let mut rows: Vec<NodeId> = Vec::with_capacity(lengths.iter().sum::<u32>() as usize);
        let mut next = Vec::with_capacity(n_nodes);
        for (node, &length) in (0..).map(NodeId).zip(&lengths) {
            next.push(rows.len() + 1);
            rows.extend(std::iter::repeat_n(node, length as usize));
        }
        for (node, neighbour) in pairs() {
            let next = &mut next[node.index()];
            rows[*next] = neighbour;
            *next += 1;
        }
        // Inside a surface, two cells share an edge.
        let some = rows.len() / 2 + n_nodes;
        let (nodes, weights) = (Vec::with_capacity(some), Vec::with_capacity(some));
        let mut adjacency = Self { ends: Vec::with_capacity(n_nodes), nodes, weights };
        let mut rest = rows.as_mut_slice();
        for &length in &lengths {
            let (row, after) = rest.split_at_mut(length as usize);
            rest = after;
            row.sort_unstable();
            for same in row.chunk_by(|a, b| a == b) {
                adjacency.nodes.push(same[0]);
                adjacency.weights.push(u16::try_from(same.len()).unwrap_or(u16::MAX));
            }
            adjacency.ends.push(adjacency.nodes.len() as u32);
        }
        adjacency
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.ends.len()
    }

    fn row(&self, node: NodeId) -> std::ops::Range<usize> {
        let begin = if node.0 == 0 { 0 } else { self.ends[node.index() - 1] };
        begin as usize..self.ends[node.index()] as usize
    }

    /// The nodes next to a node and their weights, in ascending order, without the node itself.
    pub fn neighbours(&self, node: NodeId) -> impl Iterator<Item = (NodeId, f64)> + '_ {
        let row = self.row(node);
        let weights = self.weights[row.clone()].iter().map(|&weight| f64::from(weight));
        self.nodes[row].iter().copied().zip(weights).filter(move |(neighbour, _)| *neighbour != node)
    }

    /// A node and the nodes next to it, in ascending order.
    pub fn neighbourhood(&self, node: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        self.nodes[self.row(node)].iter().copied()
    }

    /// Gives nodes that are not `known` the weighted mean of their known neighbours, ring by ring.
    ///
    /// Each ring is computed from the rings before it, so the result does not depend on any order. A node is visited
    /// once, however many rings there are. Returns which nodes have a value now; the others, which no known node is
    /// connected to, keep the value they had.
    pub fn extrapolate(&self, field: &mut Field, known: &[bool]) -> Vec<bool> {
        let mut known = known.to_vec();
        if !known.contains(&false) {
            return known;
        }
        let queued: Vec<AtomicBool> = known.iter().map(|&known| AtomicBool::new(known)).collect();
        // Who finds a node first makes no difference: all of a ring is computed from those before it. Most were found before, and to
        // read that is cheaper than to swap.
        let is_new = |node: &NodeId| {
            let queued = &queued[node.index()];
            !queued.load(Ordering::Relaxed) && !queued.swap(true, Ordering::Relaxed)
        };
        let mut ring: Vec<NodeId> =
            (0..known.len() as u32).map(NodeId).filter(|n| known[n.index()]).collect();
        let mut means = Vec::new();
        while !ring.is_empty() {
            let beside = ring.par_iter().flat_map_iter(|&node| self.neighbourhood(node).filter(is_new));
            let next: Vec<NodeId> = beside.collect();
            means.resize(next.len() * field.channels(), Vec3::ZERO);
            let parts = means.par_chunks_mut(AT_A_TIME * field.channels()).zip(next.par_chunks(AT_A_TIME));
            parts.for_each(|(means, nodes)| {
                let means = means.chunks_exact_mut(field.channels());
                means.zip(nodes).for_each(|(mean, &node)| self.mean(field, &known, node, mean));
            });
            for (&node, mean) in next.iter().zip(means.chunks_exact(field.channels())) {
                field.coefficients_mut(node).copy_from_slice(mean);
                known[node.index()] = true;
            }
            ring = next;
        }
        known
    }

    /// [Extrapolates](Self::extrapolate) and makes what remains without a value zero.
    pub fn complete(&self, field: &mut Field, known: &[bool]) {
        let known = self.extrapolate(field, known);
        for (node, _) in (0u32..).zip(&known).filter(|(_, known)| !**known) {
            field.coefficients_mut(NodeId(node)).fill(Vec3::ZERO);
        }
    }

    fn mean(&self, field: &Field, known: &[bool], node: NodeId, mean: &mut [Vec3]) {
        let known = || self.neighbours(node).filter(|(neighbour, _)| known[neighbour.index()]);
        for (channel, mean) in mean.iter_mut().enumerate() {
            let (mut sum, mut all) = (DVec3::ZERO, 0.0);
            for (neighbour, weight) in known() {
                sum += field.coefficients(neighbour)[channel].as_dvec3() * weight;
                all += weight;
            }
            *mean = (sum / all).as_vec3();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adjacency(n_nodes: usize, cells: &[[u32; 3]]) -> Adjacency {
        Adjacency::from_cells(n_nodes, cells.iter().map(|cell| cell.map(NodeId)))
    }

    #[test]
    fn neighbours_share_a_cell_and_weigh_as_many_as_they_share() {
        let adjacency = adjacency(5, &[[0, 1, 2], [2, 1, 3]]);
        let of = |node| adjacency.neighbours(NodeId(node)).map(|(n, w)| (n.0, w)).collect::<Vec<_>>();
        assert_eq!(of(0), [(1, 1.0), (2, 1.0)]);
        assert_eq!(of(1), [(0, 1.0), (2, 2.0), (3, 1.0)]);
        assert_eq!(of(4), []);
        assert!(adjacency.neighbourhood(NodeId(1)).map(|n| n.0).eq([0, 1, 2, 3]));
        assert!(adjacency.neighbourhood(NodeId(4)).map(|n| n.0).eq([4]));
    }

    #[test]
    fn each_ring_is_the_mean_of_the_rings_before_it() {
        // A strip: 0 and 1 are known, 2 and 3 follow them, then 4; 5 is apart.
        let adjacency = adjacency(6, &[[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let value = |x: f32| Vec3::splat(x);
        let mut field = Field::from_values([1.0, 3.0, 0.0, 0.0, 0.0, 7.0].map(value).to_vec());
        let known = adjacency.extrapolate(&mut field, &[true, true, false, false, false, false]);
        assert_eq!(known, [true, true, true, true, true, false]);
        // 2 shares one triangle with 0 and two with 1; 3 shares one with 1.
        let expected = [1.0, 3.0, 7.0 / 3.0, 3.0, 8.0 / 3.0, 7.0].map(value);
        assert!(field.values().iter().zip(expected).all(|(a, b)| (*a - b).length() < 1e-6), "{field:?}");
        adjacency.complete(&mut field, &known);
        assert_eq!(field.node(NodeId(5)).0, Vec3::ZERO);
    }
}
