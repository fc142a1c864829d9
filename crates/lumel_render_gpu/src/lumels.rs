//! Values of the lumels of an atlas.

use crate::light::BRIGHTEST;
use crate::memory::{buffer, within_memory};
use crate::pipelines::Layouts;
use crate::shaders::MAX_PAGES;
use crate::{Gpu, RenderError};
use glam::Vec3;
use lumel_uv::Atlas;

/// One linear RGB value per lumel of an atlas, on the device, as far as they are known.
///
/// Where a lumel is not known, light at the vertices shows. Values are kept in 32 bits: no exposure loses any.
#[derive(Debug)]
pub struct LumelBuffer {
    texture: wgpu::Texture,
    pub(crate) group: wgpu::BindGroup,
    pages: Vec<[u32; 2]>,
}

/// A part of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The page.
    pub page: usize,
    /// The first column and row.
    pub min: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// Bytes of a lumel.
const LUMEL: u32 = size_of::<[f32; 4]>() as u32;

impl LumelBuffer {
    /// Lumels of which none is known.
    ///
    /// # Errors
    /// [`RenderError::Atlas`] if the device cannot hold the pages.
    pub(crate) fn new(gpu: &Gpu, layouts: &Layouts, atlas: &Atlas) -> Result<Self, RenderError> {
        let limits = gpu.device().limits();
        let pages = atlas.pages().to_vec();
        let side = limits.max_texture_dimension_2d;
        if pages.len() > MAX_PAGES || pages.iter().flatten().any(|length| *length > side) {
            return Err(RenderError::Atlas { pages: pages.len(), limit: MAX_PAGES, side });
        }
        within_memory(gpu, "lightmap", || Self::make(gpu, layouts, pages))
    }

    /// A page of a single lumel that is not known, for what does not read any.
    pub(crate) fn blank(gpu: &Gpu, layouts: &Layouts) -> Self {
        Self::make(gpu, layouts, vec![[1, 1]])
    }

    fn make(gpu: &Gpu, layouts: &Layouts, pages: Vec<[u32; 2]>) -> Self {
        let longest = |axis: usize| pages.iter().map(|page| page[axis]).max().unwrap_or(1).max(1);
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("lumels"),
            size: wgpu::Extent3d {
                width: longest(0),
                height: longest(1),
                depth_or_array_layers: pages.len().max(1) as u32,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let mut sizes = [[1, 1, 0, 0]; MAX_PAGES];
        sizes.iter_mut().zip(&pages).for_each(|(size, &[width, height])| *size = [width, height, 0, 0]);
        let sizes = buffer(gpu, "pages", wgpu::BufferUsages::UNIFORM, bytemuck::cast_slice(&sizes));
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lumels"),
            layout: &layouts.lumels,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: sizes.as_entire_binding() },
            ],
        });
        Self { texture, group, pages }
    }

    /// Width and height of the pages, lumels.
    pub fn pages(&self) -> &[[u32; 2]] {
        &self.pages
    }

    /// Replaces the lumels of a tile, row by row.
    pub(crate) fn set(&self, gpu: &Gpu, tile: &Tile, values: impl Iterator<Item = Option<Vec3>>) {
        let [width, height] = tile.size;
        let texel = |value: Option<Vec3>| match value {
            Some(value) => {
                let number = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(-BRIGHTEST, BRIGHTEST) };
                let [r, g, b] = value.to_array().map(number);
                [r, g, b, 1.0]
            }
            None => [0.0; 4],
        };
        let texels: Vec<[f32; 4]> = values.map(texel).take(width as usize * height as usize).collect();
        let is_there = self.pages.get(tile.page).is_some_and(|page| {
            (0..2).all(|axis| tile.min[axis].saturating_add(tile.size[axis]) <= page[axis])
        });
        if !is_there || texels.is_empty() || texels.len() < width as usize * height as usize {
            return;
        }
        let origin = wgpu::Origin3d { x: tile.min[0], y: tile.min[1], z: tile.page as u32 };
        let to = wgpu::TexelCopyTextureInfo { origin, ..self.texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * LUMEL),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        gpu.queue().write_texture(to, bytemuck::cast_slice(&texels), layout, size);
    }
}
