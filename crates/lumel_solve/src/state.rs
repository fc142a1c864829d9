//! What a solve has found so far.

use crate::Errors;
use lumel_basis::Field;

/// The bounces that have been computed; all that is needed to go on.
///
/// A resumed solve gets the same bits as an uninterrupted one, because every number that the next step reads is in
/// here as it was.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveState {
    /// Whether each node could be measured; the others got the mean of their neighbours.
    pub valid: Vec<bool>,
    /// Irradiance that each bounce brought: first direct light, then one bounce, two bounces …
    pub bounces: Vec<Field>,
    /// Estimate of all bounces that were not computed.
    pub tail: Option<Field>,
    /// All light but the direct, measured once more with many rays of their own: a final gather.
    pub gathered: Option<Field>,
    /// How far the sum may be off, where replicates tell.
    pub errors: Option<Errors>,
}

impl SolveState {
    /// The state before the first step.
    pub fn new() -> Self {
        Self { valid: Vec::new(), bounces: Vec::new(), tail: None, gathered: None, errors: None }
    }

    /// The sum of all bounces and the tail, rounded once; after a final gather, of direct light and what it gathered.
    pub fn total(&self) -> Field {
        let nodes = self.bounces.first().map_or(0, Field::len);
        match &self.gathered {
            Some(gathered) => Field::sum(nodes, self.bounces.first().into_iter().chain([gathered])),
            None => Field::sum(nodes, self.bounces.iter().chain(&self.tail)),
        }
    }

    /// The light that surfaces reflect once more into all bounces but the direct light, and into the tail.
    pub(crate) fn gatherable(&self) -> Field {
        let nodes = self.bounces.first().map_or(0, Field::len);
        let Some((last, before)) = self.bounces.split_last() else { return Field::zeros(nodes) };
        // Beyond the last bounce, its light and all later light bounce into the tail.
        let into_tail = self.tail.iter().flat_map(|tail| [last, tail]);
        Field::sum(nodes, before.iter().chain(into_tail))
    }

    /// Light that has arrived but has not been sent on: the last bounce.
    pub fn unshot(&self) -> Option<&Field> {
        self.bounces.last()
    }
}

impl Default for SolveState {
    fn default() -> Self {
        Self::new()
    }
}
