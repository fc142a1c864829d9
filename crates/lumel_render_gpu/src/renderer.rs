//! Draws frames.

use crate::draw;
use crate::light::to_upload;
use crate::mips::{Level, Pyramid};
use crate::pipelines::Pipelines;
use crate::read;
use crate::texture::{self, Blank};
use crate::{Frame, Gpu, LightBuffer, Model, RenderError, Samples, Target};
use lumel_basis::{Lighting, VertexCountError, irradiance_at_vertices};
use lumel_render_cpu::{Picture, false_color_map};
use lumel_scene::Scene;
use std::sync::Arc;

/// Draws frames; holds everything that does not depend on the scene.
#[derive(Debug)]
pub struct Renderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    blank: Blank,
    false_colors: wgpu::TextureView,
}

impl Renderer {
    /// A renderer on a device.
    pub fn new(gpu: Arc<Gpu>) -> Self {
        let pipelines = Pipelines::new(&gpu);
        let (blank, false_colors) = (Blank::new(&gpu), false_colors(&gpu));
        Self { gpu, pipelines, blank, false_colors }
    }

    /// The device.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Uploads the surfaces of a scene.
    ///
    /// # Errors
    /// If they do not fit.
    pub fn upload(&self, scene: &Scene) -> Result<Model, RenderError> {
        Model::new(&self.gpu, &self.pipelines.layouts, &self.blank, scene)
    }

    /// Gives a model the materials of a scene that was [repainted](Scene::repainted); everything else must be the same.
    pub fn repaint(&self, model: &Model, scene: &Scene) {
        model.repaint(&self.gpu, scene);
    }

    /// A light buffer for a model, initially dark.
    pub fn light(&self, model: &Model) -> LightBuffer {
        LightBuffer::new(self.gpu.device(), model.vertex_count())
    }

    /// Replaces the light by that at the vertices of the model's scene. NaN becomes zero.
    ///
    /// The device interpolates linearly between vertices. [`irradiance_at_vertices`] reads or samples the light on the
    /// calling thread: call this when the light has changed, not for every frame.
    ///
    /// # Errors
    /// [`RenderError::Light`] unless model, scene and light have the same number of vertices.
    pub fn set_light(
        &self,
        light: &LightBuffer,
        scene: &Scene,
        lighting: &dyn Lighting,
    ) -> Result<(), RenderError> {
        let values = irradiance_at_vertices(scene, lighting)?;
        VertexCountError::check(values.len(), light.len())?;
        self.gpu.queue().write_buffer(&light.buffer, 0, bytemuck::cast_slice(&to_upload(&values)));
        Ok(())
    }

    /// A picture to draw on.
    ///
    /// # Errors
    /// If the size is zero or too large, or memory runs out.
    pub fn target(&self, size: [u32; 2], samples: Samples) -> Result<Target, RenderError> {
        Target::new(&self.gpu, &self.pipelines.layouts, &self.false_colors, size, samples)
    }

    /// Draws a frame; returns before the device has finished.
    pub fn draw(&self, target: &Target, frame: &Frame<'_>) {
        draw::draw(&self.gpu, &self.pipelines, target, frame);
    }

    /// Waits for the device and reads the picture.
    ///
    /// # Errors
    /// If the device fails, or the picture has more pixels than a [`Picture`] may have.
    pub fn read(&self, target: &Target) -> Result<Picture, RenderError> {
        read::read(&self.gpu, target)
    }
}

/// The map of false colours in a row.
fn false_colors(gpu: &Gpu) -> wgpu::TextureView {
    let map = false_color_map();
    let bytes = map.iter().flat_map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
    let level = Level { size: [map.len() as u32, 1], bytes };
    let pyramid = Pyramid { format: wgpu::TextureFormat::Rgba8Unorm, levels: vec![level] };
    texture::send(gpu, "false colours", &pyramid)
}
