//! Lit scenes as binary glTF 2.0.

mod binary;
mod material;
mod primitive;

use crate::display::finite_irradiance;
use crate::{ColorScale, ExportError, write_atomically};
use binary::Binary;
use glam::DVec3;
use lumel_basis::Lighting;
use lumel_scene::Scene;
use material::Materials;
use primitive::Streams;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

const JSON_CHUNK: &[u8; 4] = b"JSON";
const BIN_CHUNK: &[u8; 4] = b"BIN\0";

/// Writes the lit scene as a GLB file, atomically. Returns the exposure used.
///
/// Every object is a mesh with one primitive per material, at a node that moves it where a scene is far from the origin. Its vertices carry
/// - `_IRRADIANCE`: irradiance, W·m⁻² (lux if the lights are photometric), linear Rec. 709, exact;
/// - `COLOR_0`: radiance of a white surface under that irradiance, times the exposure, clamped to 0..=1; its fourth
///   component, in scenes that have any, is the alpha of vertices.
///
/// Materials are one-sided, with the albedo as base colour and the radiance as emission, each with its own texture.
/// They are unlit, so that any viewer shows base colour times `COLOR_0`: radiance times exposure. Base colour can only
/// darken, so the exposure is that of white, not of the actual surfaces. Emissive surfaces without textures show
/// emitted and reflected radiance in `COLOR_0` alone, with white as base colour. Emissive surfaces with a texture are
/// lit: viewers show their emission, unscaled, and reflect light of their own. Albedo and emission of each material
/// are in its `extras`; exposure, units and the hash of the geometry in those of `asset`. Normal maps are left out.
///
/// # Errors
/// Light of a different scene or that is not finite, an exposure that is not positive, a scene beyond the format's limit
/// of 4 GiB, and the errors of [`write_atomically`].
pub fn write_glb(
    path: &Path,
    scene: &Scene,
    lighting: &dyn Lighting,
    exposure: ColorScale,
) -> Result<f32, ExportError> {
    let irradiance = &*finite_irradiance(path, scene, lighting)?;
    let exposure = exposure.factor(path, irradiance)?;
    let materials = Materials::new(scene).map_err(|error| ExportError::io(path, error))?;
    let primitives = primitive::split(scene);
    let streams = Streams { scene, irradiance, exposure, materials: &materials, primitives: &primitives };
    let mut binary = Binary::default();
    let mut document = json!({});
    add_meshes(&mut document, &mut binary, &streams);
    materials.add_to(&mut document, &mut binary);
    document["asset"] = asset(scene, exposure);
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
        materials.write_images(out)
    })?;
    Ok(exposure)
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

fn asset(scene: &Scene, exposure: f32) -> Value {
    json!({
        "version": "2.0",
        "generator": concat!("lumel ", env!("CARGO_PKG_VERSION")),
        "extras": {
            "scene": scene.name(),
            "geometry_hash": scene.geometry_hash().to_hex().as_str(),
            "exposure": exposure,
            "_IRRADIANCE": "irradiance, W/m^2 (lux if the lights are photometric), linear Rec. 709",
            "COLOR_0": "min(1, _IRRADIANCE / pi * vertex tint * exposure); \
                        on emitting materials without textures min(1, (emitted + reflected radiance) * exposure)",
        },
    })
}

fn add_meshes(document: &mut Value, binary: &mut Binary, streams: &Streams<'_>) {
    let mut by_object: BTreeMap<u32, Vec<Value>> = BTreeMap::new();
    let described = streams.describe(binary);
    for (primitive, json) in streams.primitives.iter().zip(described) {
        by_object.entry(primitive.object.0).or_default().push(json);
    }
    let (names, origin) = (streams.scene.object_names(), streams.scene.origin());
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for (object, primitives) in by_object {
        let name = &names[object as usize];
        let mut node = json!({ "name": name, "mesh": meshes.len() });
        if origin != DVec3::ZERO {
            node["translation"] = json!(origin.to_array());
        }
        nodes.push(node);
        meshes.push(json!({ "name": name, "primitives": primitives }));
    }
    let all: Vec<usize> = (0..nodes.len()).collect();
    document["scene"] = json!(0);
    document["scenes"] = json!([{ "name": streams.scene.name(), "nodes": all }]);
    document["nodes"] = nodes.into();
    document["meshes"] = meshes.into();
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
