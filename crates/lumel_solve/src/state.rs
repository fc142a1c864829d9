//! What a solve has found so far.

use crate::Errors;
use glam::Vec3;
use lumel_basis::{Basis, Field, Identity, NodeId};
use lumel_transport::Source;
use std::ops::Range;

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
    /// Direct light in the basis in which it is read, where that is another than carries bounces. If it is the one that [holds direct
    /// light](Basis::direct), surfaces reflect this, and what `bounces` have of it stands for its power alone.
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

    /// After a first shot of all direct light, from another basis, which has brought this.
    pub(crate) fn of_direct(arrived: Field) -> Self {
        Self { unshot: arrived.clone(), reflected: arrived, shots: 1 }
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

    /// Direct light as surfaces reflect it, if the basis of the bounces leaves that to another one.
    pub(crate) fn direct_in(&self, basis: &dyn Basis) -> Option<&Field> {
        basis.direct().and(self.read_direct.as_ref())
    }

    /// What shines in a bounce in this basis: all emitters in the first, the direct light, and in each later one the bounce before it,
    /// which must be there.
    pub fn source_of(&self, bounce: usize, basis: &dyn Basis) -> Source<'_> {
        match (bounce.checked_sub(1), self.direct_in(basis)) {
            (None, _) => Source::Emitters(None),
            (Some(0), Some(direct)) => Source::Reflecting { direct, carried: None },
            (Some(before), _) => Source::Field(&self.bounces[before]),
        }
    }

    /// What shines in a bounce of all [unshot](Self::unshot) light.
    pub(crate) fn unshot_source(&self, basis: &dyn Basis) -> Source<'_> {
        match &self.shot {
            Some(shot) => Source::Field(&shot.unshot),
            None => self.source_of(self.bounces.len(), basis),
        }
    }

    /// The light that surfaces reflect once more into all bounces but the direct light, and into the tail; of what was shot, what
    /// is unshot too.
    pub fn gatherable(&self, basis: &dyn Basis) -> Gatherable<'_> {
        // Beyond the last bounce, its light and all later light bounce into the tail. What was unshot is reflected now.
        let is_last_reflected = self.shot.is_some() || self.tail.is_some();
        let reflected = self.bounces.len() - usize::from(!is_last_reflected && !self.bounces.is_empty());
        self.reflecting(0..reflected, basis)
    }

    /// The part of it that surfaces reflect into light that [no bounce contains](Self::beyond_bounces); `None` where there is none.
    pub fn gatherable_beyond_bounces(&self, basis: &dyn Basis) -> Option<Gatherable<'_>> {
        let last = self.bounces.len().checked_sub(1)?;
        match (&self.shot, &self.tail) {
            (Some(_), _) => Some(self.gatherable(basis)),
            (None, Some(_)) => Some(self.reflecting(last..last + 1, basis)),
            (None, None) => None,
        }
    }

    /// What surfaces reflect of these bounces, of what was shot, and of the tail.
    fn reflecting(&self, bounces: Range<usize>, basis: &dyn Basis) -> Gatherable<'_> {
        let direct = self.direct_in(basis).filter(|_| bounces.contains(&0));
        let bounces = &self.bounces[bounces][usize::from(direct.is_some())..];
        let carried = bounces.iter().chain(self.shot.iter().map(|shot| &shot.reflected)).chain(&self.tail);
        let carried: Vec<&Field> = carried.collect();
        match direct {
            Some(direct) if carried.is_empty() => Gatherable::Reflecting { direct, carried: None },
            Some(direct) => {
                let carried = Some(Field::sum(self.node_count(), carried));
                Gatherable::Reflecting { direct, carried }
            }
            None => Gatherable::Field(Field::sum(self.node_count(), carried)),
        }
    }

    /// Light that has arrived but has not been reflected: after gathering, the last bounce. `None` before direct light.
    pub fn unshot(&self) -> Option<&Field> {
        self.shot.as_ref().map(|shot| &shot.unshot).or(self.bounces.last())
    }

    /// Removes what only a finished solve has: it is made from the bounces, or what was shot.
    pub(crate) fn reopen(&mut self) {
        (self.tail, self.gathered, self.errors, self.directional) = (None, None, None, None);
        self.layers.clear();
        self.directional_layers.clear();
    }
}

/// Light that surfaces reflect, of several bounces together.
#[derive(Clone, Debug, PartialEq)]
pub enum Gatherable<'a> {
    /// All in the basis that carries bounces.
    Field(Field),
    /// Direct light in a basis of its own.
    Reflecting {
        /// Direct light.
        direct: &'a Field,
        /// All other light, in the basis that carries bounces.
        carried: Option<Field>,
    },
}

impl Gatherable<'_> {
    /// What shines where it is gathered.
    pub fn source(&self) -> Source<'_> {
        match self {
            Self::Field(field) => Source::Field(field),
            Self::Reflecting { direct, carried } => Source::Reflecting { direct, carried: carried.as_ref() },
        }
    }
}
