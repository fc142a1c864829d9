//! The materials and images of a GLB file.

use super::binary::Binary;
use crate::pixels::{self, srgb_pixels};
use crate::png::encode_png;
use glam::Vec3;
use lumel_scene::{
    MAX_ALBEDO, Material, MaterialId, Scene, Texture, TextureId, TextureRef, TriId, UvTransform, Wrap,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

const LINEAR: u32 = 9729;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;
const NO_INDEX: usize = usize::MAX;

/// Materials and textures that the scene's triangles use, ready to be written.
pub(super) struct Materials {
    /// Index in the file of each of the scene's materials; `NO_INDEX` for unused ones.
    index: Vec<usize>,
    textured: Vec<bool>,
    json: Vec<Value>,
    images: Vec<Image>,
    uses_transform: bool,
}

struct Image {
    name: String,
    png: Vec<u8>,
    wrap: [Wrap; 2],
}

/// The textures of a file under construction.
#[derive(Default)]
struct Images {
    list: Vec<Image>,
    index: BTreeMap<TextureId, usize>,
}

impl Materials {
    pub(super) fn new(scene: &Scene, exposure: f32) -> io::Result<Self> {
        let n = scene.materials().len();
        let mut used = vec![false; n];
        for tri in 0..scene.triangle_count() as u32 {
            used[scene.material_id(TriId(tri)).index()] = true;
        }
        let mut materials = Self {
            index: vec![NO_INDEX; n],
            textured: vec![false; n],
            json: Vec::new(),
            images: Vec::new(),
            uses_transform: false,
        };
        let mut images = Images::default();
        for (id, material) in scene.materials().iter().enumerate().filter(|(id, _)| used[*id]) {
            materials.index[id] = materials.json.len();
            let (factor, texture) = base_color(scene, material, exposure);
            let base_texture = texture.map(|t| images.reference(scene, t)).transpose()?;
            materials.textured[id] = base_texture.is_some();
            materials.json.push(describe(material, factor, base_texture));
            materials.uses_transform |= texture.is_some_and(|t| transform(&t.transform).is_some());
        }
        materials.images = images.list;
        Ok(materials)
    }

    /// Index in the file.
    pub(super) fn index(&self, material: MaterialId) -> usize {
        self.index[material.index()]
    }

    /// Whether the base colour has a texture.
    pub(super) fn is_textured(&self, material: MaterialId) -> bool {
        self.textured[material.index()]
    }

    /// Adds materials, textures, samplers and images to the document.
    pub(super) fn add_to(&self, document: &mut Value, binary: &mut Binary) {
        let mut extensions = vec!["KHR_materials_unlit"];
        document["materials"] = self.json.clone().into();
        if !self.images.is_empty() {
            let indices = 0..self.images.len();
            document["textures"] =
                indices.map(|index| json!({ "source": index, "sampler": index })).collect();
            document["samplers"] = self.images.iter().map(sampler).collect();
            document["images"] = (self.images.iter())
                .map(|image| {
                    let view = binary.add_view(image.png.len() as u64, json!({}));
                    json!({ "name": image.name, "mimeType": "image/png", "bufferView": view })
                })
                .collect();
        }
        if self.uses_transform {
            extensions.push("KHR_texture_transform");
        }
        document["extensionsUsed"] = json!(extensions);
    }

    /// Writes the images in the order of [`Self::add_to`].
    pub(super) fn write_images(&self, out: &mut impl Write) -> io::Result<()> {
        for Image { png, .. } in &self.images {
            out.write_all(png)?;
            out.write_all(&[0; 3][..png.len().next_multiple_of(4) - png.len()])?;
        }
        Ok(())
    }
}

/// Base colour factor and texture of a material: its albedo or its emission.
fn base_color(scene: &Scene, material: &Material, exposure: f32) -> (Vec3, Option<TextureRef>) {
    let largest = |texture: TextureRef| pixels::largest(&scene.textures()[texture.texture.index()]);
    match (material.emits(), material.albedo_texture, material.emission_texture) {
        (false, Some(texture), _) => (material.albedo * largest(texture), Some(texture)),
        (false, None, _) => (material.albedo.min(Vec3::splat(MAX_ALBEDO)), None),
        (true, _, Some(texture)) => (material.emission.0 * (exposure * largest(texture)), Some(texture)),
        // The vertex colours hold the visible radiance.
        (true, _, None) => (Vec3::ONE, None),
    }
}

fn describe(material: &Material, factor: Vec3, base_texture: Option<Value>) -> Value {
    let [r, g, b] = factor.clamp(Vec3::ZERO, Vec3::ONE).to_array();
    let mut surface =
        json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    let mut json = json!({
        "name": material.name,
        "doubleSided": false,
        "extensions": { "KHR_materials_unlit": {} },
        "extras": { "albedo": material.albedo.to_array(), "emission": material.emission.0.to_array() },
    });
    if let Some(texture) = base_texture {
        if material.emits() {
            json["emissiveTexture"] = texture.clone();
        }
        surface["baseColorTexture"] = texture;
    }
    if material.emits() {
        // For programs without support for unlit: the hue at full brightness; the extras hold the radiance.
        let emission = material.emission.0;
        json["emissiveFactor"] = json!((emission / emission.max_element()).to_array());
    }
    json["pbrMetallicRoughness"] = surface;
    json
}

impl Images {
    /// A material's reference to a texture, which is added if it is new.
    fn reference(&mut self, scene: &Scene, texture: TextureRef) -> io::Result<Value> {
        let index = match self.index.get(&texture.texture) {
            Some(&index) => index,
            None => {
                self.list.push(encode(&scene.textures()[texture.texture.index()])?);
                self.index.insert(texture.texture, self.list.len() - 1);
                self.list.len() - 1
            }
        };
        let mut json = json!({ "index": index });
        if let Some(transform) = transform(&texture.transform) {
            json["extensions"] = json!({ "KHR_texture_transform": transform });
        }
        Ok(json)
    }
}

/// The transform, unless it does nothing or is not finite.
fn transform(transform: &UvTransform) -> Option<Value> {
    let UvTransform { offset, rotation, scale } = *transform;
    let useful = *transform != UvTransform::default()
        && offset.is_finite()
        && scale.is_finite()
        && rotation.is_finite();
    useful.then(|| json!({ "offset": offset.to_array(), "rotation": rotation, "scale": scale.to_array() }))
}

/// glTF takes base colour textures as sRGB: others are converted, and brighter ones scaled to fit.
fn encode(texture: &Texture) -> io::Result<Image> {
    let (width, height) = texture.size();
    let mut png = Vec::new();
    encode_png(&mut png, width, height, &srgb_pixels(texture), &[])?;
    Ok(Image { name: texture.name.clone(), png, wrap: [texture.wrap_u, texture.wrap_v] })
}

fn sampler(image: &Image) -> Value {
    let [s, t] = image.wrap.map(|wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    });
    json!({ "wrapS": s, "wrapT": t, "magFilter": LINEAR, "minFilter": LINEAR_MIPMAP_LINEAR })
}
