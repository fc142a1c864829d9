//! The passes of a frame: scene, tone mapper, overlay.

use crate::display::Shown;
use crate::layout::View;
use crate::light::Moments;
use crate::memory::buffer;
use crate::model::{Batch, Model};
use crate::overlay::Hidden;
use crate::pipelines::{Detail, Green, Key, Layer, Pipelines, Quantity, Reading, Shade, Tilt, Value};
use crate::rect_lights::{RectLightInstance, instances};
use crate::shaders::MAX_F16;
use crate::{Frame, Gpu, LightBuffer, Lit, Look, LumelBuffer, Target, Values};

/// Draws a frame on a target.
pub(crate) fn draw(
    gpu: &Gpu,
    pipelines: &Pipelines,
    no_lumels: &LumelBuffer,
    target: &Target,
    frame: &Frame<'_>,
) {
    let shown = Shown::of(&frame.look);
    let ripple = frame.ripple.map(|rippled| rippled.ripple);
    let view = View::new(frame.camera, frame.model.near, target.size(), shown.exposure, ripple);
    if let Some(view) = &view {
        gpu.queue().write_buffer(&target.view_values, 0, bytemuck::bytes_of(view));
    }
    gpu.queue().write_buffer(&target.tone_values, 0, bytemuck::bytes_of(&shown.tone));
    let draw = Draw { gpu, pipelines, no_lumels, target, frame };
    // A camera without a view sees nothing.
    let sees = view.is_some();
    let marks = sees && draw.has_marks();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    if sees {
        let parts: Vec<_> =
            draw.parts(target.size()[0]).into_iter().map(|part| (part.light, part.columns)).collect();
        draw.gather(&mut encoder, &parts);
    }
    draw.scene(
        &mut encoder,
        sees,
        if marks { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard },
        shown.exposure,
    );
    draw.tone(&mut encoder, Key::Tone(shown.curve));
    if marks {
        draw.overlay(&mut encoder);
    }
    gpu.queue().submit([encoder.finish()]);
}

/// A part of the picture.
struct Part<'a> {
    light: Values<'a>,
    columns: std::ops::Range<u32>,
    surfaces: Surfaces,
}

/// Whether normals are tilted as the frame says.
#[derive(Clone, Copy, PartialEq)]
enum Surfaces {
    Tilted,
    Smooth,
}

/// A picture that is drawn.
pub(crate) struct Draw<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pipelines: &'a Pipelines,
    no_lumels: &'a LumelBuffer,
    pub(crate) target: &'a Target,
    pub(crate) frame: &'a Frame<'a>,
}

impl Draw<'_> {
    pub(crate) fn pipeline(&self, key: Key) -> wgpu::RenderPipeline {
        self.pipelines.get(self.gpu.device(), key)
    }

    fn shows_edges(&self) -> bool {
        self.frame.wireframe && self.gpu.draws_wireframes()
    }

    fn shows_grid(&self) -> bool {
        self.frame.grid && self.frame.model.has_atlas()
    }

    fn has_marks(&self) -> bool {
        let marks = |overlay: &crate::Overlay| overlay.dots.count + overlay.lines.count > 0;
        self.shows_edges() || self.shows_grid() || self.frame.overlay.is_some_and(marks)
    }

    fn background(&self, exposure: f32) -> wgpu::Color {
        let Look::Radiance { .. } = self.frame.look else { return wgpu::Color::TRANSPARENT };
        let channel = |x: f32| {
            let exposed = x * exposure;
            f64::from(if exposed.is_nan() { 0.0 } else { exposed.clamp(-MAX_F16, MAX_F16) })
        };
        let [r, g, b] = self.frame.sky.0.to_array().map(channel);
        wgpu::Color { r, g, b, a: 0.0 }
    }

    /// The sky, where it is not the same everywhere.
    fn backdrop(&self, pass: &mut wgpu::RenderPass<'_>) {
        let (Look::Radiance { .. }, Some(backdrop)) = (self.frame.look, self.frame.backdrop) else { return };
        let (is_image, samples) = (backdrop.is_image(), self.target.samples());
        pass.set_pipeline(&self.pipeline(Key::Backdrop { is_image, samples }));
        pass.set_bind_group(1, &backdrop.group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn scene(&self, encoder: &mut wgpu::CommandEncoder, sees: bool, depth: wgpu::StoreOp, exposure: f32) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(self.target.exposed.cleared(self.background(exposure)))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.target.depth,
                // Infinitely far away.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: depth }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        if !sees {
            return;
        }
        pass.set_bind_group(0, &self.target.view_group, &[]);
        self.backdrop(&mut pass);
        let [width, height] = self.target.size();
        for Part { light, columns, surfaces } in self.parts(width) {
            if columns.is_empty() || !self.fits(light) {
                continue;
            }
            pass.set_scissor_rect(columns.start, 0, columns.end - columns.start, height);
            self.surfaces(&mut pass, light, surfaces);
        }
        pass.set_scissor_rect(0, 0, width, height);
        if let Look::Radiance { .. } = self.frame.look {
            self.rect_lights(&mut pass);
        }
    }

    /// Whether values are those of the model.
    fn fits(&self, values: Values<'_>) -> bool {
        let (Values::Vertices(vertices) | Values::Lumels { vertices, .. } | Values::Points { vertices, .. }) =
            values;
        let model = self.frame.model;
        vertices.fits(model.vertex_count(), model.sources.as_ref())
    }

    /// What is shown in each range of columns.
    fn parts(&self, width: u32) -> Vec<Part<'_>> {
        let split = |left, right, at: f32, surfaces| {
            // Casting NaN gives 0.
            let divider = ((at.clamp(0.0, 1.0) * width as f32).round() as u32).min(width);
            vec![
                Part { light: left, columns: 0..divider, surfaces: Surfaces::Tilted },
                Part { light: right, columns: divider..width, surfaces },
            ]
        };
        match self.frame.light {
            Lit::One(light) => vec![Part { light, columns: 0..width, surfaces: Surfaces::Tilted }],
            Lit::Split { left, right, at } => split(left, right, at, Surfaces::Tilted),
            Lit::Smooth { light, at } => split(light, light, at, Surfaces::Smooth),
        }
    }

    fn surfaces(&self, pass: &mut wgpu::RenderPass<'_>, values: Values<'_>, surfaces: Surfaces) {
        let Model { positions, normals, uvs, places, tints, no_tint, indices, .. } = self.frame.model;
        let samples = self.target.samples();
        let (light, lumels, reading) = match values {
            Values::Lumels { lumels, filter, vertices } if self.frame.model.has_atlas() => {
                (vertices, lumels, Reading::from(filter))
            }
            Values::Vertices(vertices)
            | Values::Lumels { vertices, .. }
            | Values::Points { vertices, .. } => (vertices, self.no_lumels, Reading::Vertices),
        };
        let tilt = |batch: &Batch| match surfaces {
            Surfaces::Tilted => self.tilt(batch),
            Surfaces::Smooth => Tilt::default(),
        };
        let shade = self.shade(light, lumels).filter(|_| surfaces == Surfaces::Tilted);
        pass.set_bind_group(3, &lumels.group, &[]);
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.set_vertex_buffer(0, positions.slice(..));
        pass.set_vertex_buffer(1, light.buffer.slice(..));
        if let (Values::Points { .. }, Some(value)) = (values, self.value_of_points()) {
            return self.under_points(pass, value);
        }
        let quantity = match self.frame.look {
            Look::Radiance { .. } => Quantity::Radiance,
            Look::Albedo => Quantity::Albedo,
            Look::Irradiance { .. } => return self.light(pass, Value::Irradiance, reading, shade),
            Look::FalseColor { .. } => return self.light(pass, Value::Luminance, reading, shade),
            Look::Vectors => return self.light(pass, Value::Vector, reading, None),
            Look::Plain if reading != Reading::Vertices => {
                return self.light(pass, Value::Color, reading, None);
            }
            Look::Plain => {
                pass.set_vertex_buffer(2, normals.slice(..));
                return self.everything(pass, Key::Plain(samples));
            }
            Look::Normals => return self.normals(pass, tilt),
        };
        pass.set_vertex_buffer(2, uvs.slice(..));
        let mut last = None;
        for batch in &self.frame.model.batches {
            let detail = match quantity {
                Quantity::Radiance => batch.detail,
                Quantity::Albedo => Detail { emission_map: false, ..batch.detail },
            };
            let tilt = tilt(batch);
            if let (Some((shade, moments)), Quantity::Radiance) = (&shade, quantity)
                && tilt != Tilt::default()
            {
                last = None;
                let key = Key::Relief(Value::Radiance, detail, reading, tilt, *shade, samples);
                self.relief(pass, batch, key, moments);
                continue;
            }
            let key = match (detail == Detail::default(), quantity) {
                (true, Quantity::Radiance) if reading == Reading::Vertices => {
                    Key::Value(Value::Radiance, samples)
                }
                (true, Quantity::Albedo) => Key::Value(Value::Albedo, samples),
                _ => Key::Surface(quantity, detail, reading, samples),
            };
            if last != Some(key) {
                pass.set_pipeline(&self.pipeline(key));
                last = Some(key);
            }
            pass.set_bind_group(1, &self.frame.model.materials, &[batch.material]);
            if let Key::Surface(..) = key {
                pass.set_bind_group(2, &batch.textures, &[]);
                pass.set_vertex_buffer(3, if detail.tint { tints } else { no_tint }.slice(..));
                pass.set_vertex_buffer(4, places.slice(..));
            }
            pass.draw_indexed(batch.indices.clone(), 0, 0..1);
        }
    }

    /// What tilts the normals of a batch.
    fn tilt(&self, batch: &Batch) -> Tilt {
        let ripple = self.frame.ripple.is_some_and(|rippled| rippled.materials.contains(&batch.material_id));
        Tilt { map: Green::of(self.frame.relief.maps).filter(|_| batch.has_normal_map), ripple }
    }

    /// How light on tilted normals is found, and what is known of it; `None` if there are none or it is not known.
    fn shade(&self, light: &LightBuffer, lumels: &LumelBuffer) -> Option<(Shade, Moments)> {
        let is_tilted = self.frame.model.batches.iter().any(|batch| self.tilt(batch) != Tilt::default());
        let moments = light.moments().filter(|_| is_tilted)?;
        let on_lumels = lumels.directional() == moments.kind;
        Some((Shade::new(self.frame.relief.shading, moments.kind, on_lumels), moments))
    }

    /// Light as it arrives, which does not depend on materials but for their normals.
    fn light(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        value: Value,
        reading: Reading,
        shade: Option<(Shade, Moments)>,
    ) {
        let Model { normals, places, .. } = self.frame.model;
        let samples = self.target.samples();
        let plain = match reading {
            Reading::Vertices => Key::Value(value, samples),
            _ => Key::LumelValue(value, reading, samples),
        };
        let set_plain = |pass: &mut wgpu::RenderPass<'_>| {
            if reading != Reading::Vertices {
                pass.set_vertex_buffer(2, normals.slice(..));
                pass.set_vertex_buffer(3, places.slice(..));
            }
        };
        let Some((shade, moments)) = shade else {
            set_plain(pass);
            return self.everything(pass, plain);
        };
        for batch in &self.frame.model.batches {
            let tilt = self.tilt(batch);
            if tilt != Tilt::default() {
                let key = Key::Relief(value, Detail::default(), reading, tilt, shade, samples);
                self.relief(pass, batch, key, &moments);
                continue;
            }
            set_plain(pass);
            pass.set_pipeline(&self.pipeline(plain));
            pass.set_bind_group(1, &self.frame.model.materials, &[batch.material]);
            pass.draw_indexed(batch.indices.clone(), 0, 0..1);
        }
    }

    /// Triangles whose normals are tilted. Leaves texture coordinates in place.
    fn relief(&self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, key: Key, moments: &Moments) {
        let Model { normals, uvs, tangents, places, tints, no_tint, .. } = self.frame.model;
        let is_tinted = matches!(key, Key::Relief(_, Detail { tint: true, .. }, ..));
        pass.set_pipeline(&self.pipeline(key));
        pass.set_bind_group(1, &self.frame.model.materials, &[batch.material]);
        pass.set_bind_group(2, &batch.textures, &[]);
        let tint = if is_tinted { tints } else { no_tint };
        for (slot, buffer) in (2..).zip([uvs, tint, places, normals, tangents, &moments.buffer]) {
            pass.set_vertex_buffer(slot, buffer.slice(..));
        }
        pass.draw_indexed(batch.indices.clone(), 0, 0..1);
    }

    /// All triangles at once, for quantities that do not depend on materials.
    fn everything(&self, pass: &mut wgpu::RenderPass<'_>, key: Key) {
        pass.set_pipeline(&self.pipeline(key));
        if let Key::Value(..) = key {
            pass.set_bind_group(1, &self.frame.model.materials, &[0]);
        }
        pass.draw_indexed(self.frame.model.all_indices(), 0, 0..1);
    }

    fn normals(&self, pass: &mut wgpu::RenderPass<'_>, tilt: impl Fn(&Batch) -> Tilt) {
        let model = self.frame.model;
        pass.set_vertex_buffer(1, model.normals.slice(..));
        pass.set_vertex_buffer(2, model.uvs.slice(..));
        pass.set_vertex_buffer(3, model.tangents.slice(..));
        for batch in &model.batches {
            pass.set_pipeline(&self.pipeline(Key::Normals(tilt(batch), self.target.samples())));
            pass.set_bind_group(1, &model.materials, &[batch.material]);
            pass.set_bind_group(2, &batch.textures, &[]);
            pass.draw_indexed(batch.indices.clone(), 0, 0..1);
        }
    }

    fn rect_lights(&self, pass: &mut wgpu::RenderPass<'_>) {
        let model = self.frame.model;
        let rect_lights = instances(self.frame.rect_lights);
        if rect_lights.is_empty() {
            return;
        }
        let values: Vec<RectLightInstance> = rect_lights.iter().map(|(values, _)| *values).collect();
        let bytes = bytemuck::cast_slice(&values);
        let buffer = buffer(self.gpu, "rect_lights", wgpu::BufferUsages::VERTEX, bytes);
        pass.set_pipeline(&self.pipeline(Key::RectLight(self.target.samples())));
        pass.set_vertex_buffer(0, buffer.slice(..));
        for (i, (_, texture)) in (0..).zip(&rect_lights) {
            let group = texture.and_then(|id| model.textured_rect_lights.get(id.index()));
            pass.set_bind_group(1, group.unwrap_or(&model.plain_rect_light), &[]);
            pass.draw(0..6, i..i + 1);
        }
    }

    fn tone(&self, encoder: &mut wgpu::CommandEncoder, key: Key) {
        let mut pass = self.screen(encoder, "tone mapper", wgpu::LoadOp::Clear(wgpu::Color::BLACK));
        pass.set_pipeline(&self.pipeline(key));
        pass.set_bind_group(0, &self.target.tone_group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn screen<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
        load: wgpu::LoadOp<wgpu::Color>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.target.view(),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        })
    }

    fn overlay(&self, encoder: &mut wgpu::CommandEncoder) {
        let (layer, group) = self.target.overlay(self.gpu, &self.pipelines.layouts);
        self.marks(encoder, layer);
        let mut pass = self.screen(encoder, "composite", wgpu::LoadOp::Load);
        pass.set_pipeline(&self.pipeline(Key::Composite));
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn marks(&self, encoder: &mut wgpu::CommandEncoder, layer: &crate::target::Layer) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overlay"),
            color_attachments: &[Some(layer.cleared(wgpu::Color::TRANSPARENT))],
            // Read only.
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.target.depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let samples = self.target.samples();
        pass.set_bind_group(0, &self.target.view_group, &[]);
        if self.shows_edges() {
            let model = self.frame.model;
            pass.set_pipeline(&self.pipeline(Key::Edges(samples)));
            pass.set_vertex_buffer(0, model.positions.slice(..));
            pass.set_index_buffer(model.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(model.all_indices(), 0, 0..1);
        }
        if self.shows_grid() {
            let model = self.frame.model;
            pass.set_pipeline(&self.pipeline(Key::Grid(samples)));
            pass.set_vertex_buffer(0, model.positions.slice(..));
            pass.set_vertex_buffer(1, model.places.slice(..));
            pass.set_index_buffer(model.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(model.all_indices(), 0, 0..1);
        }
        let Some(overlay) = self.frame.overlay else { return };
        let layers: &[Layer] = match overlay.hidden() {
            Hidden::Invisible => &[Layer::Seen],
            Hidden::Faint => &[Layer::Behind, Layer::Seen],
        };
        for &layer in layers {
            let kinds =
                [(&overlay.lines, Key::Lines(layer, samples)), (&overlay.dots, Key::Dots(layer, samples))];
            for (marks, key) in kinds.into_iter().filter(|(marks, _)| marks.count > 0) {
                pass.set_pipeline(&self.pipeline(key));
                pass.set_vertex_buffer(0, marks.buffer.slice(..));
                pass.draw(0..4, 0..marks.count);
            }
        }
    }
}
