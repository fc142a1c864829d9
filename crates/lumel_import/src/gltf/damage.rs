//! Damaged files: an error or a scene, never a panic.

use super::testing::{Model, U8, U16, read_bytes};
use lumel_scene::SceneError;
use proptest::prelude::*;
use serde_json::{Value, json};

/// A document with a bit of everything.
fn rich() -> Model {
    let mut model = Model::triangle();
    let (color, normal) = (model.texture([255, 0, 0]), model.texture([128, 128, 255]));
    let sampler = model.push("samplers", json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9729 }));
    model.json["textures"][0]["sampler"] = json!(sampler);
    let transform =
        json!({ "KHR_texture_transform": { "offset": [0.5, 0], "rotation": 1, "scale": [2, 2] } });
    model.push(
        "materials",
        json!({
            "name": "Rich", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.5,
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.5, 0.5, 1],
                "baseColorTexture": { "index": color, "texCoord": 0, "extensions": transform },
                "metallicFactor": 0,
            },
            "normalTexture": { "index": normal, "scale": 1 },
            "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": color },
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 3 } },
        }),
    );
    model.push(
        "materials",
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [1, 0, 0, 1] } } }),
    );
    let indices = model.accessor(U16, "SCALAR", 4, &[0, 0, 1, 0, 2, 0, 1, 0]);
    let uvs = model.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let colors = model.accessor(U8, "VEC4", 3, &[200; 12]);
    model.json["accessors"][colors]["normalized"] = json!(true);
    let (at, values) = (model.view(&[1]), model.view(&[0, 0, 0, 63, 0, 0, 0, 64, 0, 0, 0, 64]));
    model.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": at, "byteOffset": 0, "componentType": U8 },
        "values": { "bufferView": values, "byteOffset": 0 },
    });
    *model.primitive() = json!({
        "attributes": { "POSITION": 0, "TEXCOORD_0": uvs, "NORMAL": normals, "COLOR_0": colors },
        "indices": indices, "mode": 5, "material": 0,
    });
    let fan = json!({ "attributes": { "POSITION": 0 }, "mode": 6, "material": 1 });
    model.push("meshes", json!({ "name": "Fan", "primitives": [fan], "weights": [0] }));
    let (joints, weights) =
        (model.accessor(U8, "VEC4", 3, &[0; 12]), model.accessor(U8, "VEC4", 3, &[63; 12]));
    let bind: Vec<f32> = (0..16).map(|i| f32::from(u8::from(i % 5 == 0))).collect();
    let bind = model.floats("MAT4", &bind);
    let attributes = json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
    let bones = json!({ "attributes": attributes, "targets": [{ "POSITION": normals }], "material": 1 });
    model.push("meshes", json!({ "name": "Bones", "primitives": [bones], "weights": [0.5] }));
    model.push("skins", json!({ "joints": [2], "inverseBindMatrices": bind, "skeleton": 0 }));
    let moves = model.floats("VEC3", &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let turns = model.accessor(U8, "VEC4", 2, &[0, 0, 0, 255, 0, 0, 255, 0]);
    let instances = json!({ "attributes": { "TRANSLATION": moves, "ROTATION": turns } });
    model.json["nodes"] = json!([
        { "mesh": 0, "scale": [-1, 2, 1], "children": [1, 2, 3, 4], "name": "Root" },
        { "mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1] },
        { "camera": 0, "rotation": [0, 0, 0, 1], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "mesh": 2, "skin": 0, "extensions": { "KHR_node_visibility": { "visible": true } } },
        { "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": instances } },
    ]);
    model.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
    let spot = json!({ "innerConeAngle": 0.1, "outerConeAngle": 0.5 });
    let light = json!({ "type": "spot", "intensity": 5, "color": [1, 1, 1], "range": 9, "spot": spot });
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_texture_transform", "X_other"]);
    model.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    model.json["scene"] = json!(0);
    model.json["scenes"] = json!([{ "nodes": [0] }]);
    model.json["buffers"] = json!([{ "byteLength": model.bin.len() }]);
    model
}

/// Reads and builds. Of what was read, the scene may find nothing wrong but that there is nothing left of it, or nothing that
/// numbers hold.
fn survive(bytes: &[u8]) {
    match read_bytes(bytes) {
        Ok(imported) => match imported.scene.build() {
            Ok(_)
            | Err(SceneError::Empty { .. } | SceneError::TooSmall { .. } | SceneError::Unresolved { .. }) => {
            }
            Err(error) => panic!("read, but cannot be built: {error}"),
        },
        Err(message) => assert!(!message.is_empty() && message.len() < 1000, "{message}"),
    }
}

/// The paths of all values in a document.
fn places(value: &Value, place: &str, all: &mut Vec<String>) {
    all.push(place.to_owned());
    match value {
        Value::Object(map) => map.iter().for_each(|(key, v)| places(v, &format!("{place}/{key}"), all)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| places(v, &format!("{place}/{i}"), all))
        }
        _ => {}
    }
}

fn hostile_values() -> Vec<Value> {
    let deep = (0..100).fold(json!(1), |inner, _| json!([inner]));
    vec![
        json!(null),
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(7),
        json!(0.5),
        json!(1e38),
        json!(-1e300),
        json!(65_535),
        json!(4_294_967_295_u32),
        json!(4_294_967_296_u64),
        json!(u64::MAX),
        json!(true),
        json!(""),
        json!("data:;base64,AAAA"),
        json!("/dev/zero"),
        json!([]),
        json!([0]),
        json!([0, 0, 0]),
        json!({}),
        json!({ "index": 1 }),
        deep,
    ]
}

#[test]
fn the_undamaged_document_is_read_without_loss() {
    let imported = rich().read().unwrap();
    let scene = &imported.scene;
    assert_eq!((scene.objects.len(), scene.materials.len(), scene.textures.len()), (5, 2, 2));
    assert_eq!((scene.lights.len(), scene.cameras.len()), (1, 1));
    // The strip's second triangle turns back on itself.
    assert!(scene.objects.iter().all(|object| object.faces.len() == 1));
    survive(&rich().glb());
}

#[test]
fn a_file_may_end_anywhere() {
    let bytes = rich().glb();
    for end in 0..bytes.len() {
        survive(&bytes[..end]);
        // The same with a header that hides the cut.
        let mut bytes = bytes[..end].to_vec();
        if end >= 12 {
            bytes[8..12].copy_from_slice(&(end as u32).to_le_bytes());
        }
        survive(&bytes);
    }
}

#[test]
fn any_value_of_the_document_may_be_wrong_or_missing() {
    let model = rich();
    let mut all = Vec::new();
    places(&model.json, "", &mut all);
    assert!(all.len() > 200);
    for place in &all {
        for value in hostile_values() {
            let mut damaged = model.clone();
            *damaged.json.pointer_mut(place).unwrap() = value;
            survive(&damaged.glb());
        }
        let (parent, key) = place.rsplit_once('/').unwrap_or_default();
        let mut damaged = model.clone();
        if let Some(Value::Object(parent)) = damaged.json.pointer_mut(parent) {
            parent.remove(key);
            survive(&damaged.glb());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_may_be_wrong(edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = rich().glb();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        survive(&bytes);
    }

    #[test]
    fn any_two_values_may_be_wrong(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>()), 2)
    ) {
        let mut model = rich();
        let values = hostile_values();
        for (at, value) in edits {
            let mut all = Vec::new();
            places(&model.json, "", &mut all);
            *model.json.pointer_mut(at.get::<String>(&all)).unwrap() = value.get(&values).clone();
        }
        survive(&model.glb());
    }

    #[test]
    fn any_vertex_data_may_be_there(data in prop::collection::vec(any::<u32>(), 9)) {
        let mut model = rich();
        for (four, value) in model.bin.chunks_exact_mut(4).zip(data) {
            four.copy_from_slice(&value.to_le_bytes());
        }
        survive(&model.glb());
    }
}
