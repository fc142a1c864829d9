//! Values of the lumels of an atlas.

use crate::light::{layers_of, number, packed};
use crate::memory::{buffer, within_memory};
use crate::pipelines::Layouts;
use crate::shaders::MAX_PAGES;
use crate::{Gpu, RenderError};
use glam::Vec3;
use lumel_basis::{Directional, IncidentRadiance};
use lumel_uv::Atlas;

/// One linear RGB value per lumel of an atlas, on the device, as far as they are known.
///
/// Where a lumel is not known, light at the vertices shows. Values are kept in 32 bits: no exposure loses any.
#[derive(Debug)]
pub struct LumelBuffer {
    texture: wgpu::Texture,
    /// Light by direction of the kind, if it is known: as many layers for each page as [`layers_of`] says.
    moments: wgpu::Texture,
    kind: Directional,
    sizes: wgpu::Buffer,
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
        let texture = layers(gpu, "lumels", extent(&pages), pages.len().max(1) as u32);
        let moments = layers(gpu, "no light by direction", [1, 1], 1);
        let mut sizes = [[1, 1, 0, 0]; MAX_PAGES];
        sizes.iter_mut().zip(&pages).for_each(|(size, &[width, height])| *size = [width, height, 0, 0]);
        let sizes = buffer(gpu, "pages", wgpu::BufferUsages::UNIFORM, bytemuck::cast_slice(&sizes));
        let group = group(gpu, layouts, [&texture, &moments], &sizes);
        Self { texture, moments, kind: Directional::Off, sizes, group, pages }
    }

    /// Makes room for light by direction of a kind, zero at first; [`Directional::Off`] frees it.
    ///
    /// # Errors
    /// [`RenderError::Atlas`] if the device cannot hold as many layers.
    pub(crate) fn begin_moments(
        &mut self,
        gpu: &Gpu,
        layouts: &Layouts,
        kind: Directional,
    ) -> Result<(), RenderError> {
        let n_layers = self.pages.len().max(1) as u32 * layers_of(kind);
        let limits = gpu.device().limits();
        if n_layers > limits.max_texture_array_layers {
            let limit = (limits.max_texture_array_layers / layers_of(kind)) as usize;
            let side = limits.max_texture_dimension_2d;
            return Err(RenderError::Atlas { pages: self.pages.len(), limit, side });
        }
        let moments = match kind {
            Directional::Off => layers(gpu, "no light by direction", [1, 1], 1),
            _ => {
                let make = || layers(gpu, "lumels by direction", extent(&self.pages), n_layers);
                within_memory(gpu, "light by direction", make)?
            }
        };
        self.group = group(gpu, layouts, [&self.texture, &moments], &self.sizes);
        (self.moments, self.kind) = (moments, kind);
        Ok(())
    }

    /// What is known of light by direction.
    pub fn directional(&self) -> Directional {
        self.kind
    }

    /// Bytes that light by direction of a kind takes on the device.
    pub fn bytes_of_moments(&self, kind: Directional) -> u64 {
        let [width, height] = extent(&self.pages).map(u64::from);
        width * height * self.pages.len() as u64 * u64::from(layers_of(kind) * LUMEL)
    }

    /// Width and height of the pages, lumels.
    pub fn pages(&self) -> &[[u32; 2]] {
        &self.pages
    }

    /// Replaces the lumels of a tile, row by row.
    pub(crate) fn set(&self, gpu: &Gpu, tile: &Tile, values: impl Iterator<Item = Option<Vec3>>) {
        let texel = |value: Option<Vec3>| match value {
            Some(value) => {
                let [r, g, b] = value.to_array().map(number);
                [r, g, b, 1.0]
            }
            None => [0.0; 4],
        };
        let texels: Vec<[f32; 4]> = values.map(texel).take(tile.len()).collect();
        self.write(gpu, &self.texture, tile, tile.page as u32, &texels);
    }

    /// Replaces light by direction of a tile, row by row, of the kind that there is room for.
    pub(crate) fn set_moments(&self, gpu: &Gpu, tile: &Tile, light: impl Iterator<Item = IncidentRadiance>) {
        let n_layers = layers_of(self.kind) as usize;
        let light: Vec<_> =
            light.take(tile.len()).map(|light| packed(self.kind, light.coefficients())).collect();
        for layer in 0..n_layers {
            let texels: Vec<[f32; 4]> = light.iter().map(|texels| texels[layer]).collect();
            self.write(gpu, &self.moments, tile, (tile.page * n_layers + layer) as u32, &texels);
        }
    }

    /// Writes the texels of a tile into a layer, if the tile is on its page and all are there.
    fn write(&self, gpu: &Gpu, to: &wgpu::Texture, tile: &Tile, layer: u32, texels: &[[f32; 4]]) {
        let [width, height] = tile.size;
        let is_there = self.pages.get(tile.page).is_some_and(|page| {
            (0..2).all(|axis| tile.min[axis].saturating_add(tile.size[axis]) <= page[axis])
        });
        if !is_there || texels.is_empty() || texels.len() < tile.len() {
            return;
        }
        let origin = wgpu::Origin3d { x: tile.min[0], y: tile.min[1], z: layer };
        let to = wgpu::TexelCopyTextureInfo { origin, ..to.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * LUMEL),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        gpu.queue().write_texture(to, bytemuck::cast_slice(texels), layout, size);
    }
}

impl Tile {
    /// Lumels on it.
    fn len(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

/// The width and height that all pages have room in.
fn extent(pages: &[[u32; 2]]) -> [u32; 2] {
    [0, 1].map(|axis| pages.iter().map(|page| page[axis]).max().unwrap_or(1).max(1))
}

fn layers(gpu: &Gpu, label: &str, [width, height]: [u32; 2], count: u32) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: count },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Lumels and their light by direction, as the shaders read them.
fn group(
    gpu: &Gpu,
    layouts: &Layouts,
    textures: [&wgpu::Texture; 2],
    sizes: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let array = wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    };
    let [lumels, moments] = textures.map(|texture| texture.create_view(&array));
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("lumels"),
        layout: &layouts.lumels,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&lumels) },
            wgpu::BindGroupEntry { binding: 1, resource: sizes.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&moments) },
        ],
    })
}
