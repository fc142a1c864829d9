//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box around some points; inverted when there are none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        let empty = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        points.into_iter().fold(empty, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Length from corner to corner, metres.
    pub fn diagonal(&self) -> f32 {
        (self.max - self.min).length()
    }
}
