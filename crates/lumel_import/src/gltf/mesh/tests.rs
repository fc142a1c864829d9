use crate::gltf::testing::{Model, U8, U16, U32, facing, text};
use glam::{Vec2, Vec3, Vec4};
use lumel_scene::Smoothing;
use serde_json::{Value, json};

/// A square of four corners in z = 0, drawn in this mode and order.
fn square(mode: u32, indices: &[u16]) -> Model {
    let mut model = Model::triangle();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let positions = model.floats("VEC3", &corners);
    let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let indices = model.accessor(U16, "SCALAR", indices.len() as u64, &bytes);
    *model.primitive() = json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode });
    model
}

fn with_attribute(mut model: Model, name: &str, kind: &str, values: &[f32]) -> Model {
    let accessor = model.floats(kind, values);
    model.primitive()["attributes"][name] = json!(accessor);
    model
}

#[test]
fn a_mirrored_node_flips_the_winding_and_keeps_normals_outside() {
    let normals = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let mut model = with_attribute(Model::triangle(), "NORMAL", "VEC3", &normals);
    for (scale, outside) in [
        ([-1, 1, 1], Vec3::Z),
        ([1, 1, -1], Vec3::NEG_Z),
        ([-1, -1, 1], Vec3::Z),
        ([-1, -1, -1], Vec3::NEG_Z),
    ] {
        model.json["nodes"][0]["scale"] = json!(scale);
        let object = model.object();
        assert_eq!(facing(&object), [outside], "{scale:?}");
        assert!(object.normals.iter().all(|n| *n == outside), "{scale:?}: {:?}", object.normals);
    }
}

#[test]
fn normals_stay_perpendicular_under_uneven_scale() {
    // The triangle x + y = 1 with its normal along (1, 1, 0), stretched along x.
    let mut model = Model::triangle();
    let positions = model.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    let normals = model.floats("VEC3", &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    model.primitive()["attributes"] = json!({ "POSITION": positions, "NORMAL": normals });
    for scale in [[4.0, 1.0, 1.0], [1.0, -3.0, 2.0], [4e-20, 1e-20, 1e-20], [4e18, 1e18, 1e18]] {
        model.json["nodes"][0]["scale"] = json!(scale);
        let object = model.object();
        let normal = object.normals[0].normalize();
        assert!(normal.dot(facing(&object)[0]) > 0.999_999, "{scale:?}: {normal}");
    }
    // Squeezed flat, the triangle has no area but the normal still has a direction.
    model.json["nodes"][0]["scale"] = json!([0, 1, 1]);
    assert_eq!(model.object().normals[0], Vec3::X);
}

#[test]
fn tangents_of_normal_maps_stand_as_their_node_does() {
    let (up, along) = ([0.0, 0.0, 1.0].repeat(3), [1.0, 0.0, 0.0, -1.0].repeat(3));
    let mut model = with_attribute(Model::triangle(), "NORMAL", "VEC3", &up);
    model = with_attribute(model, "TANGENT", "VEC4", &along);
    model = with_attribute(model, "TEXCOORD_0", "VEC2", &[0.0; 6]);
    assert!(model.object().tangents.is_empty(), "nothing asks for them");
    let texture = model.texture([128, 128, 255]);
    let material = model.push("materials", json!({ "normalTexture": { "index": texture, "scale": 0.5 } }));
    model.primitive()["material"] = json!(material);
    for (scale, expected) in [
        ([2, 1, 1], Vec4::new(2.0, 0.0, 0.0, -1.0)),
        ([-1, 1, 1], Vec4::new(-1.0, 0.0, 0.0, 1.0)),
        ([-1, -1, 1], Vec4::new(-1.0, 0.0, 0.0, -1.0)),
    ] {
        model.json["nodes"][0]["scale"] = json!(scale);
        assert_eq!(model.object().tangents, [expected; 3], "{scale:?}");
    }
    model.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    assert!(model.object().tangents.is_empty(), "flat faces have tangents of their own");
}

#[test]
fn unscaled_data_arrive_bit_for_bit() {
    let normals = [0.267_261_24, 0.534_522_5, 0.801_783_7].repeat(3);
    let object = with_attribute(Model::triangle(), "NORMAL", "VEC3", &normals).object();
    assert_eq!(object.normals[2].to_array(), normals[..3]);
    assert_eq!(object.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn indices_may_have_any_unsigned_type_or_be_absent() {
    let mut model = Model::triangle();
    let absent = model.object();
    assert_eq!(facing(&absent), [Vec3::Z]);
    for (component, size) in [(U8, 1), (U16, 2), (U32, 4)] {
        let bytes: Vec<u8> = [1_u32, 2, 0].iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
        let indices = model.accessor(component, "SCALAR", 3, &bytes);
        model.primitive()["indices"] = json!(indices);
        let object = model.object();
        assert_eq!(object.faces[0].vertices, [1, 2, 0], "{component}");
        assert_eq!(object.positions, absent.positions);
    }
    let signed = model.accessor(5120, "SCALAR", 3, &[0, 1, 2]);
    model.primitive()["indices"] = json!(signed);
    assert!(model.error().contains("accessor 4, are not unsigned integers"), "{}", model.error());
}

#[test]
fn strips_and_fans_face_the_same_way_as_triangles() {
    for (mode, indices) in [
        (4, vec![0_u16, 1, 2, 0, 2, 3]),
        (5, vec![0, 1, 3, 2]),
        (6, vec![0, 1, 2, 3]),
        (5, vec![0, 1, 3, 3, 2, 1]),
    ] {
        let object = square(mode, &indices).object();
        assert_eq!(facing(&object), [Vec3::Z; 2], "mode {mode}");
        let area: f32 = object
            .faces
            .iter()
            .map(|f| object.corners(f))
            .map(|[a, b, c]| (b - a).cross(c - a).length())
            .sum();
        assert_eq!(area, 2.0, "mode {mode}");
    }
}

#[test]
fn points_and_lines_are_no_surface() {
    for mode in 0..4 {
        let imported = square(mode, &[0, 1, 2, 3]).read().unwrap();
        assert!(imported.scene.objects.is_empty());
        assert!(text(&imported.warnings).contains("mesh 0: its points and lines"));
    }
    assert!(square(7, &[0, 1, 2]).error().contains("its mode is none of 0 to 6"));
    let imported = square(4, &[0, 1, 2, 0, 2]).read().unwrap();
    assert_eq!(imported.scene.objects[0].faces.len(), 1);
    assert!(text(&imported.warnings).contains("primitive 0: 5 corners do not make triangles"));
}

#[test]
fn indices_out_of_range_are_refused() {
    assert_eq!(square(4, &[0, 1, 4]).error(), "mesh 0, primitive 0: refers to vertex 4 of 4");
    assert!(square(5, &[0, 1, 65_535]).error().contains("vertex 65535 of 4"));
    let mut model = Model::triangle();
    model.json["nodes"][0]["mesh"] = json!(3);
    assert_eq!(model.error(), "node 0: refers to mesh 3 of 1");
    let mut model = Model::triangle();
    model.primitive()["attributes"]["POSITION"] = json!(9);
    assert_eq!(model.error(), "mesh 0, primitive 0, POSITION: refers to accessor 9 of 1");
}

#[test]
fn vertices_that_no_triangle_uses_are_left_behind() {
    let object = square(4, &[3, 0, 2]).object();
    assert_eq!(object.positions, [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(object.faces[0].vertices, [2, 0, 1]);
}

#[test]
fn quantised_meshes_get_their_size_from_the_node() {
    let mut model = Model::triangle();
    let positions = model.accessor(5120, "VEC3", 3, &[0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0]);
    model.json["bufferViews"][1]["byteStride"] = json!(4);
    let normals = model.accessor(5120, "VEC3", 3, &[0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0]);
    model.json["bufferViews"][2]["byteStride"] = json!(4);
    for accessor in [positions, normals] {
        model.json["accessors"][accessor]["normalized"] = json!(true);
    }
    let uvs = model.accessor(U16, "VEC2", 3, &[0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 3, 0]);
    model.primitive()["attributes"] = json!({ "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs });
    model.json["nodes"][0]["scale"] = json!([2, 2, 2]);
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let object = model.object();
    assert_eq!(object.positions, [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0]);
    assert_eq!(object.normals, [Vec3::Z; 3]);
    assert_eq!(object.uvs, [Vec2::ZERO, Vec2::X * 2.0, Vec2::Y * 3.0]);
}

#[test]
fn missing_normals_are_left_to_be_flat() {
    let object = Model::triangle().object();
    assert!(object.normals.is_empty() && object.uvs.is_empty() && object.tints.is_empty());
    assert_eq!(object.faces[0].smoothing, Smoothing::Flat);
}

#[test]
fn parts_with_and_without_an_attribute_share_an_object() {
    let ones = [1.0; 9];
    let mut model = with_attribute(Model::triangle(), "NORMAL", "VEC3", &ones);
    let full = model.primitive().clone();
    let bare = json!({ "attributes": { "POSITION": 0 } });
    model.json["meshes"][0]["primitives"] = json!([bare, full, bare]);
    let object = model.object();
    assert_eq!(
        object.faces.iter().map(|f| f.vertices).collect::<Vec<_>>(),
        [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    );
    let given: Vec<bool> = object.normals.iter().map(|n| *n != Vec3::ZERO).collect();
    assert_eq!(given, [false, false, false, true, true, true, false, false, false]);
    let smoothing: Vec<_> = object.faces.iter().map(|f| f.smoothing).collect();
    assert_eq!(smoothing, [Smoothing::Flat, Smoothing::Crease, Smoothing::Flat]);
}

/// A triangle with a `COLOR_0`.
fn colored(component: u32, kind: &str, normalized: bool, bytes: &[u8]) -> Model {
    let mut model = Model::triangle();
    let colors = model.accessor(component, kind, 3, bytes);
    model.json["accessors"][colors]["normalized"] = json!(normalized);
    model.primitive()["attributes"]["COLOR_0"] = json!(colors);
    model
}

#[test]
fn the_fourth_component_of_vertex_colours_is_alpha() {
    let alphas = |component, kind: &str, bytes: &[u8]| colored(component, kind, true, bytes).object().alphas;
    assert_eq!(alphas(U8, "VEC4", &[9, 9, 9, 51, 9, 9, 9, 255, 9, 9, 9, 0]), [0.2, 1.0, 0.0]);
    let floats: Vec<u8> = [0.5_f32, 0.5, 0.5, 1.5].repeat(3).iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(alphas(5126, "VEC4", &floats), [1.0; 3], "at most 1");
    assert_eq!(alphas(U8, "VEC3", &[51; 9]), [0.0; 0]);
}

#[test]
fn vertex_colours_of_every_type_are_linear_tints() {
    let tint = |component: u32, kind: &str, normalized: bool, bytes: &[u8]| {
        colored(component, kind, normalized, bytes).object().tints[0]
    };
    let floats: Vec<u8> = [0.25_f32, 0.5, 1.5, 0.1].repeat(3).iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(tint(5126, "VEC4", false, &floats), Vec3::new(0.25, 0.5, 1.0), "at most 1");
    assert_eq!(tint(U8, "VEC3", true, &[51, 255, 0].repeat(3)), Vec3::new(0.2, 1.0, 0.0));
    assert_eq!(
        tint(U8, "VEC4", false, &[51, 255, 0, 9].repeat(3)),
        Vec3::new(0.2, 1.0, 0.0),
        "without the flag"
    );
    assert_eq!(tint(U16, "VEC3", true, &[0x33, 0x33, 0xff, 0xff, 0, 0].repeat(3)), Vec3::new(0.2, 1.0, 0.0));
}

#[test]
fn attributes_need_one_element_for_each_vertex() {
    let message = with_attribute(Model::triangle(), "NORMAL", "VEC3", &[0.0; 6]).error();
    assert_eq!(message, "mesh 0, primitive 0: its NORMAL, accessor 1, has 2 elements for 3 vertices");
    let message = with_attribute(Model::triangle(), "TEXCOORD_0", "VEC3", &[0.0; 9]).error();
    assert_eq!(message, "mesh 0, primitive 0: its TEXCOORD_0, accessor 1, has 3 components");
}

fn textured(info: Value) -> Model {
    let mut model = Model::triangle();
    let texture = model.texture([255, 0, 0]);
    let mut info = info;
    info["index"] = json!(texture);
    model.push(
        "materials",
        json!({ "pbrMetallicRoughness": { "baseColorTexture": info, "metallicFactor": 0 } }),
    );
    model.primitive()["material"] = json!(0);
    let model = with_attribute(model, "TEXCOORD_0", "VEC2", &[0.0; 6]);
    with_attribute(model, "TEXCOORD_1", "VEC2", &[1.0; 6])
}

#[test]
fn coordinates_are_those_the_texture_asks_for() {
    assert_eq!(textured(json!({})).object().uvs, [Vec2::ZERO; 3]);
    assert_eq!(textured(json!({ "texCoord": 1 })).object().uvs, [Vec2::ONE; 3]);
    let over = json!({ "texCoord": 0, "extensions": { "KHR_texture_transform": { "texCoord": 1 } } });
    assert_eq!(textured(over).object().uvs, [Vec2::ONE; 3]);
    let imported = textured(json!({ "texCoord": 2 })).read().unwrap();
    assert!(imported.scene.objects[0].uvs.is_empty());
    assert_eq!(
        text(&imported.warnings),
        "mesh 0, primitive 0: it has no TEXCOORD_2, for which its material asks: zero is used\n"
    );
}

#[test]
fn the_second_set_of_coordinates_is_the_place_in_a_lightmap_of_any_type_and_whatever_materials_use_it_for() {
    let places = |component: u32, bytes: &[u8]| {
        let mut model = Model::triangle();
        let uvs = model.accessor(component, "VEC2", 3, bytes);
        model.json["bufferViews"][1]["byteStride"] = json!(4);
        model.primitive()["attributes"]["TEXCOORD_1"] = json!(uvs);
        model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        model.object().lightmap_uvs
    };
    // As fractions, with the flag or without.
    let fractions = [Vec2::ZERO, Vec2::new(1.0, 0.2), Vec2::new(0.2, 1.0)];
    assert_eq!(places(U8, &[0, 0, 0, 0, 255, 51, 0, 0, 51, 255, 0, 0]), fractions);
    assert_eq!(places(U16, &[0, 0, 0, 0, 255, 255, 51, 51, 51, 51, 255, 255]), fractions);
    for info in [json!({}), json!({ "texCoord": 1 })] {
        assert_eq!(textured(info).object().lightmap_uvs, [Vec2::ONE; 3]);
    }
    let mut model = with_attribute(Model::triangle(), "TEXCOORD_1", "VEC2", &[1.0; 6]);
    let full = model.primitive().clone();
    model.json["meshes"][0]["primitives"] = json!([full, { "attributes": { "POSITION": 0 } }]);
    let given: Vec<bool> = model.object().lightmap_uvs.iter().map(|uv| uv.is_finite()).collect();
    assert_eq!(given, [true, true, true, false, false, false]);
    let message = with_attribute(Model::triangle(), "TEXCOORD_1", "VEC2", &[0.0; 4]).error();
    assert_eq!(message, "mesh 0, primitive 0: its TEXCOORD_1, accessor 1, has 2 elements for 3 vertices");
}

#[test]
fn every_node_shows_its_own_instance() {
    let mut model = Model::triangle();
    model.json["meshes"][0]["name"] = json!("Tile");
    model.push("nodes", json!({ "mesh": 0, "name": "Second", "translation": [5, 0, 0] }));
    let objects = model.read().unwrap().scene.objects;
    let names: Vec<_> = objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["Tile", "Second"]);
    assert_eq!(objects[1].positions[0], Vec3::X * 5.0);
}

#[test]
fn extras_of_a_node_say_how_fine_its_lumels_are() {
    let mut model = Model::triangle();
    model.push("nodes", json!({ "mesh": 0, "extras": { "lumel_density_factor": 2.5, "other": [] } }));
    for wrong in [json!(0), json!("fine"), json!(1e300)] {
        model.push("nodes", json!({ "mesh": 0, "name": "Odd", "extras": { "lumel_density_factor": wrong } }));
    }
    model.push("nodes", json!({ "mesh": 0, "extras": "lumel_density_factor" }));
    let imported = model.read().unwrap();
    let factors: Vec<_> = imported.scene.objects.iter().map(|object| object.density_factor).collect();
    assert_eq!(factors, [None, Some(2.5), None, None, None, None]);
    let text = text(&imported.warnings);
    assert_eq!(imported.warnings.len(), 3);
    let line = "node \"Odd\": its lumel_density_factor is 0, which is no number above 0: it is ignored\n";
    assert!(text.starts_with(line), "{text}");
}

#[test]
fn instances_beyond_number_are_refused_before_they_take_memory() {
    let mut model = Model::triangle();
    // Each mesh makes a million triangles out of three vertices.
    model.push("accessors", json!({ "componentType": U8, "type": "SCALAR", "count": 3_000_000 }));
    *model.primitive() = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
    model.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 200]);
    assert_eq!(
        model.error(),
        "node 134: with it, the scene has more than the 134217728 triangles lumel reads"
    );
    // Nor may primitives that make none go on for ever.
    let points = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
    model.json["meshes"][0]["primitives"] = json!(vec![points; 2000]);
    model.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 2000]);
    assert!(model.error().starts_with("node 1048: with it"));
}
