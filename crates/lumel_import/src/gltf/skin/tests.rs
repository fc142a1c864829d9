use crate::gltf::testing::{Model, U8, U16, facing, text};
use glam::Vec3;
use serde_json::json;

/// The triangle on two joints at x = 10 and x = 20, of which the second is turned by a quarter about z; corners belong to
/// the first, the second, and both. The node of the mesh is far away.
fn skinned() -> Model {
    let mut model = Model::triangle();
    let joints = model.accessor(U8, "VEC4", 3, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let weights = model.floats("VEC4", weights.as_flattened());
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    model.primitive()["attributes"]["NORMAL"] = json!(normals);
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    let down = |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0];
    let bind = model.floats("MAT4", [down(-1.0), down(0.0)].as_flattened());
    model.json["nodes"] = json!([
        { "name": "Hero", "mesh": 0, "skin": 0, "translation": [500, 0, 0] },
        { "children": [2], "translation": [10, 0, 0] },
        { "translation": [10, 0, 0], "rotation": [0, 0, 1, 1] },
    ]);
    model.json["skins"] = json!([{ "name": "Bones", "joints": [1, 2], "inverseBindMatrices": bind }]);
    model
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-5
}

#[test]
fn joints_place_a_skinned_mesh_and_its_node_does_not() {
    let object = skinned().object();
    // (0, 0) - 1 + 10; (1, 0) turned to (0, 1) + 20; the mean of (0, 1) + 9 and (0, 1) turned to (-1, 0) + 20.
    let expected = [Vec3::X * 9.0, Vec3::new(20.0, 1.0, 0.0), Vec3::new(14.0, 0.5, 0.0)];
    assert!(object.positions.iter().zip(expected).all(|(&p, e)| near(p, e)), "{:?}", object.positions);
    assert!(object.normals.iter().all(|&n| near(n.normalize(), Vec3::Z)), "{:?}", object.normals);
}

#[test]
fn a_skin_without_inverse_bind_matrices_has_identities_and_joints_may_be_outside_the_scene() {
    let mut model = skinned();
    model.json["skins"][0].as_object_mut().unwrap().remove("inverseBindMatrices");
    model.json["scenes"] = json!([{ "nodes": [0] }]);
    assert!(near(model.object().positions[0], Vec3::X * 10.0));
}

#[test]
fn weights_of_all_types_and_sets_count_by_their_share() {
    let mut model = skinned();
    // Halves that sum to one half over two sets, as bytes and as shorts.
    let bytes = model.accessor(U8, "VEC4", 3, &[64, 0, 0, 0].repeat(3));
    let shorts: Vec<u8> = [64 * 257_u16, 0, 0, 0].repeat(3).iter().flat_map(|w| w.to_le_bytes()).collect();
    let shorts = model.accessor(U16, "VEC4", 3, &shorts);
    let second = model.accessor(U16, "VEC4", 3, &[1, 0, 0, 0, 0, 0, 0, 0].repeat(3));
    let first = model.accessor(U8, "VEC4", 3, &[0; 12]);
    let attributes = json!({
        "POSITION": 0, "JOINTS_0": first, "WEIGHTS_0": bytes, "JOINTS_1": second, "WEIGHTS_1": shorts,
    });
    model.primitive()["attributes"] = attributes;
    assert!(near(model.object().positions[0], Vec3::X * 14.5), "{:?}", model.object().positions);
}

#[test]
fn normals_turn_with_the_joints_and_mirrored_joints_keep_the_outside() {
    let mut model = skinned();
    model.json["nodes"][1]["rotation"] = json!([1, 0, 0, 1]);
    // A quarter turn about x takes z to -y.
    assert!(near(model.object().normals[0].normalize(), Vec3::NEG_Y), "{:?}", model.object().normals);
    let mut model = skinned();
    model.json["nodes"][1]["scale"] = json!([1, 1, -1]);
    let object = model.object();
    assert_eq!(facing(&object), [Vec3::NEG_Z]);
    assert!(near(object.normals[0].normalize(), Vec3::NEG_Z));
}

#[test]
fn vertices_without_weights_follow_their_first_joint() {
    let mut model = skinned();
    let weights = model.floats("VEC4", &[0.0; 12]);
    model.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    let imported = model.read().unwrap();
    assert!(near(imported.scene.objects[0].positions[1], Vec3::new(20.0, 1.0, 0.0)));
    assert!(text(&imported.warnings).contains("mesh 0, primitive 0: 3 vertices without weights"));
}

#[test]
fn a_primitive_without_joints_stands_at_the_node() {
    let mut model = skinned();
    model.primitive()["attributes"] = json!({ "POSITION": 0 });
    let imported = model.read().unwrap();
    assert_eq!(imported.scene.objects[0].positions[0], Vec3::X * 500.0);
    assert!(text(&imported.warnings).contains("mesh 0, primitive 0: a node shows it with a skin"));
}

#[test]
fn broken_skins_are_refused_by_name() {
    let broken = |change: &dyn Fn(&mut Model)| {
        let mut model = skinned();
        change(&mut model);
        model.error()
    };
    let skin = |key: &'static str, value: serde_json::Value| {
        broken(&move |model: &mut Model| model.json["skins"][0][key] = value.clone())
    };
    assert_eq!(
        skin("joints", json!([1])),
        "mesh 0, primitive 0: vertex 1 refers to joint 1 of 1 in skin \"Bones\""
    );
    assert_eq!(skin("joints", json!([])), "skin \"Bones\": it has no joints");
    assert_eq!(skin("joints", json!([1, 9])), "skin \"Bones\": refers to node 9 of 3");
    assert_eq!(
        skin("joints", json!([1, 2, 0])),
        "skin \"Bones\", inverseBindMatrices: accessor 4 has 2 for 3 joints"
    );
    assert!(skin("inverseBindMatrices", json!(0)).contains("has 3 components where a matrix has 16"));
    assert!(skin("inverseBindMatrices", json!(99)).contains("refers to accessor 99"));
    let node = broken(&|model| model.json["nodes"][0]["skin"] = json!(7));
    assert_eq!(node, "node \"Hero\": refers to skin 7 of 1");
    let attribute = |name: &'static str, kind: &'static str, values: &'static [f32]| {
        broken(&move |model: &mut Model| {
            let accessor = model.floats(kind, values);
            model.primitive()["attributes"][name] = json!(accessor);
        })
    };
    assert!(attribute("WEIGHTS_0", "VEC4", &[1.0; 8]).contains("has 2 elements for 3 vertices"));
    assert!(attribute("WEIGHTS_0", "VEC3", &[1.0; 9]).contains("has 3 components"));
    assert!(attribute("WEIGHTS_0", "VEC4", &[f32::NAN; 12]).contains("vertex 0 has the weight NaN"));
    assert!(attribute("JOINTS_0", "VEC4", &[0.0; 12]).contains("JOINTS_0 are not unsigned integers"));
    let lone = broken(&|model| {
        model.primitive()["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    });
    assert!(lone.contains("it has JOINTS_0 but no WEIGHTS_0"), "{lone}");
    let infinite = broken(&|model| model.bin.iter_mut().rev().take(128).for_each(|byte| *byte = 0xff));
    assert!(infinite.contains("the transform of joint 0 is not a finite number"), "{infinite}");
}
