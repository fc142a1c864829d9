//! Continuing a bake that was stopped.

use crate::assembly;
use crate::{Baker, Settings};
use glam::Vec3;
use lumel_basis::{Basis, Field};
use lumel_export::{Solution, SolutionError};
use lumel_solve::SolveState;

/// Why a solution cannot be continued.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// It belongs to a different scene.
    #[error(transparent)]
    Scene(#[from] SolutionError),
    /// The scene is lit differently.
    #[error("the solution was computed with other materials or lights; bake the scene again")]
    Lighting,
    /// The settings would give other bounces.
    #[error("the solution was computed with other settings ({differences}); use the same or bake again")]
    Settings {
        /// Which settings differ, and how.
        differences: String,
    },
    /// Its samples are not kept.
    #[error("a solution with a target error cannot be resumed, as it does not keep its rounds; bake again")]
    TargetError,
}

impl Baker {
    /// The state from which to continue a solution that was saved.
    ///
    /// Bounces beyond those that these settings ask for are left out, so that the result does not depend on how far
    /// the solution went.
    ///
    /// # Errors
    /// When the solution is of another scene, other lights or other settings.
    pub fn resume(&self, solution: &Solution) -> Result<SolveState, ResumeError> {
        solution.check_belongs_to(self.scene())?;
        if !solution.has_lighting_of(self.scene()) {
            return Err(ResumeError::Lighting);
        }
        self.check_settings(&solution.meta.settings)?;
        if matches!(self.method(), crate::Method::Replicates { .. }) {
            return Err(ResumeError::TargetError);
        }
        let first_vertices = self.basis().first_vertices();
        let at_nodes = |values: &Vec<Vec3>| {
            Field::from_values(first_vertices.iter().map(|&v| values[v as usize]).collect())
        };
        let mut bounces: Vec<Field> = solution.bounces.iter().map(at_nodes).collect();
        if let Some(wanted) = self.settings().stop().wanted(self.integrals(), &bounces) {
            bounces.truncate(wanted);
        }
        let valid = first_vertices.iter().map(|&v| solution.valid[v as usize]).collect();
        Ok(SolveState { basis: Some(self.basis().identity()), valid, bounces, ..SolveState::new() })
    }

    /// Whether bounces that were computed with settings from a file are those of this baker.
    fn check_settings(&self, found: &serde_json::Value) -> Result<(), ResumeError> {
        let Some(found) = serde_json::from_value::<Settings>(found.clone()).ok() else {
            let differences = "they are unknown to this version".to_owned();
            return Err(ResumeError::Settings { differences });
        };
        let shape = self.shape();
        let method = assembly::method(self.scene(), (shape.elements, shape.sampling), &found);
        if found.same_bounces_as(self.settings()) && method == self.method() {
            return Ok(());
        }
        Err(ResumeError::Settings { differences: self.settings().differences_of_bounces(&found) })
    }
}
