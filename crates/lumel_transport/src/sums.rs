//! Measurements before they are divided by their weights.

use glam::DVec3;
use lumel_basis::NodeId;

/// Weighted sums of measurements, by node: plain data that merges by adding.
///
/// Entry `i` says that measurements of `nodes[i]` with the total weight `weights[i]` add up to `values[i]`. Nodes may occur
/// more than once. The order of entries is that of the elements that were measured, so that sums which are merged in the
/// order of their chunks have the same bits, whoever measured them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sums {
    /// The node of each entry.
    pub nodes: Vec<NodeId>,
    /// Sum of the weights.
    pub weights: Vec<f64>,
    /// Weighted sum of what was measured, W·m⁻²: as many values per entry as the operator has channels, side by side.
    pub values: Vec<DVec3>,
    /// Weighted share of hemisphere rays that met the back of a surface; empty unless the source was
    /// [nothing](crate::Source::Nothing).
    pub back_faces: Vec<f64>,
}

impl Sums {
    /// Number of entries.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether nothing was measured.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Adds an entry for a measurement of irradiance.
    pub fn push(&mut self, node: NodeId, weight: f64, value: DVec3) {
        self.nodes.push(node);
        self.weights.push(weight);
        self.values.push(value * weight);
    }

    /// Adds an entry for a measurement of validity alone: the share of rays that met back faces.
    pub fn push_back_faces(&mut self, node: NodeId, weight: f64, share: f64) {
        self.push(node, weight, DVec3::ZERO);
        self.back_faces.push(share * weight);
    }

    /// Adds a measurement of irradiance to the entry of its node from entry `first` on, or as a new one.
    ///
    /// For the few nodes of one element; looks through all entries from `first`.
    pub fn add_from(&mut self, first: usize, node: NodeId, weight: f64, value: DVec3) {
        match self.nodes[first..].iter().position(|&known| known == node) {
            Some(i) => {
                self.weights[first + i] += weight;
                self.values[first + i] += value * weight;
            }
            None => self.push(node, weight, value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_of_one_element_share_an_entry_per_node() {
        let mut sums = Sums::default();
        sums.push(NodeId(1), 1.0, DVec3::ONE);
        sums.add_from(1, NodeId(1), 2.0, DVec3::ONE);
        sums.add_from(1, NodeId(1), 1.0, DVec3::splat(4.0));
        assert_eq!((sums.len(), sums.weights[1], sums.values[1]), (2, 3.0, DVec3::splat(6.0)));
    }
}
