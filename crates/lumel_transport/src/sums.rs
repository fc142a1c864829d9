//! Measurements before they are divided by their weights.

use glam::DVec3;
use lumel_basis::NodeId;
use smallvec::SmallVec;

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
    /// Weighted share of sites that nobody can see, inside geometry for example; empty unless the source was
    /// [nothing](crate::Source::Nothing).
    pub hidden: Vec<f64>,
}

impl Sums {
    /// No entries yet, with room for some of one channel.
    pub fn with_capacity(entries: usize) -> Self {
        let (nodes, weights) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        Self { nodes, weights, values: Vec::with_capacity(entries), hidden: Vec::new() }
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

    /// Adds an entry for a measurement of all channels.
    pub fn push_channels(&mut self, node: NodeId, weight: f64, values: &[DVec3]) {
        self.nodes.push(node);
        self.weights.push(weight);
        self.values.extend(values.iter().map(|value| *value * weight));
    }

    /// Adds an entry for a measurement of validity alone: the share of sites that nobody can see.
    pub fn push_hidden(&mut self, node: NodeId, weight: f64, share: f64) {
        self.push(node, weight, DVec3::ZERO);
        self.hidden.push(share * weight);
    }

    /// An entry for each node of each element. Where it was only found out what is hidden, the values are the
    /// shares of it.
    pub(crate) fn of_elements(elements: &[ElementSums], are_hidden: bool) -> Self {
        let mut sums = Self::with_capacity(elements.iter().map(|element| element.0.len()).sum());
        for &(node, weight, value) in elements.iter().flat_map(|element| &element.0) {
            sums.nodes.push(node);
            sums.weights.push(weight);
            if are_hidden {
                sums.hidden.push(value.x);
            }
            sums.values.push(if are_hidden { DVec3::ZERO } else { value });
        }
        sums
    }

    /// An entry for each node of each element, of sums by channel of the same measurements.
    pub(crate) fn of_channels(channels: &[Vec<ElementSums>]) -> Self {
        let Some(first) = channels.first() else { return Self::default() };
        let mut all = Self::of_elements(first, false);
        all.values = Vec::with_capacity(channels.len() * all.len());
        for (element, sums) in first.iter().enumerate() {
            for entry in 0..sums.0.len() {
                all.values.extend(channels.iter().map(|sums| sums[element].0[entry].2));
            }
        }
        all
    }
}

/// Sums of the few nodes of one element, whose measurements come one by one; mostly of a triangle's three.
#[derive(Clone, Debug, Default)]
pub(crate) struct ElementSums(SmallVec<[(NodeId, f64, DVec3); 3]>);

impl ElementSums {
    /// Adds a measurement of irradiance; `place` is where the node stands among those of the measurement.
    ///
    /// Measurements of an element mostly count towards the same nodes in the same order.
    #[inline]
    pub(crate) fn add(&mut self, place: usize, node: NodeId, weight: f64, value: DVec3) {
        let value = value * weight;
        let known = match self.0.get(place) {
            Some((known, ..)) if *known == node => Some(place),
            _ => self.0.iter().position(|(known, ..)| *known == node),
        };
        match known {
            Some(place) => {
                let (_, sum_of_weights, sum) = &mut self.0[place];
                *sum_of_weights += weight;
                *sum += value;
            }
            None => self.0.push((node, weight, value)),
        }
    }

    /// Whether nothing was measured.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds what another measurement of the same element has found, with more samples, to the nodes that are here: its
    /// mean, with the weights that are here.
    pub(crate) fn add_means(&mut self, other: &Self) {
        for (node, own, sum) in &mut self.0 {
            if let Some((_, weight, value)) = other.0.iter().find(|(known, ..)| known == node) {
                *sum += *value * (*own / *weight);
            }
        }
    }

    /// Empty sums of so many elements.
    pub(crate) fn some(elements: usize) -> Vec<Self> {
        std::iter::repeat_with(Self::default).take(elements).collect()
    }

    /// Makes some the empty sums of so many elements, in the memory that they have.
    pub(crate) fn reset(some: &mut Vec<Self>, elements: usize) {
        some.iter_mut().for_each(|sums| sums.0.clear());
        some.resize_with(elements, Self::default);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_of_one_element_share_an_entry_per_node() {
        let mut elements = ElementSums::some(2);
        elements[0].add(0, NodeId(1), 1.0, DVec3::ONE);
        elements[1].add(0, NodeId(1), 2.0, DVec3::ONE);
        elements[1].add(0, NodeId(1), 1.0, DVec3::splat(4.0));
        let sums = Sums::of_elements(&elements, false);
        assert_eq!((sums.len(), sums.weights[1], sums.values[1]), (2, 3.0, DVec3::splat(6.0)));
    }

    #[test]
    fn means_of_two_measurements_of_one_element_add_up() {
        let [mut a, mut b] = [ElementSums::default(), ElementSums::default()];
        a.add(0, NodeId(1), 2.0, DVec3::ONE);
        b.add(0, NodeId(7), 1.0, DVec3::ONE);
        b.add(1, NodeId(1), 0.5, DVec3::splat(3.0));
        a.add_means(&b);
        let sums = Sums::of_elements(&[a], false);
        assert_eq!((sums.nodes, sums.weights), (vec![NodeId(1)], vec![2.0]));
        assert_eq!(sums.values, [DVec3::splat(8.0)]);
    }
}
