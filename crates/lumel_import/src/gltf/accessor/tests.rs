use super::*;
use crate::PathPolicy;
use crate::gltf::container::Container;
use crate::gltf::testing::{F32, Model, U8, U16, U32};
use crate::paths::Resolver;
use lumel_scene::Warnings;
use serde_json::json;
use std::path::Path;

/// The elements of the last accessor, or what is wrong with it.
fn elements<const N: usize>(model: &Model) -> Result<Vec<[f32; N]>, String> {
    let glb = model.glb();
    let container = Container::open(&glb).unwrap();
    let document = Document::parse(container.json, &mut Warnings::default()).unwrap();
    let resolver = Resolver::new(Path::new("model.glb"), PathPolicy::WithinFolder).unwrap();
    let buffers = Buffers::new(&document, container.bin, &resolver);
    let accessors = Accessors::new(&document, &buffers);
    let elements = accessors.elements(document.accessors.len() - 1, "test").map_err(|e| e.to_string())?;
    Ok((0..elements.count()).map(|i| elements.vector(i)).collect())
}

fn one(component: u32, kind: &str, count: u64, bytes: &[u8]) -> Model {
    let mut model = Model::empty();
    model.accessor(component, kind, count, bytes);
    model
}

#[test]
fn every_component_type_is_read_plain_and_normalised() {
    let check = |component: u32, bytes: &[u8], plain: [f32; 2], normalized: [f32; 2]| {
        let mut model = one(component, "VEC2", 1, bytes);
        assert_eq!(elements(&model).unwrap(), [plain], "{component}");
        model.json["accessors"][0]["normalized"] = json!(true);
        assert_eq!(elements(&model).unwrap(), [normalized], "{component}");
    };
    check(5120, &[0x7f, 0x80], [127.0, -128.0], [1.0, -1.0]);
    check(U8, &[0, 255], [0.0, 255.0], [0.0, 1.0]);
    check(5122, &[0x80, 0xff, 0x00, 0x80], [-128.0, -32_768.0], [-128.0 / 32_767.0, -1.0]);
    check(U16, &[0xff, 0xff, 1, 0], [65_535.0, 1.0], [1.0, 1.0 / 65_535.0]);
    check(U32, &[0xff; 8], [4_294_967_295.0; 2], [1.0; 2]);
    check(F32, &[0, 0, 0, 0xbf, 0, 0, 0x20, 0x40], [-0.5, 2.5], [-0.5, 2.5]);
}

#[test]
fn strides_and_offsets_are_followed() {
    let mut model = one(U8, "VEC2", 3, &[9, 9, 1, 2, 9, 3, 4, 9, 5, 6]);
    model.json["bufferViews"][0]["byteOffset"] = json!(1);
    model.json["bufferViews"][0]["byteLength"] = json!(9);
    model.json["bufferViews"][0]["byteStride"] = json!(3);
    model.json["accessors"][0]["byteOffset"] = json!(1);
    assert_eq!(elements(&model).unwrap(), [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
    model.json["accessors"][0]["byteOffset"] = json!(2);
    assert_eq!(
        elements::<2>(&model).unwrap_err(),
        "accessor 0: 3 elements of 2 bytes, 3 apart, do not fit the 9 bytes of bufferView 0 from byte 2"
    );
    model.json["bufferViews"][0]["byteStride"] = json!(1);
    assert!(elements::<2>(&model).unwrap_err().contains("byteStride of 1 for elements of 2 bytes"));
}

#[test]
fn without_a_buffer_view_there_are_zeros() {
    let mut model = one(F32, "VEC3", 2, &[]);
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(elements(&model).unwrap(), [[0.0; 3]; 2]);
}

fn sparse(indices: &[u8], n_values: u8) -> Model {
    let mut model = Model::empty();
    let indices_view = model.view(indices);
    let values: Vec<u8> = (0..n_values).map(|v| 100 + v).collect();
    let values_view = model.view(&values);
    model.accessor(U8, "SCALAR", 5, &[1, 2, 3, 4, 5]);
    model.json["accessors"][0]["sparse"] = json!({
        "count": indices.len(),
        "indices": { "bufferView": indices_view, "componentType": U8 },
        "values": { "bufferView": values_view },
    });
    model
}

#[test]
fn sparse_values_replace_their_elements() {
    let mut model = sparse(&[0, 3, 4], 3);
    assert_eq!(elements(&model).unwrap(), [[100.0], [2.0], [3.0], [101.0], [102.0]]);
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(elements(&model).unwrap(), [[100.0], [0.0], [0.0], [101.0], [102.0]]);
}

#[test]
fn sparse_indices_must_rise_and_stay_inside() {
    for bad in [[1, 1], [3, 2], [2, 5]] {
        let message = elements::<1>(&sparse(&bad, 2)).unwrap_err();
        assert!(message.starts_with("accessor 0, sparse: index "), "{bad:?}: {message}");
    }
    assert!(elements::<1>(&sparse(&[0, 1], 1)).unwrap_err().contains("do not fit"));
}

#[test]
fn absurd_sizes_are_refused_before_anything_is_allocated() {
    let mut zeros = one(F32, "VEC3", 4_000_000_000, &[]);
    zeros.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(
        elements::<3>(&zeros).unwrap_err(),
        "accessor 0: it has 4000000000 elements but no bufferView; at most 4194304 can be"
    );
    for count in [2, 4_294_967_297, u64::MAX / 12, u64::MAX] {
        let message = elements::<3>(&one(F32, "VEC3", count, &[0; 12])).unwrap_err();
        assert!(message.contains("do not fit the 12 bytes"), "{count}: {message}");
    }
    let mut far = one(F32, "VEC3", 1, &[0; 12]);
    far.json["accessors"][0]["byteOffset"] = json!(u64::MAX);
    assert!(elements::<3>(&far).unwrap_err().contains("do not fit"));
    far.json["accessors"][0]["byteOffset"] = json!(0);
    far.json["bufferViews"][0]["byteStride"] = json!(u64::from(u32::MAX));
    assert!(elements::<3>(&far).is_ok(), "the last element needs no stride");
    assert_eq!(elements::<3>(&one(F32, "VEC3", 0, &[])).unwrap(), [[0.0; 3]; 0]);
}

#[test]
fn unknown_types_and_references_are_named() {
    assert!(elements::<1>(&one(5124, "SCALAR", 1, &[0; 4])).unwrap_err().contains("componentType"));
    assert!(elements::<1>(&one(F32, "MAT2", 1, &[0; 16])).unwrap_err().contains("its type is none of"));
    let mut lost = one(F32, "SCALAR", 1, &[0; 4]);
    lost.json["accessors"][0]["bufferView"] = json!(7);
    assert_eq!(elements::<1>(&lost).unwrap_err(), "accessor 0: refers to bufferView 7 of 1");
}
