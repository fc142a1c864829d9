//! What the stage is to show.

use super::content::Side;
use crate::prefs::ViewPrefs;
use crate::selection::Selection;
use crate::session::Session;
use lumel_render_cpu::Ripple;
use lumel_render_gpu::{Hidden, Mark};

/// What the stage is to show.
pub struct Showing<'a> {
    /// The scene and its light.
    pub session: &'a Session,
    /// How.
    pub view: &'a ViewPrefs,
    /// Beside what.
    pub split: Option<Split>,
    /// Dots and lines.
    pub marks: Option<&'a Marks>,
    /// How good.
    pub quality: Quality,
    /// Waves over the materials that have them.
    pub ripple: Option<Ripple>,
}

/// Two solutions side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The solution right of the divider.
    pub right: Side,
    /// Which bounces right of the divider.
    pub selection: Selection,
    /// Where the divider is, 0..=1.
    pub at: f32,
}

/// Dots and lines on the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// Dots.
    pub points: Vec<Mark>,
    /// Lines.
    pub lines: Vec<[Mark; 2]>,
    /// How those behind surfaces are shown.
    pub hidden: Hidden,
    /// Changes with them.
    pub generation: u64,
}

/// How much a picture may cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// As good as it gets.
    Still,
    /// Something moves or a solve needs the processor.
    Live,
}
