//! The numbers of a GLB file: triangles by object and material, and their vertices' attributes.

use super::binary::Binary;
use super::material::Materials;
use glam::{Vec2, Vec3, Vec4};
use lumel_scene::{Bounds, MaterialId, ObjectId, Scene, TriId};
use lumel_uv::Atlas;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};

pub(super) const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;
pub(super) const VERTICES: u32 = 34962;
pub(super) const INDICES: u32 = 34963;

/// The triangles of one object with one material, on one page of an atlas.
pub(super) struct Primitive {
    pub(super) object: ObjectId,
    pub(super) material: MaterialId,
    pub(super) page: usize,
    /// Indices into `corners`.
    indices: Vec<u32>,
    /// For every vertex, one of the scene's corners (`3 * triangle + corner`) that it is at.
    corners: Vec<u32>,
}

impl Primitive {
    /// For every vertex, a corner of the scene that it is at.
    pub(super) fn corners(&self) -> impl Iterator<Item = u32> {
        self.corners.iter().copied()
    }
}

/// Sorts the scene's triangles. A vertex that several primitives use is in each of them; one that has several places in
/// an atlas is there once for each.
pub(super) fn split(scene: &Scene, atlas: Option<&Atlas>) -> Vec<Primitive> {
    let mut sorted: BTreeMap<(ObjectId, MaterialId, usize), Vec<u32>> = BTreeMap::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let page = atlas.map_or(0, |atlas| atlas.page(tri));
        sorted.entry((scene.object_id(tri), scene.material_id(tri), page)).or_default().push(tri.0);
    }
    let mut primitives = Vec::with_capacity(sorted.len());
    for ((object, material, page), tris) in sorted {
        let indices = Vec::with_capacity(3 * tris.len());
        let mut primitive = Primitive { object, material, page, indices, corners: Vec::new() };
        let mut local = HashMap::new();
        for corner in tris.iter().flat_map(|tri| 3 * tri..3 * tri + 3) {
            let place = atlas.map(|atlas| place(atlas, corner).to_array().map(f32::to_bits));
            let index = *local.entry((vertex(scene, corner), place)).or_insert_with(|| {
                primitive.corners.push(corner);
                primitive.corners.len() as u32 - 1
            });
            primitive.indices.push(index);
        }
        primitives.push(primitive);
    }
    primitives
}

/// The scene's vertex at a corner.
pub(super) fn vertex(scene: &Scene, corner: u32) -> usize {
    scene.triangles()[corner as usize / 3][corner as usize % 3] as usize
}

/// The texture coordinates of the scene at a corner.
pub(super) fn uv(scene: &Scene, corner: u32) -> [f32; 2] {
    scene.uvs()[vertex(scene, corner)].to_array()
}

/// Where a corner is on its page, 0 to 1.
pub(super) fn place(atlas: &Atlas, corner: u32) -> Vec2 {
    atlas.texture_coordinates(TriId(corner / 3))[corner as usize % 3]
}

/// Which vertices have an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Only {
    All,
    /// Those whose material has textures.
    Textured,
    /// Those whose material has a normal map.
    NormalMapped,
}

/// What each vertex has.
pub(super) struct Attribute<'a> {
    /// What glTF calls it.
    pub(super) name: &'static str,
    /// Number of components.
    pub(super) width: usize,
    /// Which vertices have it.
    pub(super) only: Only,
    /// The components at a corner, and zeros after them.
    pub(super) value: Box<dyn Fn(MaterialId, u32) -> [f32; 4] + 'a>,
}

impl<'a> Attribute<'a> {
    /// An attribute of all vertices.
    pub(super) fn new<const WIDTH: usize>(
        name: &'static str,
        value: impl Fn(MaterialId, u32) -> [f32; WIDTH] + 'a,
    ) -> Self {
        let padded = move |material: MaterialId, corner: u32| {
            let mut components = [0.0; 4];
            components[..WIDTH].copy_from_slice(&value(material, corner));
            components
        };
        Self { name, width: WIDTH, only: Only::All, value: Box::new(padded) }
    }

    fn stride(&self) -> u64 {
        4 * self.width as u64
    }
}

/// Tangents, where normal maps have any; any frame where they make no difference.
pub(super) fn tangents(scene: &Scene) -> Option<Attribute<'_>> {
    let tangent = |_, corner| {
        let vertex = vertex(scene, corner);
        let tangent = scene.tangents()[vertex];
        let any = || scene.normals()[vertex].any_orthonormal_vector().extend(1.0);
        if tangent == Vec4::ZERO { any() } else { tangent }.to_array()
    };
    let attribute = Attribute { only: Only::NormalMapped, ..Attribute::new("TANGENT", tangent) };
    (!scene.tangents().is_empty()).then_some(attribute)
}

/// Tints and alphas, where there are any.
pub(super) fn tints(scene: &Scene) -> Option<Attribute<'_>> {
    let tint = |corner: u32| scene.tints()[vertex(scene, corner)].clamp(Vec3::ZERO, Vec3::ONE);
    if !scene.alphas().is_empty() {
        let with_alpha =
            move |_, corner| tint(corner).extend(scene.alphas()[vertex(scene, corner)]).to_array();
        return Some(Attribute::new("COLOR_0", with_alpha));
    }
    let has_any = scene.tints().iter().any(|tint| *tint != Vec3::ONE);
    has_any.then(|| Attribute::new("COLOR_0", move |_, corner| tint(corner).to_array()))
}

/// All numbers of a file, attribute by attribute: indices first.
pub(super) struct Streams<'a> {
    pub(super) scene: &'a Scene,
    pub(super) materials: &'a Materials,
    pub(super) primitives: &'a [Primitive],
    pub(super) attributes: Vec<Attribute<'a>>,
}

impl Streams<'_> {
    /// Lays out the numbers and returns the description of each primitive.
    pub(super) fn describe(&self, binary: &mut Binary) -> Vec<Value> {
        let n_indices: u64 = self.primitives.iter().map(|p| p.indices.len() as u64).sum();
        let indices = binary.add_view(4 * n_indices, json!({ "target": INDICES }));
        // The view of each attribute, if anything has it, and where the next vertex is in it.
        let mut views: Vec<Option<(usize, u64)>> = Vec::new();
        for attribute in &self.attributes {
            let n: u64 = self.with(attribute).map(|p| p.corners.len() as u64).sum();
            let stride = attribute.stride();
            let view = || binary.add_view(stride * n, json!({ "target": VERTICES, "byteStride": stride }));
            views.push((n > 0).then(view).map(|view| (view, 0)));
        }
        let mut first_index = 0;
        let mut described = Vec::with_capacity(self.primitives.len());
        for primitive in self.primitives {
            let n = primitive.corners.len() as u64;
            let mut attributes = json!({});
            for (attribute, view) in self.attributes.iter().zip(&mut views) {
                let Some((view, offset)) = view.as_mut().filter(|_| self.has(primitive, attribute)) else {
                    continue;
                };
                let accessor = binary.add_accessor(json!({
                    "bufferView": view, "byteOffset": offset,
                    "componentType": F32, "type": format!("VEC{}", attribute.width), "count": n,
                }));
                if attribute.name == "POSITION" {
                    let positions = primitive.corners.iter().map(|&corner| vertex(self.scene, corner));
                    let bounds = Bounds::around(positions.map(|v| self.scene.positions()[v]));
                    binary.accessors[accessor]["min"] = json!(bounds.min.to_array());
                    binary.accessors[accessor]["max"] = json!(bounds.max.to_array());
                }
                attributes[attribute.name] = json!(accessor);
                *offset += attribute.stride() * n;
            }
            let indices = binary.add_accessor(json!({
                "bufferView": indices, "byteOffset": 4 * first_index,
                "componentType": U32, "type": "SCALAR", "count": primitive.indices.len(),
            }));
            described.push(json!({
                "attributes": attributes, "indices": indices,
                "material": self.materials.index(primitive),
            }));
            first_index += primitive.indices.len() as u64;
        }
        described
    }

    /// Writes the numbers in the order of [`Self::describe`].
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        for index in self.primitives.iter().flat_map(|p| &p.indices) {
            out.write_all(&index.to_le_bytes())?;
        }
        for attribute in &self.attributes {
            for primitive in self.with(attribute) {
                for &corner in &primitive.corners {
                    for component in &(attribute.value)(primitive.material, corner)[..attribute.width] {
                        out.write_all(&component.to_le_bytes())?;
                    }
                }
            }
        }
        Ok(())
    }

    fn has(&self, primitive: &Primitive, attribute: &Attribute<'_>) -> bool {
        match attribute.only {
            Only::All => true,
            Only::Textured => self.materials.is_textured(primitive.material),
            Only::NormalMapped => self.materials.is_normal_mapped(primitive.material),
        }
    }

    fn with(&self, attribute: &Attribute<'_>) -> impl Iterator<Item = &Primitive> {
        self.primitives.iter().filter(|primitive| self.has(primitive, attribute))
    }
}
