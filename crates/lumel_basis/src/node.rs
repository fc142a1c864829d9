//! Names and weights of coefficients.

/// A coefficient of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The index as a `usize`, for slices.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Nodes and their weights; kept between calls so that nothing is allocated per ray.
#[derive(Clone, Debug, Default)]
pub struct NodeWeights(Vec<(NodeId, f32)>);

impl NodeWeights {
    /// Removes all nodes.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a node.
    pub fn push(&mut self, node: NodeId, weight: f32) {
        self.0.push((node, weight));
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The nodes and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, f32)> + '_ {
        self.0.iter().copied()
    }
}
