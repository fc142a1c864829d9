//! Diffuse materials.

use super::document::{Document, label, named};
use super::fault::Fault;
use super::textures::Textures;
use glam::{Vec2, Vec3};
use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::NormalTexture;
use gltf_json::texture::Info;
use gltf_json::validation::Checked;
use lumel_scene::{
    AlphaMode, Encoding, Gloss, Material, MaterialId, NormalMap, Radiance, Sides, Texture, TextureRef,
    Transparency, UvTransform, Warnings,
};
use std::collections::BTreeMap;

/// The materials of a document, each converted when it is first used.
pub(super) struct Materials<'a> {
    document: &'a Document,
    textures: Textures<'a>,
    converted: Vec<Material>,
    known: Vec<Option<Used>>,
    /// The material of primitives without one.
    default: Option<Used>,
    /// What is lost when materials are treated as diffuse, and which materials they are.
    limitations: BTreeMap<&'static str, Vec<String>>,
}

/// What a mesh needs to know about its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Used {
    pub(super) id: MaterialId,
    /// Which set of texture coordinates its textures use; `None` without textures.
    pub(super) uv_set: Option<u32>,
    /// Whether tangents are of use.
    pub(super) has_normal_map: bool,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, textures: Textures<'a>) -> Self {
        let known = vec![None; document.materials.len()];
        Self { document, textures, converted: Vec::new(), known, default: None, limitations: BTreeMap::new() }
    }

    /// The scene's material for one of the document's; `None` asks for the default.
    pub(super) fn get(
        &mut self,
        index: Option<usize>,
        user: &str,
        warnings: &mut Warnings,
    ) -> Result<Used, Fault> {
        let document = self.document;
        let (known, material) = match index {
            None => (self.default, None),
            Some(index) => match document.materials.get(index) {
                Some(material) => (self.known[index], material.as_ref()),
                None => return Err(Fault::absent(user, "material", index, document.materials.len())),
            },
        };
        if let Some(used) = known {
            return Ok(used);
        }
        let (converted, uv_set) = match (index, material) {
            (Some(index), Some(material)) => self.convert(index, material, warnings),
            _ => (Material::default(), None),
        };
        let has_normal_map = converted.normal_texture.is_some();
        let used = Used { id: MaterialId(self.converted.len() as u32), uv_set, has_normal_map };
        self.converted.push(converted);
        *index.map_or(&mut self.default, |index| &mut self.known[index]) = Some(used);
        Ok(used)
    }

    /// The scene's materials and textures, in the order of their ids.
    ///
    /// Warns of what they lose.
    pub(super) fn finish(self, warnings: &mut Warnings) -> (Vec<Material>, Vec<Texture>) {
        for (message, names) in &self.limitations {
            warnings.push_for_all("material", names, *message);
        }
        (self.converted, self.textures.into_textures())
    }

    /// - The base colour of metals is used as albedo. A metal reflects that fraction of the light, although not
    ///   diffusely; a black surface would absorb it.
    /// - Emission is used as radiance, unconverted: cd/m² give lux, W·m⁻²·sr⁻¹ give W·m⁻².
    /// - Alpha counts as `alphaMode` says. Of what transmits, the base colour tints what passes; what is left of it is
    ///   the albedo.
    fn convert(
        &mut self,
        index: usize,
        material: &gltf_json::Material,
        warnings: &mut Warnings,
    ) -> (Material, Option<u32>) {
        let subject = label("material", index, material.name.as_deref());
        for message in limitations(material) {
            self.limitations.entry(message).or_default().push(named(index, material.name.as_deref()));
        }
        let pbr = &material.pbr_metallic_roughness;
        let strength = material.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |e| e.emissive_strength.0);
        let emission = Vec3::from(material.emissive_factor.0) * strength;

        let mut uv_set = None;
        let textures = &mut self.textures;
        let mut bind = |slot: Option<Slot>| {
            let slot = slot?;
            let texture = match textures.get(slot.texture, slot.encoding) {
                Ok(texture) => texture,
                Err(problem) => {
                    let message = format!("{} texture left out: {problem}", slot.what);
                    warnings.push(&subject, message);
                    return None;
                }
            };
            // Meshes have one set of coordinates, and albedo matters most.
            let set = *uv_set.get_or_insert(slot.uv_set);
            if set != slot.uv_set {
                let message = format!(
                    "{} texture asks for TEXCOORD_{} beside TEXCOORD_{set}, which is used for both",
                    slot.what, slot.uv_set
                );
                warnings.push(&subject, message);
            }
            Some(TextureRef { texture, transform: slot.transform })
        };
        let albedo_texture =
            bind(pbr.base_color_texture.as_ref().map(|info| Slot::color("base colour", info)));
        let emissive = material.emissive_texture.as_ref().filter(|_| emission != Vec3::ZERO);
        let emission_texture = bind(emissive.map(|info| Slot::color("emissive", info)));
        let normal_texture = material.normal_texture.as_ref().and_then(|normal| {
            Some(NormalMap { image: bind(Some(Slot::normal(normal)))?, scale: Vec2::splat(normal.scale) })
        });

        // Coordinates are those of the other textures: alone, it would change what is baked.
        let gloss_texture = (pbr.metallic_roughness_texture.as_ref())
            .map(|info| Slot::color("metallic-roughness", info))
            .filter(|slot| Some(slot.uv_set) == uv_set)
            .and_then(|slot| self.textures.encoded(slot.texture, slot.transform));
        let gloss = Gloss {
            metallic: share(pbr.metallic_factor.0),
            roughness: share(pbr.roughness_factor.0),
            texture: gloss_texture,
        };

        let [red, green, blue, alpha] = pbr.base_color_factor.0;
        let base = Vec3::new(red, green, blue);
        let transmission = transmission_factor(material) * (1.0 - pbr.metallic_factor.0.clamp(0.0, 1.0));
        let mode = alpha_mode(material);
        let transparency = Transparency {
            mode,
            alpha,
            texture: albedo_texture.filter(|_| mode != AlphaMode::Opaque),
            transmission: base * transmission,
        };
        let material = Material {
            name: material.name.clone().unwrap_or_else(|| subject.clone()),
            albedo: base - base * transmission,
            albedo_texture,
            emission: Radiance(emission),
            emission_texture,
            normal_texture,
            sides: if material.double_sided { Sides::Both } else { Sides::Front },
            transparency,
            gloss,
        };
        (material, uv_set)
    }
}

/// A number within 0..=1; 1 for what is none.
fn share(factor: f32) -> f32 {
    if factor.is_nan() { 1.0 } else { factor.clamp(0.0, 1.0) }
}

const TRANSMISSION: &str = "KHR_materials_transmission";

/// A number of an extension, 0 without it.
fn factor(material: &gltf_json::Material, extension: &str, name: &str) -> f32 {
    let extension = material.extensions.as_ref().and_then(|e| e.others.get(extension));
    extension.and_then(|e| e.get(name)?.as_f64()).unwrap_or(0.0) as f32
}

fn transmission_factor(material: &gltf_json::Material) -> f32 {
    factor(material, TRANSMISSION, "transmissionFactor").clamp(0.0, 1.0)
}

fn alpha_mode(material: &gltf_json::Material) -> AlphaMode {
    match material.alpha_mode {
        Checked::Valid(gltf_json::material::AlphaMode::Mask) => {
            AlphaMode::Mask { cutoff: material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0) }
        }
        Checked::Valid(gltf_json::material::AlphaMode::Blend) => AlphaMode::Blend,
        Checked::Valid(gltf_json::material::AlphaMode::Opaque) | Checked::Invalid => AlphaMode::Opaque,
    }
}

/// What is lost when a material is treated as diffuse.
fn limitations(material: &gltf_json::Material) -> Vec<&'static str> {
    let mut messages = Vec::new();
    let pbr = &material.pbr_metallic_roughness;
    if pbr.metallic_factor.0 > 0.5 {
        messages.push(match pbr.metallic_roughness_texture {
            Some(_) => "metal in its texture is treated as diffuse, with its base colour as albedo",
            None => "metal is treated as diffuse, with its base colour as albedo",
        });
    }
    if let Some(extensions) = &material.extensions {
        if extensions.unlit.is_some() {
            messages.push("KHR_materials_unlit: its base colour, though lit already, is used as albedo");
        }
        if factor(material, "KHR_materials_diffuse_transmission", "diffuseTransmissionFactor") > 0.0 {
            messages.push("light that passes through it diffusely is not computed");
        }
        let transmission = extensions.others.get(TRANSMISSION);
        if transmission.is_some_and(|e| e.get("transmissionTexture").is_some())
            && transmission_factor(material) > 0.0
        {
            messages.push("its transmission texture is ignored: light passes through all of it alike");
        }
    }
    messages
}

/// A texture as a material refers to it.
struct Slot {
    /// What the texture is for.
    what: &'static str,
    /// Index of the texture.
    texture: usize,
    uv_set: u32,
    transform: UvTransform,
    encoding: Encoding,
}

impl Slot {
    fn color(what: &'static str, info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        Self::new(what, info.index.value(), info.tex_coord, transform, Encoding::Srgb)
    }

    fn normal(info: &NormalTexture) -> Self {
        // The schema's type does not know that normal textures can be transformed too.
        let extension = info.extensions.as_ref().and_then(|e| e.others.get("KHR_texture_transform"));
        let transform = extension.and_then(|e| serde_json::from_value::<TextureTransform>(e.clone()).ok());
        Self::new("normal", info.index.value(), info.tex_coord, transform.as_ref(), Encoding::Linear)
    }

    fn new(
        what: &'static str,
        texture: usize,
        tex_coord: u32,
        transform: Option<&TextureTransform>,
        encoding: Encoding,
    ) -> Self {
        let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(tex_coord);
        let transform = transform.map_or_else(UvTransform::default, |t| UvTransform {
            offset: Vec2::from(t.offset.0),
            rotation: t.rotation.0,
            scale: Vec2::from(t.scale.0),
        });
        Self { what, texture, uv_set, transform, encoding }
    }
}

#[cfg(test)]
mod tests;
