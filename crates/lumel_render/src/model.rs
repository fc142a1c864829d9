//! A scene on the device.

/// The surfaces of a scene on the device: geometry, materials and textures.
#[derive(Debug)]
pub struct Model {
    pub(crate) vertices: usize,
}

impl Model {
    /// Number of vertices: what light buffers must have.
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }
}
