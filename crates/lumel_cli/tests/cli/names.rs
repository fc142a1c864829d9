use crate::common::{Place, run};

/// A triangle whose names would clear the screen and forge a line.
const SCENE: &str = r#"{
    "asset": { "version": "2.0" },
    "buffers": [{ "byteLength": 36, "uri":
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }],
    "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
    "materials": [{ "name": "red\u001b[2J\r\nerror: disk on fire", "pbrMetallicRoughness": { "metallicFactor": 1 } }],
    "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
    "nodes": [{ "mesh": 0, "name": "n\u001b]0;title\u0007" }],
    "extensionsUsed": ["X_\u001b[1m"]
}"#;

#[test]
fn control_characters_of_names_are_spelled_out() {
    let place = Place::new();
    place.write("scene.gltf", SCENE);
    let run = run(&mut place.lumel("info scene.gltf")).done();
    for (text, expected) in [
        (&run.stdout, r#""red\u{1b}[2J\r\nerror: disk on fire" albedo"#),
        (&run.stdout, r#""n\u{1b}]0;title\u{7}""#),
        (&run.stderr, r#"material "red\u{1b}[2J\r\nerror: disk on fire": metal"#),
        (&run.stderr, r"X_\u{1b}[1m: this extension"),
    ] {
        assert!(text.contains(expected), "no {expected} in: {text}");
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    }
    place.write("broken.gltf", &SCENE.replace(r#""mesh": 0"#, r#""mesh": 7"#));
    let run =
        crate::common::run(&mut place.lumel("info broken.gltf")).failed(r#"node "n\u{1b}]0;title\u{7}""#);
    assert!(!run.stderr.contains('\u{1b}'), "{:?}", run.stderr);
}

#[test]
fn a_misspelt_scene_is_answered_by_what_is_most_like_it() {
    let place = Place::new();
    place.write("rooms/kitchen.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let names =
        [("cornel-box", "cornell-box?"), ("atriun", "atrium?"), ("rooms/kitchn.obj", "rooms/kitchen.obj?")];
    for (misspelt, meant) in names {
        run(&mut place.lumel(&format!("info {misspelt}"))).failed(&format!("did you mean {meant}"));
    }
    run(&mut place.lumel("info zzz")).failed("built-in scenes are");
}
