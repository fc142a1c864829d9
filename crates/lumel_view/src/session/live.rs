//! Light that follows the hand.
//!
//! Once all hemisphere rays are stored, a solve under other lights or with other albedos traces shadow rays only and is
//! done in a fraction of a second. So whenever either has changed, the session solves again by itself: with few shadow
//! rays while the hand moves, with all of them when it rests. Its light is shown whole, all bounces at once, and the
//! light before stays in sight until then.

use super::solve::{Computed, Kind};
use super::{Hand, Session};
use lumel::Settings;

/// Shadow rays while the hand moves, at most.
const COARSE: u32 = 8;

impl Session {
    /// Why the light does not follow changes of lights and materials; `None` if it does.
    pub fn obstacle_to_live(&self) -> Option<&'static str> {
        let Some(document) = &self.document else { return Some("no scene is open") };
        if !self.live {
            return Some("it is switched off");
        }
        if self.settings.solver == lumel::SolverKind::Neumann {
            return Some("rays are not stored");
        }
        if self.settings.target_error != lumel::TargetError::Off {
            return Some("an error to stop at needs new rays");
        }
        (!document.baker.has_rays_of(&self.settings)).then_some("solve once, then all rays are stored")
    }

    /// Whether a solve runs that was not asked for but follows the lights.
    pub fn is_following(&self) -> bool {
        self.running.as_ref().is_some_and(|r| r.kind() == Kind::Follow && r.is_under_way())
    }

    /// Whether the light is that of a moving hand, and better light is to come by itself.
    pub fn is_light_in_motion(&self) -> bool {
        let is_coarse = |computed: &Computed| computed.settings.as_ref().is_some_and(|s| self.is_coarse(s));
        self.is_following() || self.computed.as_ref().is_some_and(|c| is_coarse(c) && self.follows(c))
    }

    /// Whether light that was computed follows all changes from now on.
    pub(super) fn follows(&self, computed: &Computed) -> bool {
        let Some(document) = &self.document else { return false };
        let (Some(_), Some(settings)) = (&computed.lights, &computed.settings) else { return false };
        // Without light there is nothing to show, and what was stopped half-way goes on only when asked to.
        document.shines(&self.lights)
            && (self.is_coarse(settings) || computed.complete && *settings == self.settings)
            && self.obstacle_to_live().is_none()
    }

    /// Solves again by itself when lights or materials have changed.
    pub(super) fn follow_changes(&mut self, hand: Hand) {
        let Some(computed) = self.computed.as_ref().filter(|computed| self.follows(computed)) else { return };
        let is_coarse = computed.settings.as_ref().is_some_and(|settings| self.is_coarse(settings));
        let changed = !self.is_lit_as(computed);
        if let Some(running) = &self.running {
            // The hand moves on: what would be shown is old. A solve with few shadow rays is not stopped, or nothing
            // would ever be shown while the hand moves faster than that.
            let is_old = running.kind() == Kind::Follow && !self.is_running_for_now();
            if is_old && !self.is_coarse(running.settings()) {
                running.stop();
            }
            return;
        }
        match hand {
            Hand::Busy if changed => self.follow(self.coarse()),
            Hand::Free if changed || is_coarse => self.follow(self.settings.clone()),
            Hand::Busy | Hand::Free => {}
        }
    }

    /// The settings while the hand moves.
    fn coarse(&self) -> Settings {
        Settings { direct_samples: self.settings.direct_samples.min(COARSE), ..self.settings.clone() }
    }

    /// Whether light of these settings is that of a moving hand, to be refined.
    fn is_coarse(&self, settings: &Settings) -> bool {
        *settings == self.coarse() && *settings != self.settings
    }
}
