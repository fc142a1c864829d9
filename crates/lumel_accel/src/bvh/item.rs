//! What the tree is built over.

use super::aabb::Aabb;
use glam::{Vec3, Vec3A};

/// A triangle and its box.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
    pub(super) tri: u32,
}

impl Item {
    /// `None` for a triangle that is not finite: it cannot be met, and its box would spoil the tree.
    pub(super) fn new(tri: u32, corners: &[Vec3; 3], padding: Vec3A) -> Option<Self> {
        corners.iter().all(|p| p.is_finite()).then(|| {
            let [a, b, c] = corners.map(Vec3A::from);
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let (below, above) = (min.map(f32::next_down), max.map(f32::next_up));
            Self { min: below.min(min - padding), max: above.max(max + padding), tri }
        })
    }

    pub(super) fn center(&self) -> Vec3A {
        // Halved first: doubled coordinates could overflow.
        0.5 * self.min + 0.5 * self.max
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb { min: self.min.into(), max: self.max.into() }
    }
}
