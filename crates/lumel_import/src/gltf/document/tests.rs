use super::*;
use serde_json::json;

fn parse(document: &Value) -> Result<(Document, Warnings), String> {
    let mut warnings = Warnings::default();
    let text = serde_json::to_vec(document).unwrap();
    let document = Document::parse(&text, &mut warnings).map_err(|fault| fault.to_string())?;
    Ok((document, warnings))
}

fn with(key: &str, value: Value) -> Value {
    let mut document = json!({ "asset": { "version": "2.0" } });
    document[key] = value;
    document
}

#[test]
fn versions_that_we_cannot_read_are_refused() {
    let version = |asset: Value| parse(&json!({ "asset": asset })).map(|_| ());
    assert_eq!(version(json!({ "version": "2.0" })), Ok(()));
    assert_eq!(version(json!({ "version": "2" })), Ok(()));
    assert_eq!(version(json!({ "version": "2.1", "minVersion": "2.0" })), Ok(()));
    for bad in [json!({ "version": "1.0" }), json!({ "version": "3.0" }), json!({ "version": "two" })] {
        assert!(version(bad.clone()).unwrap_err().contains("lumel reads version 2.0"), "{bad}");
    }
    assert_eq!(
        version(json!({ "version": "2.1", "minVersion": "2.1" })).unwrap_err(),
        "glTF of at least version \"2.1\"; lumel reads version 2.0"
    );
    assert_eq!(version(json!([])).unwrap_err(), "asset: it has no \"version\"");
    assert!(parse(&json!([])).unwrap_err().contains("no JSON object"));
    assert!(Document::parse(b"{\"asset\":", &mut Warnings::default()).is_err());
}

#[test]
fn wrong_types_are_fatal_in_geometry_only_and_name_their_place() {
    let error =
        parse(&with("accessors", json!([{ "componentType": "x", "count": 1, "type": "VEC3" }]))).unwrap_err();
    assert!(error.starts_with("accessor 0: invalid type"), "{error}");
    assert_eq!(parse(&with("nodes", json!({}))).unwrap_err(), "\"nodes\": it must be a list");
    let bad = json!([{ "name": "Wall", "pbrMetallicRoughness": { "metallicFactor": "shiny" } }]);
    let (document, warnings) = parse(&with("materials", bad)).unwrap();
    assert!(document.materials[0].is_none());
    let warning = warnings.iter().next().unwrap();
    assert_eq!(warning.subject, "material \"Wall\"");
    assert!(warning.message.starts_with("ignored: invalid type"), "{}", warning.message);
}

#[test]
fn names_that_are_no_text_are_dropped_and_long_ones_cut() {
    let nodes = json!([{ "name": 42 }, { "name": "ä".repeat(5000) }, { "name": "Lamp", "extras": 7 }]);
    let (document, warnings) = parse(&with("nodes", nodes)).unwrap();
    assert_eq!(document.node_label(0), "node 0");
    assert_eq!(document.node_label(1).chars().count(), "node \"\"".len() + MAX_NAME);
    assert_eq!(document.node_label(2), "node \"Lamp\"");
    assert_eq!(warnings.len(), 1);
}

#[test]
fn indices_beyond_32_bits_do_not_wrap_around() {
    let error = parse(&with("nodes", json!([{ "mesh": 4_294_967_296_u64 }]))).unwrap_err();
    assert!(error.starts_with("node 0: invalid type: floating point"), "{error}");
    let (document, _) = parse(&with("nodes", json!([{ "mesh": 3.0, "scale": [5e9, 1, 1] }]))).unwrap();
    assert_eq!(document.nodes[0].mesh.unwrap().value(), 3);
    assert_eq!(document.nodes[0].scale.unwrap()[0], 5e9);
    let views = json!([{ "buffer": 0, "byteLength": 5_000_000_000_u64 }]);
    let (document, _) = parse(&with("bufferViews", views)).unwrap();
    assert_eq!(document.views[0].byte_length.0, 5_000_000_000);
    assert!(parse(&with("bufferViews", json!([{ "buffer": 0, "byteLength": 1e300 }]))).is_err());
    assert!(parse(&with("bufferViews", json!([{ "buffer": 0, "byteLength": -1 }]))).is_err());
}

#[test]
fn the_default_scene_wins_then_the_first() {
    let roots = |scene: Option<u32>| {
        let mut document = with("scenes", json!([{ "nodes": [1] }, { "nodes": [2, 3] }, {}]));
        if let Some(scene) = scene {
            document["scene"] = scene.into();
        }
        parse(&document).map(|(document, _)| document.roots.unwrap())
    };
    assert_eq!(roots(None).unwrap(), [1]);
    assert_eq!(roots(Some(1)).unwrap(), [2, 3]);
    assert_eq!(roots(Some(2)).unwrap(), [0; 0]);
    assert_eq!(roots(Some(3)).unwrap_err(), "\"scene\": refers to scene 3 of 3");
    assert_eq!(parse(&with("scene", json!(0))).unwrap().0.roots, None);
}
