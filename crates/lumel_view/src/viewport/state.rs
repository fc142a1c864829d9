//! What the viewport remembers, and what it shows and changes.

use super::marks::CurrentMarks;
use super::ripple::Waves;
use crate::actions::Actions;
use crate::compare::Comparison;
use crate::gizmo::Gizmo;
use crate::pick::Pick;
use crate::prefs::Prefs;
use crate::session::Session;
use crate::stage::{Quality, Stage};
use eframe::egui::{Id, Key, Rect, pos2, vec2};
use glam::Vec3;
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// How long after the last movement the picture counts as still.
pub(super) const SETTLE: Duration = Duration::from_millis(220);

/// What the viewport remembers from frame to frame.
#[derive(Default)]
pub struct Viewport {
    pub(super) id: Option<Id>,
    pub(super) area: Option<Rect>,
    pub(super) moved: Option<Instant>,
    /// Whether a key flew in the last frame: the first frame of a flight has no sensible duration.
    pub(super) flying: bool,
    pub(super) gizmo: Gizmo,
    /// What an orbit that is under way turns around.
    pub(super) pivot: Option<Vec3>,
    /// When the key that frames when it is tapped was pressed, seconds.
    pub(super) tapped: Option<f64>,
    pub(super) dividing: bool,
    pub(super) marks: CurrentMarks,
    pub(super) problem: Option<String>,
    pub(super) waves: Waves,
    /// Keys that ran a command: they do not fly while they stay down.
    pub(super) spent_keys: HashSet<Key>,
}

/// What the viewport shows and changes.
pub struct Subject<'a> {
    /// The scene and its light.
    pub session: &'a mut Session,
    /// How it is drawn and flown through.
    pub prefs: &'a mut Prefs,
    /// What draws it; `None` without a graphics device.
    pub stage: Option<&'a mut Stage>,
    /// The solution right of the divider.
    pub comparison: &'a mut Comparison,
    /// The spot that was clicked.
    pub pick: &'a mut Option<Pick>,
    /// What the window as a whole is to do.
    pub actions: &'a mut Actions,
    /// Whether a dialog takes the keys.
    pub in_dialog: bool,
}

impl Viewport {
    /// The viewport's widget, once it was shown.
    pub fn id(&self) -> Option<Id> {
        self.id
    }

    /// Where it is in the window.
    pub fn area(&self) -> Rect {
        self.area.unwrap_or(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 480.0)))
    }

    /// Whether something moves.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// Whether keys that fly are held.
    pub fn is_flying(&self) -> bool {
        self.flying
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        let size = self.area().size();
        size.x / size.y.max(1.0)
    }

    /// Marks a key that ran a command: it does not fly until released.
    pub fn spend(&mut self, key: Key) {
        self.spent_keys.insert(key);
    }

    /// Unmarks the keys that are no longer down.
    pub fn release_keys(&mut self, is_down: impl Fn(Key) -> bool) {
        self.spent_keys.retain(|key| is_down(*key));
    }

    /// How much a picture may cost now.
    pub fn quality(&self, session: &Session) -> Quality {
        let live =
            self.is_moving() || self.waves.are_seen || session.is_solving() || session.is_light_in_motion();
        if live { Quality::Live } else { Quality::Still }
    }
}
