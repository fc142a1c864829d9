//! Live relighting.
//!
//! Once all hemisphere rays are stored, a solve for different lights or albedos traces only shadow rays and takes a
//! fraction of a second. So the session solves again whenever either changes: with few shadow rays during a drag, with
//! all of them after it. The result is shown only when all bounces are done; until then the previous light stays
//! visible.

use super::running::Errand;
use super::{Computed, Hand, Session};
use lumel::Settings;

/// Most shadow rays during a drag.
const COARSE: u32 = 8;

impl Session {
    /// Why changes of lights and materials are not relit live; `None` if they are.
    pub fn obstacle_to_live(&self) -> Option<&'static str> {
        let Some(document) = &self.document else { return Some("no scene is open") };
        if !self.live {
            return Some("it is switched off");
        }
        if self.settings.solver == lumel::SolverKind::Neumann {
            return Some("this solver stores no rays");
        }
        if self.settings.target_error != lumel::TargetError::Off {
            return Some("a target error needs new rays");
        }
        let has_rays = document.has_baker() && document.baker.has_rays_of(&self.settings);
        (!has_rays).then_some("solve once to store all rays")
    }

    /// Whether a solve of live relighting runs.
    pub fn is_following(&self) -> bool {
        self.running.as_ref().is_some_and(|r| r.follows() && r.is_under_way())
    }

    /// Whether the light is the coarse one of a drag, to be refined when the drag ends.
    pub fn is_light_in_motion(&self) -> bool {
        let is_coarse = |computed: &Computed| computed.settings().is_some_and(|s| self.is_coarse(s));
        self.is_following() || self.computed.as_ref().is_some_and(|c| is_coarse(c) && self.follows(c))
    }

    /// Whether live relighting keeps this light up to date.
    pub(super) fn follows(&self, computed: &Computed) -> bool {
        let Some(document) = &self.document else { return false };
        let (Some(_), Some(settings)) = (&computed.inputs.lights, computed.settings()) else { return false };
        // Without a light source there is nothing to show, and a stopped solve resumes only on request.
        let is_whole = || computed.complete && !self.changes_since(&computed.inputs).settings();
        document.shines(&self.lights)
            && (self.is_coarse(settings) || is_whole())
            && self.obstacle_to_live().is_none()
    }

    /// Starts a solve when lights or materials have changed.
    pub(super) fn follow_changes(&mut self, hand: Hand) {
        let Some(computed) = self.computed.as_ref().filter(|computed| self.follows(computed)) else { return };
        let is_coarse = computed.settings().is_some_and(|settings| self.is_coarse(settings));
        let changed = self.changes_since(&computed.inputs).lighting();
        if let Some(running) = &self.running {
            // The drag has moved on: the result would be outdated. A coarse solve is not stopped, or nothing would
            // ever be shown during a drag that is faster than a solve.
            let is_old = self.changes_since(&running.inputs).lighting();
            let is_fine = running.follows() && !self.is_coarse(running.settings());
            if is_old && (is_fine || running.errand == Errand::Lumels) {
                running.job.stop();
            }
            return;
        }
        match hand {
            Hand::Busy if changed => self.follow(self.coarse()),
            Hand::Free if changed || is_coarse => self.follow(self.settings.clone()),
            Hand::Busy | Hand::Free => {}
        }
    }

    /// The settings during a drag.
    fn coarse(&self) -> Settings {
        Settings { direct_samples: self.settings.direct_samples.min(COARSE), ..self.settings.clone() }
    }

    /// Whether these are the settings of a drag, to be refined.
    fn is_coarse(&self, settings: &Settings) -> bool {
        *settings == self.coarse() && *settings != self.settings
    }
}
