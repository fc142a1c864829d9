//! Which cells touch each node.

use crate::NodeId;

/// The cells that touch each node, in ascending order, in compressed rows.
pub(super) struct Incidence {
    /// Where the row of each node ends.
    ends: Vec<u32>,
    cells: Vec<u32>,
}

impl Incidence {
    /// Of `n_cells` cells with these nodes. A cell that has a node twice is in its row once.
    pub(super) fn new<const N: usize>(
        n_nodes: usize,
        n_cells: usize,
        nodes_of: impl Fn(usize) -> [NodeId; N],
    ) -> Self {
        let once = |cell: usize| {
            let nodes = nodes_of(cell);
            (0..N).filter(move |&k| !nodes[..k].contains(&nodes[k])).map(move |k| nodes[k].index())
        };
        let mut ends = vec![0u32; n_nodes];
        (0..n_cells).flat_map(once).for_each(|node| ends[node] += 1);
        let mut sum = 0;
        for end in &mut ends {
            // Where the row begins; filling it moves this to its end.
            let begin = sum;
            sum += *end;
            *end = begin;
        }
        let mut cells = vec![0; sum as usize];
        for cell in 0..n_cells {
            for node in once(cell) {
                cells[ends[node] as usize] = cell as u32;
                ends[node] += 1;
            }
        }
        Self { ends, cells }
    }

    /// The cells that touch a node.
    pub(super) fn of(&self, node: NodeId) -> impl Iterator<Item = usize> + '_ {
        let begin = if node.0 == 0 { 0 } else { self.ends[node.index() - 1] };
        let row = &self.cells[begin as usize..self.ends[node.index()] as usize];
        row.iter().map(|&cell| cell as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_node_has_its_cells_once_and_in_order() {
        let cells = [[3, 0], [1, 1], [1, 3]].map(|cell: [u32; 2]| cell.map(NodeId));
        let incidence = Incidence::new(5, cells.len(), |cell| cells[cell]);
        let of = |node| incidence.of(NodeId(node)).collect::<Vec<_>>();
        assert_eq!([0, 1, 2, 3, 4].map(of), [vec![0], vec![1, 2], vec![], vec![0, 2], vec![]]);
    }
}
