//! What a solve has found so far.

use crate::Errors;
use lumel_basis::{Field, Identity};

/// All that is needed to continue a solve.
///
/// A resumed solve gets the same bits as an uninterrupted one, because every number that the next step reads is in
/// here as it was. The invariant of every step, with the operator K and direct light e:
///
/// `total = e + K (total − unshot)`
///
/// that is, all light but the unshot has been reflected once more and is counted where it arrived.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolveState {
    /// The basis of all fields; `None` before the first step.
    pub basis: Option<Identity>,
    /// Whether each node could be measured; the others are extrapolated from their neighbours.
    pub valid: Vec<bool>,
    /// What each step brought. Steps that gather bring a bounce each: first direct light, then one bounce, two bounces …
    pub bounces: Vec<Field>,
    /// Estimate of all bounces that were not computed.
    pub tail: Option<Field>,
    /// All light but the direct, measured once more with many rays of their own: a final gather.
    pub gathered: Option<Field>,
    /// How far the sum may be off, where replicates tell.
    pub errors: Option<Errors>,
    /// The nodes that each round of a target error measures, the round that comes next included.
    pub rounds: Vec<Vec<bool>>,
    /// The part of the total that each layer of emitters causes, where layers were asked for.
    pub layers: Vec<Field>,
    /// The total by direction, where that was asked for: further channels beside the same irradiance.
    pub directional: Option<Field>,
    /// The layers by direction, where both were asked for.
    pub directional_layers: Vec<Field>,
}

impl SolveState {
    /// The state before the first step.
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of nodes; 0 before the first step.
    pub fn node_count(&self) -> usize {
        self.bounces.first().map_or(self.valid.len(), Field::node_count)
    }

    /// All light that has arrived, the tail included, rounded once; after a final gather, direct light and what was
    /// gathered.
    pub fn total(&self) -> Field {
        match &self.gathered {
            Some(gathered) => {
                Field::sum(self.node_count(), self.bounces.first().into_iter().chain([gathered]))
            }
            None => Field::sum(self.node_count(), self.bounces.iter().chain(&self.tail)),
        }
    }

    /// The light that surfaces reflect once more into all bounces but the direct light, and into the tail.
    pub fn gatherable(&self) -> Field {
        let Some((last, before)) = self.bounces.split_last() else { return Field::zeros(self.node_count()) };
        // Beyond the last bounce, its light and all later light bounce into the tail.
        let into_tail = self.tail.iter().flat_map(|tail| [last, tail]);
        Field::sum(self.node_count(), before.iter().chain(into_tail))
    }

    /// Light that has arrived but has not been reflected: after gathering, the last bounce. `None` before direct light.
    pub fn unshot(&self) -> Option<&Field> {
        self.bounces.last()
    }

    /// Removes what only a finished solve has: it is made from the bounces.
    pub(crate) fn reopen(&mut self) {
        (self.tail, self.gathered, self.errors) = (None, None, None);
        self.directional = None;
        self.layers.clear();
        self.directional_layers.clear();
    }
}
