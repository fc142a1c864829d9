use super::*;
use crate::gltf::testing::{Model, text};
use lumel_scene::{SceneBuilder, Wrap};
use serde_json::{Value, json};
use std::f32::consts::FRAC_PI_2;

/// A triangle of this material; texture 0 is red, texture 1 is grey.
fn model(material: Value) -> Model {
    let mut model = Model::triangle();
    model.texture([255, 0, 0]);
    model.texture([188, 188, 188]);
    model.push("materials", material);
    let coordinates = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = json!(coordinates);
    model.primitive()["material"] = json!(0);
    model
}

fn read(material: Value) -> (SceneBuilder, String) {
    let imported = model(material).read().unwrap();
    (imported.scene, text(&imported.warnings))
}

fn matte(more: Value) -> Value {
    let mut material = json!({ "name": "M", "pbrMetallicRoughness": { "metallicFactor": 0 } });
    for (key, value) in more.as_object().unwrap() {
        if let (Some(old), Some(new)) = (material[key].as_object_mut(), value.as_object()) {
            old.extend(new.clone());
        } else {
            material[key] = value.clone();
        }
    }
    material
}

#[test]
fn base_colour_is_the_albedo_and_sides_are_kept() {
    let (scene, warnings) =
        read(matte(json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 0.125, 0.1] } })));
    let material = &scene.materials[0];
    assert_eq!((material.name.as_str(), material.albedo), ("M", Vec3::new(0.5, 0.25, 0.125)));
    assert_eq!((material.sides, material.emits()), (Sides::Front, false));
    assert_eq!(warnings, "");
    let (scene, _) = read(matte(json!({ "doubleSided": true })));
    assert_eq!(scene.materials[0].sides, Sides::Both);
}

#[test]
fn primitives_without_material_share_the_default_one() {
    let mut model = model(matte(json!({})));
    let bare = json!({ "attributes": { "POSITION": 0 } });
    let made = model.primitive().clone();
    model.json["meshes"][0]["primitives"] = json!([bare, made, bare, made]);
    let imported = model.read().unwrap();
    let ids: Vec<_> = imported.scene.objects[0].faces.iter().map(|face| face.material.0).collect();
    assert_eq!(ids, [0, 1, 0, 1]);
    assert_eq!(imported.scene.materials[0], Material::default());
    model.primitive()["material"] = json!(5);
    assert_eq!(model.error(), "mesh 0, primitive 0: refers to material 5 of 1");
}

#[test]
fn emission_is_factor_times_strength_times_texture() {
    let (scene, warnings) = read(matte(json!({
        "emissiveFactor": [1, 0.5, 0],
        "emissiveTexture": { "index": 1 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 20 } },
    })));
    let material = &scene.materials[0];
    assert_eq!(material.emission, Radiance(Vec3::new(20.0, 10.0, 0.0)));
    let texture = &scene.textures[material.emission_texture.unwrap().texture.index()];
    assert!((texture.sample(Vec2::ZERO).x - 0.5).abs() < 0.01, "188 is half the light in sRGB");
    assert_eq!(warnings, "");
    let (scene, _) = read(matte(json!({ "emissiveTexture": { "index": 1 } })));
    assert!(scene.textures.is_empty(), "black times a texture is black");
}

#[test]
fn texture_transforms_are_kept_for_every_texture() {
    let extension = json!({ "KHR_texture_transform":
        { "offset": [0.5, 0.25], "rotation": FRAC_PI_2, "scale": [2, 3] } });
    let info = json!({ "index": 0, "extensions": extension });
    let (scene, warnings) = read(matte(json!({
        "pbrMetallicRoughness": { "baseColorTexture": info },
        "normalTexture": info,
        "emissiveTexture": info,
        "emissiveFactor": [1, 1, 1],
    })));
    let expected =
        UvTransform { offset: Vec2::new(0.5, 0.25), rotation: FRAC_PI_2, scale: Vec2::new(2.0, 3.0) };
    let material = &scene.materials[0];
    let normal = material.normal_texture.map(|map| map.image);
    for texture in [material.albedo_texture, material.emission_texture, normal] {
        assert_eq!(texture.unwrap().transform, expected);
    }
    assert_eq!(warnings, "");
}

#[test]
fn an_image_as_colour_and_as_data_is_two_textures_and_otherwise_one() {
    let (scene, _) = read(matte(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 } },
        "normalTexture": { "index": 1 },
        "emissiveTexture": { "index": 1 },
        "emissiveFactor": [1, 1, 1],
    })));
    let material = &scene.materials[0];
    let red = |texture: Option<TextureRef>| scene.textures[texture.unwrap().texture.index()].texel(0, 0).x;
    assert_eq!(scene.textures.len(), 2);
    assert_eq!(material.albedo_texture, material.emission_texture);
    assert!(red(material.albedo_texture) < 0.51 && red(material.normal_texture.map(|map| map.image)) > 0.73);
}

#[test]
fn samplers_say_how_textures_wrap() {
    let mut model = model(matte(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } }, "normalTexture": { "index": 1 },
    })));
    let sampler = model.push("samplers", json!({ "wrapS": 33071, "wrapT": 33648 }));
    model.json["textures"][0]["sampler"] = json!(sampler);
    let textures = model.read().unwrap().scene.textures;
    assert_eq!((textures[0].wrap_u, textures[0].wrap_v), (Wrap::Clamp, Wrap::Mirror));
    assert_eq!((textures[1].wrap_u, textures[1].wrap_v), (Wrap::Repeat, Wrap::Repeat));
}

#[test]
fn images_that_cannot_be_had_leave_the_factor_and_a_warning() {
    let material = matte(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [0.2, 0.2, 0.2, 1], "baseColorTexture": { "index": 0 } },
    }));
    for (image, problem) in [
        (json!({ "uri": "absent.png" }), "\"absent.png\" does not exist"),
        (json!({ "uri": "../outside.png" }), "outside the folder"),
        (json!({ "uri": "data:image/png;base64,AAAA" }), "image 0 is in no known format"),
        (json!({ "uri": "data:image/png;base64,A" }), "cannot read image image 0"),
        (json!({ "bufferView": 99 }), "bufferView 99"),
        (json!({ "name": "Bricks" }), "image Bricks: it has neither"),
        (json!({ "uri": 3 }), "no image in a format"),
    ] {
        let mut model = model(material.clone());
        model.json["images"][0] = image;
        let imported = model.read().unwrap();
        let warnings = text(&imported.warnings);
        assert!(warnings.contains("material \"M\": base colour texture left out: "), "{warnings}");
        assert!(warnings.contains(problem), "{warnings}");
        assert_eq!(imported.scene.materials[0].albedo, Vec3::splat(0.2));
        assert_eq!(imported.scene.materials[0].albedo_texture, None);
    }
    let mut model = model(material);
    model.json["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    assert!(text(&model.read().unwrap().warnings).contains("no image in a format that lumel reads"));
}

#[test]
fn other_coordinates_than_the_base_colours_are_warned_about() {
    let (scene, warnings) = read(matte(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "normalTexture": { "index": 1, "texCoord": 1 },
    })));
    assert!(scene.materials[0].normal_texture.is_some());
    assert_eq!(
        warnings,
        "material \"M\": normal texture asks for TEXCOORD_1 beside TEXCOORD_0, which is used for both\n"
    );
}

#[test]
fn what_diffuse_light_cannot_do_is_said_once_for_each_material() {
    let transmission = json!({ "KHR_materials_transmission":
        { "transmissionFactor": 1, "transmissionTexture": { "index": 0 } } });
    let diffuse = json!({ "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 1 } });
    let cases = [
        (json!({ "pbrMetallicRoughness": { "metallicFactor": 1 } }), "M\": metal is treated as diffuse"),
        (
            json!({ "pbrMetallicRoughness": { "metallicFactor": 1, "metallicRoughnessTexture": { "index": 0 } } }),
            "metal in its texture is treated as diffuse",
        ),
        (json!({ "extensions": { "KHR_materials_unlit": {} } }), "KHR_materials_unlit: its base colour"),
        (json!({ "extensions": transmission }), "its transmission texture is ignored"),
        (json!({ "extensions": diffuse }), "light that passes through it diffusely is not computed"),
    ];
    for (more, message) in cases {
        let mut model = model(matte(more));
        model.push("nodes", json!({ "mesh": 0 }));
        let warnings = text(&model.read().unwrap().warnings);
        assert_eq!((warnings.matches(message).count(), warnings.lines().count()), (1, 1), "{warnings}");
    }
}

#[test]
fn what_many_materials_lose_alike_is_said_once() {
    let metal = |name| json!({ "name": name, "pbrMetallicRoughness": { "metallicFactor": 1 } });
    let mut model = model(metal("A"));
    for (index, name) in [(1, "B"), (2, ""), (3, "D")] {
        model.push("materials", metal(name));
        let mut mesh = model.json["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(index);
        model.push("meshes", mesh);
    }
    for mesh in 0..4 {
        model.push("nodes", json!({ "mesh": mesh }));
    }
    let warnings = text(&model.read().unwrap().warnings);
    assert_eq!(
        warnings,
        "materials \"A\", \"B\" and 2 more: metal is treated as diffuse, with its base colour as albedo\n"
    );
}

#[test]
fn alpha_counts_as_its_mode_says() {
    let transparency = |more: Value| {
        let base = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 0.25], "baseColorTexture": { "index": 0 } });
        let mut material = matte(json!({ "pbrMetallicRoughness": base }));
        material.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let (scene, warnings) = read(material);
        assert_eq!(warnings, "");
        let material = &scene.materials[0];
        assert_eq!(material.albedo, Vec3::splat(0.5));
        (material.transparency, material.albedo_texture)
    };
    let (opaque, _) = transparency(json!({}));
    assert_eq!((opaque.mode, opaque.texture), (AlphaMode::Opaque, None));
    for (more, mode) in [
        (json!({ "alphaMode": "MASK" }), AlphaMode::Mask { cutoff: 0.5 }),
        (json!({ "alphaMode": "MASK", "alphaCutoff": 0.75 }), AlphaMode::Mask { cutoff: 0.75 }),
        (json!({ "alphaMode": "BLEND" }), AlphaMode::Blend),
    ] {
        let (found, albedo_texture) = transparency(more);
        assert_eq!((found.mode, found.alpha, found.texture), (mode, 0.25, albedo_texture));
        assert!(albedo_texture.is_some());
    }
}

#[test]
fn what_transmits_is_not_reflected_and_tinted_by_the_base_colour() {
    let extension = json!({ "KHR_materials_transmission": { "transmissionFactor": 0.75 } });
    let (scene, warnings) = read(matte(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.4, 0.2, 1] },
        "extensions": extension,
    })));
    let material = &scene.materials[0];
    assert!((material.transparency.transmission - Vec3::new(0.6, 0.3, 0.15)).length() < 1e-6);
    assert!((material.albedo - Vec3::new(0.2, 0.1, 0.05)).length() < 1e-6);
    assert_eq!(warnings, "");
    let (scene, _) = read(json!({ "extensions": extension }));
    assert_eq!(scene.materials[0].transparency.transmission, Vec3::ZERO, "metal lets nothing through");
}

#[test]
fn specular_glossiness_gives_its_diffuse_colour_unless_there_is_better() {
    let old = json!({ "KHR_materials_pbrSpecularGlossiness":
        { "diffuseFactor": [0.1, 0.2, 0.3, 1], "diffuseTexture": { "index": 0 } } });
    let (scene, warnings) = read(json!({ "extensions": old }));
    assert_eq!(scene.materials[0].albedo, Vec3::new(0.1, 0.2, 0.3));
    assert!(scene.materials[0].albedo_texture.is_some());
    assert_eq!(warnings, "");
    let (scene, _) = read(matte(json!({ "extensions": old })));
    assert_eq!((scene.materials[0].albedo, scene.materials[0].albedo_texture), (Vec3::ONE, None));
}

#[test]
fn a_material_of_the_wrong_types_becomes_the_default_one() {
    let (scene, warnings) = read(json!({ "name": "Odd", "doubleSided": "yes" }));
    assert_eq!(scene.materials, [Material::default()]);
    assert!(warnings.starts_with("material \"Odd\": ignored: invalid type"), "{warnings}");
}

#[test]
fn metal_and_roughness_are_kept_with_their_image_as_it_is() {
    let transform = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25] } });
    let surface = json!({
        "metallicFactor": 0.75, "roughnessFactor": 0.25, "baseColorTexture": { "index": 0 },
        "metallicRoughnessTexture": { "index": 1, "extensions": transform },
    });
    let model = model(json!({ "pbrMetallicRoughness": surface }));
    let imported = model.read().unwrap().scene;
    let gloss = &imported.materials[0].gloss;
    assert_eq!((gloss.metallic, gloss.roughness), (0.75, 0.25));
    let texture = gloss.texture.as_ref().unwrap();
    assert_eq!((texture.image.mime_type, texture.transform.offset), ("image/png", Vec2::new(0.5, 0.25)));
    assert_eq!(texture.image.bytes, crate::testing::png([188, 188, 188, 255]));
    assert_eq!(imported.textures.len(), 1, "it is not decoded");
    // Light does not depend on it.
    let hash = |scene: &SceneBuilder| scene.clone().build().unwrap().0.hash();
    let dull = SceneBuilder {
        materials: vec![Material { gloss: Gloss::default(), ..imported.materials[0].clone() }],
        ..imported.clone()
    };
    assert_eq!(hash(&dull), hash(&imported));
    // Nor do coordinates: alone, it would bring some.
    let alone = json!({ "metallicRoughnessTexture": { "index": 1 } });
    assert!(read(json!({ "pbrMetallicRoughness": alone })).0.materials[0].gloss.texture.is_none());
}
