//! The passes of light at scattered points: where surfaces are, the light there, and surfaces under it.
//!
//! Light is gathered once for each pixel, however many triangles it shows: what that costs depends on pixels and levels.

use crate::draw::Draw;
use crate::model::{Batch, Model};
use crate::pipelines::{Detail, Key, Value};
use crate::{Look, PointBuffer, Values};
use std::ops::Range;

impl Draw<'_> {
    /// What is shown of light at points; `None` for what shows no light.
    pub(crate) fn value_of_points(&self) -> Option<Value> {
        match self.frame.look {
            Look::Radiance { .. } => Some(Value::Radiance),
            Look::Irradiance { .. } => Some(Value::Irradiance),
            Look::FalseColor { .. } => Some(Value::Luminance),
            Look::Albedo | Look::Normals | Look::Vectors | Look::Plain => None,
        }
    }

    /// Finds the light of the points that parts of the picture show, in columns.
    pub(crate) fn gather<'v>(&self, encoder: &mut wgpu::CommandEncoder, parts: &[(Values<'v>, Range<u32>)]) {
        let of_points = |(values, columns): &(Values<'v>, Range<u32>)| match *values {
            Values::Points { points, finest, .. } if !columns.is_empty() => {
                Some((points, finest, columns.clone()))
            }
            _ => None,
        };
        let parts: Vec<_> = parts.iter().filter_map(of_points).collect();
        if parts.is_empty() || self.value_of_points().is_none() {
            return;
        }
        self.places(encoder);
        for (i, (points, finest, columns)) in parts.into_iter().enumerate() {
            points.set_finest(self.gpu, finest);
            let load =
                if i == 0 { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
            self.light_of_points(encoder, points, columns, load);
        }
    }

    /// Positions and normals of what pixels show.
    fn places(&self, encoder: &mut wgpu::CommandEncoder) {
        let places = self.target.places(self.gpu, &self.pipelines.layouts);
        let attachment = |view| {
            let ops = wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            };
            Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("places"),
            color_attachments: &places.surface.each_ref().map(attachment),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &places.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let Model { positions, normals, uvs, indices, batches, .. } = self.frame.model;
        pass.set_bind_group(0, &self.target.view_group, &[]);
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        for (slot, buffer) in (0..).zip([positions, uvs, normals]) {
            pass.set_vertex_buffer(slot, buffer.slice(..));
        }
        for batch in batches {
            let detail = Detail { transparent: batch.detail.transparent, ..Detail::default() };
            pass.set_pipeline(&self.pipeline(Key::Places(detail)));
            self.draw_batch(&mut pass, batch);
        }
    }

    fn light_of_points(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        points: &PointBuffer,
        columns: Range<u32>,
        load: wgpu::LoadOp<wgpu::Color>,
    ) {
        let places = self.target.places(self.gpu, &self.pipelines.layouts);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("light of points"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &places.light,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        let [_, height] = self.target.size();
        pass.set_scissor_rect(columns.start, 0, columns.end - columns.start, height);
        pass.set_pipeline(&self.pipeline(Key::Gather));
        pass.set_bind_group(0, &places.group, &[]);
        pass.set_bind_group(1, &points.group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Surfaces under light that was gathered, and that of the vertices.
    pub(crate) fn under_points(&self, pass: &mut wgpu::RenderPass<'_>, value: Value) {
        let Model { normals, uvs, tints, no_tint, batches, .. } = self.frame.model;
        pass.set_bind_group(3, &self.target.places(self.gpu, &self.pipelines.layouts).lit_group, &[]);
        pass.set_vertex_buffer(2, uvs.slice(..));
        pass.set_vertex_buffer(4, normals.slice(..));
        for batch in batches {
            let detail = match value {
                Value::Radiance => batch.detail,
                _ => Detail { transparent: batch.detail.transparent, ..Detail::default() },
            };
            pass.set_pipeline(&self.pipeline(Key::PointSurface(value, detail, self.target.samples())));
            pass.set_vertex_buffer(3, if detail.tint { tints } else { no_tint }.slice(..));
            self.draw_batch(pass, batch);
        }
    }

    fn draw_batch(&self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch) {
        pass.set_bind_group(1, &self.frame.model.materials, &[batch.material]);
        pass.set_bind_group(2, &batch.textures, &[]);
        pass.draw_indexed(batch.indices.clone(), 0, 0..1);
    }
}
