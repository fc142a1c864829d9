//! What of the light is out of date.

use super::{Computed, Session};
use crate::inputs::{Changes, Inputs};
use crate::lights::shining;
use lumel::{Scene, Settings, TargetError};
use std::sync::Arc;

impl Session {
    /// What a solve of this scene with these settings is computed from now.
    pub(super) fn inputs(&self, scene: &Arc<Scene>, settings: &Settings) -> Inputs {
        let (scene, lights) = (Arc::clone(scene), Some(shining(&self.lights)));
        Inputs { scene, lights, settings: Some(settings.clone()) }
    }

    /// What has changed since a light was computed, or a solve for it begun.
    pub(super) fn changes_since(&self, inputs: &Inputs) -> Changes {
        let Some(document) = &self.document else { return Changes::default() };
        inputs.changes(&self.inputs(&document.scene, &self.settings))
    }

    /// What has changed since the light that is shown was computed; `None` when there is none.
    pub fn changes(&self) -> Option<Changes> {
        self.computed.as_ref().map(|computed| self.changes_since(&computed.inputs))
    }

    /// Why the light that is shown is out of date; `None` where it is not, or will be up to date by itself.
    pub fn out_of_date(&self) -> Option<Changes> {
        let computed = self.computed.as_ref().filter(|_| !self.is_solving())?;
        let changes = self.changes_since(&computed.inputs);
        (changes.outdates() && !self.follows(computed)).then_some(changes)
    }

    /// Whether the next solve resumes a stopped one.
    pub fn can_go_on(&self) -> bool {
        let is_resumed = |computed: &Computed| {
            !computed.complete && self.resumes(computed, self.changes_since(&computed.inputs))
        };
        !self.light.is_empty()
            && self.out_of_date().is_none()
            && self.computed.as_ref().is_some_and(is_resumed)
    }

    /// Whether the next solve continues this light, after changes that do not put it out of date.
    pub(super) fn resumes(&self, computed: &Computed, changes: Changes) -> bool {
        // A solve to an error with other bounces might choose other samples, and a solution does not tell its samples.
        self.settings.target_error == TargetError::Off || computed.solved.is_some() && !changes.any()
    }
}
