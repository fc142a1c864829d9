//! Textures on the device.

use crate::Gpu;
use crate::mips::Pyramid;
use crate::pipelines::Layouts;
use lumel_scene::{Filter, Texture, TextureRef, Wrap};

/// Anisotropic filtering, on devices that do it in hardware.
const ANISOTROPY: u16 = 8;

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
const FILTERS: [Filter; 2] = [Filter::Linear, Filter::Nearest];

/// What all models share: samplers for all filters and wrap modes, and a white texture for materials without one.
#[derive(Debug)]
pub(crate) struct Blank {
    samplers: Vec<wgpu::Sampler>,
    white: Image,
}

/// A texture with the sampler for its filter and wrap modes.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    view: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl Blank {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let sampler = |filter, u, v| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some("texture"),
                address_mode_u: address_mode(u),
                address_mode_v: address_mode(v),
                mag_filter: filter_mode(filter),
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                // The interface allows anisotropy between linear texels only.
                anisotropy_clamp: if gpu.is_software() || filter == Filter::Nearest { 1 } else { ANISOTROPY },
                ..Default::default()
            })
        };
        let wraps = || WRAPS.into_iter().flat_map(|u| WRAPS.map(|v| (u, v)));
        let samplers: Vec<_> = (FILTERS.into_iter())
            .flat_map(|filter| wraps().map(move |(u, v)| (filter, u, v)))
            .map(|(filter, u, v)| sampler(filter, u, v))
            .collect();
        let white = Image { view: send(gpu, "white", &Pyramid::white()), sampler: samplers[0].clone() };
        Self { samplers, white }
    }

    /// Uploads a texture, scaled down if it is too large for the device.
    pub(crate) fn upload(&self, gpu: &Gpu, texture: &Texture) -> Image {
        let limit = gpu.device().limits().max_texture_dimension_2d;
        let view = send(gpu, &texture.name, &Pyramid::new(texture, limit));
        let index = |wrap| WRAPS.iter().position(|w| *w == wrap).unwrap_or(0);
        let filter = FILTERS.iter().position(|f| *f == texture.filter).unwrap_or(0);
        let number = (filter * WRAPS.len() + index(texture.wrap_u)) * WRAPS.len() + index(texture.wrap_v);
        let sampler = &self.samplers[number];
        Image { view, sampler: sampler.clone() }
    }

    /// The bind group of a material's albedo, emission and normal map, and alpha.
    pub(crate) fn textures(
        &self,
        gpu: &Gpu,
        layouts: &Layouts,
        images: &[Image],
        maps: [Option<TextureRef>; 4],
    ) -> wgpu::BindGroup {
        let image = |map: Option<TextureRef>| map.and_then(|map| images.get(map.texture.index()));
        let images = maps.map(|map| image(map).unwrap_or(&self.white));
        bind(gpu, &layouts.textures, &images)
    }

    /// The bind group of a rectangle light with this texture, or without one.
    pub(crate) fn rect_light(&self, gpu: &Gpu, layouts: &Layouts, image: Option<&Image>) -> wgpu::BindGroup {
        bind(gpu, &layouts.rect_light, &[image.unwrap_or(&self.white)])
    }
}

fn filter_mode(filter: Filter) -> wgpu::FilterMode {
    match filter {
        Filter::Linear => wgpu::FilterMode::Linear,
        Filter::Nearest => wgpu::FilterMode::Nearest,
    }
}

fn address_mode(wrap: Wrap) -> wgpu::AddressMode {
    match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    }
}

fn bind(gpu: &Gpu, layout: &wgpu::BindGroupLayout, images: &[&Image]) -> wgpu::BindGroup {
    let resources = images.iter().flat_map(|image| {
        [wgpu::BindingResource::TextureView(&image.view), wgpu::BindingResource::Sampler(&image.sampler)]
    });
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("textures"),
        layout,
        entries: &entries,
    })
}

/// A texture of these levels; there is at least one.
pub(crate) fn send(gpu: &Gpu, label: &str, pyramid: &Pyramid) -> wgpu::TextureView {
    let extent = |[width, height]: [u32; 2]| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(pyramid.levels[0].size),
        mip_level_count: pyramid.levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: pyramid.format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, level) in (0..).zip(&pyramid.levels) {
        let to = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        let [width, height] = level.size;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((level.bytes.len() / height as usize) as u32),
            rows_per_image: None,
        };
        gpu.queue().write_texture(to, &level.bytes, layout, extent([width, height]));
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
