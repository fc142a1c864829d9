use crate::gltf::testing::{Model, U8};
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

/// The triangle with two targets: the first lifts it, the second moves it along x; both turn its normals.
fn morphed(weights: Value, node_weights: Value) -> Model {
    let mut model = Model::triangle();
    let mut vectors = |v: [f32; 3]| model.floats("VEC3", v.repeat(3).as_slice());
    let [up, along] = [vectors([0.0, 0.0, 2.0]), vectors([8.0, 0.0, 0.0])];
    let [normal, tilt] = [vectors([0.0, 0.0, 1.0]), vectors([0.0, 1.0, -1.0])];
    model.primitive()["attributes"]["NORMAL"] = json!(normal);
    model.primitive()["targets"] = json!([{ "POSITION": up, "NORMAL": tilt }, { "POSITION": along }]);
    model.json["meshes"][0]["weights"] = weights;
    model.json["nodes"][0]["weights"] = node_weights;
    model
}

#[test]
fn weights_of_the_mesh_move_positions_and_normals() {
    let object = morphed(json!([0.5, 0.25]), json!(null)).object();
    assert_eq!(object.positions, [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::new(2.0, 0.0, 1.0)));
    assert_eq!(object.normals[0], Vec3::new(0.0, 0.5, 0.5));
}

#[test]
fn weights_of_the_node_come_first_and_none_means_none() {
    let object = morphed(json!([1, 1]), json!([0, -0.5])).object();
    assert_eq!((object.positions[0], object.normals[0]), (Vec3::X * -4.0, Vec3::Z));
    for (mesh, node) in [(json!([1, 1]), json!([0, 0])), (json!(null), json!(null))] {
        assert_eq!(morphed(mesh, node).object().positions[0], Vec3::ZERO);
    }
}

#[test]
fn texture_coordinates_and_colours_morph_too() {
    let mut model = morphed(json!([0.5, 0]), json!(null));
    let (uvs, uv_steps) = (model.floats("VEC2", &[0.25; 6]), model.floats("VEC2", &[0.5; 6]));
    let (colors, steps) = (model.accessor(U8, "VEC4", 3, &[51; 12]), model.floats("VEC3", &[0.4; 9]));
    model.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
    model.primitive()["attributes"]["COLOR_0"] = json!(colors);
    model.primitive()["targets"][0] = json!({ "TEXCOORD_0": uv_steps, "COLOR_0": steps });
    let object = model.object();
    assert_eq!(object.uvs[0], Vec2::splat(0.5));
    assert!((object.tints[0] - 0.4).length() < 1e-6, "{}", object.tints[0]);
}

#[test]
fn targets_may_be_sparse() {
    let mut model = morphed(json!([1, 0]), json!(null));
    let (at, values) = (model.view(&[2]), model.view(&[0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 0]));
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": at, "componentType": U8 },
        "values": { "bufferView": values },
    });
    let step = model
        .push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": 3, "sparse": sparse }));
    model.primitive()["targets"][0] = json!({ "POSITION": step });
    assert_eq!(model.object().positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)]);
}

#[test]
fn targets_that_do_not_fit_are_refused_by_name() {
    let error = morphed(json!([1]), json!(null)).error();
    assert_eq!(error, "mesh 0, primitive 0: it has 2 morph targets for 1 weights");
    let error = morphed(json!([1e39, 0]), json!(null)).error();
    assert!(error.contains("the weight inf"), "{error}");
    let mut model = morphed(json!([1, 0]), json!(null));
    let short = model.floats("VEC3", &[0.0; 6]);
    model.primitive()["targets"][0]["POSITION"] = json!(short);
    let place = "mesh 0, primitive 0, morph target's POSITION: ";
    assert_eq!(model.error(), format!("{place}accessor 5 has 2 elements for 3 vertices"));
    let flat = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["targets"][0]["POSITION"] = json!(flat);
    assert_eq!(model.error(), format!("{place}accessor 6 has 2 components"));
    model.primitive()["targets"][0]["POSITION"] = json!(77);
    assert_eq!(model.error(), format!("{place}refers to accessor 77 of 7"));
    model.primitive()["targets"] = json!("many");
    assert!(model.error().starts_with("mesh 0, primitive 0, targets: invalid type"), "{}", model.error());
}
