//! A first look at all light, as it stands in for what is not measured yet.

use crate::unshot::Unshot;
use glam::Vec3;
use lumel::{Baker, SolveState};
use lumel_basis::{Field, NodeId};
use std::sync::Arc;

/// Direct light and some bounces, as they were looked at first.
pub(super) struct FirstLook {
    /// Direct light and some bounces.
    bounces: Vec<Field>,
    /// What further bounces would bring everywhere.
    further: Vec3,
}

impl FirstLook {
    /// That of these bounces.
    pub(super) fn new(baker: &Baker, bounces: Vec<Field>) -> Self {
        let state = SolveState { bounces, ..SolveState::new() };
        Self { further: baker.ambient(&state), bounces: state.bounces }
    }

    /// A bounce of which nothing but these nodes is measured yet; `None` if it was not looked at.
    pub(super) fn completing(&self, bounce: u32, field: &Field, measured: &[bool]) -> Option<Field> {
        let mut whole = self.bounces.get(bounce as usize)?.clone();
        for (node, _) in (0..).map(NodeId).zip(measured).filter(|(_, measured)| **measured) {
            whole.coefficients_mut(node).copy_from_slice(field.coefficients(node));
        }
        Some(whole)
    }

    /// Direct light.
    pub(super) fn direct(&self) -> SolveState {
        let bounces = self.bounces.iter().take(1).cloned().collect();
        SolveState { bounces, ..SolveState::new() }
    }

    /// What is still to come after so many bounces: those that were looked at, each colour by a share, in place of light that is
    /// everywhere the same.
    pub(super) fn instead(&self, baker: &Baker, unshot: Unshot, bounces: usize, share: Vec3) -> Unshot {
        let Some(later) = self.bounces.get(bounces..).filter(|later| !later.is_empty()) else {
            return unshot;
        };
        let mut seen = baker.carried_at_vertices(&Field::sum(later[0].node_count(), later));
        seen.iter_mut().for_each(|value| *value *= share);
        Unshot { ambient: self.further * share, seen: Some(Arc::new(seen)), ..unshot }
    }
}
