//! Draws frames.

use crate::draw;
use crate::mips::{Level, Pyramid};
use crate::pipelines::Pipelines;
use crate::read;
use crate::texture::{self, Blank};
use crate::{
    Backdrop, Frame, Gpu, LightBuffer, LumelBuffer, Model, PointBuffer, RenderError, Samples, Target, Tile,
};
use glam::Vec3;
use lumel_basis::{
    Directional, IncidentRadiance, Lighting, PointCloud, VertexCountError, incident_at_vertices,
    irradiance_at_vertices,
};
use lumel_render_cpu::{Picture, false_color_map};
use lumel_scene::{Scene, Sky};
use lumel_uv::Atlas;
use std::sync::Arc;

/// Draws frames; holds everything that does not depend on the scene.
#[derive(Debug)]
pub struct Renderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    blank: Blank,
    no_lumels: LumelBuffer,
    false_colors: wgpu::TextureView,
}

impl Renderer {
    /// A renderer on a device.
    pub fn new(gpu: Arc<Gpu>) -> Self {
        let pipelines = Pipelines::new(&gpu);
        let (blank, false_colors) = (Blank::new(&gpu), false_colors(&gpu));
        let no_lumels = LumelBuffer::blank(&gpu, &pipelines.layouts);
        Self { gpu, pipelines, blank, no_lumels, false_colors }
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
        Model::new(&self.gpu, &self.pipelines.layouts, &self.blank, scene, None)
    }

    /// Uploads the surfaces of a scene with their places in an atlas, so that light on its lumels can be shown.
    ///
    /// # Errors
    /// If they do not fit.
    pub fn upload_with_atlas(&self, scene: &Scene, atlas: &Atlas) -> Result<Model, RenderError> {
        Model::new(&self.gpu, &self.pipelines.layouts, &self.blank, scene, Some(atlas))
    }

    /// Gives a model the materials of a scene that was [repainted](Scene::repainted); everything else must be the same.
    pub fn repaint(&self, model: &Model, scene: &Scene) {
        model.repaint(&self.gpu, scene);
    }

    /// A light buffer for a model, initially dark.
    pub fn light(&self, model: &Model) -> LightBuffer {
        LightBuffer::new(self.gpu.device(), model.vertex_count(), model.sources.clone())
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
        light.set(self.gpu.queue(), &values);
        light.set_moments(&self.gpu, incident_at_vertices(scene, lighting).as_deref());
        Ok(())
    }

    /// A buffer for the lumels of an atlas, of which none is known.
    ///
    /// # Errors
    /// If they do not fit.
    pub fn lumels(&self, atlas: &Atlas) -> Result<LumelBuffer, RenderError> {
        LumelBuffer::new(&self.gpu, &self.pipelines.layouts, atlas)
    }

    /// Replaces the lumels of a part of a page, row by row; NaN becomes zero. A part that is not on the page is left out.
    pub fn set_lumels(&self, lumels: &LumelBuffer, tile: &Tile, values: impl Iterator<Item = Option<Vec3>>) {
        lumels.set(&self.gpu, tile, values);
    }

    /// Makes room for light by direction on the lumels, zero at first; [`Directional::Off`] frees it. Where there is none,
    /// light by direction of the vertices is shown.
    ///
    /// # Errors
    /// If it does not fit.
    pub fn begin_lumel_moments(
        &self,
        lumels: &mut LumelBuffer,
        kind: Directional,
    ) -> Result<(), RenderError> {
        lumels.begin_moments(&self.gpu, &self.pipelines.layouts, kind)
    }

    /// Replaces light by direction on a part of a page, row by row. A part that is not on the page is left out.
    pub fn set_lumel_moments(
        &self,
        lumels: &LumelBuffer,
        tile: &Tile,
        light: impl Iterator<Item = IncidentRadiance>,
    ) {
        lumels.set_moments(&self.gpu, tile, light);
    }

    /// A buffer for scattered points, initially dark.
    ///
    /// # Errors
    /// [`RenderError::Points`] if they do not fit.
    pub fn points(&self, cloud: &PointCloud) -> Result<PointBuffer, RenderError> {
        PointBuffer::new(&self.gpu, &self.pipelines.layouts, cloud)
    }

    /// Replaces the light at scattered points, in the order of their cloud. NaN becomes zero.
    pub fn set_points(&self, points: &PointBuffer, values: &[Vec3]) {
        points.set(&self.gpu, values);
    }

    /// A sky to draw behind surfaces; `before`, which it replaces, is changed where it has the same image. `None` for a sky that is the
    /// same everywhere.
    ///
    /// # Errors
    /// If it does not fit.
    pub fn backdrop(&self, sky: &Sky, before: Option<Backdrop>) -> Result<Option<Backdrop>, RenderError> {
        Backdrop::new(&self.gpu, &self.pipelines.layouts, sky, before)
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
        draw::draw(&self.gpu, &self.pipelines, &self.no_lumels, target, frame);
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
