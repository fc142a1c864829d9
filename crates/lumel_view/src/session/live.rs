//! Light that follows the hand.
//!
//! Once all hemisphere rays are stored, a solve under other lights traces shadow rays only and is done in a fraction of
//! a second. So whenever lights have changed, the session solves again by itself: with few shadow rays while the hand
//! moves, with all of them when it rests. Its light is shown whole, all bounces at once, and the light before stays in
//! sight until then.

use super::solve::Kind;
use super::{Hand, Session};
use crate::lights::shining;
use lumel::Settings;

/// Shadow rays while the hand moves, at most.
const COARSE: u32 = 8;

impl Session {
    /// Why the light does not follow changes of the lights; `None` if it does.
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

    /// Solves again by itself when lights have changed.
    pub(super) fn follow_lights(&mut self, hand: Hand) {
        if self.running.is_some() || self.obstacle_to_live().is_some() {
            return;
        }
        let (Some(document), Some(computed)) = (&self.document, &self.computed) else { return };
        let (Some(lights), Some(settings)) = (&computed.lights, &computed.settings) else { return };
        // Without light there is nothing to show, and what was stopped half-way goes on only when asked to.
        if !document.shines(&self.lights) || !(computed.complete || self.is_coarse(settings)) {
            return;
        }
        let moved = *lights != shining(&self.lights);
        if !self.is_coarse_or_same(settings) {
            return;
        }
        match hand {
            Hand::Busy if moved => self.follow(self.coarse()),
            Hand::Free if moved || self.is_coarse(settings) => self.follow(self.settings.clone()),
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

    fn is_coarse_or_same(&self, settings: &Settings) -> bool {
        *settings == self.coarse() || *settings == self.settings
    }
}
