//! Vertices in one place.

use glam::Vec3;
use std::collections::HashMap;

/// Numbers places: the same one for all vertices that are there.
#[derive(Debug, Default)]
pub struct Weld(HashMap<[u32; 3], u32>);

impl Weld {
    /// The number of a place.
    pub fn number(&mut self, position: Vec3) -> u32 {
        let next = self.0.len() as u32;
        // Adding zero turns -0 into 0.
        *self.0.entry((position + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    }
}
