//! Small documents for tests, made in code.

use super::read;
use crate::paths::Resolver;
use crate::{Imported, PathPolicy};
use glam::{DVec3, Vec3};
use lumel_scene::{ObjectMesh, Warnings};
use serde_json::{Value, json};
use std::io::Cursor;
use std::path::Path;

pub(super) const U8: u32 = 5121;
pub(super) const U16: u32 = 5123;
pub(super) const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;

/// A document and its binary chunk.
#[derive(Clone)]
pub(super) struct Model {
    pub(super) json: Value,
    pub(super) bin: Vec<u8>,
}

impl Model {
    /// A document with nothing in it.
    pub(super) fn empty() -> Self {
        Self { json: json!({ "asset": { "version": "2.0" } }), bin: Vec::new() }
    }

    /// Node 0 shows mesh 0: a triangle from the origin along x and y, which faces +z. Accessor 0 holds its positions.
    pub(super) fn triangle() -> Self {
        let mut model = Self::empty();
        let positions = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        model.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": positions } }] }));
        model.push("nodes", json!({ "mesh": 0 }));
        model
    }

    /// Appends to a list of the document and returns the index.
    pub(super) fn push(&mut self, list: &str, item: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let items = list.as_array_mut().unwrap();
        items.push(item);
        items.len() - 1
    }

    /// Appends bytes and returns the view of them.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend(bytes);
        self.push("bufferViews", view)
    }

    pub(super) fn accessor(&mut self, component: u32, kind: &str, count: u64, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        self.push("accessors", accessor)
    }

    pub(super) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "MAT4" => 16,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(F32, kind, (values.len() / width) as u64, &bytes)
    }

    /// An image of one texel and a texture of it.
    pub(super) fn texture(&mut self, rgb: [u8; 3]) -> usize {
        let mut png = Cursor::new(Vec::new());
        let image = image::RgbImage::from_pixel(1, 1, image::Rgb(rgb));
        image.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let view = self.view(png.get_ref());
        let image = self.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        self.push("textures", json!({ "source": image }))
    }

    /// The first primitive of the first mesh.
    pub(super) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if let Some(document) = json.as_object_mut() {
            document.entry("buffers").or_insert_with(|| json!([{ "byteLength": self.bin.len() }]));
        }
        let mut json = serde_json::to_vec(&json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.bin.len();
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend((length as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bin)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }

    /// What becomes of it, or the message.
    pub(super) fn read(&self) -> Result<Imported, String> {
        read_bytes(&self.glb())
    }

    /// The only object.
    pub(super) fn object(&self) -> ObjectMesh {
        let imported = self.read().unwrap();
        assert_eq!(imported.scene.objects.len(), 1);
        imported.scene.objects[0].clone()
    }

    pub(super) fn error(&self) -> String {
        self.read().map(|_| "no error").unwrap_err()
    }
}

pub(super) fn read_bytes(bytes: &[u8]) -> Result<Imported, String> {
    let resolver = Resolver::new(Path::new("model.glb"), PathPolicy::WithinFolder).unwrap();
    read(bytes, &resolver, glam::DVec3::ZERO).map_err(|fault| fault.to_string())
}

/// All warnings, one a line.
pub(super) fn text(warnings: &Warnings) -> String {
    warnings.iter().map(|warning| format!("{warning}\n")).collect()
}

/// Unit normals of the faces from their winding.
pub(super) fn facing(object: &ObjectMesh) -> Vec<Vec3> {
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero().as_vec3();
    object.faces.iter().map(|face| normal(object.corners(face).map(|p| p.as_dvec3()))).collect()
}
