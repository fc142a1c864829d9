//! From JSON to the types of the schema.

use super::fault::Fault;
use super::morph::MorphTargets;
use super::{compression, extensions, own, specular_glossiness};
use crate::text::escaped;
use gltf_json::extensions::scene::khr_lights_punctual::Light;
use gltf_json::texture::Sampler;
use gltf_json::{Accessor, Buffer, Camera, Image, Index, Material, Mesh, Node, Skin, Texture, buffer};
use lumel_scene::Warnings;
use serde::de::DeserializeOwned;
use serde_json::{Map, Number, Value};

/// Longer names are truncated, because instances and messages repeat them.
const MAX_NAME: usize = 200;

/// A glTF document: well-typed, but with unchecked indices and sizes.
///
/// Geometry must have the right types. Items that only affect appearance are `None` if their type is wrong, with a
/// warning.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) buffers: Vec<Buffer>,
    pub(super) views: Vec<buffer::View>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) targets: MorphTargets,
    pub(super) nodes: Vec<Node>,
    /// By node: how much finer its lumels are than those of others, where the file says it.
    pub(super) density_factors: Vec<Option<f32>>,
    pub(super) skins: Vec<Skin>,
    pub(super) materials: Vec<Option<Material>>,
    pub(super) textures: Vec<Option<Texture>>,
    pub(super) images: Vec<Option<Image>>,
    pub(super) samplers: Vec<Option<Sampler>>,
    pub(super) cameras: Vec<Option<Camera>>,
    pub(super) lights: Vec<Option<Light>>,
    /// The root nodes of the scene; `None` where the file has no scenes.
    pub(super) roots: Option<Vec<usize>>,
}

impl Document {
    /// Reads a document whose version and extensions are supported.
    pub(super) fn parse(json: &[u8], warnings: &mut Warnings) -> Result<Self, Fault> {
        let mut root: Value = serde_json::from_slice(json)
            .map_err(|error| Fault::Malformed(format!("not a glTF document: {error}")))?;
        own::restore(&mut root, warnings);
        let density_factors = density_factors(&root, warnings);
        if !tidy(&mut root, "") {
            warnings.push("", "names that are not text are ignored");
        }
        let Value::Object(mut root) = root else {
            return Err(Fault::Malformed("not a glTF document: it is no JSON object".into()));
        };
        check_version(&root)?;
        compression::check(&root)?;
        extensions::check(&root, warnings)?;
        let roots = scene_roots(&mut root)?;
        let mut materials = take_list(&mut root, "materials")?;
        materials.iter_mut().for_each(specular_glossiness::to_metallic_roughness);
        let lights = match root.get_mut("extensions").and_then(|e| e.get_mut("KHR_lights_punctual")) {
            Some(Value::Object(extension)) => take_list(extension, "lights")?,
            _ => Vec::new(),
        };
        let targets = MorphTargets::take(&mut root)?;
        Ok(Self {
            buffers: strict(&mut root, "buffers", "buffer")?,
            views: strict(&mut root, "bufferViews", "bufferView")?,
            accessors: strict(&mut root, "accessors", "accessor")?,
            meshes: strict(&mut root, "meshes", "mesh")?,
            targets,
            nodes: strict(&mut root, "nodes", "node")?,
            density_factors,
            skins: strict(&mut root, "skins", "skin")?,
            materials: lenient(materials, "material", warnings),
            textures: lenient(take_list(&mut root, "textures")?, "texture", warnings),
            images: lenient(take_list(&mut root, "images")?, "image", warnings),
            samplers: lenient(take_list(&mut root, "samplers")?, "sampler", warnings),
            cameras: lenient(take_list(&mut root, "cameras")?, "camera", warnings),
            lights: lenient(lights, "light", warnings),
            roots,
        })
    }

    /// A node as messages name it.
    pub(super) fn node_label(&self, node: usize) -> String {
        label("node", node, self.nodes.get(node).and_then(|n| n.name.as_deref()))
    }

    /// A mesh as messages name it.
    pub(super) fn mesh_label(&self, mesh: usize) -> String {
        label("mesh", mesh, self.meshes.get(mesh).and_then(|m| m.name.as_deref()))
    }
}

/// `what "name"`, or `what index` if it has no name.
pub(super) fn label(what: &str, index: usize, name: Option<&str>) -> String {
    format!("{what} {}", named(index, name))
}

/// The name of an object in quotes, or its index.
pub(super) fn named(index: usize, name: Option<&str>) -> String {
    match name.filter(|name| !name.is_empty()) {
        Some(name) => format!("\"{name}\""),
        None => index.to_string(),
    }
}

/// What `extras` of nodes say about lumels: there is no common name for it.
const DENSITY_FACTOR: &str = "lumel_density_factor";

/// The density factors of all nodes.
fn density_factors(root: &Value, warnings: &mut Warnings) -> Vec<Option<f32>> {
    let nodes = root.get("nodes").and_then(Value::as_array).into_iter().flatten();
    let mut factor = |(index, node): (usize, &Value)| {
        let given = node.get("extras").and_then(|extras| extras.get(DENSITY_FACTOR))?;
        let factor =
            given.as_f64().map(|factor| factor as f32).filter(|factor| *factor > 0.0 && factor.is_finite());
        if factor.is_none() {
            let name = node.get("name").and_then(Value::as_str);
            let message =
                format!("its {DENSITY_FACTOR} is {given}, which is no number above 0: it is ignored");
            warnings.push(label("node", index, name.map(escaped).as_deref()), message);
        }
        factor
    };
    nodes.enumerate().map(&mut factor).collect()
}

/// Corrects cases in which the types of the schema are too strict or too lax.
///
/// - `extras` are dropped and names that are not text too; very long ones are cut, control characters spelled out.
/// - Whole numbers may be written `3.0`.
/// - The types keep only 32 bits of an index, so 4294967296 would pass for 0. Numbers that large become floats, which
///   are refused where an index is expected. Sizes have 64 bits.
///
/// Returns whether all names were text.
fn tidy(value: &mut Value, key: &str) -> bool {
    let mut all_text = true;
    match value {
        Value::Object(map) => {
            map.remove("extras");
            if map.get("name").is_some_and(|name| !name.is_string()) {
                map.remove("name");
                all_text = false;
            }
            map.iter_mut().for_each(|(key, value)| all_text &= tidy(value, key));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| all_text &= tidy(item, key)),
        Value::String(text) if key == "name" => {
            if let Some((end, _)) = text.char_indices().nth(MAX_NAME) {
                text.truncate(end);
            }
            *text = escaped(text);
        }
        Value::Number(number) => {
            let is_size = matches!(key, "byteLength" | "byteOffset" | "count");
            match (number.as_u64(), number.as_f64()) {
                (Some(large), Some(float)) if large > u64::from(u32::MAX) && !is_size => {
                    *number = Number::from_f64(float).unwrap_or_else(|| number.clone());
                }
                (None, Some(float))
                    if float.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&float) =>
                {
                    *number = Number::from(float as u32);
                }
                _ => {}
            }
        }
        _ => {}
    }
    all_text
}

fn check_version(root: &Map<String, Value>) -> Result<(), Fault> {
    let asset = root.get("asset").and_then(Value::as_object);
    let Some(version) = asset.and_then(|a| a.get("version")).and_then(Value::as_str) else {
        return Err(Fault::at("asset", "it has no \"version\""));
    };
    let numbers = |version: &str| -> Option<(u32, u32)> {
        let (major, minor) = version.split_once('.').unwrap_or((version, "0"));
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    if numbers(version).map(|(major, _)| major) != Some(2) {
        return Err(Fault::Unsupported(format!("glTF version \"{version}\"; lumel reads version 2.0")));
    }
    // Documents of 2.1 may be read as 2.0 unless they say otherwise.
    match asset.and_then(|a| a.get("minVersion")).and_then(Value::as_str) {
        Some(least) if numbers(least).is_none_or(|least| least > (2, 0)) => {
            Err(Fault::Unsupported(format!("glTF of at least version \"{least}\"; lumel reads version 2.0")))
        }
        _ => Ok(()),
    }
}

/// The nodes of the default scene, or of the first.
fn scene_roots(root: &mut Map<String, Value>) -> Result<Option<Vec<usize>>, Fault> {
    let mut scenes = take_list(root, "scenes")?;
    let chosen = match root.get("scene") {
        None | Some(Value::Null) if scenes.is_empty() => return Ok(None),
        None | Some(Value::Null) => 0,
        Some(index) => typed::<u32>(index.clone(), "scene")? as usize,
    };
    let count = scenes.len();
    // Some writers state a default scene and write none; then there is nothing to choose from.
    if count == 0 {
        return Ok(None);
    }
    let scene = scenes.get_mut(chosen).ok_or_else(|| Fault::absent("\"scene\"", "scene", chosen, count))?;
    let nodes = scene.get_mut("nodes").map_or(Value::Array(Vec::new()), Value::take);
    let nodes: Vec<Index<Node>> = typed(nodes, &format!("scene {chosen}, \"nodes\""))?;
    Ok(Some(nodes.iter().map(Index::value).collect()))
}

fn take_list(map: &mut Map<String, Value>, key: &str) -> Result<Vec<Value>, Fault> {
    match map.remove(key) {
        None | Some(Value::Null) => Ok(Vec::new()),
        Some(Value::Array(items)) => Ok(items),
        Some(_) => Err(Fault::at(format_args!("\"{key}\""), "it must be a list")),
    }
}

/// A value as a type of the schema; `place` is for messages.
pub(super) fn typed<T: DeserializeOwned>(value: Value, place: &str) -> Result<T, Fault> {
    serde_json::from_value(value).map_err(|error| Fault::at(place, error))
}

fn strict<T: DeserializeOwned>(
    root: &mut Map<String, Value>,
    key: &str,
    what: &str,
) -> Result<Vec<T>, Fault> {
    let items = take_list(root, key)?.into_iter().enumerate();
    items.map(|(index, item)| typed(item, &format!("{what} {index}"))).collect()
}

fn lenient<T: DeserializeOwned>(items: Vec<Value>, what: &str, warnings: &mut Warnings) -> Vec<Option<T>> {
    let mut read = |(index, item): (usize, Value)| {
        let name = item.get("name").and_then(Value::as_str).map(str::to_owned);
        match serde_json::from_value(item) {
            Ok(item) => Some(item),
            Err(error) => {
                warnings.push(label(what, index, name.as_deref()), format!("ignored: {error}"));
                None
            }
        }
    };
    items.into_iter().enumerate().map(&mut read).collect()
}

#[cfg(test)]
mod tests;
