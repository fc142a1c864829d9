//! Files that lumel has written: what shows their light is not what their surfaces are made of.

use lumel_scene::Warnings;
use serde_json::{Value, json};

/// The attribute to which `COLOR_0` with alpha is moved: of it, alpha alone is the surface's.
pub(super) const BAKED: &str = "LUMEL_BAKED";

const STRENGTH: &str = "KHR_materials_emissive_strength";

/// Turns a file of `lumel bake` back into the scene that was baked, as far as it holds it.
///
/// `COLOR_0` is light and left out, but for its alpha. Emissive surfaces that show it alone have white as base colour and no strength; their
/// albedo and emission are in the extras. The emission of lit ones is times a scale.
pub(super) fn restore(root: &mut Value, warnings: &mut Warnings) {
    if !shows_light(root) {
        return;
    }
    let scale = root["asset"]["extras"]["emission_scale"].as_f64().filter(|scale| *scale > 0.0);
    let scale = scale.unwrap_or(1.0);
    let accessors: Vec<Value> = items(root, "accessors").map(|accessor| accessor["type"].clone()).collect();
    let has_alpha = |colors: &Value| {
        colors.as_u64().and_then(|index| accessors.get(index as usize)).is_some_and(|kind| kind == "VEC4")
    };
    let mut has_colors = false;
    for mesh in items(root, "meshes") {
        for primitive in items(mesh, "primitives") {
            let attributes = primitive.get_mut("attributes").and_then(Value::as_object_mut);
            let Some(attributes) = attributes else { continue };
            let Some(colors) = attributes.remove("COLOR_0") else { continue };
            has_colors = true;
            if has_alpha(&colors) {
                attributes.insert(format!("_{BAKED}"), colors);
            }
        }
    }
    items(root, "materials").for_each(|material| restore_material(material, scale));
    if has_colors {
        warnings.push(
            "COLOR_0",
            "lumel has baked these vertex colours: they are light and left out of the albedo",
        );
    }
}

/// Whether lumel has written the light of a bake into its materials. Where those of the scene are kept, there is no exposure.
fn shows_light(root: &Value) -> bool {
    let asset = &root["asset"];
    asset["generator"].as_str().is_some_and(|generator| generator.starts_with("lumel "))
        && asset["extras"]["_IRRADIANCE"].is_string()
        && asset["extras"]["exposure"].is_number()
}

fn restore_material(material: &mut Value, scale: f64) {
    let [albedo, emission] = ["albedo", "emission"].map(|name| color(&material["extras"][name]));
    let Some(fields) = material.as_object_mut() else { return };
    let extensions = fields.get_mut("extensions").and_then(Value::as_object_mut);
    let was_unlit = extensions.is_some_and(|extensions| extensions.remove("KHR_materials_unlit").is_some());
    if let Some(emission) = emission.filter(|_| was_unlit) {
        let strength = emission.into_iter().fold(1.0, f64::max);
        fields.insert("emissiveFactor".into(), json!(emission.map(|c| c / strength)));
        fields["extensions"][STRENGTH] = json!({ "emissiveStrength": strength });
    }
    if !was_unlit {
        let strength = fields.get("extensions").map(|all| &all[STRENGTH]["emissiveStrength"]);
        let strength = strength.and_then(Value::as_f64).unwrap_or(1.0) / scale;
        if fields.get("emissiveFactor").is_some() {
            let extensions = fields.entry("extensions").or_insert_with(|| json!({}));
            extensions[STRENGTH] = json!({ "emissiveStrength": strength });
        }
    }
    let surface = fields.get_mut("pbrMetallicRoughness").filter(|surface| surface.is_object());
    let (Some(surface), Some([r, g, b])) = (surface, albedo) else { return };
    if surface["baseColorTexture"].is_null() {
        let alpha = surface["baseColorFactor"].get(3).cloned().unwrap_or(json!(1));
        surface["baseColorFactor"] = json!([r, g, b, alpha]);
    }
}

/// Three numbers.
fn color(value: &Value) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    numbers?.try_into().ok()
}

fn items<'a>(value: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    let items = value.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten();
    items.filter(|item| item.is_object())
}

#[cfg(test)]
mod tests {
    use crate::gltf::testing::{Model, text};
    use glam::Vec3;
    use serde_json::json;

    /// A triangle with vertex colours and an emissive material, as lumel writes them.
    fn baked(generator: &str) -> Model {
        let mut model = Model::triangle();
        let colors = model.floats("VEC3", &[0.25; 9]);
        model.primitive()["attributes"]["COLOR_0"] = json!(colors);
        model.primitive()["material"] = json!(0);
        model.json["asset"]["generator"] = json!(generator);
        model.json["asset"]["extras"] =
            json!({ "_IRRADIANCE": "irradiance", "exposure": 0.5, "emission_scale": 0.5 });
        let surface = json!({ "baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0 });
        model.json["materials"] = json!([{
            "pbrMetallicRoughness": surface, "extensions": { "KHR_materials_unlit": {} },
            "extras": { "albedo": [0.5, 0.25, 0.125], "emission": [0, 3, 6] },
        }]);
        model
    }

    #[test]
    fn light_that_lumel_has_baked_is_no_albedo() {
        let imported = baked("lumel 0.1.0").read().unwrap();
        assert!(imported.scene.objects[0].tints.is_empty());
        assert_eq!(imported.scene.materials[0].albedo, Vec3::new(0.5, 0.25, 0.125));
        assert_eq!(imported.scene.materials[0].emission.0, Vec3::new(0.0, 3.0, 6.0));
        assert!(text(&imported.warnings).contains("lumel has baked these vertex colours"));
        assert_eq!(imported.warnings.len(), 1, "nothing is said about unlit");
    }

    #[test]
    fn the_alpha_of_what_lumel_has_baked_is_the_surface_s() {
        let mut model = baked("lumel 0.1.0");
        let colors = model.floats("VEC4", &[0.25, 0.25, 0.25, 0.75].repeat(3));
        model.primitive()["attributes"]["COLOR_0"] = json!(colors);
        let object = model.object();
        assert!(object.tints.is_empty());
        assert_eq!(object.alphas, [0.75; 3]);
    }

    #[test]
    fn emission_that_is_shown_to_scale_is_that_of_the_scene_again() {
        let mut model = baked("lumel 0.1.0");
        let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 3 } });
        model.json["materials"][0]["extensions"] = strength;
        model.json["materials"][0]["emissiveFactor"] = json!([0, 0.5, 1]);
        assert_eq!(model.read().unwrap().scene.materials[0].emission.0, Vec3::new(0.0, 3.0, 6.0));
        model.json["materials"][0]["extensions"] = json!({});
        assert_eq!(model.read().unwrap().scene.materials[0].emission.0, Vec3::new(0.0, 1.0, 2.0));
    }

    #[test]
    fn files_with_the_materials_of_the_scene_are_taken_as_they_are() {
        let mut model = baked("lumel 0.1.0");
        model.json["asset"]["extras"] = json!({ "_IRRADIANCE": "irradiance" });
        let imported = model.read().unwrap();
        assert_eq!(imported.scene.objects[0].tints, [Vec3::splat(0.25); 3]);
        assert_eq!(imported.scene.materials[0].albedo, Vec3::ONE);
    }

    #[test]
    fn files_of_other_programs_keep_their_colours() {
        let imported = baked("lumelish").read().unwrap();
        assert_eq!(imported.scene.objects[0].tints, [Vec3::splat(0.25); 3]);
        assert_eq!(imported.scene.materials[0].albedo, Vec3::ONE);
    }
}
