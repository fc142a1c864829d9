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
    /// No entries yet, with room for some of one channel.
    pub fn with_capacity(entries: usize) -> Self {
        let (nodes, weights) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        Self { nodes, weights, values: Vec::with_capacity(entries), back_faces: Vec::new() }
    }

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

    /// Adds an entry for each node of an element, and empties the element.
    pub(crate) fn append(&mut self, element: &mut ElementSums) {
        for (node, weight, value) in element.0.drain(..) {
            self.nodes.push(node);
            self.weights.push(weight);
            self.values.push(value);
        }
    }
}

/// Sums of the few nodes of one element, whose measurements come one by one.
#[derive(Debug, Default)]
pub(crate) struct ElementSums(Vec<(NodeId, f64, DVec3)>);

impl ElementSums {
    /// Adds a measurement of irradiance.
    #[inline]
    pub(crate) fn add(&mut self, node: NodeId, weight: f64, value: DVec3) {
        let value = value * weight;
        match self.0.iter_mut().find(|(known, ..)| *known == node) {
            Some((_, sum_of_weights, sum)) => {
                *sum_of_weights += weight;
                *sum += value;
            }
            None => self.0.push((node, weight, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_of_one_element_share_an_entry_per_node() {
        let (mut sums, mut element) = (Sums::default(), ElementSums::default());
        sums.push(NodeId(1), 1.0, DVec3::ONE);
        element.add(NodeId(1), 2.0, DVec3::ONE);
        element.add(NodeId(1), 1.0, DVec3::splat(4.0));
        sums.append(&mut element);
        assert_eq!((sums.len(), sums.weights[1], sums.values[1]), (2, 3.0, DVec3::splat(6.0)));
        sums.append(&mut element);
        assert_eq!(sums.len(), 2);
    }
}
