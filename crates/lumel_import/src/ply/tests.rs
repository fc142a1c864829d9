use crate::testing::{load_error, load_with_warnings, png, try_load};
use crate::{ImportError, Imported};
use glam::{Vec2, Vec3};
use lumel_scene::{AlphaMode, ObjectMesh};
use proptest::prelude::*;

const HEADER: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                      element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const VERTICES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn ascii(body: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\ncomment by hand\n{body}").into_bytes()
}

fn square(face: &str) -> Vec<u8> {
    ascii(&format!("{HEADER}0 0 0\n1 0 0\n1 1 0\n0 1 0\n{face}\n"))
}

fn binary(format: &str, float: fn(f32) -> [u8; 4], int: fn(i32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
    bytes.extend(VERTICES.as_flattened().iter().flat_map(|&v| float(v)));
    bytes.push(4);
    bytes.extend([0, 1, 2, 3].into_iter().flat_map(int));
    bytes
}

fn ply(bytes: &[u8]) -> Imported {
    try_load(&[("test.ply", bytes)]).unwrap()
}

fn mesh(bytes: &[u8]) -> ObjectMesh {
    ply(bytes).scene.objects[0].clone()
}

fn error(bytes: &[u8]) -> String {
    load_error(&[("test.ply", bytes)])
}

#[test]
fn all_three_encodings_give_the_same_mesh() {
    let text = mesh(&square("4 0 1 2 3"));
    assert_eq!(text.positions, VERTICES.map(Vec3::from_array));
    assert_eq!(text.faces.iter().map(|f| f.vertices).collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(text.name, "test");
    assert!(text.normals.is_empty() && text.uvs.is_empty() && text.tints.is_empty());
    // What is written in digits is not rounded.
    let rounded = ObjectMesh { rounding: f64::from(f32::EPSILON) / 2.0, ..text };
    assert_eq!(mesh(&binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)), rounded);
    assert_eq!(mesh(&binary("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes)), rounded);
}

#[test]
fn text_may_spell_numbers_and_break_lines_as_it_likes() {
    let body = "0. -0 +0 1\n0 .0\n\n1e0 1. 0.e1 nan\n1 0\n4 0 1\n2 3";
    let positions = mesh(&ascii(&format!("{HEADER}{body}"))).positions;
    assert_eq!(positions[..3], VERTICES.map(Vec3::from_array)[..3]);
    assert!(positions[3].x.is_nan(), "left for build() to drop");
}

#[test]
fn attributes_of_every_name_and_type_are_read() {
    let header = "element vertex 3\nproperty double x\nproperty double y\nproperty int z\nproperty float quality\n\
                  property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n\
                  property uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float S\n\
                  property float T\nelement face 1\nproperty uchar flags\n\
                  property list ushort uint vertex_index\nproperty list uchar float texcoord\n\
                  element edge 1\nproperty int vertex1\nend_header\n";
    let body = "0 0 0 9 0 0 1 255 188 0 255 0.25 0.25\n1 0 0 9 0 0 1 0 0 0 0 1 0\n0 1 0 9 0 0 1 0 0 0 0 0 1\n\
                7 3 0 1 2 2 0.5 0.5\n3\n";
    for names in [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]] {
        let header = header.replace("float S", &format!("float {}", names[0]));
        let header = header.replace("float T", &format!("float {}", names[1]));
        let mesh = mesh(&ascii(&format!("{header}{body}")));
        assert_eq!(mesh.normals, [Vec3::Z; 3]);
        assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.75), "v points down");
        assert!((mesh.tints[0] - Vec3::new(1.0, 0.502_886, 0.0)).length() < 1e-4, "{}", mesh.tints[0]);
        assert_eq!(mesh.faces[0].vertices, [0, 1, 2]);
    }
    let floats = header.replace("property uchar red", "property float red");
    let floats = floats.replace("property uchar green", "property float green");
    let floats = floats.replace("property uchar blue", "property float blue");
    let mesh = mesh(&ascii(&format!("{floats}{}", body.replace("255 188 0", "0.25 0.5 0"))));
    assert_eq!(mesh.tints[0], Vec3::new(0.25, 0.5, 0.0), "floats are linear");
}

#[test]
fn strips_alternate_and_restart() {
    let header = HEADER.replace("element face 1", "element tristrips 1").replace("uchar int", "int int");
    let mesh = mesh(&ascii(&format!("{header}0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 3 2\n")));
    let up = mesh.faces.iter().all(|face| {
        let [a, b, c] = mesh.corners(face);
        (b - a).cross(c - a).z > 0.0
    });
    assert_eq!(mesh.faces.len(), 3);
    assert!(up, "every triangle faces the same way");
}

#[test]
fn bad_indices_and_missing_properties_are_named() {
    assert_eq!(error(&square("3 0 1 4")), "test.ply: face 0 refers to vertex 4 of 4, counted from 0");
    assert_eq!(error(&square("3 0 1 -1")), "test.ply: face 0 refers to vertex -1 of 4, counted from 0");
    let text = String::from_utf8(square("3 0 1 2")).unwrap();
    let message = error(text.replace("vertex_indices", "corners").as_bytes());
    assert_eq!(message, "test.ply: element \"face\" has no property vertex_indices or vertex_index");
    let message = error(text.replace("float z", "float height").as_bytes());
    assert_eq!(message, "test.ply: the vertices have no x, y and z");
    let message = error(text.replace("1 1 0", "1 1 zero").as_bytes());
    assert_eq!(message, "test.ply:13: vertex 2, property z: \"zero\" is not a number of the declared type");
    let message = error(text.replace("uchar int", "uchar float").as_bytes());
    assert_eq!(message, "test.ply:15: face 0: property vertex_indices has the wrong type");
    let message = error(text.replace("3 0 1 2", "3 0 1").as_bytes());
    assert_eq!(message, "test.ply:15: face 0, property vertex_indices: the file ends too early");
}

#[test]
fn headers_that_promise_too_much_are_refused_at_once() {
    for (what, count) in [("vertex 4", "vertex 4000000000"), ("face 1", "face 18446744073709551615")] {
        for mut bytes in
            [square("3 0 1 2"), binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)]
        {
            let start = bytes.windows(what.len()).position(|w| w == what.as_bytes()).unwrap();
            bytes.splice(start..start + what.len(), count.bytes());
            let message = error(&bytes);
            assert!(message.contains("do not fit the file"), "{message}");
        }
    }
    let header = HEADER.replace("uchar int", "uint int");
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\n{header}").into_bytes();
    bytes.extend(VERTICES.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend([0xff; 16]);
    let message = error(&bytes);
    let expected = "test.ply: Unexpected end of file while reading binary element 'face' (expected 1, got 0)";
    assert_eq!(message, expected, "a list of four billion");
    let message = error(&ascii("element nothing 99999999\nend_header\n"));
    assert!(message.contains("do not fit"), "{message}");
}

#[test]
fn faces_that_are_none_are_dropped_and_counted() {
    let text = String::from_utf8(square("3 0 1 2")).unwrap().replace("face 1", "face 4");
    let bytes = format!("{text}2 0 1\n4 0 0 1 1\n4 0 1 2 3\n").into_bytes();
    let (imported, warnings) = load_with_warnings(&[("test.ply", &bytes)]);
    assert_eq!(imported.scene.objects[0].faces.len(), 3);
    let expected = [
        "test.ply: 1 faces dropped: fewer than three corners, first in face 1",
        "test.ply: 1 faces dropped: no area, first in face 2",
    ];
    assert_eq!(warnings, expected);
}

#[test]
fn files_without_surfaces_are_empty() {
    let points =
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n";
    for bytes in [ascii(points), ascii("end_header\n")] {
        let error = try_load(&[("test.ply", &bytes)]).unwrap_err();
        assert!(matches!(error, ImportError::Empty { .. }), "{error}");
    }
    for bytes in [b"".as_slice(), b"ply\n", b"not a ply", b"ply\nformat ascii 2.0\nend_header\n"] {
        assert!(error(bytes).starts_with("test.ply"), "{bytes:?}");
    }
}

/// The square with one red face of these types, and another comment.
fn red_face(kind: &str, red: &str, comment: &str) -> Vec<u8> {
    let channels: String = ["red", "green", "blue"].map(|c| format!("property {kind} {c}\n")).concat();
    let text = String::from_utf8(square(&format!("4 0 1 2 3 {red} 0 0"))).unwrap();
    text.replace("end_header", &format!("{channels}comment {comment}\nend_header")).into_bytes()
}

#[test]
fn colours_of_faces_are_their_albedo() {
    for (kind, red) in
        [("uchar", "255"), ("ushort", "65535"), ("int", "255"), ("float", "1"), ("double", "1.0")]
    {
        let (imported, warnings) = load_with_warnings(&[("test.ply", &red_face(kind, red, ""))]);
        assert_eq!(imported.scene.materials.len(), 1);
        assert_eq!(imported.scene.materials[0].albedo, Vec3::X, "{kind}");
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    let text = String::from_utf8(red_face("uchar", "255", "")).unwrap().replace("face 1", "face 3");
    let scene = ply(format!("{text}3 0 1 2 0 188 0\n3 0 2 3 255 0 0\n").as_bytes()).scene;
    assert_eq!(scene.objects[0].faces.iter().map(|f| f.material.0).collect::<Vec<_>>(), [0, 0, 1, 0]);
    assert!((scene.materials[1].albedo.y - 0.502_886).abs() < 1e-4, "sRGB");
}

#[test]
fn colours_of_vertices_are_the_albedo_whatever_their_type() {
    let colored = |kind: &str, color: &str| {
        let channels: String = ["red", "green", "blue"].map(|c| format!("property {kind} {c}\n")).concat();
        let header = HEADER.replace("element face", &format!("{channels}element face"));
        let rows: String = VERTICES.map(|[x, y, z]| format!("{x} {y} {z} {color}\n")).concat();
        let (imported, warnings) =
            load_with_warnings(&[("test.ply", &ascii(&format!("{header}{rows}4 0 1 2 3\n")))]);
        let scene = imported.scene;
        (scene.materials[0].albedo * scene.objects[0].tints[0], warnings)
    };
    let half = Vec3::new(1.0, 0.502_886, 0.0);
    for (kind, color) in
        [("uchar", "255 188 0"), ("int", "255 188 0"), ("uint", "255 188 0"), ("short", "255 188 0")]
    {
        let (albedo, warnings) = colored(kind, color);
        assert!((albedo - half).length() < 1e-4 && warnings.is_empty(), "{kind}: {albedo}");
    }
    assert_eq!(colored("float", "1 0.5 0").0, Vec3::new(1.0, 0.5, 0.0));
    let (albedo, warnings) = colored("float", "255 188 0");
    assert!((albedo - half).length() < 1e-4, "{albedo}");
    assert_eq!(warnings, ["test.ply: colours of vertices reach 255: they are taken as sRGB from 0 to 255"]);
    let (albedo, warnings) = colored("float", "1.5 0.5 0");
    assert_eq!(albedo, Vec3::new(1.0, 0.5, 0.0));
    assert_eq!(warnings, ["test.ply: colours of vertices reach 1.5: they are clamped to 1"]);
}

/// The square with these alphas of its vertices: what is read, and warnings.
fn with_alpha(kind: &str, alphas: [&str; 4]) -> (Vec<f32>, AlphaMode, Vec<String>) {
    let header = HEADER.replace("element face", &format!("property {kind} alpha\nelement face"));
    let row = |([x, y, z], alpha): ([f32; 3], &str)| format!("{x} {y} {z} {alpha}\n");
    let rows: String = VERTICES.into_iter().zip(alphas).map(row).collect();
    let (imported, warnings) =
        load_with_warnings(&[("test.ply", &ascii(&format!("{header}{rows}4 0 1 2 3\n")))]);
    let scene = imported.scene;
    (scene.objects[0].alphas.clone(), scene.materials[0].transparency.mode, warnings)
}

#[test]
fn alpha_of_vertices_is_that_of_the_surface_whatever_its_type() {
    let expected = vec![0.0, 0.2, 0.4, 1.0];
    for (kind, alphas) in [
        ("uchar", ["0", "51", "102", "255"]),
        ("ushort", ["0", "13107", "26214", "65535"]),
        ("float", ["0", "0.2", "0.4", "1"]),
        ("double", ["0", "51", "102", "255"]),
    ] {
        assert_eq!(with_alpha(kind, alphas), (expected.clone(), AlphaMode::Blend, vec![]), "{kind}");
    }
    assert_eq!(with_alpha("uchar", ["255"; 4]), (vec![], AlphaMode::Opaque, vec![]));
    let message = "test.ply: alpha is 0 at all vertices: it is left out, and the surface is opaque";
    assert_eq!(with_alpha("uchar", ["0"; 4]), (vec![], AlphaMode::Opaque, vec![message.to_owned()]));
}

#[test]
fn faces_of_very_many_colours_share_materials() {
    let n = 66_000;
    let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "property list uchar uchar vertex_indices\nproperty uchar red\nproperty uchar green\n\
                property uchar blue\nend_header\n";
    let text = format!("ply\nformat binary_little_endian 1.0\n{header}element face {n}\n{face}");
    let mut bytes = text.into_bytes();
    bytes.extend(VERTICES[..3].as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend((0..n as u32).flat_map(|i| [3, 0, 1, 2, i as u8, (i >> 8) as u8, (i >> 16) as u8]));
    let (imported, warnings) = load_with_warnings(&[("test.ply", &bytes)]);
    assert!(imported.scene.materials.len() <= 32 * 32 * 32);
    assert_eq!(imported.scene.objects[0].faces.len(), n);
    assert_eq!(warnings, ["test.ply: its faces have more than 65536 colours: they are rounded to 32 steps"]);
}

#[test]
fn textures_that_comments_name_are_used_or_named() {
    let header = HEADER.replace("element face", "property float s\nproperty float t\nelement face");
    let rows: String = VERTICES.map(|[x, y, z]| format!("{x} {y} {z} {x} {y}\n")).concat();
    let body = format!("comment TextureFile wood.png\n{header}{rows}4 0 1 2 3\n");
    let picture = png([255, 0, 0, 255]);
    let (imported, warnings) = load_with_warnings(&[("test.ply", &ascii(&body)), ("wood.png", &picture)]);
    let material = &imported.scene.materials[0];
    assert_eq!((material.albedo, material.albedo_texture.is_some()), (Vec3::ONE, true));
    assert_eq!((imported.scene.textures.len(), warnings.len()), (1, 0));
    let (imported, warnings) = load_with_warnings(&[("test.ply", &ascii(&body))]);
    assert_eq!(imported.scene.materials[0].albedo, Vec3::splat(0.5));
    assert!(warnings[0].starts_with("test.ply: texture wood.png left out: "), "{warnings:?}");
    let bare = String::from_utf8(square("4 0 1 2 3")).unwrap().replace("by hand", "TextureFile wood.png");
    let (_, warnings) = load_with_warnings(&[("test.ply", bare.as_bytes()), ("wood.png", &picture)]);
    assert!(
        warnings[0].contains("texture wood.png left out: the vertices have no coordinates"),
        "{warnings:?}"
    );
}

#[test]
fn light_that_lumel_has_baked_is_no_albedo() {
    let channels = "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face";
    let rows: String = VERTICES.map(|[x, y, z]| format!("{x} {y} {z} 9 9 9\n")).concat();
    let body = format!("{}{rows}4 0 1 2 3\n", HEADER.replace("element face", channels));
    let baked = ascii(&format!("comment lumel 0.1.0, scene room\n{body}"));
    let (imported, warnings) = load_with_warnings(&[("test.ply", &baked)]);
    assert!(imported.scene.objects[0].tints.is_empty());
    assert_eq!(imported.scene.materials[0].albedo, Vec3::splat(0.5));
    let expected = "test.ply: lumel has baked its vertex colours: they are light and left out of the albedo";
    assert_eq!(warnings, [expected]);
    assert_eq!(mesh(&ascii(&body)).tints.len(), 4);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_damage_panics(
        noise in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
        whole in any::<bool>(),
        kind in 0..3,
    ) {
        let mut bytes = match kind {
            0 => square("4 0 1 2 3"),
            1 => binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes),
            _ => binary("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes),
        };
        for (index, byte) in noise {
            let index = index.index(bytes.len());
            bytes[index] = byte;
        }
        if !whole {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(imported) = try_load(&[("test.ply", &bytes)]) {
            let _ = imported.scene.build();
        }
    }
}
