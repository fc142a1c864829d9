//! Light at the vertices of a model.

use crate::corners::gathered;
use glam::Vec3;
use std::sync::Arc;

/// One linear RGB value per vertex of a [`Model`](crate::Model), on the device: usually irradiance, W·m⁻².
///
/// Geometry never moves while a solve runs; only this is uploaded again.
#[derive(Debug)]
pub struct LightBuffer {
    pub(crate) buffer: wgpu::Buffer,
    vertices: usize,
    /// The vertex of the scene that each of the device is, if they differ.
    sources: Option<Arc<[u32]>>,
}

/// Larger values would overflow in the formulas of the tone mappers, which clamp to it as well.
pub(crate) const BRIGHTEST: f32 = 1e15;

impl LightBuffer {
    /// For so many vertices of a scene, which are split as `sources` says.
    pub(crate) fn new(device: &wgpu::Device, vertices: usize, sources: Option<Arc<[u32]>>) -> Self {
        let on_device = sources.as_ref().map_or(vertices, |sources| sources.len());
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("light"),
            size: (on_device * size_of::<[f32; 3]>()) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, vertices, sources }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.vertices
    }

    /// Whether it has light for the vertices of a model.
    pub(crate) fn fits(&self, vertices: usize, sources: Option<&Arc<[u32]>>) -> bool {
        let same = match (&self.sources, sources) {
            (Some(ours), Some(theirs)) => Arc::ptr_eq(ours, theirs),
            (ours, theirs) => ours.is_none() && theirs.is_none(),
        };
        same && self.vertices == vertices
    }

    /// Whether it has no values; every model has vertices.
    pub fn is_empty(&self) -> bool {
        self.vertices == 0
    }
}

impl LightBuffer {
    /// Replaces the values: those of the scene's vertices. NaN becomes zero, so that it does not spread over triangles.
    pub(crate) fn set(&self, queue: &wgpu::Queue, values: &[Vec3]) {
        let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(-BRIGHTEST, BRIGHTEST) };
        let values: Vec<[f32; 3]> = values.iter().map(|value| value.to_array().map(number)).collect();
        let values = gathered(self.sources.as_deref(), &values);
        queue.write_buffer(&self.buffer, 0, bytemuck::cast_slice(&values));
    }
}
