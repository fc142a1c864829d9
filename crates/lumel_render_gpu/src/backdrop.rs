//! The sky as a background.

use crate::layout::BackdropValues;
use crate::memory::{buffer, within_memory};
use crate::mips::Pyramid;
use crate::pipelines::Layouts;
use crate::{Gpu, RenderError, texture};
use lumel_scene::{Sky, SkyImage};
use std::sync::Arc;

/// A sky that is not the same everywhere, on the device.
#[derive(Debug)]
pub struct Backdrop {
    pub(crate) group: wgpu::BindGroup,
    values: wgpu::Buffer,
    image: Option<Arc<SkyImage>>,
}

impl Backdrop {
    /// That of a sky; `before` is given new numbers where its image is the same. `None` for a sky that is the same everywhere.
    pub(crate) fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        sky: &Sky,
        before: Option<Self>,
    ) -> Result<Option<Self>, RenderError> {
        let Some(values) = BackdropValues::of(sky) else { return Ok(None) };
        let image = sky.image().cloned();
        let same = before.filter(|before| match (&before.image, &image) {
            (Some(before), Some(image)) => before.has_texels_of(image),
            (before, image) => before.is_none() && image.is_none(),
        });
        if let Some(same) = same {
            gpu.queue().write_buffer(&same.values, 0, bytemuck::bytes_of(&values));
            return Ok(Some(Self { image, ..same }));
        }
        within_memory(gpu, "the image of the sky", || Some(Self::upload(gpu, layouts, &values, image)))
    }

    fn upload(gpu: &Gpu, layouts: &Layouts, values: &BackdropValues, image: Option<Arc<SkyImage>>) -> Self {
        let limit = gpu.device().limits().max_texture_dimension_2d;
        let pyramid = match &image {
            Some(image) => Pyramid::largest(image.texture(), limit),
            None => Pyramid::white(),
        };
        let texels = texture::send(gpu, "backdrop", &pyramid);
        let values = buffer(gpu, "backdrop", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(values));
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("backdrop"),
            layout: &layouts.backdrop,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: values.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&texels) },
            ],
        });
        Self { group, values, image }
    }

    /// Whether it is an image.
    pub(crate) fn is_image(&self) -> bool {
        self.image.is_some()
    }
}
