//! Render targets.

use crate::attachments::{DEPTH, HDR, PICTURE, Samples};
use crate::layout::{Tone, View};
use crate::memory::{buffer, within_memory};
use crate::pipelines::Layouts;
use crate::places::Places;
use crate::{Gpu, RenderError};
use std::sync::OnceLock;

/// A picture on the device, with all its attachments.
#[derive(Debug)]
pub struct Target {
    size: [u32; 2],
    samples: Samples,
    pub(crate) picture: wgpu::Texture,
    view: wgpu::TextureView,
    pub(crate) exposed: Layer,
    pub(crate) depth: wgpu::TextureView,
    /// Created when there is an overlay.
    overlay: OnceLock<(Layer, wgpu::BindGroup)>,
    /// Created when there is light of points.
    places: OnceLock<Places>,
    pub(crate) view_values: wgpu::Buffer,
    pub(crate) view_group: wgpu::BindGroup,
    pub(crate) tone_values: wgpu::Buffer,
    pub(crate) tone_group: wgpu::BindGroup,
}

/// A colour attachment with its samples, and their mean.
#[derive(Debug)]
pub(crate) struct Layer {
    /// `None` when there is only one sample.
    samples: Option<wgpu::TextureView>,
    mean: wgpu::TextureView,
}

impl Layer {
    fn new(gpu: &Gpu, label: &str, size: [u32; 2], samples: Samples, format: wgpu::TextureFormat) -> Self {
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let view = |samples, usage| view(&texture(gpu, label, size, samples, format, usage));
        Self {
            samples: (samples != Samples::One).then(|| view(samples, attachment)),
            mean: view(Samples::One, attachment | wgpu::TextureUsages::TEXTURE_BINDING),
        }
    }

    /// The attachment, cleared to a colour and resolved to the mean.
    pub(crate) fn cleared(&self, color: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
        let (view, resolve_target, store) = match &self.samples {
            Some(samples) => (samples, Some(&self.mean), wgpu::StoreOp::Discard),
            None => (&self.mean, None, wgpu::StoreOp::Store),
        };
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(color), store };
        wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target, ops }
    }
}

impl Target {
    pub(crate) fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        false_colors: &wgpu::TextureView,
        size: [u32; 2],
        samples: Samples,
    ) -> Result<Self, RenderError> {
        let [width, height] = size;
        let limit = gpu.device().limits().max_texture_dimension_2d;
        if size.iter().any(|n| !(1..=limit).contains(n)) {
            return Err(RenderError::Size { width, height, limit });
        }
        let what = format!("a picture of {width} x {height} pixels");
        within_memory(gpu, &what, || Self::make(gpu, layouts, false_colors, size, samples))
    }

    fn make(
        gpu: &Gpu,
        layouts: &Layouts,
        false_colors: &wgpu::TextureView,
        size: [u32; 2],
        samples: Samples,
    ) -> Self {
        use wgpu::BindingResource::TextureView;
        use wgpu::TextureUsages as Usage;
        let usage = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let picture = texture(gpu, "picture", size, Samples::One, PICTURE, usage);
        let exposed = Layer::new(gpu, "exposed", size, samples, HDR);
        let uniform = |label, size: usize| buffer(gpu, label, wgpu::BufferUsages::UNIFORM, &vec![0; size]);
        let view_values = uniform("view", size_of::<View>());
        let tone_values = uniform("tone", size_of::<Tone>());
        let view_group = bind(gpu, &layouts.view, &[view_values.as_entire_binding()]);
        let resources =
            [TextureView(&exposed.mean), tone_values.as_entire_binding(), TextureView(false_colors)];
        let tone_group = bind(gpu, &layouts.tone, &resources);
        Self {
            size,
            samples,
            view: view(&picture),
            picture,
            exposed,
            depth: view(&texture(gpu, "depth", size, samples, DEPTH, Usage::RENDER_ATTACHMENT)),
            overlay: OnceLock::new(),
            places: OnceLock::new(),
            view_values,
            view_group,
            tone_values,
            tone_group,
        }
    }

    /// The overlay, and how it is composited.
    pub(crate) fn overlay(&self, gpu: &Gpu, layouts: &Layouts) -> &(Layer, wgpu::BindGroup) {
        self.overlay.get_or_init(|| {
            let layer = Layer::new(gpu, "overlay", self.size, self.samples, PICTURE);
            let group = bind(gpu, &layouts.composite, &[wgpu::BindingResource::TextureView(&layer.mean)]);
            (layer, group)
        })
    }

    /// What light of points is found with.
    pub(crate) fn places(&self, gpu: &Gpu, layouts: &Layouts) -> &Places {
        self.places.get_or_init(|| Places::new(gpu, layouts, self.size))
    }

    /// The picture as `Rgba8Unorm` that holds sRGB codes: the format that egui expects and PNG stores.
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

pub(crate) fn texture(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    samples: Samples,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples.count(),
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

pub(crate) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

pub(crate) fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let numbered = (0..).zip(resources.iter().cloned());
    let entries: Vec<_> =
        numbered.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
