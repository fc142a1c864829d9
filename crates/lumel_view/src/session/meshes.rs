//! The triangles that are shown.

use super::Session;
use crate::inputs::Inputs;
use crate::mesh::Mesh;
use crate::solver::{Phase, SolveStart};
use lumel::Adaptive;

impl Session {
    /// Shows the triangles that light is on, unless they are shown already.
    pub(super) fn show_mesh(&mut self, mesh: &Mesh) {
        let Some(document) = &mut self.document else { return };
        if mesh.is_of(&document.scene) {
            if mesh.indicator.is_some() {
                document.indicator.clone_from(&mesh.indicator);
            }
            return;
        }
        document.show(mesh);
        self.refined_for = None;
        self.mesh_generation += 1;
        self.paint();
    }

    /// Notes what the triangles that are shown were refined for, unless that is known: what light on them is computed from.
    pub(super) fn note_refined_for(&mut self, inputs: Option<Inputs>) {
        let is_refined = self.document.as_ref().is_some_and(|d| d.scene.refinement().is_some());
        if is_refined && self.refined_for.is_none() {
            self.refined_for = inputs;
        }
    }

    /// Whether edges are being split.
    pub fn is_refining(&self) -> bool {
        matches!(self.phase(), Some(Phase::Refining { .. }))
    }

    /// Whether the mesh was refined for other lights or materials than those that the scene has now.
    pub fn follows_other_light(&self) -> bool {
        let changed = |inputs: &Inputs| self.changes_since(inputs);
        self.settings.adaptive != Adaptive::Off
            && self.refined_for.as_ref().map(changed).is_some_and(|c| c.lights || c.materials)
    }

    /// How a solve from scratch begins.
    pub(super) fn begin_anew(&self) -> SolveStart {
        match self.settings.adaptive {
            Adaptive::Off => SolveStart::Anew,
            Adaptive::Auto | Adaptive::At(_) => SolveStart::Refine(None),
        }
    }
}
