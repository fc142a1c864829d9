//! The picture in the window: a copy without filtering, much cheaper on a software renderer than an egui image.

use eframe::egui::{PaintCallbackInfo, Rect, Shape};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use eframe::wgpu;
use std::sync::Arc;

const SOURCE: &str = include_str!("blit.wgsl");

/// What copies a picture into the window's format.
pub(super) struct Blit {
    layout: wgpu::BindGroupLayout,
    pipeline: Arc<wgpu::RenderPipeline>,
}

/// A picture that can be shown in the window.
#[derive(Clone)]
pub struct ShownPicture {
    pipeline: Arc<wgpu::RenderPipeline>,
    group: Arc<wgpu::BindGroup>,
}

impl Blit {
    pub(super) fn new(state: &RenderState) -> Self {
        let device = &state.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("picture"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("blit.wgsl"),
            source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
        });
        let to_linear = if state.target_format.is_srgb() { 1.0 } else { 0.0 };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("picture"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[("TO_LINEAR", to_linear)],
                    ..wgpu::PipelineCompilationOptions::default()
                },
                targets: &[Some(state.target_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { layout, pipeline: Arc::new(pipeline) }
    }

    /// A picture made ready for the window.
    pub(super) fn shown(&self, state: &RenderState, picture: &wgpu::TextureView) -> ShownPicture {
        let group = state.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(picture),
            }],
        });
        ShownPicture { pipeline: Arc::clone(&self.pipeline), group: Arc::new(group) }
    }
}

impl ShownPicture {
    /// The picture over an area of the window.
    pub fn shape(&self, area: Rect) -> Shape {
        Shape::Callback(Callback::new_paint_callback(area, self.clone()))
    }
}

impl CallbackTrait for ShownPicture {
    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &*self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

#[cfg(test)]
mod tests {
    use super::SOURCE;

    #[test]
    fn the_shader_is_valid() {
        let module = naga::front::wgsl::parse_str(SOURCE).unwrap();
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module).unwrap();
    }
}
