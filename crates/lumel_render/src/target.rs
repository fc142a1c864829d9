//! Where pictures are drawn.

use crate::{Gpu, RenderError};

/// Samples per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Samples {
    /// One, at the centre: the fastest.
    One,
    /// Four: smooth edges.
    #[default]
    Four,
}

impl Samples {
    /// As a number.
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

/// A picture on the device.
#[derive(Debug)]
pub struct Target {
    size: [u32; 2],
    samples: Samples,
    pub(crate) picture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Target {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], samples: Samples) -> Result<Self, RenderError> {
        let [width, height] = size;
        let limit = gpu.device().limits().max_texture_dimension_2d;
        if size.iter().any(|n| !(1..=limit).contains(n)) {
            return Err(RenderError::Size { width, height, limit });
        }
        let picture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { size, samples, picture, view })
    }

    /// The picture as `Rgba8Unorm` that holds sRGB codes: what egui wants of a texture, and what a PNG stores.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Samples per pixel.
    pub fn samples(&self) -> Samples {
        self.samples
    }
}
