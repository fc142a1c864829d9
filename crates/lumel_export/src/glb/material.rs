//! The materials and images of a GLB file.

use super::binary::Binary;
use super::lamps::{LampPlace, rectangles};
use super::page_image::{FineImage, PageImages};
use super::primitive::Primitive;
use crate::pixels::{self, linear_pixels, opacity_pixels, srgb_pixels};
use crate::png::encode_png;
use glam::Vec3;
use lumel_scene::{
    AlphaMode, EncodedImage, Filter, Gloss, GlossTexture, MAX_ALBEDO, Material, MaterialId, Scene, Texture,
    TextureId, TextureRef, Transparency, UvTransform, Wrap,
};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::sync::Arc;

/// Magnification and minification of linear and nearest filters. Smaller pictures of a lightmap would mix charts.
const LINEAR: [u32; 2] = [9729, 9987];
const NEAREST: [u32; 2] = [9728, 9986];
const LIGHTMAP: [u32; 2] = [9729, 9729];
const CLAMP: u32 = 33071;
const UNLIT: &str = "KHR_materials_unlit";
const STRENGTH: &str = "KHR_materials_emissive_strength";
const SPECULAR: &str = "KHR_materials_specular";
const TRANSFORM: &str = "KHR_texture_transform";
const MOZ_LIGHTMAP: &str = "MOZ_lightmap";

/// Materials and textures that the scene's triangles use, ready to be written.
pub(super) struct Materials {
    /// Index in the file by the scene's material and the page whose light it shows; page 0 if it shows none.
    index: BTreeMap<(MaterialId, usize), usize>,
    /// Whether a material of the scene has textures beside light.
    textured: BTreeSet<MaterialId>,
    /// Whether it has a normal map.
    normal_mapped: BTreeSet<MaterialId>,
    /// Whether it shows the light of pages.
    by_page: bool,
    lamps: LampPlace,
    /// Indices in the file of the materials of [`rectangles`].
    rectangles: Vec<usize>,
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
    /// A lightmap has all that is seen, as emission.
    Emission,
}

/// What a file shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Appearance {
    /// The light that was computed.
    Light,
    /// Surfaces that viewers light.
    Surfaces,
    /// The same, with what hides the surroundings from them.
    Occluded,
    /// Surfaces that emit all that is seen of them.
    Emitters,
}

/// How materials are written.
pub(super) struct Look<'a> {
    pub(super) appearance: Appearance,
    /// The light that they show, if it is in pages.
    pub(super) pages: Option<&'a PageImages>,
    /// The factor of what they emit.
    pub(super) exposure: f32,
    /// Where lights are.
    pub(super) lamps: LampPlace,
}

impl Look<'_> {
    /// Without pages, with emission as it is, and lights among the surfaces.
    pub(super) fn of(appearance: Appearance) -> Self {
        Self { appearance, pages: None, exposure: 1.0, lamps: LampPlace::Scene }
    }
}

impl Appearance {
    fn of(self, material: &Material) -> Shown {
        match self {
            Self::Light => Shown::of(material),
            Self::Surfaces | Self::Occluded => Shown::Apart,
            Self::Emitters => Shown::Emission,
        }
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
    mime_type: &'static str,
    bytes: Vec<u8>,
    sampler: Value,
    fine: Option<FineImage>,
}

impl Image {
    fn png(name: String, bytes: Vec<u8>, sampler: Value) -> Self {
        Self { name, mime_type: "image/png", bytes, sampler, fine: None }
    }
}

/// What an image holds of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Content {
    Color,
    ColorAndAlpha,
    Normals,
    /// Those whose green points down.
    FlippedNormals,
}

/// The textures of a file under construction.
#[derive(Default)]
struct Images {
    list: Vec<Image>,
    index: BTreeMap<(TextureId, Content), usize>,
    /// By place in [`PageImages`].
    pages: BTreeMap<usize, usize>,
    /// Those that are as they were read, with their index.
    encoded: Vec<(Arc<EncodedImage>, [Wrap; 2], Filter, usize)>,
    extensions: BTreeSet<&'static str>,
}

impl Materials {
    /// Those of the primitives, and those of the lights that can be seen.
    pub(super) fn new(scene: &Scene, primitives: &[Primitive], look: &Look<'_>) -> io::Result<Self> {
        let Look { appearance, pages, .. } = *look;
        let mut materials = Self {
            index: BTreeMap::new(),
            textured: BTreeSet::new(),
            normal_mapped: BTreeSet::new(),
            by_page: pages.is_some(),
            lamps: look.lamps,
            rectangles: Vec::new(),
            json: Vec::new(),
            images: Vec::new(),
            extensions: BTreeSet::new(),
        };
        let used: BTreeSet<_> = primitives.iter().map(|primitive| materials.key(primitive)).collect();
        let mut images = Images::default();
        for (id, page) in used {
            let material = &scene.materials()[id.index()];
            let mut json = describe(scene, material, look, &mut images)?;
            if json.get("normalTexture").is_some() {
                materials.normal_mapped.insert(id);
            }
            let surface = &json["pbrMetallicRoughness"];
            let of_surface = [&surface["baseColorTexture"], &surface["metallicRoughnessTexture"]];
            let slots = of_surface.into_iter().chain([&json["emissiveTexture"], &json["normalTexture"]]);
            if slots.into_iter().any(|slot| !slot.is_null()) {
                materials.textured.insert(id);
            }
            if let Some(pages) = pages {
                images.add_light(&mut json, appearance, pages, page, material);
            }
            materials.index.insert((id, page), materials.json.len());
            materials.json.push(json);
        }
        for (name, light) in rectangles(scene, look.lamps) {
            let texture = light.texture.map(TextureRef::plain);
            let material = Material {
                emission: light.radiance,
                emission_texture: texture,
                ..Material::diffuse(name, Vec3::ZERO)
            };
            let look = Look { appearance: Appearance::Surfaces, pages: None, ..*look };
            materials.rectangles.push(materials.json.len());
            materials.json.push(describe(scene, &material, &look, &mut images)?);
        }
        (materials.images, materials.extensions) = (images.list, images.extensions);
        Ok(materials)
    }

    fn key(&self, primitive: &Primitive) -> (MaterialId, usize) {
        (primitive.material, if self.by_page { primitive.page } else { 0 })
    }

    /// Index in the file.
    pub(super) fn index(&self, primitive: &Primitive) -> usize {
        self.index[&self.key(primitive)]
    }

    /// Indices in the file of the materials of [`rectangles`].
    pub(super) fn of_rectangles(&self) -> &[usize] {
        &self.rectangles
    }

    /// Where lights are in the file.
    pub(super) fn lamps(&self) -> LampPlace {
        self.lamps
    }

    /// The extensions that they use.
    pub(super) fn extensions(&self) -> &BTreeSet<&'static str> {
        &self.extensions
    }

    /// Whether it has textures that are placed by `TEXCOORD_0`.
    pub(super) fn is_textured(&self, material: MaterialId) -> bool {
        self.textured.contains(&material)
    }

    /// Whether it has a normal map.
    pub(super) fn is_normal_mapped(&self, material: MaterialId) -> bool {
        self.normal_mapped.contains(&material)
    }

    /// Adds materials, textures, samplers and images to the document.
    pub(super) fn add_to(&self, document: &mut Value, binary: &mut Binary) {
        document["materials"] = self.json.clone().into();
        if !self.images.is_empty() {
            let indices = 0..self.images.len();
            document["textures"] =
                indices.map(|index| json!({ "source": index, "sampler": index })).collect();
            document["samplers"] = self.images.iter().map(|image| image.sampler.clone()).collect();
            document["images"] = (self.images.iter())
                .map(|image| {
                    let view = binary.add_view(image.bytes.len() as u64, json!({}));
                    let mut json =
                        json!({ "name": image.name, "mimeType": image.mime_type, "bufferView": view });
                    if let Some(FineImage { size, words }) = &image.fine {
                        let view = binary.add_view(words.len() as u64, json!({}));
                        json["extras"] = json!({ "rgb9e5": { "bufferView": view, "size": size } });
                    }
                    json
                })
                .collect();
        }
    }

    /// Writes the images in the order of [`Self::add_to`].
    pub(super) fn write_images(&self, out: &mut impl Write) -> io::Result<()> {
        for Image { bytes, fine, .. } in &self.images {
            out.write_all(bytes)?;
            out.write_all(&[0; 3][..bytes.len().next_multiple_of(4) - bytes.len()])?;
            if let Some(FineImage { words, .. }) = fine {
                out.write_all(words)?;
            }
        }
        Ok(())
    }
}

/// Albedo in the base colour, emission in the emissive slots, each with its own texture.
fn describe(scene: &Scene, material: &Material, look: &Look<'_>, images: &mut Images) -> io::Result<Value> {
    let shown = look.appearance.of(material);
    let mut json = json!({
        "name": material.name,
        "doubleSided": false,
        "extensions": {},
        "extras": { "albedo": material.albedo.to_array(), "emission": material.emission.0.to_array() },
    });
    let Transparency { mode, alpha, texture, transmission } = material.transparency;
    let is_opaque = mode == AlphaMode::Opaque;
    let (albedo, albedo_texture) = if is_opaque && shown == Shown::Emission {
        (Vec3::ZERO, None)
    } else if is_opaque {
        images.slot(scene, material.albedo, material.albedo_texture, false)?
    } else {
        // A file has one image for colour and alpha; alpha of another image is left out.
        let surface = if shown == Shown::Emission { texture } else { material.albedo_texture.or(texture) };
        images.slot(scene, material.albedo, surface, texture.is_some() && texture == surface)?
    };
    // Glass is written as clear as it is.
    let clarity = 1.0 - transmission.element_sum() / 3.0;
    let opacity = if is_opaque { clarity } else { alpha * clarity };
    let base = match albedo_texture {
        _ if shown == Shown::Colors => Vec3::ONE,
        _ if shown == Shown::Emission => Vec3::ZERO,
        Some(_) => albedo.clamp(Vec3::ZERO, Vec3::ONE),
        None => albedo.clamp(Vec3::ZERO, Vec3::splat(MAX_ALBEDO)),
    };
    let mut surface = json!({ "baseColorFactor": base.extend(opacity).to_array(), "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    if let Some(texture) = albedo_texture {
        surface["baseColorTexture"] = texture;
    }
    if matches!(look.appearance, Appearance::Surfaces | Appearance::Occluded) {
        images.add_gloss(&mut surface, &material.gloss);
    }
    json["pbrMetallicRoughness"] = surface;
    if shown == Shown::Emission {
        // Black surfaces would still mirror the surroundings a little.
        json["extensions"][SPECULAR] = json!({ "specularFactor": 0.0 });
        images.extensions.insert(SPECULAR);
    }
    match mode {
        AlphaMode::Mask { cutoff } => {
            json["alphaMode"] = json!("MASK");
            json["alphaCutoff"] = json!(cutoff * clarity);
        }
        AlphaMode::Opaque if transmission == Vec3::ZERO => {}
        AlphaMode::Opaque | AlphaMode::Blend => json["alphaMode"] = json!("BLEND"),
    }
    if material.emits() && shown != Shown::Emission {
        let (emission, texture) =
            images.slot(scene, material.emission.0 * look.exposure, material.emission_texture, false)?;
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
    if let Some(map) = material.normal_texture.filter(|_| shown != Shown::Emission) {
        let content = if map.scale.y < 0.0 { Content::FlippedNormals } else { Content::Normals };
        let mut texture = images.reference(scene, map.image, content)?;
        texture["scale"] = json!(map.scale.x);
        json["normalTexture"] = texture;
    }
    if matches!(shown, Shown::Reflection | Shown::Colors) {
        json["extensions"][UNLIT] = json!({});
        images.extensions.insert(UNLIT);
    }
    Ok(json)
}

impl Images {
    /// Lets a material show the light of a page: in the extension that three.js adds to what it computes, as emission, or as
    /// what hides light.
    fn add_light(
        &mut self,
        json: &mut Value,
        appearance: Appearance,
        pages: &PageImages,
        page: usize,
        material: &Material,
    ) {
        let place = pages.place(page, material);
        let image = pages.image(place);
        let list = &mut self.list;
        let index = *self.pages.entry(place).or_insert_with(|| {
            let name = format!("lightmap {place}");
            let (png, fine) = (image.png.clone(), image.fine.clone());
            list.push(Image { fine, ..Image::png(name, png, sampler([CLAMP; 2], LIGHTMAP)) });
            list.len() - 1
        });
        if appearance == Appearance::Occluded {
            json["occlusionTexture"] = json!({ "index": index, "texCoord": 1 });
        } else if appearance == Appearance::Emitters {
            json["emissiveFactor"] = json!([1.0, 1.0, 1.0]);
            json["emissiveTexture"] = json!({ "index": index, "texCoord": 1 });
            json["extensions"][STRENGTH] = json!({ "emissiveStrength": image.scale });
            self.extensions.insert(STRENGTH);
        } else {
            json["extensions"][MOZ_LIGHTMAP] =
                json!({ "index": index, "texCoord": 1, "intensity": image.scale });
            self.extensions.insert(MOZ_LIGHTMAP);
        }
    }

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
        let content = if with_alpha { Content::ColorAndAlpha } else { Content::Color };
        Ok((factor * largest, Some(self.reference(scene, texture, content)?)))
    }

    /// A material's reference to a texture, which is added if it is new.
    fn reference(&mut self, scene: &Scene, texture: TextureRef, content: Content) -> io::Result<Value> {
        let index = match self.index.get(&(texture.texture, content)) {
            Some(&index) => index,
            None => {
                self.list.push(encode(&scene.textures()[texture.texture.index()], content)?);
                self.index.insert((texture.texture, content), self.list.len() - 1);
                self.list.len() - 1
            }
        };
        Ok(self.placed(index, &texture.transform))
    }

    /// A reference to a texture of the file.
    fn placed(&mut self, index: usize, uv: &UvTransform) -> Value {
        let mut json = json!({ "index": index });
        if let Some(transform) = transform(uv) {
            json["extensions"] = json!({ TRANSFORM: transform });
            self.extensions.insert(TRANSFORM);
        }
        json
    }

    /// Metal and roughness, with their image as it was read.
    fn add_gloss(&mut self, surface: &mut Value, gloss: &Gloss) {
        surface["metallicFactor"] = json!(gloss.metallic);
        surface["roughnessFactor"] = json!(gloss.roughness);
        let Some(GlossTexture { image, transform, wrap, filter }) = &gloss.texture else { return };
        let is_same = |(known, wraps, how, _): &&(Arc<EncodedImage>, [Wrap; 2], Filter, usize)| {
            Arc::ptr_eq(known, image) && wraps == wrap && how == filter
        };
        let index = self.encoded.iter().find(is_same).map(|(.., index)| *index);
        let index = index.unwrap_or_else(|| {
            let EncodedImage { name, mime_type, bytes } = &**image;
            let sampler = sampler_of(*wrap, *filter);
            let image_of = Image { mime_type, ..Image::png(name.clone(), bytes.clone(), sampler) };
            self.list.push(image_of);
            let index = self.list.len() - 1;
            self.encoded.push((Arc::clone(image), *wrap, *filter, index));
            index
        });
        surface["metallicRoughnessTexture"] = self.placed(index, transform);
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

/// glTF takes textures of colours as sRGB: others are converted, and brighter ones scaled to fit. Normals are linear, with green
/// up.
fn encode(texture: &Texture, content: Content) -> io::Result<Image> {
    let (width, height) = texture.size();
    let mut png = Vec::new();
    match content {
        Content::Color => encode_png(&mut png, width, height, &srgb_pixels(texture), &[])?,
        Content::ColorAndAlpha => {
            let pixel = |([r, g, b], [alpha, ..]): ([u8; 3], [u8; 3])| [r, g, b, alpha];
            let colors = srgb_pixels(texture).into_iter();
            let pixels: Vec<[u8; 4]> = colors.zip(opacity_pixels(texture)).map(pixel).collect();
            encode_png(&mut png, width, height, &pixels, &[])?;
        }
        Content::Normals => encode_png(&mut png, width, height, &linear_pixels(texture), &[])?,
        Content::FlippedNormals => {
            let flipped = linear_pixels(texture).into_iter().map(|[r, g, b]| [r, u8::MAX - g, b]);
            encode_png(&mut png, width, height, &flipped.collect::<Vec<_>>(), &[])?;
        }
    }
    let sampler = sampler_of([texture.wrap_u, texture.wrap_v], texture.filter);
    Ok(Image::png(texture.name.clone(), png, sampler))
}

fn sampler_of(wrap: [Wrap; 2], filter: Filter) -> Value {
    let wrap = wrap.map(|wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => CLAMP,
    });
    let filter = match filter {
        Filter::Linear => LINEAR,
        Filter::Nearest => NEAREST,
    };
    sampler(wrap, filter)
}

fn sampler([s, t]: [u32; 2], [mag, min]: [u32; 2]) -> Value {
    json!({ "wrapS": s, "wrapT": t, "magFilter": mag, "minFilter": min })
}
