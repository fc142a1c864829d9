//! What a solve has found so far.

use crate::Errors;
use glam::Vec3;
use lumel_basis::{Field, Identity, NodeId};

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
    /// Direct light, then one bounce, two bounces … Where light is shot, direct light alone: shots tell no bounces apart.
    pub bounces: Vec<Field>,
    /// What shots have brought, if light was shot.
    pub shot: Option<ShotLight>,
    /// Estimate of the light that was not computed: further bounces, or what is unshot.
    pub tail: Option<Field>,
    /// All light but the direct, measured once more with many rays of their own: a final gather.
    pub gathered: Option<Field>,
    /// Direct light in the basis in which light is read, where that is another than carries it from bounce to bounce.
    pub read_direct: Option<Field>,
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

/// What shots have brought.
#[derive(Clone, Debug, PartialEq)]
pub struct ShotLight {
    /// All light but the direct, so far.
    pub reflected: Field,
    /// Light that has arrived, direct or not, but has not been shot.
    pub unshot: Field,
    /// How many batches of nodes have shot.
    pub shots: u32,
}

impl ShotLight {
    /// Before the first shot, after this direct light.
    pub(crate) fn new(direct: &Field) -> Self {
        let dark = vec![Vec3::ZERO; direct.values().len()];
        let reflected = Field::with_channels(direct.channels(), dark);
        Self { reflected, unshot: direct.clone(), shots: 0 }
    }

    /// What these nodes send: their unshot light.
    pub(crate) fn sent(&self, nodes: &[NodeId]) -> Field {
        let mut sent = Field::zeros(self.unshot.node_count());
        for &node in nodes {
            sent.coefficients_mut(node)[0] = self.unshot.node(node).0;
        }
        sent
    }

    /// Counts what has arrived from these nodes, which have nothing unshot but what they send to each other.
    pub(crate) fn receive(&mut self, nodes: &[NodeId], arrived: &Field) {
        nodes.iter().for_each(|&node| self.unshot.coefficients_mut(node).fill(Vec3::ZERO));
        for sum in [&mut self.reflected, &mut self.unshot] {
            sum.values_mut().iter_mut().zip(arrived.values()).for_each(|(sum, new)| *sum += *new);
        }
        self.shots += 1;
    }
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
            None => Field::sum(self.node_count(), self.found().chain(&self.tail)),
        }
    }

    /// What shots have brought; darkness before the first.
    pub(crate) fn reflected(&self) -> Field {
        self.shot.as_ref().map_or_else(|| Field::zeros(self.node_count()), |shot| shot.reflected.clone())
    }

    /// All light that has been found, part by part: without the tail, and before a final gather.
    pub fn found(&self) -> impl Iterator<Item = &Field> {
        self.bounces.iter().chain(self.shot.iter().map(|shot| &shot.reflected))
    }

    /// The part of the light found that no bounce contains: what shots have brought, and the tail.
    pub fn beyond_bounces(&self) -> Option<Field> {
        match &self.shot {
            Some(shot) => {
                Some(Field::sum(self.node_count(), [&shot.reflected].into_iter().chain(&self.tail)))
            }
            None => self.tail.clone(),
        }
    }

    /// The light that surfaces reflect once more into all bounces but the direct light, and into the tail; of what was shot, what
    /// is unshot too.
    pub fn gatherable(&self) -> Field {
        if self.shot.is_some() {
            // What was unshot is reflected now.
            return Field::sum(self.node_count(), self.found().chain(&self.tail));
        }
        let Some((last, before)) = self.bounces.split_last() else { return Field::zeros(self.node_count()) };
        // Beyond the last bounce, its light and all later light bounce into the tail.
        let into_tail = self.tail.iter().flat_map(|tail| [last, tail]);
        Field::sum(self.node_count(), before.iter().chain(into_tail))
    }

    /// Light that has arrived but has not been reflected: after gathering, the last bounce. `None` before direct light.
    pub fn unshot(&self) -> Option<&Field> {
        self.shot.as_ref().map(|shot| &shot.unshot).or(self.bounces.last())
    }

    /// Removes what only a finished solve has: it is made from the bounces, or what was shot.
    pub(crate) fn reopen(&mut self) {
        (self.tail, self.gathered, self.errors) = (None, None, None);
        (self.read_direct, self.directional) = (None, None);
        self.layers.clear();
        self.directional_layers.clear();
    }
}
