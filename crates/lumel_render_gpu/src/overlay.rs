//! Dots and lines over the picture.

use crate::Gpu;
use crate::memory::buffer;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A place in the scene and a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where, world space.
    pub position: Vec3,
    /// sRGB and opacity.
    pub color: [u8; 4],
}

/// What is shown of marks behind surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// Nothing.
    #[default]
    Invisible,
    /// A quarter of their opacity.
    Faint,
}

/// Dots and lines over the picture, in colours that no exposure changes.
///
/// Dots are 5 pixels wide, lines 1.5. What lies on a surface is drawn before it; what lies behind one within a few
/// pixels' worth of distance is too.
#[derive(Debug)]
pub struct Overlay {
    pub(crate) dots: Marks,
    pub(crate) lines: Marks,
    hidden: Hidden,
}

/// Instances of one kind.
#[derive(Debug)]
pub(crate) struct Marks {
    pub(crate) buffer: wgpu::Buffer,
    pub(crate) count: u32,
}

/// [`Mark`] as `overlay.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Instance {
    position: [f32; 3],
    color: [u8; 4],
}

impl Overlay {
    /// Sends dots and lines to the device, to be drawn in this order. Those at places that are not finite are left
    /// out, and what is too much for the device.
    pub fn new(gpu: &Gpu, points: &[Mark], lines: &[[Mark; 2]]) -> Self {
        let dots: Vec<_> = points.iter().map(|mark| [*mark]).collect();
        Self { dots: marks(gpu, &dots), lines: marks(gpu, lines), hidden: Hidden::default() }
    }

    /// The same with what lies behind surfaces shown or not.
    #[must_use]
    pub fn with_hidden(self, hidden: Hidden) -> Self {
        Self { hidden, ..self }
    }

    /// What is shown of marks behind surfaces.
    pub fn hidden(&self) -> Hidden {
        self.hidden
    }
}

fn marks<const N: usize>(gpu: &Gpu, marks: &[[Mark; N]]) -> Marks {
    let fits = gpu.device().limits().max_buffer_size as usize / size_of::<[Instance; N]>();
    let finite = marks.iter().filter(|marks| marks.iter().all(|mark| mark.position.is_finite()));
    let instance = |mark: Mark| Instance { position: mark.position.to_array(), color: mark.color };
    let instances: Vec<[Instance; N]> = finite.take(fits).map(|marks| marks.map(instance)).collect();
    let bytes = bytemuck::cast_slice(instances.as_flattened());
    Marks { buffer: buffer(gpu, "marks", wgpu::BufferUsages::VERTEX, bytes), count: instances.len() as u32 }
}
