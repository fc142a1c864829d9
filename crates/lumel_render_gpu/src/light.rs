//! Light at the vertices of a model.

use crate::Gpu;
use crate::corners::gathered;
use crate::memory::buffer;
use glam::Vec3;
use lumel_basis::{Directional, Harmonics, IncidentRadiance};
use std::sync::{Arc, Mutex, PoisonError};

/// One linear RGB value per vertex of a [`Model`](crate::Model), on the device: usually irradiance, W·m⁻².
///
/// Geometry never moves while a solve runs; only this is uploaded again.
#[derive(Debug)]
pub struct LightBuffer {
    pub(crate) buffer: wgpu::Buffer,
    vertices: usize,
    /// The vertex of the scene that each of the device is, if they differ.
    sources: Option<Arc<[u32]>>,
    /// Where light by direction is known.
    moments: Mutex<Option<Moments>>,
}

/// Coefficients of incident light on the device: see `shading.wgsl`.
#[derive(Clone, Debug)]
pub(crate) struct Moments {
    pub(crate) kind: Directional,
    pub(crate) buffer: wgpu::Buffer,
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
        Self { buffer, vertices, sources, moments: Mutex::default() }
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
        let values: Vec<[f32; 3]> = values.iter().map(|value| value.to_array().map(number)).collect();
        let values = gathered(self.sources.as_deref(), &values);
        queue.write_buffer(&self.buffer, 0, bytemuck::cast_slice(&values));
    }

    /// What is known of light by direction.
    pub(crate) fn moments(&self) -> Option<Moments> {
        // A thread that panicked has left no incomplete buffer behind.
        self.moments.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Replaces light by direction: that at the scene's vertices, or `None` where it is not known. NaN becomes zero.
    pub(crate) fn set_moments(&self, gpu: &Gpu, light: Option<&[IncidentRadiance]>) {
        let mut moments = self.moments.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((light, first)) = light.and_then(|light| Some((light, light.first()?))) else {
            *moments = None;
            return;
        };
        let kind = first.kind();
        let bytes = self.packed(kind, light);
        match &*moments {
            Some(known) if known.kind == kind => gpu.queue().write_buffer(&known.buffer, 0, &bytes),
            _ => {
                let buffer = buffer(gpu, "light by direction", wgpu::BufferUsages::VERTEX, &bytes);
                *moments = Some(Moments { kind, buffer });
            }
        }
    }

    fn packed(&self, kind: Directional, light: &[IncidentRadiance]) -> Vec<u8> {
        let light: Vec<&IncidentRadiance> = light.iter().collect();
        let light = gathered(self.sources.as_deref(), &light);
        let numbers = light.iter().flat_map(|light| packed(kind, light.coefficients())).flatten();
        numbers.flat_map(f32::to_le_bytes).collect()
    }
}

/// How many texels or vertex attributes of four numbers the coefficients of a place take.
pub(crate) fn layers_of(kind: Directional) -> u32 {
    match kind {
        Directional::Off => 0,
        Directional::Sh1 => 3,
        Directional::Sh2 => 7,
    }
}

/// The coefficients of a place of a kind, as many times four as [`layers_of`] says.
pub(crate) fn packed(kind: Directional, c: &Harmonics<Vec3>) -> Vec<[f32; 4]> {
    let packed = match kind {
        Directional::Off => vec![],
        Directional::Sh1 => two_bands(c).to_vec(),
        Directional::Sh2 => three_bands(c).to_vec(),
    };
    packed.into_iter().map(|four| four.map(number)).collect()
}

pub(crate) fn number(x: f32) -> f32 {
    if x.is_nan() { 0.0 } else { x.clamp(-BRIGHTEST, BRIGHTEST) }
}

/// The bands 0 and 1 of each channel.
fn two_bands(c: &Harmonics<Vec3>) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|channel| [c[0], c[1], c[2], c[3]].map(|c| c[channel]))
}

/// The same, four of band 2 of each channel, and the last of all.
fn three_bands(c: &Harmonics<Vec3>) -> [[f32; 4]; 7] {
    let [red, green, blue] = two_bands(c);
    let [red_2, green_2, blue_2] = [0, 1, 2].map(|channel| [c[4], c[5], c[6], c[7]].map(|c| c[channel]));
    [red, green, blue, red_2, green_2, blue_2, c[8].extend(0.0).to_array()]
}
