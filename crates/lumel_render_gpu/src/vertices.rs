//! Vertex buffers as the pipelines read them.

use wgpu::VertexFormat::{self, Float32x2, Float32x3, Float32x4, Snorm16x4, Uint32, Unorm8x4};
use wgpu::VertexStepMode;

/// One vertex buffer per attribute, so that a pipeline reads only what it needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attribute {
    formats: &'static [VertexFormat],
    step: VertexStepMode,
    /// Whether all vertices share the first value.
    constant: bool,
}

const fn per_vertex(formats: &'static [VertexFormat]) -> Attribute {
    Attribute { formats, step: VertexStepMode::Vertex, constant: false }
}

const fn per_instance(formats: &'static [VertexFormat]) -> Attribute {
    Attribute { formats, step: VertexStepMode::Instance, constant: false }
}

pub(crate) const POSITION: Attribute = per_vertex(&[Float32x3]);
pub(crate) const LIGHT: Attribute = per_vertex(&[Float32x3]);
pub(crate) const NORMAL: Attribute = per_vertex(&[Snorm16x4]);
pub(crate) const TANGENT: Attribute = per_vertex(&[Snorm16x4]);
pub(crate) const NO_TANGENT: Attribute = Attribute { constant: true, ..TANGENT };
pub(crate) const UV: Attribute = per_vertex(&[Float32x2]);
pub(crate) const TINT: Attribute = per_vertex(&[Float32x3]);
pub(crate) const NO_TINT: Attribute = Attribute { constant: true, ..TINT };

/// Place on a page of the atlas, lumels, the page, and the first and last places of the chart.
pub(crate) const PLACE: Attribute = per_vertex(&[Float32x2, Uint32, Float32x4]);
pub(crate) const NO_PLACE: Attribute = Attribute { constant: true, ..PLACE };

/// Coefficients of incident light by channel: the bands 0 and 1, and the bands 0 to 2.
pub(crate) const TWO_BANDS: Attribute = per_vertex(&[Float32x4; 3]);
pub(crate) const THREE_BANDS: Attribute = per_vertex(&[Float32x4; 7]);

/// Centre, half edges, radiance.
pub(crate) const RECT_LIGHT: Attribute = per_instance(&[Float32x3; 4]);

/// Position, colour.
pub(crate) const DOT: Attribute = per_instance(&[Float32x3, Unorm8x4]);

/// Twice position and colour.
pub(crate) const LINE: Attribute = per_instance(&[Float32x3, Unorm8x4, Float32x3, Unorm8x4]);

/// A vertex buffer with the locations of its attributes.
pub(crate) struct Layout {
    stride: u64,
    step: VertexStepMode,
    attributes: Vec<wgpu::VertexAttribute>,
}

impl Layout {
    pub(crate) fn as_layout(&self) -> wgpu::VertexBufferLayout<'_> {
        wgpu::VertexBufferLayout {
            array_stride: self.stride,
            step_mode: self.step,
            attributes: &self.attributes,
        }
    }
}

/// Buffers in order; locations are numbered consecutively.
pub(crate) fn layouts(buffers: &[Attribute]) -> Vec<Layout> {
    let mut location = 0;
    let layout = |buffer: &Attribute| {
        let mut offset = 0;
        let mut attributes = Vec::new();
        for &format in buffer.formats {
            attributes.push(wgpu::VertexAttribute { format, offset, shader_location: location });
            offset += format.size();
            location += 1;
        }
        Layout { stride: if buffer.constant { 0 } else { offset }, step: buffer.step, attributes }
    };
    buffers.iter().map(layout).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_follow_each_other_without_gaps() {
        let made = layouts(&[POSITION, LINE, NO_TINT]);
        let strides: Vec<u64> = made.iter().map(|layout| layout.stride).collect();
        assert_eq!(strides, [12, 32, 0]);
        let line: Vec<_> = made[1].attributes.iter().map(|a| (a.offset, a.shader_location)).collect();
        assert_eq!(line, [(0, 1), (12, 2), (16, 3), (28, 4)]);
        assert_eq!(made[2].attributes[0].shader_location, 5);
    }
}
