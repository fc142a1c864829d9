//! Known extensions.

use super::fault::Fault;
use lumel_scene::Warnings;
use serde_json::{Map, Value};

/// Extensions that a file may require.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that make no difference to diffuse light, or about which the item that uses them is warned about.
const HARMLESS: &[&str] = &[
    // Another way to store what the file holds in plain form too, as it must when the extension is not required.
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
    // What mirrors and coats reflect.
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    // Named by material.
    "KHR_materials_diffuse_transmission",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_volume",
    // Alternatives to what the file shows, other people's results, and notes.
    "FB_ngon_encoding",
    "KHR_animation_pointer",
    "KHR_materials_variants",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MOZ_lightmap",
];

/// Refuses required extensions that are not supported; warns about unknown extensions in use.
pub(super) fn check(root: &Map<String, Value>, warnings: &mut Warnings) -> Result<(), Fault> {
    let names = |key| root.get(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    let missing: Vec<_> = names("extensionsRequired").filter(|name| !SUPPORTED.contains(name)).collect();
    if !missing.is_empty() {
        let (names, it) = (missing.join(", "), if missing.len() == 1 { "it" } else { "them" });
        return Err(Fault::Unsupported(format!("the file requires {names}; export it without {it}")));
    }
    for name in names("extensionsUsed").filter(|name| !SUPPORTED.contains(name) && !HARMLESS.contains(name)) {
        warnings.push(name, "this extension is not supported; the file is read without it");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn checked(document: Value) -> Result<Warnings, String> {
        let mut warnings = Warnings::default();
        let root = document.as_object().unwrap();
        check(root, &mut warnings).map(|()| warnings).map_err(|fault| fault.to_string())
    }

    #[test]
    fn required_extensions_that_we_do_not_have_are_refused_by_name() {
        assert!(checked(json!({ "extensionsRequired": SUPPORTED })).unwrap().is_empty());
        assert_eq!(
            checked(json!({ "extensionsRequired": ["KHR_texture_transform", "KHR_texture_basisu", "X_y"] }))
                .unwrap_err(),
            "the file requires KHR_texture_basisu, X_y; export it without them"
        );
    }

    #[test]
    fn used_extensions_are_named_when_they_may_change_the_light() {
        let used = json!({ "extensionsUsed": ["EXT_lights_ies", "KHR_materials_clearcoat", 7] });
        let warnings = checked(used).unwrap();
        let subjects: Vec<_> = warnings.iter().map(|w| w.subject.as_str()).collect();
        assert_eq!(subjects, ["EXT_lights_ies"]);
    }
}
