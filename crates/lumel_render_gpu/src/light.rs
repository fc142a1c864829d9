//! Light at the vertices of a model.

use glam::Vec3;

/// One linear RGB value per vertex of a [`Model`](crate::Model), on the device: usually irradiance, W·m⁻².
///
/// Geometry never moves while a solve runs; only this is uploaded again.
#[derive(Debug)]
pub struct LightBuffer {
    pub(crate) buffer: wgpu::Buffer,
    vertices: usize,
}

/// Larger values would overflow in the formulas of the tone mappers, which clamp to it as well.
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

    /// Whether it has no values; every model has vertices.
    pub fn is_empty(&self) -> bool {
        self.vertices == 0
    }
}

/// The values to upload: NaN becomes zero, so that it does not spread over triangles.
pub(crate) fn to_upload(values: &[Vec3]) -> Vec<[f32; 3]> {
    let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(-BRIGHTEST, BRIGHTEST) };
    values.iter().map(|value| value.to_array().map(number)).collect()
}
