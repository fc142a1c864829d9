//! Dots and lines over the picture.

use crate::Gpu;
use crate::memory::buffer;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A position in the scene and a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Position in world space, metres.
    pub position: Vec3,
    /// sRGB and opacity.
    pub color: [u8; 4],
}

/// How marks behind surfaces are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// Not at all.
    #[default]
    Invisible,
    /// At a quarter of their opacity.
    Faint,
}

/// Dots and lines over the picture, in colours that do not depend on the exposure.
///
/// Dots are 5 pixels wide, lines 1.5. Marks on a surface are drawn in front of it, as are those up to a few
/// pixels behind it.
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
    /// Uploads dots and lines, to be drawn in this order. Those at positions that are not finite and those that exceed
    /// the limits of the device are left out.
    pub fn new(gpu: &Gpu, points: &[Mark], lines: &[[Mark; 2]]) -> Self {
        let dots: Vec<_> = points.iter().map(|mark| [*mark]).collect();
        Self { dots: marks(gpu, &dots), lines: marks(gpu, lines), hidden: Hidden::default() }
    }

    /// The same, with or without marks behind surfaces.
    #[must_use]
    pub fn with_hidden(self, hidden: Hidden) -> Self {
        Self { hidden, ..self }
    }

    /// How marks behind surfaces are shown.
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
