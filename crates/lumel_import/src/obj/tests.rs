use crate::ImportError;
use crate::testing::{load_error, load_with_warnings, try_load};
use glam::{Vec2, Vec3};
use lumel_scene::{ObjectMesh, SceneBuilder, Smoothing};
use proptest::prelude::*;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn obj(text: &str) -> SceneBuilder {
    try_load(&[("test.obj", text.as_bytes())]).unwrap().scene
}

fn warnings(text: &str) -> Vec<String> {
    load_with_warnings(&[("test.obj", text.as_bytes())]).1
}

fn error(text: &str) -> String {
    load_error(&[("test.obj", text.as_bytes())])
}

fn names(scene: &SceneBuilder) -> Vec<&str> {
    scene.objects.iter().map(|object| object.name.as_str()).collect()
}

fn corners(object: &ObjectMesh) -> Vec<[Vec3; 3]> {
    object.faces.iter().map(|face| object.corners(face)).collect()
}

#[test]
fn vertices_keep_the_order_of_the_file_whatever_the_faces_use_first() {
    let scene = obj("v 0 0 0\nv 1 0 0\nv 9 9 9\nv 1 1 0\nv 0 1 0\nf 5 4 2\nf 5 2 1\n");
    let object = &scene.objects[0];
    assert_eq!(object.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(object.faces[0].vertices, [3, 2, 1]);
    assert_eq!(object.faces[1].vertices, [3, 1, 0]);
}

#[test]
fn a_position_with_several_attributes_becomes_several_vertices_side_by_side() {
    let text = format!("{SQUARE}vt 0 0\nvt 1 0.25\nf 1/1 2/1 3/1\nf 1/2 3/1 4/2\n");
    let object = &obj(&text).objects[0];
    assert_eq!(object.positions[..2], [Vec3::ZERO; 2]);
    assert_eq!(object.uvs[..2], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.75)], "v points down");
    assert_eq!(object.positions.len(), 5);
}

#[test]
fn corners_of_every_form_may_be_mixed() {
    let text =
        format!("{SQUARE}vt 0.5 0.5\nvn 0 0 1\nf 1/1/1 2 3//1 4/1\nf 1/ 2// 3/1/\nf -4/-1/-1 -3 -2//-1\n");
    let object = &obj(&text).objects[0];
    assert_eq!(object.faces.len(), 4);
    let at = |position: Vec3| -> Vec<(Vec2, Vec3)> {
        let all = object.positions.iter().zip(object.uvs.iter().zip(&object.normals));
        all.filter(|(p, _)| **p == position).map(|(_, (uv, n))| (*uv, *n)).collect()
    };
    assert_eq!(at(Vec3::X), [(Vec2::ZERO, Vec3::ZERO)], "a missing uv is never the last one");
    assert_eq!(at(Vec3::Y), [(Vec2::splat(0.5), Vec3::ZERO)]);
    let plain = &obj(&format!("{SQUARE}f 1 2 3\n")).objects[0];
    assert!(plain.uvs.is_empty() && plain.normals.is_empty() && plain.tints.is_empty());
}

#[test]
fn negative_indices_count_back_and_positive_ones_may_run_ahead() {
    let scene = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf 1 2 5\nf -4 -3 -1\nv 0 0 2\n");
    let [a, b, c] = corners(&scene.objects[0])[..] else { panic!() };
    assert_eq!(a, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(b[2], Vec3::Z * 2.0);
    assert_eq!(c, [Vec3::ZERO, Vec3::X, Vec3::Z]);
}

#[test]
fn bad_indices_are_errors_with_file_line_and_object() {
    let cases = [
        ("o box\nf 1 2 99\n", "test.obj:6: face refers to vertex 99 of 4, object \"box\""),
        ("g left side\nf 1 2 -5\n", "test.obj:6: face refers to vertex -5 of 4, object \"left side\""),
        ("f 1 0 2\n", "test.obj:5: face refers to vertex 0; indices start at 1"),
        ("f 1/7 2 3\n", "test.obj:5: face refers to texture coordinate 7 of 0, object \"test\""),
        ("f 1 2 x\n", "test.obj:5: face refers to vertex \"x\", not a number"),
        ("f 1 2 3/1/1/1\n", "test.obj:5: face corner \"3/1/1/1\" is not of the form v/vt/vn"),
        ("f 1 2 /1\n", "test.obj:5: face corner \"/1\" is not of the form v/vt/vn"),
        ("f 1 2 4294967296\n", "test.obj:5: face refers to vertex 4294967296 of 4"),
        ("f 1 2 -9223372036854775808\n", "test.obj:5: face refers to vertex -9223372036854775808 of 4"),
        (
            "f 1 2 99999999999999999999\n",
            "test.obj:5: face refers to vertex \"99999999999999999999\", not a number",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(error(&format!("{SQUARE}{text}")), expected);
    }
    assert_eq!(error("v 1 2\n"), "test.obj:1: vertex has 2 of 3 numbers");
    assert_eq!(error("\nv 1 2 3,5\n"), "test.obj:2: \"3,5\" is not a number");
    assert_eq!(error("vn 0 1 # up\n"), "test.obj:1: normal has 2 of 3 numbers");
    assert_eq!(error("vt\n"), "test.obj:1: texture coordinate has 0 of 1 numbers");
    let long = format!("{SQUARE}f{}\n", " 1 2 3".repeat(10_000));
    assert!(error(&long).contains("face has 30000 corners, more than 16384; split it"), "{}", error(&long));
}

#[test]
fn references_to_absent_normals_are_mended() {
    let text = format!("{SQUARE}f 1//1 2//1 3//1\nf 1 3 4\n");
    assert_eq!(obj(&text).objects[0].faces.len(), 2);
    let expected = "test.obj: 1 faces refer to normals that the file lacks; they are made instead, first in line 5, \
                    object \"test\"";
    assert_eq!(warnings(&text), [expected]);
}

#[test]
fn smoothing_follows_the_statements_and_the_angle_where_there_are_none() {
    let smoothings = |text: &str| -> Vec<Smoothing> {
        obj(&format!("{SQUARE}{text}")).objects[0].faces.iter().map(|face| face.smoothing).collect()
    };
    assert_eq!(smoothings("f 1 2 3\nf 1 3 4\n"), [Smoothing::Crease; 2]);
    let text = "f 1 2 3\ns 7\nf 1 2 3\ns off\nf 1 2 3\ns on\nf 1 2 3\ns 0\nf 1 2 3\n";
    let (group, flat) = (Smoothing::Group, Smoothing::Flat);
    assert_eq!(smoothings(text), [flat, group(7), flat, group(1), flat]);
    assert_eq!(smoothings("s soft\nf 1 2 3\n"), [flat]);
    assert!(warnings(&format!("{SQUARE}s soft\nf 1 2 3\n"))[0].contains("smoothing groups taken as off"));
}

#[test]
fn objects_come_from_o_or_from_g_where_there_is_no_o() {
    let face = "f 1 2 3\n";
    let scene = obj(&format!("{SQUARE}{face}g a b\n{face}g c\n{face}g a b\n{face}g empty\n"));
    assert_eq!(names(&scene), ["test", "a b", "c"]);
    assert_eq!(scene.objects[1].faces.len(), 2, "groups of one name are one object");
    let scene = obj(&format!("{SQUARE}g x\n{face}o A\ng y\n{face}g z\n{face}o\n{face}"));
    assert_eq!(names(&scene), ["test", "A", "test"], "groups inside objects do not part them");
    let scene = obj(&format!("{SQUARE}usemtl m\no A\n{face}"));
    assert_eq!(scene.materials[scene.objects[0].faces[0].material.index()].name, "m", "o keeps the material");
}

#[test]
fn vertex_colours_tint_and_the_fourth_number_is_a_weight() {
    let scene = obj("v 0 0 0\nv 1 0 0 0.5 0 1\nv 1 1 0 1\nv 0 1 0 1 0 0 1\nf 1 2 3 4\n");
    let tints = &scene.objects[0].tints;
    assert_eq!((tints[0], tints[2]), (Vec3::ONE, Vec3::ONE));
    assert!((tints[1] - Vec3::new(0.214_041, 0.0, 1.0)).length() < 1e-5, "sRGB becomes linear: {}", tints[1]);
    assert!((tints[3] - Vec3::Z).length() < 1e-6);
    let text = "v 0 0 0 255 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert!(warnings(text)[0].contains("vertex colours above 1"), "{:?}", warnings(text));
    assert!((obj(text).objects[0].tints[0] - Vec3::X).length() < 1e-6);
}

#[test]
fn polygons_are_cut_right_and_those_without_area_are_counted() {
    let text = "v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nv 3 0 0\nv 4 0 0\nf 2 3 4 1\nf 1 3 5 6\nf 1 2\nf\nf 1 5 6 3\n";
    let scene = obj(text);
    assert_eq!(scene.objects[0].faces.len(), 2);
    assert_eq!(scene.objects[0].positions.len(), 4, "vertices of dropped faces are not kept");
    let area: f32 =
        corners(&scene.objects[0]).iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
    assert!((area - 0.5).abs() < 1e-6, "{area}");
    let expected = [
        "test.obj: 2 faces dropped: fewer than three corners, first in line 9, object \"test\"",
        "test.obj: 2 faces dropped: no area, first in line 8, object \"test\"",
    ];
    assert_eq!(warnings(text), expected);
}

#[test]
fn what_is_not_a_surface_is_skipped() {
    let text = format!("{SQUARE}l 1 2 3 4\np 1 2\nf 1 2 3\nvp 0 0\nsurf 0 1 0 1 1 2 3 4\nnonsense x y\n");
    assert_eq!(obj(&text).objects[0].faces.len(), 1);
    let expected =
        "test.obj: 1 free-form curves or surfaces skipped; export them as polygons, first in line 9";
    assert_eq!(warnings(&text), [expected]);
    for empty in ["", "# nothing\n", SQUARE, &format!("{SQUARE}l 1 2 3\np 1\n")] {
        let error = try_load(&[("test.obj", empty.as_bytes())]).unwrap_err();
        assert!(matches!(error, ImportError::Empty { .. }), "{error}");
    }
}

#[test]
fn a_lone_face_that_crosses_itself_is_named() {
    let bow_tie = |y: f32| format!("v 0 0 0\nv 1 {y} 0\nv 1 0 0\nv 0 1 0\no tie\nf 1 2 3 4\n");
    let message = load_error(&[("test.obj", bow_tie(1.0).as_bytes())]);
    assert!(
        message.starts_with("test.obj: no triangles are left: 1 faces dropped: their outline"),
        "{message}"
    );
    assert!(message.ends_with("first in line 6, object \"tie\""), "{message}");
    let expected = "test.obj: 1 faces whose outline crosses itself are covered in some way; split them, first in \
                    line 6, object \"tie\"";
    assert_eq!(warnings(&bow_tie(3.0)), [expected]);
}

#[test]
fn light_that_lumel_has_baked_is_no_albedo() {
    let mesh = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n";
    let baked = format!("# lumel 0.1.0, scene room\n# vertex colours: sRGB of radiance times 2\n\n{mesh}");
    assert!(obj(&baked).objects[0].tints.is_empty());
    let expected = "test.obj: lumel has baked its vertex colours: they are light and left out of the albedo";
    assert_eq!(warnings(&baked), [expected]);
    for other in [mesh.to_owned(), format!("# lumelish\n{mesh}"), format!("v 9 9 9\n# lumel 1\n{mesh}")] {
        assert!(!obj(&other).objects[0].tints.is_empty(), "{other}");
    }
}

#[test]
fn names_of_any_encoding_are_kept() {
    let text = [SQUARE.as_bytes(), b"o T\xfcr\nf 1 2 3\no T\xc3\xbcr\nf 1 3 4\n"].concat();
    let scene = try_load(&[("test.obj", &text)]).unwrap().scene;
    assert_eq!(names(&scene), ["Tür"]);
}

#[test]
fn broken_positions_are_left_for_build_to_drop() {
    let scene = obj(&format!("{SQUARE}v nan 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 3 5\n"));
    assert_eq!(scene.objects[0].faces.len(), 4);
    let (scene, warnings) = scene.build().unwrap();
    assert_eq!(scene.triangle_count(), 2);
    assert!(warnings.iter().any(|w| w.message.contains("not finite")), "{warnings:?}");
}

/// Pieces that make files interesting when thrown together.
fn statement() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        (-9i32..99).prop_map(|i| i.to_string()),
        Just("1e39".to_owned()),
        Just("nan".to_owned()),
        Just(".5".to_owned())
    ];
    let corner = prop_oneof![
        8 => (1i32..6).prop_map(|i| i.to_string()),
        1 => (-9i32..9).prop_map(|i| format!("{i}/{i}/{i}")),
        1 => Just("1//".to_owned()),
        1 => Just("/".to_owned()),
    ];
    let join = |words: Vec<String>| words.join(" ");
    prop_oneof![
        4 => prop::collection::vec(number, 0..8).prop_map(move |w| format!("v {}", join(w))),
        4 => prop::collection::vec(corner, 0..9).prop_map(move |w| format!("f {}", join(w))),
        1 => prop::sample::select(vec!["o a", "g b c", "s 1", "s off", "usemtl m", "vt 0", "vn 0 0 1", "\\", "#"])
            .prop_map(str::to_owned),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_mixture_of_statements_panics(
        statements in prop::collection::vec(statement(), 0..20),
        cut in 0.0..1.0f64,
        noise in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let mut bytes = format!("{SQUARE}v 5 5 5\n{}", statements.join("\n")).into_bytes();
        for (index, byte) in noise {
            let index = index.index(bytes.len());
            bytes[index] = byte;
        }
        bytes.truncate((bytes.len() as f64 * (0.3 + cut)) as usize);
        if let Ok(imported) = try_load(&[("test.obj", &bytes)]) {
            let _ = imported.scene.build();
        }
    }
}
