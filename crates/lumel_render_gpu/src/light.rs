//! Light in the vertices of a model.

use glam::Vec3;

/// One linear RGB value per vertex of a [`Model`](crate::Model), on the device: usually irradiance, W·m⁻².
///
/// Geometry never moves while a solve runs; this is all that has to be sent again.
#[derive(Debug)]
pub struct LightBuffer {
    pub(crate) buffer: wgpu::Buffer,
    vertices: usize,
}

/// Beyond this the formulas of the tone mappers would overflow: they cut there as well.
const BRIGHTEST: f32 = 1e15;

impl LightBuffer {
    pub(crate) fn new(device: &wgpu::Device, vertices: usize) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("light"),
            size: (vertices * size_of::<[f32; 3]>()) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, vertices }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.vertices
    }

    /// Whether it has no values; no model is without vertices.
    pub fn is_empty(&self) -> bool {
        self.vertices == 0
    }
}

/// What is sent to the device: what is not a number becomes zero, so that it does not spread over its triangles.
pub(crate) fn to_upload(values: &[Vec3]) -> Vec<[f32; 3]> {
    let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(-BRIGHTEST, BRIGHTEST) };
    values.iter().map(|value| value.to_array().map(number)).collect()
}
