//! Which nodes lie beside each other.

use lumel_basis::{Basis, NodeId};
use lumel_scene::TriId;

/// The nodes that share a triangle with each node, itself included.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// Where the list of each node ends.
    ends: Vec<usize>,
    nodes: Vec<u32>,
}

impl Neighbours {
    /// Those of a basis over so many triangles. Where light is not linear over triangles, a node has only itself.
    pub fn new(basis: &dyn Basis, n_triangles: usize) -> Self {
        let triangles = (0..n_triangles as u32).filter_map(|tri| basis.corner_nodes(TriId(tri)));
        Self::from_triangles(basis.node_count(), triangles)
    }

    /// Those of so many nodes, from the corners of all triangles.
    pub(crate) fn from_triangles(n_nodes: usize, triangles: impl Iterator<Item = [NodeId; 3]>) -> Self {
        let mut pairs: Vec<(u32, u32)> = (0..n_nodes as u32).map(|node| (node, node)).collect();
        for corners in triangles {
            let of_corner = |a: NodeId| corners.map(|b| (a.0, b.0));
            pairs.extend(corners.into_iter().flat_map(of_corner));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut ends = vec![0; n_nodes];
        pairs.iter().for_each(|&(node, _)| ends[node as usize] += 1);
        let mut end = 0;
        for count in &mut ends {
            end += *count;
            *count = end;
        }
        Self { ends, nodes: pairs.into_iter().map(|(_, beside)| beside).collect() }
    }

    /// The nodes beside a node, and that node.
    pub fn of(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let begin = if node == 0 { 0 } else { self.ends[node - 1] };
        self.nodes[begin..self.ends[node]].iter().map(|&node| node as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_node_has_itself_and_those_it_shares_a_triangle_with_once() {
        let triangles = [[0, 1, 2], [2, 1, 3]].map(|corners| corners.map(NodeId));
        let neighbours = Neighbours::from_triangles(5, triangles.into_iter());
        let of = |node| neighbours.of(node).collect::<Vec<_>>();
        assert_eq!(of(0), [0, 1, 2]);
        assert_eq!(of(1), [0, 1, 2, 3]);
        assert_eq!(of(3), [1, 2, 3]);
        assert_eq!(of(4), [4]);
    }
}
