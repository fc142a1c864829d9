//! What light of scattered points is found with, pixel by pixel.

use crate::Gpu;
use crate::attachments::{DEPTH, PLACES, POINT_LIGHT, Samples};
use crate::pipelines::Layouts;
use crate::target::{bind, texture, view};
use wgpu::BindingResource::TextureView;

/// Where the surface of each pixel is, and the light of points there; one sample for each.
#[derive(Debug)]
pub(crate) struct Places {
    /// Position and normal.
    pub(crate) surface: [wgpu::TextureView; 2],
    pub(crate) depth: wgpu::TextureView,
    pub(crate) light: wgpu::TextureView,
    /// Position and normal, to gather light at.
    pub(crate) group: wgpu::BindGroup,
    /// The same with the light.
    pub(crate) lit_group: wgpu::BindGroup,
}

impl Places {
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 2]) -> Self {
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let make = |label, format, usage| view(&texture(gpu, label, size, Samples::One, format, usage));
        let read = |label, format| make(label, format, attachment | wgpu::TextureUsages::TEXTURE_BINDING);
        let surface = PLACES.map(|format| read("places", format));
        let light = read("light of points", POINT_LIGHT);
        let [position, normal] = surface.each_ref();
        Self {
            group: bind(gpu, &layouts.places, &[TextureView(position), TextureView(normal)]),
            lit_group: bind(
                gpu,
                &layouts.lit_places,
                &[TextureView(position), TextureView(normal), TextureView(&light)],
            ),
            depth: make("depth of places", DEPTH, attachment),
            surface,
            light,
        }
    }
}
