//! In which order light is transported, and when a solve is finished.

use crate::brightest::brightest;
use crate::{PowerLog, SolveState};
use lumel_basis::NodeId;
use serde::{Deserialize, Serialize};

/// The light that one step transports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shot {
    /// What emitters send: direct light.
    Emitters,
    /// All light that is unshot: one bounce.
    All,
    /// The unshot light of these nodes, each named once.
    Nodes(Vec<NodeId>),
}

/// Decides what is transported next.
///
/// Called between steps with the state so far and the powers of its bounces; must depend on nothing else, or resumed
/// solves would differ.
pub trait Schedule: Send + Sync {
    /// The next shot; `None` when the solve is finished.
    fn next(&self, state: &SolveState, powers: &PowerLog<'_>) -> Option<Shot>;

    /// How many of the bounces of a state an uninterrupted solve computes before it is finished; `None` if it is not finished
    /// with these.
    fn wanted(&self, state: &SolveState, powers: &PowerLog<'_>) -> Option<usize> {
        self.next(state, powers).is_none().then_some(state.bounces.len())
    }
}

/// Bounce by bounce: direct light, then all unshot light at once, until [`Stop`] is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gather {
    /// When enough bounces have been computed.
    pub stop: Stop,
}

impl Schedule for Gather {
    fn next(&self, state: &SolveState, powers: &PowerLog<'_>) -> Option<Shot> {
        let next = if state.bounces.is_empty() { Shot::Emitters } else { Shot::All };
        (!self.stop.is_reached(powers)).then_some(next)
    }

    fn wanted(&self, _: &SolveState, powers: &PowerLog<'_>) -> Option<usize> {
        self.stop.wanted(powers)
    }
}

/// Each batch of nodes that shoots together has this share of the unshot power.
///
/// Fewer would be picked more carefully, but each step looks at all nodes.
const BATCH: f64 = 0.3;

/// The brightest first: direct light, then again and again the nodes with the largest unshot power, until what is missing is
/// less than a share of all light.
///
/// Southwell's relaxation in batches. It reaches the same light as [`Gather`], of which every bounce is a batch of all nodes.
///
/// Cohen, Chen, Wallace, Greenberg, *A Progressive Refinement Approach to Fast Radiosity Image Generation*, SIGGRAPH 1988.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shoot {
    /// The share of all light that may be missing.
    pub remainder: f32,
}

impl Schedule for Shoot {
    fn next(&self, state: &SolveState, powers: &PowerLog<'_>) -> Option<Shot> {
        let Some(unshot) = state.unshot() else { return Some(Shot::Emitters) };
        let integrals = powers.integrals();
        if integrals.missing(state) < f64::from(self.remainder) {
            return None;
        }
        let nodes = brightest(&integrals.unshot_powers(unshot), BATCH);
        (!nodes.is_empty()).then_some(Shot::Nodes(nodes))
    }
}

/// When enough bounces have been computed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// After this many; 0 is direct light only.
    Bounces(u32),
    /// When the bounces to come would bring less than this share of all light, but after `at_most` in any case.
    Remainder {
        /// The share.
        fraction: f32,
        /// The limit.
        at_most: u32,
    },
}

impl Stop {
    /// Whether the logged bounces, direct light included, are enough: the one rule for when a solve is finished.
    pub fn is_reached(self, powers: &PowerLog<'_>) -> bool {
        self.wanted(powers).is_some()
    }

    /// How many of the logged bounces an uninterrupted solve computes before it is finished; `None` if it needs more.
    ///
    /// What went further, under another rule, is cut to that: results do not depend on how far a solve went before.
    pub fn wanted(self, powers: &PowerLog<'_>) -> Option<usize> {
        match self {
            Self::Bounces(n) => (powers.powers().len() > n as usize).then_some(n as usize + 1),
            Self::Remainder { fraction, at_most } => {
                powers.first_below(f64::from(fraction), at_most as usize)
            }
        }
    }
}
