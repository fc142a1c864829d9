//! What can be undone.

use crate::lights::EditLight;
use crate::sky::EditSky;
use crate::slots::Slots;
use glam::Vec3;

/// All that can be undone. Which light is active comes back with it, but choosing another is no change.
#[derive(Clone, Debug, Default)]
pub(super) struct Edit {
    pub(super) lights: Vec<EditLight>,
    pub(super) sky: EditSky,
    pub(super) albedos: Vec<Vec3>,
    pub(super) active: usize,
    pub(super) slots: Slots,
}

impl PartialEq for Edit {
    fn eq(&self, other: &Self) -> bool {
        let lighting = self.lights == other.lights && self.sky == other.sky;
        lighting && self.albedos == other.albedos && self.slots == other.slots
    }
}
