//! The numbers of a GLB file: triangles by object and material, and their vertices' attributes.

use super::binary::Binary;
use super::material::{Materials, Shown};
use crate::display::{seen_radiance, white_radiance};
use glam::Vec3;
use lumel_scene::{Barycentrics, Bounds, MaterialId, ObjectId, Scene, SurfacePoint, TriId};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

const U32: u32 = 5125;
const F32: u32 = 5126;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The triangles of one object with one material.
pub(super) struct Primitive {
    pub(super) object: ObjectId,
    pub(super) material: MaterialId,
    /// Indices into `corners`.
    indices: Vec<u32>,
    /// For every vertex, one of the scene's corners (`3 * triangle + corner`) that it is at.
    corners: Vec<u32>,
}

/// Sorts the scene's triangles. A vertex that several primitives use is in each of them.
pub(super) fn split(scene: &Scene) -> Vec<Primitive> {
    let mut sorted: BTreeMap<(ObjectId, MaterialId), Vec<u32>> = BTreeMap::new();
    for tri in 0..scene.triangle_count() as u32 {
        sorted.entry((scene.object_id(TriId(tri)), scene.material_id(TriId(tri)))).or_default().push(tri);
    }
    let mut local = vec![u32::MAX; scene.vertex_count()];
    let mut primitives = Vec::with_capacity(sorted.len());
    for ((object, material), tris) in sorted {
        let mut primitive =
            Primitive { object, material, indices: Vec::with_capacity(3 * tris.len()), corners: Vec::new() };
        for corner in tris.iter().flat_map(|tri| 3 * tri..3 * tri + 3) {
            let index = &mut local[vertex(scene, corner)];
            if *index == u32::MAX {
                *index = primitive.corners.len() as u32;
                primitive.corners.push(corner);
            }
            primitive.indices.push(*index);
        }
        for &corner in &primitive.corners {
            local[vertex(scene, corner)] = u32::MAX;
        }
        primitives.push(primitive);
    }
    primitives
}

fn vertex(scene: &Scene, corner: u32) -> usize {
    scene.triangles()[corner as usize / 3][corner as usize % 3] as usize
}

/// All numbers of a file, attribute by attribute: indices, positions, normals, irradiance, colours, texture coordinates.
pub(super) struct Streams<'a> {
    pub(super) scene: &'a Scene,
    pub(super) irradiance: &'a [Vec3],
    pub(super) exposure: f32,
    pub(super) materials: &'a Materials,
    pub(super) primitives: &'a [Primitive],
}

impl Streams<'_> {
    /// Lays out the numbers and returns the description of each primitive.
    pub(super) fn describe(&self, binary: &mut Binary) -> Vec<Value> {
        let n_indices: u64 = self.primitives.iter().map(|p| p.indices.len() as u64).sum();
        let n_vertices: u64 = self.primitives.iter().map(|p| p.corners.len() as u64).sum();
        let n_textured: u64 = self.textured().map(|p| p.corners.len() as u64).sum();
        let indices = binary.add_view(4 * n_indices, json!({ "target": INDICES }));
        let mut vectors = |stride: u64| {
            binary.add_view(stride * n_vertices, json!({ "target": VERTICES, "byteStride": stride }))
        };
        let color = if self.has_alpha() { 16 } else { 12 };
        let [positions, normals, irradiance, colors] =
            [12, 12, 12, color].map(|stride| (vectors(stride), stride));
        let uvs = (n_textured > 0)
            .then(|| binary.add_view(8 * n_textured, json!({ "target": VERTICES, "byteStride": 8 })));
        let (mut first_index, mut first_vertex, mut first_uv) = (0, 0, 0);
        let mut described = Vec::with_capacity(self.primitives.len());
        for primitive in self.primitives {
            let n = primitive.corners.len() as u64;
            let mut vector = |(view, stride): (usize, u64)| {
                binary.add_accessor(json!({
                    "bufferView": view, "byteOffset": stride * first_vertex,
                    "componentType": F32, "type": format!("VEC{}", stride / 4), "count": n,
                }))
            };
            let mut attributes = json!({
                "POSITION": vector(positions), "NORMAL": vector(normals),
                "_IRRADIANCE": vector(irradiance), "COLOR_0": vector(colors),
            });
            let position = attributes["POSITION"].as_u64().unwrap_or_default() as usize;
            let bounds = Bounds::around(self.vertices(primitive).map(|v| self.scene.positions()[v]));
            binary.accessors[position]["min"] = json!(bounds.min.to_array());
            binary.accessors[position]["max"] = json!(bounds.max.to_array());
            if let Some(view) = uvs.filter(|_| self.materials.is_textured(primitive.material)) {
                attributes["TEXCOORD_0"] = json!(binary.add_accessor(json!({
                    "bufferView": view, "byteOffset": 8 * first_uv,
                    "componentType": F32, "type": "VEC2", "count": n,
                })));
                first_uv += n;
            }
            let indices = binary.add_accessor(json!({
                "bufferView": indices, "byteOffset": 4 * first_index,
                "componentType": U32, "type": "SCALAR", "count": primitive.indices.len(),
            }));
            described.push(json!({
                "attributes": attributes, "indices": indices,
                "material": self.materials.index(primitive.material),
            }));
            first_index += primitive.indices.len() as u64;
            first_vertex += n;
        }
        described
    }

    /// Writes the numbers in the order of [`Self::describe`].
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        for index in self.primitives.iter().flat_map(|p| &p.indices) {
            out.write_all(&index.to_le_bytes())?;
        }
        for values in [self.scene.positions(), self.scene.normals(), self.irradiance] {
            for primitive in self.primitives {
                for vertex in self.vertices(primitive) {
                    write_floats(out, &values[vertex].to_array())?;
                }
            }
        }
        for primitive in self.primitives {
            for &corner in &primitive.corners {
                let color = self.color(primitive.material, corner);
                match self.scene.alphas().get(vertex(self.scene, corner)) {
                    Some(&alpha) => write_floats(out, &color.extend(alpha).to_array())?,
                    None => write_floats(out, &color.to_array())?,
                }
            }
        }
        for primitive in self.textured() {
            for vertex in self.vertices(primitive) {
                write_floats(out, &self.scene.uvs()[vertex].to_array())?;
            }
        }
        Ok(())
    }

    /// Whether `COLOR_0` has the alphas of vertices as a fourth component.
    fn has_alpha(&self) -> bool {
        !self.scene.alphas().is_empty()
    }

    /// `COLOR_0`: what times the base colour is seen.
    fn color(&self, material: MaterialId, corner: u32) -> Vec3 {
        let vertex = vertex(self.scene, corner);
        let irradiance = self.irradiance[vertex];
        let color = match Shown::of(&self.scene.materials()[material.index()]) {
            Shown::Reflection | Shown::Apart => white_radiance(irradiance) * self.scene.tints()[vertex],
            Shown::Colors => {
                let bary = Barycentrics::CORNERS[corner as usize % 3];
                let at = SurfacePoint { tri: TriId(corner / 3), bary };
                seen_radiance(self.scene, at, irradiance).0
            }
        };
        (color * self.exposure).clamp(Vec3::ZERO, Vec3::ONE)
    }

    fn vertices<'p>(&'p self, primitive: &'p Primitive) -> impl Iterator<Item = usize> + 'p {
        primitive.corners.iter().map(|&corner| vertex(self.scene, corner))
    }

    fn textured(&self) -> impl Iterator<Item = &Primitive> {
        self.primitives.iter().filter(|p| self.materials.is_textured(p.material))
    }
}

fn write_floats(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    for value in values {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}
