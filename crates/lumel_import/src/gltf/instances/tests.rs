use crate::gltf::testing::{Model, U8, facing, text};
use glam::Vec3;
use serde_json::{Value, json};

/// The triangle at a node moved by 100 along x, with these attributes of its instances.
fn instanced(model: &mut Model, attributes: Value) {
    model.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    model.json["nodes"][0] = json!({
        "name": "Tile", "mesh": 0, "translation": [100, 0, 0],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
    });
}

#[test]
fn instances_are_scaled_turned_and_moved_at_their_node() {
    let mut model = Model::triangle();
    let translation = model.floats("VEC3", &[0.0, 0.0, 5.0, 0.0, 7.0, 0.0]);
    // No turn, and a quarter turn about z as signed bytes.
    let rotation = model.accessor(5120, "VEC4", 2, &[0, 0, 0, 127, 0, 0, 90, 90]);
    model.json["accessors"][rotation]["normalized"] = json!(true);
    let scale = model.floats("VEC3", &[2.0, 1.0, 1.0, 3.0, 3.0, -1.0]);
    instanced(&mut model, json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale }));
    let objects = model.read().unwrap().scene.objects;
    let names: Vec<_> = objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["Tile #1", "Tile #2"]);
    assert_eq!(objects[0].positions[1], Vec3::new(102.0, 0.0, 5.0));
    assert!((objects[1].positions[1] - Vec3::new(100.0, 10.0, 0.0)).length() < 1e-4);
    assert_eq!((facing(&objects[0]), facing(&objects[1])), (vec![Vec3::Z], vec![Vec3::NEG_Z]));
}

#[test]
fn normalised_translations_and_instances_below_other_nodes_are_read() {
    let mut model = Model::triangle();
    let translation = model.accessor(U8, "VEC3", 1, &[255, 0, 51]);
    model.json["accessors"][translation]["normalized"] = json!(true);
    instanced(&mut model, json!({ "TRANSLATION": translation }));
    model.push("nodes", json!({ "children": [0], "scale": [10, 10, 10] }));
    let object = model.object();
    assert_eq!(object.name, "Tile");
    assert_eq!(object.positions[0], Vec3::new(1010.0, 0.0, 2.0));
}

#[test]
fn attributes_of_applications_only_count_the_instances() {
    let mut model = Model::triangle();
    let id = model.floats("SCALAR", &[1.0, 2.0, 3.0]);
    instanced(&mut model, json!({ "_ID": id }));
    assert_eq!(model.read().unwrap().scene.objects.len(), 3);
    let none = model.accessor(U8, "SCALAR", 0, &[]);
    instanced(&mut model, json!({ "_ID": none }));
    assert!(model.read().unwrap().scene.objects.is_empty());
}

#[test]
fn a_skinned_mesh_is_shown_once() {
    let mut model = Model::triangle();
    let translation = model.floats("VEC3", &[0.0; 6]);
    instanced(&mut model, json!({ "TRANSLATION": translation }));
    model.json["skins"] = json!([{ "joints": [0] }]);
    model.json["nodes"][0]["skin"] = json!(0);
    let imported = model.read().unwrap();
    assert_eq!(imported.scene.objects.len(), 1);
    assert!(text(&imported.warnings).contains("node \"Tile\": its mesh is skinned"));
}

#[test]
fn broken_instances_are_refused_by_name() {
    let mut model = Model::triangle();
    let (two, three) = (model.floats("VEC3", &[1.0; 6]), model.floats("VEC3", &[1.0; 9]));
    let zeros = model.floats("VEC4", &[0.0; 8]);
    let infinite = model.floats("VEC3", &[1.0, 1.0, 1.0, f32::INFINITY, 0.0, 0.0]);
    let mut error = |attributes: Value| {
        instanced(&mut model, attributes);
        model.error()
    };
    let place = "node \"Tile\", EXT_mesh_gpu_instancing";
    assert_eq!(error(json!({})), format!("{place}: it has no \"attributes\""));
    assert_eq!(
        error(json!({ "SCALE": two, "TRANSLATION": three })),
        format!("{place}, TRANSLATION: accessor {three} has 3 elements where others have 2")
    );
    assert_eq!(
        error(json!({ "ROTATION": two })),
        format!("{place}, ROTATION: accessor {two} has 3 components, not 4")
    );
    assert_eq!(error(json!({ "ROTATION": zeros })), format!("{place}: instance 0 has a rotation of zero"));
    assert_eq!(
        error(json!({ "TRANSLATION": infinite })),
        format!("{place}: instance 1 is not a finite transform")
    );
    assert!(error(json!({ "TRANSLATION": 99 })).contains("refers to accessor 99"));
    assert!(error(json!({ "TRANSLATION": "0" })).contains("it is not the index of an accessor"));
}

#[test]
fn absurd_numbers_of_instances_are_refused_before_they_take_memory() {
    let mut model = Model::triangle();
    model.push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": 4_000_000 }));
    instanced(&mut model, json!({ "TRANSLATION": 1 }));
    let expected = "node \"Tile\": with it, the scene has more than the 134217728 triangles lumel reads";
    assert_eq!(model.error(), expected);
    model.json["accessors"][1]["count"] = json!(u64::MAX);
    assert!(model.error().contains("no bufferView; at most"), "{}", model.error());
}
