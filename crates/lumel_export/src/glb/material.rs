//! The materials and images of a GLB file.

use super::binary::Binary;
use crate::pixels::{self, opacity_pixels, srgb_pixels};
use crate::png::encode_png;
use glam::Vec3;
use lumel_scene::{
    AlphaMode, Filter, MAX_ALBEDO, Material, MaterialId, Scene, Texture, TextureId, TextureRef, Transparency,
    TriId, UvTransform, Wrap,
};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

/// Magnification and minification of linear and nearest filters.
const LINEAR: [u32; 2] = [9729, 9987];
const NEAREST: [u32; 2] = [9728, 9986];
const UNLIT: &str = "KHR_materials_unlit";
const STRENGTH: &str = "KHR_materials_emissive_strength";
const TRANSFORM: &str = "KHR_texture_transform";
const NO_INDEX: usize = usize::MAX;

/// Materials and textures that the scene's triangles use, ready to be written.
pub(super) struct Materials {
    /// Index in the file of each of the scene's materials; `NO_INDEX` for unused ones.
    index: Vec<usize>,
    textured: Vec<bool>,
    json: Vec<Value>,
    images: Vec<Image>,
    extensions: BTreeSet<&'static str>,
}

/// What shows the light of a material's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// Base colour times `COLOR_0`.
    Reflection,
    /// `COLOR_0` alone: emitted and reflected.
    Colors,
    /// `COLOR_0` has what is reflected; the emission is the material's own, and viewers must light the rest.
    Apart,
}

/// What a file shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Appearance {
    /// The light that was computed.
    Light,
    /// Surfaces that viewers light.
    Surfaces,
}

impl Appearance {
    fn of(self, material: &Material) -> Shown {
        if self == Self::Light { Shown::of(material) } else { Shown::Apart }
    }
}

impl Shown {
    /// Textures of albedo and emission cannot both be in the base colour, so that emission with any needs a slot.
    pub(super) fn of(material: &Material) -> Self {
        match (material.emits(), material.albedo_texture, material.emission_texture) {
            (false, ..) => Self::Reflection,
            (true, None, None) => Self::Colors,
            (true, ..) => Self::Apart,
        }
    }
}

struct Image {
    name: String,
    png: Vec<u8>,
    wrap: [Wrap; 2],
    filter: Filter,
}

/// The textures of a file under construction.
#[derive(Default)]
struct Images {
    list: Vec<Image>,
    /// By texture, and whether with its alpha.
    index: BTreeMap<(TextureId, bool), usize>,
    extensions: BTreeSet<&'static str>,
}

impl Materials {
    pub(super) fn new(scene: &Scene, appearance: Appearance) -> io::Result<Self> {
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
            extensions: BTreeSet::new(),
        };
        let mut images = Images::default();
        for (id, material) in scene.materials().iter().enumerate().filter(|(id, _)| used[*id]) {
            materials.index[id] = materials.json.len();
            let json = describe(scene, material, appearance.of(material), &mut images)?;
            let slots = [&json["pbrMetallicRoughness"]["baseColorTexture"], &json["emissiveTexture"]];
            materials.textured[id] = slots.iter().any(|slot| !slot.is_null());
            materials.json.push(json);
        }
        (materials.images, materials.extensions) = (images.list, images.extensions);
        Ok(materials)
    }

    /// Index in the file.
    pub(super) fn index(&self, material: MaterialId) -> usize {
        self.index[material.index()]
    }

    /// Whether it has textures.
    pub(super) fn is_textured(&self, material: MaterialId) -> bool {
        self.textured[material.index()]
    }

    /// Adds materials, textures, samplers and images to the document.
    pub(super) fn add_to(&self, document: &mut Value, binary: &mut Binary) {
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
        if !self.extensions.is_empty() {
            document["extensionsUsed"] = json!(self.extensions);
        }
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

/// Albedo in the base colour, emission in the emissive slots, each with its own texture.
fn describe(scene: &Scene, material: &Material, shown: Shown, images: &mut Images) -> io::Result<Value> {
    let mut json = json!({
        "name": material.name,
        "doubleSided": false,
        "extensions": {},
        "extras": { "albedo": material.albedo.to_array(), "emission": material.emission.0.to_array() },
    });
    let Transparency { mode, alpha, texture, transmission } = material.transparency;
    let is_opaque = mode == AlphaMode::Opaque;
    let (albedo, albedo_texture) = if is_opaque {
        images.slot(scene, material.albedo, material.albedo_texture, false)?
    } else {
        // A file has one image for colour and alpha; alpha of another image is left out.
        let surface = material.albedo_texture.or(texture);
        images.slot(scene, material.albedo, surface, texture.is_some() && texture == surface)?
    };
    // Glass is written as clear as it is.
    let clarity = 1.0 - transmission.element_sum() / 3.0;
    let opacity = if is_opaque { clarity } else { alpha * clarity };
    let base = match albedo_texture {
        _ if shown == Shown::Colors => Vec3::ONE,
        Some(_) => albedo.clamp(Vec3::ZERO, Vec3::ONE),
        None => albedo.clamp(Vec3::ZERO, Vec3::splat(MAX_ALBEDO)),
    };
    let mut surface = json!({ "baseColorFactor": base.extend(opacity).to_array(), "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    if let Some(texture) = albedo_texture {
        surface["baseColorTexture"] = texture;
    }
    json["pbrMetallicRoughness"] = surface;
    match mode {
        AlphaMode::Mask { cutoff } => {
            json["alphaMode"] = json!("MASK");
            json["alphaCutoff"] = json!(cutoff * clarity);
        }
        AlphaMode::Opaque if transmission == Vec3::ZERO => {}
        AlphaMode::Opaque | AlphaMode::Blend => json["alphaMode"] = json!("BLEND"),
    }
    if material.emits() {
        let (emission, texture) =
            images.slot(scene, material.emission.0, material.emission_texture, false)?;
        let strength = emission.max_element().max(1.0);
        json["emissiveFactor"] = json!((emission / strength).to_array());
        if let Some(texture) = texture {
            json["emissiveTexture"] = texture;
        }
        // Unlit materials must have no strength: the extras tell how bright they are.
        if strength > 1.0 && shown == Shown::Apart {
            json["extensions"][STRENGTH] = json!({ "emissiveStrength": strength });
            images.extensions.insert(STRENGTH);
        }
    }
    if shown != Shown::Apart {
        json["extensions"][UNLIT] = json!({});
        images.extensions.insert(UNLIT);
    }
    Ok(json)
}

impl Images {
    /// The factor and the texture of a colour; an image holds the texture over its largest value.
    fn slot(
        &mut self,
        scene: &Scene,
        factor: Vec3,
        texture: Option<TextureRef>,
        with_alpha: bool,
    ) -> io::Result<(Vec3, Option<Value>)> {
        let Some(texture) = texture else { return Ok((factor, None)) };
        let largest = pixels::largest(&scene.textures()[texture.texture.index()]);
        Ok((factor * largest, Some(self.reference(scene, texture, with_alpha)?)))
    }

    /// A material's reference to a texture, which is added if it is new.
    fn reference(&mut self, scene: &Scene, texture: TextureRef, with_alpha: bool) -> io::Result<Value> {
        let index = match self.index.get(&(texture.texture, with_alpha)) {
            Some(&index) => index,
            None => {
                self.list.push(encode(&scene.textures()[texture.texture.index()], with_alpha)?);
                self.index.insert((texture.texture, with_alpha), self.list.len() - 1);
                self.list.len() - 1
            }
        };
        let mut json = json!({ "index": index });
        if let Some(transform) = transform(&texture.transform) {
            json["extensions"] = json!({ TRANSFORM: transform });
            self.extensions.insert(TRANSFORM);
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

/// glTF takes textures of colours as sRGB: others are converted, and brighter ones scaled to fit.
fn encode(texture: &Texture, with_alpha: bool) -> io::Result<Image> {
    let (width, height) = texture.size();
    let mut png = Vec::new();
    let colors = srgb_pixels(texture);
    if with_alpha {
        let pixel = |([r, g, b], [alpha, ..]): ([u8; 3], [u8; 3])| [r, g, b, alpha];
        let pixels: Vec<[u8; 4]> = colors.into_iter().zip(opacity_pixels(texture)).map(pixel).collect();
        encode_png(&mut png, width, height, &pixels, &[])?;
    } else {
        encode_png(&mut png, width, height, &colors, &[])?;
    }
    let (wrap, filter) = ([texture.wrap_u, texture.wrap_v], texture.filter);
    Ok(Image { name: texture.name.clone(), png, wrap, filter })
}

fn sampler(image: &Image) -> Value {
    let [s, t] = image.wrap.map(|wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    });
    let [mag, min] = match image.filter {
        Filter::Linear => LINEAR,
        Filter::Nearest => NEAREST,
    };
    json!({ "wrapS": s, "wrapT": t, "magFilter": mag, "minFilter": min })
}
