//! Two solutions side by side, and how much they differ.

use crate::selection::Selection;
use crate::session::Session;
use crate::stage::{Side, Split};
use lumel::Difference;
use std::borrow::Cow;

/// What is compared with the light of the scene.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Whether the picture is split.
    pub on: bool,
    /// The solution right of the divider.
    pub right: Side,
    /// Which bounces right of the divider.
    pub selection: Selection,
    at: f32,
    difference: Option<(DifferenceKey, Option<Difference>)>,
}

/// What a difference depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DifferenceKey {
    light: u64,
    left: Selection,
    right: Side,
    selection: Selection,
}

impl Default for Comparison {
    fn default() -> Self {
        Self { on: false, right: Side::Current, selection: Selection::DIRECT, at: 0.5, difference: None }
    }
}

impl Comparison {
    /// The split of the picture, if there is one.
    pub fn split(&self) -> Option<Split> {
        self.on.then_some(Split { right: self.right, selection: self.selection, at: self.at })
    }

    /// Moves the divider, 0..=1 of the width.
    pub fn set_divider(&mut self, at: f32) {
        if at.is_finite() {
            self.at = at.clamp(0.02, 0.98);
        }
    }

    /// Splits the picture or makes it whole. What was kept last comes right of the divider.
    pub fn toggle(&mut self, session: &Session) {
        self.on = !self.on;
        if let (true, Some(kept)) = (self.on, session.kept.last()) {
            self.choose(Side::Kept(kept.id), Selection::All);
        }
    }

    /// Shows the same light without normal maps and ripples right of the divider, or no longer.
    pub fn toggle_smooth(&mut self) {
        self.on = !self.is_smooth();
        if self.on {
            self.choose(Side::Smooth, Selection::All);
        }
    }

    /// Whether the same light without normal maps and ripples is right of the divider.
    pub fn is_smooth(&self) -> bool {
        self.on && self.right == Side::Smooth
    }

    /// Keeps the light as it is now, and compares with it where nothing else was chosen.
    pub fn keep(&mut self, session: &mut Session) {
        session.keep_light();
        if let (Side::Current, Some(kept)) = (self.right, session.kept.last()) {
            self.choose(Side::Kept(kept.id), Selection::All);
        }
    }

    /// Puts a light right of the divider.
    pub fn choose(&mut self, right: Side, selection: Selection) {
        (self.right, self.selection) = (right, selection);
    }

    /// Goes back to the light of the scene when the one that was chosen is gone.
    pub fn check(&mut self, session: &Session) {
        if let Side::Kept(id) = self.right
            && !session.kept.iter().any(|kept| kept.id == id)
        {
            self.choose(Side::Current, Selection::DIRECT);
        }
    }

    /// How the light left of the divider differs from that right of it, over the vertices that were measured.
    ///
    /// `None` where there is nothing to compare. Computed when one of both has changed.
    pub fn difference(&mut self, session: &Session, left: Selection) -> Option<&Difference> {
        let key = DifferenceKey {
            light: session.light_generation,
            left,
            right: self.right,
            selection: self.selection,
        };
        if self.difference.as_ref().is_none_or(|(of, _)| *of != key) {
            self.difference = Some((key, self.compute(session, left)));
        }
        self.difference.as_ref().and_then(|(_, difference)| difference.as_ref())
    }

    fn compute(&self, session: &Session, left: Selection) -> Option<Difference> {
        let scene = &session.document.as_ref()?.scene;
        let n = scene.vertex_count();
        let right = match self.right {
            Side::Current | Side::Smooth => Cow::Borrowed(&session.light),
            Side::Kept(id) => session.kept.iter().find(|kept| kept.id == id)?.light_on(scene),
        };
        if session.light.is_empty() || right.is_empty() {
            return None;
        }
        let counts: Vec<bool> = (0..n)
            .map(|v| [&session.light, &*right].iter().all(|l| l.valid.get(v).copied().unwrap_or(true)))
            .collect();
        Difference::of(&session.light.select(left, n), &right.select(self.selection, n), &counts)
    }
}
