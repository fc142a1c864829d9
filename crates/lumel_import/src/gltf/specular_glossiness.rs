//! Materials of the extension `KHR_materials_pbrSpecularGlossiness`.

use serde_json::{Map, Value, json};

/// Rewrites a material of the old KHR_materials_pbrSpecularGlossiness as one of metal and roughness, unless it is both.
///
/// Its diffuse colour is the albedo; the specular colour is ignored.
pub(super) fn to_metallic_roughness(material: &mut Value) {
    let Some(material) = material.as_object_mut().filter(|m| !m.contains_key("pbrMetallicRoughness")) else {
        return;
    };
    let extensions = material.get("extensions");
    let Some(old) = extensions.and_then(|e| e.get("KHR_materials_pbrSpecularGlossiness")?.as_object()) else {
        return;
    };
    let mut new = Map::from_iter([("metallicFactor".to_owned(), json!(0))]);
    for (from, to) in [("diffuseFactor", "baseColorFactor"), ("diffuseTexture", "baseColorTexture")] {
        if let Some(value) = old.get(from) {
            new.insert(to.to_owned(), value.clone());
        }
    }
    material.insert("pbrMetallicRoughness".to_owned(), Value::Object(new));
}
