//! Lit scenes as binary glTF 2.0.

mod binary;
mod lamps;
mod lightmapped;
mod lit;
mod material;
mod page_image;
mod primitive;
mod unwrapped;

use crate::{ExportError, write_atomically};
use binary::Binary;
use glam::DVec3;
use lamps::Quads;
use primitive::Streams;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

pub use lightmapped::{LightmapTarget, write_lightmap_glb};
pub use lit::{GlbOptions, GltfMaterials, write_glb};
pub use unwrapped::write_unwrapped_glb;

const JSON_CHUNK: &[u8; 4] = b"JSON";
const BIN_CHUNK: &[u8; 4] = b"BIN\0";

/// Writes what was prepared as a GLB file, atomically.
fn write(path: &Path, streams: &Streams<'_>, mut extras: Value) -> Result<(), ExportError> {
    let lamps = streams.materials.lamps();
    let mut binary = Binary::default();
    let mut document = json!({});
    add_meshes(&mut document, &mut binary, streams);
    streams.materials.add_to(&mut document, &mut binary);
    let mut extensions = streams.materials.extensions().clone();
    let quads = Quads::of(streams.scene, lamps);
    quads.add_to(&mut document, &mut binary, streams.materials.of_rectangles());
    lamps::add_cameras(&mut document, streams.scene);
    if lamps::add_lights(&mut document, streams.scene, lamps) {
        extensions.insert(lamps::PUNCTUAL);
    }
    if !extensions.is_empty() {
        document["extensionsUsed"] = json!(extensions);
    }
    let left_out = lamps::left_out(streams.scene, lamps);
    if !left_out.is_empty() {
        extras["lights_left_out"] = json!(left_out);
    }
    let generator = concat!("lumel ", env!("CARGO_PKG_VERSION"));
    document["asset"] = json!({ "version": "2.0", "generator": generator, "extras": extras });
    document["bufferViews"] = binary.views.into();
    document["accessors"] = binary.accessors.into();
    document["buffers"] = json!([{ "byteLength": binary.length }]);
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = file_length(json.len() as u64, binary.length).map_err(|p| ExportError::content(path, p))?;
    write_atomically(path, |out| {
        out.write_all(b"glTF")?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&length.to_le_bytes())?;
        // Both fit, because the whole does.
        out.write_all(&(json.len() as u32).to_le_bytes())?;
        out.write_all(JSON_CHUNK)?;
        out.write_all(&json)?;
        out.write_all(&(binary.length as u32).to_le_bytes())?;
        out.write_all(BIN_CHUNK)?;
        streams.write(out)?;
        streams.materials.write_images(out)?;
        quads.write(out)
    })
}

/// The length of the file, which must fit in 32 bits.
fn file_length(json: u64, binary: u64) -> Result<u32, String> {
    // A header of 12 bytes for the file and one of 8 for each of its two chunks.
    let length = 28 + json + binary;
    u32::try_from(length).map_err(|_| {
        let gib = length as f64 / f64::from(1 << 30);
        format!(
            "the GLB file would have {gib:.1} GiB; the limit of the format is 4 GiB: write PLY or split the scene"
        )
    })
}

fn add_meshes(document: &mut Value, binary: &mut Binary, streams: &Streams<'_>) {
    let mut by_object: BTreeMap<u32, Vec<Value>> = BTreeMap::new();
    let described = streams.describe(binary);
    let n_pages = streams.primitives.iter().map(|primitive| primitive.page + 1).max();
    for (primitive, mut json) in streams.primitives.iter().zip(described) {
        if n_pages > Some(1) {
            json["extras"] = json!({ "lightmap_page": primitive.page });
        }
        by_object.entry(primitive.object.0).or_default().push(json);
    }
    let (names, origin) = (streams.scene.object_names(), streams.scene.origin());
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for (object, primitives) in by_object {
        let name = &names[object as usize];
        nodes.push(mesh_node(name, meshes.len(), origin));
        meshes.push(json!({ "name": name, "primitives": primitives }));
    }
    let all: Vec<usize> = (0..nodes.len()).collect();
    document["scene"] = json!(0);
    document["scenes"] = json!([{ "name": streams.scene.name(), "nodes": all }]);
    document["nodes"] = nodes.into();
    document["meshes"] = meshes.into();
}

/// A node with a mesh that is relative to the origin of the scene.
fn mesh_node(name: &str, mesh: usize, origin: DVec3) -> Value {
    let mut node = json!({ "name": name, "mesh": mesh });
    if origin != DVec3::ZERO {
        node["translation"] = json!(origin.to_array());
    }
    node
}

/// Adds a node to one of the scenes.
fn add_node(document: &mut Value, scene: usize, node: Value) {
    let Some(nodes) = document["nodes"].as_array_mut() else { return };
    nodes.push(node);
    let index = nodes.len() - 1;
    if let Some(all) = document["scenes"][scene]["nodes"].as_array_mut() {
        all.push(json!(index));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_end_at_four_gibibytes() {
        assert_eq!(file_length(100, 1000), Ok(1128));
        assert_eq!(file_length(4, u64::from(u32::MAX) - 32), Ok(u32::MAX));
        let error = file_length(4, u64::from(u32::MAX) - 31).unwrap_err();
        assert!(error.starts_with("the GLB file would have 4.0 GiB"), "{error}");
        assert!(file_length(1 << 20, 1 << 40).is_err());
    }
}
