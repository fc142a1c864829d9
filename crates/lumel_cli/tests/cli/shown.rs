//! What glTF files show, measured: a square of one metre two metres above the floor, of radiance 1.
//!
//! Its irradiance below is that of the contour integral over its edges (Lambert's formula).

use crate::common::{Place, run};
use serde_json::{Value, json};

/// Below the middle of the square, and one and two metres beside it, W/m².
const BELOW: f64 = 0.230_837;
const ONE_BESIDE: f64 = 0.155_6;
const TWO_BESIDE: f64 = 0.063_7;

/// The binary data of [`scene`], and where it goes on.
fn geometry() -> Vec<u8> {
    let floor = [[-3.0, 0.0, -3.0], [-3.0, 0.0, 3.0], [3.0, 0.0, 3.0], [3.0, 0.0, -3.0_f32]];
    let lamp = [[-0.5, 2.0, -0.5], [0.5, 2.0, -0.5], [0.5, 2.0, 0.5], [-0.5, 2.0, 0.5_f32]];
    let uvs = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0_f32];
    let numbers = floor.as_flattened().iter().chain(lamp.as_flattened()).chain(&uvs);
    let mut bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3, 0, 0]);
    bytes
}

/// Accessors: 0 and 1 positions of floor and lamp, 2 coordinates, 3 indices; `more` follows, 4 and on.
fn scene(lamps: &[Value], more: &[(&str, &[f32])]) -> (Value, Vec<u8>) {
    let mut bytes = geometry();
    let floats = |offset: usize, kind: &str, count: usize| {
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * count * width(kind) });
        (view, json!({ "componentType": 5126, "count": count, "type": kind }))
    };
    let indices = json!({ "componentType": 5121, "count": 6, "type": "SCALAR" });
    let mut described = vec![floats(0, "VEC3", 4), floats(48, "VEC3", 4), floats(96, "VEC2", 4)];
    described.push((json!({ "buffer": 0, "byteOffset": 128, "byteLength": 6 }), indices));
    for (kind, values) in more {
        described.push(floats(bytes.len(), kind, values.len() / width(kind)));
        bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    }
    let (views, mut accessors): (Vec<_>, Vec<_>) = described.into_iter().unzip();
    accessors.iter_mut().enumerate().for_each(|(i, accessor)| accessor["bufferView"] = json!(i));
    let mut nodes = vec![json!({ "mesh": 0 })];
    nodes.extend_from_slice(lamps);
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": "scene.bin" }],
        "bufferViews": views,
        "accessors": accessors,
        "materials": [
            { "pbrMetallicRoughness": { "metallicFactor": 0 } },
            { "emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": { "metallicFactor": 0 } },
        ],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 3, "material": 0 }] },
            { "primitives": [{
                "attributes": { "POSITION": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 1,
            }] },
        ],
        "nodes": nodes,
    });
    (document, bytes)
}

fn width(kind: &str) -> usize {
    match kind {
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 16,
    }
}

/// Checks the irradiance at the origin: half a per cent is several standard errors.
fn assert_measured(place: &Place, (document, bytes): &(Value, Vec<u8>), expected: f64) {
    std::fs::write(place.path("scene.bin"), bytes).unwrap();
    place.write("scene.gltf", &document.to_string());
    let line = "measure scene.gltf --point 0,0,0 --normal 0,1,0 --bounces 0 --direct-samples 1024 --json";
    let measured: Value = serde_json::from_str(&run(&mut place.lumel(line)).done().stdout).unwrap();
    let irradiance = measured["irradiance"][0][1].as_f64().unwrap();
    assert!((irradiance - expected).abs() < 0.005 * expected, "{irradiance}, not {expected}");
}

#[test]
fn joints_place_a_skinned_lamp_and_its_node_does_not() {
    let lamp = json!({ "mesh": 1, "skin": 0, "translation": [5, 0, 0] });
    let raised = json!({ "translation": [0, 7, 0] });
    let down = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -7.0, 0.0, 1.0];
    let weights: Vec<f32> = [1.0, 0.0, 0.0, 0.0].repeat(4);
    let mut scene = scene(&[lamp, raised], &[("MAT4", &down), ("VEC4", &weights)]);
    let joints = json!({ "componentType": 5121, "count": 4, "type": "VEC4" });
    scene.0["accessors"].as_array_mut().unwrap().push(joints);
    let attributes = &mut scene.0["meshes"][1]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(6), json!(5));
    scene.0["skins"] = json!([{ "joints": [2], "inverseBindMatrices": 4 }]);
    assert_measured(&Place::new(), &scene, BELOW);
}

#[test]
fn morph_weights_move_a_lamp() {
    let lamp = json!({ "mesh": 1, "translation": [2, 0, 0], "weights": [0.5] });
    let step: Vec<f32> = [-4.0, 0.0, 0.0].repeat(4);
    let mut scene = scene(&[lamp], &[("VEC3", &step)]);
    scene.0["meshes"][1]["primitives"][0]["targets"] = json!([{ "POSITION": 4 }]);
    scene.0["meshes"][1]["weights"] = json!([0]);
    assert_measured(&Place::new(), &scene, BELOW);
}

#[test]
fn every_instance_of_a_lamp_shines() {
    let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 4 } } });
    let lamp = json!({ "mesh": 1, "extensions": extension });
    let scene = scene(&[lamp], &[("VEC3", &[-2.0, 0.0, 0.0, 2.0, 0.0, 0.0])]);
    assert_measured(&Place::new(), &scene, 2.0 * TWO_BESIDE);
}

#[test]
fn hidden_lamps_do_not_shine() {
    let hidden = json!({ "KHR_node_visibility": { "visible": false } });
    let lamp = json!({ "mesh": 1, "translation": [1, 0, 0] });
    let below_hidden = json!({ "mesh": 1, "translation": [-1, 0, 0] });
    let parent = json!({ "children": [2], "extensions": hidden });
    let mut scene = scene(&[lamp, below_hidden, parent], &[]);
    scene.0["extensionsRequired"] = json!(["KHR_node_visibility"]);
    assert_measured(&Place::new(), &scene, ONE_BESIDE);
}

#[test]
fn the_nearest_filter_keeps_texels_apart() {
    let place = Place::new();
    // Black and white, as a bitmap of 24 bits whose row is padded to eight bytes.
    let mut bitmap = b"BM\x3e\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\x18\0".to_vec();
    bitmap.extend([0; 24]);
    bitmap.extend([0, 0, 0, 255, 255, 255, 0, 0]);
    std::fs::write(place.path("two.bmp"), bitmap).unwrap();
    let mut scene = scene(&[json!({ "mesh": 1 })], &[]);
    let half = json!({ "KHR_texture_transform": { "offset": [0.5, 0], "scale": [0.5, 1] } });
    scene.0["materials"][1]["emissiveTexture"] = json!({ "index": 0, "extensions": half });
    scene.0["images"] = json!([{ "uri": "two.bmp" }]);
    scene.0["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    scene.0["samplers"] = json!([{ "magFilter": 9728 }]);
    assert_measured(&place, &scene, BELOW);
}
