//! Compressed meshes, which lumel does not read.

use super::document::label;
use super::fault::Fault;
use serde_json::{Map, Value};

const DRACO: &str = "KHR_draco_mesh_compression";

/// Extensions that compress, and how to get a file without them.
const COMPRESSIONS: [(&str, &str); 3] = [
    ("EXT_meshopt_compression", MESHOPT_REMEDY),
    ("KHR_meshopt_compression", MESHOPT_REMEDY),
    (DRACO, "export it without compression; in Blender's exporter, turn Compression off"),
];

const MESHOPT_REMEDY: &str =
    "export it without compression, or unpack it: gltfpack -noq -i IN.glb -o OUT.glb";

/// Refuses files whose meshes are only there in compressed form, required or not.
pub(super) fn check(root: &Map<String, Value>) -> Result<(), Fault> {
    for (name, remedy) in COMPRESSIONS {
        let required = list(root, "extensionsRequired").any(|required| required == name);
        let place = if name == DRACO { lone_primitive(root) } else { lone_view(root, name) };
        let place = place.or_else(|| required.then(|| "the file".to_owned()));
        if let Some(place) = place {
            let problem = format!("{place} is compressed by {name}, which lumel does not read; {remedy}");
            return Err(Fault::Unsupported(problem));
        }
    }
    Ok(())
}

/// A view of a buffer without bytes, which stands for what the extension unpacks.
fn lone_view(root: &Map<String, Value>, extension: &str) -> Option<String> {
    let is_lone = |view: &Value| {
        let compressed = view["extensions"][extension].is_object();
        let index = view["buffer"].as_u64().and_then(|index| usize::try_from(index).ok());
        let buffer = index.and_then(|index| root.get("buffers")?.get(index));
        compressed
            && buffer.is_some_and(|buffer| {
                // Buffer 0 of a GLB has no URI, but it is the placeholder only if it says so.
                let placeholder = buffer["extensions"][extension]["fallback"] == true || index != Some(0);
                buffer["uri"].is_null() && placeholder
            })
    };
    let index = list(root, "bufferViews").position(is_lone)?;
    Some(format!("bufferView {index}"))
}

/// A primitive whose accessors have no data of their own.
fn lone_primitive(root: &Map<String, Value>) -> Option<String> {
    let has_data = |accessor: &Value| {
        let accessor = accessor.as_u64().and_then(|index| usize::try_from(index).ok());
        let accessor = accessor.and_then(|index| root.get("accessors")?.get(index));
        accessor.is_none_or(|accessor| !accessor["bufferView"].is_null() || !accessor["sparse"].is_null())
    };
    for (index, mesh) in list(root, "meshes").enumerate() {
        let primitives = mesh.get("primitives").and_then(Value::as_array).into_iter().flatten();
        let is_lone = |primitive: &Value| {
            let accessors = [&primitive["attributes"]["POSITION"], &primitive["indices"]];
            primitive["extensions"][DRACO].is_object() && !accessors.into_iter().all(has_data)
        };
        if let Some(number) = primitives.into_iter().position(is_lone) {
            let mesh = label("mesh", index, mesh["name"].as_str());
            return Some(format!("{mesh}, primitive {number},"));
        }
    }
    None
}

fn list<'a>(root: &'a Map<String, Value>, key: &str) -> impl Iterator<Item = &'a Value> {
    root.get(key).and_then(Value::as_array).into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use crate::gltf::testing::Model;
    use serde_json::json;

    #[test]
    fn views_that_only_an_extension_fills_are_refused_with_a_remedy() {
        for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
            let mut model = Model::triangle();
            model.json["bufferViews"][0]["extensions"] =
                json!({ name: { "buffer": 0, "mode": "ATTRIBUTES" } });
            model.json["buffers"] = json!([{ "byteLength": model.bin.len() }, { "byteLength": 36 }]);
            assert!(model.read().is_ok(), "what is there uncompressed too can be read");
            model.json["bufferViews"][0]["buffer"] = json!(1);
            let expected =
                format!("bufferView 0 is compressed by {name}, which lumel does not read; export it");
            assert!(model.error().starts_with(&expected), "{}", model.error());
            assert!(model.error().contains("gltfpack -noq"));
            model.json["buffers"] =
                json!([{ "byteLength": 36, "extensions": { name: { "fallback": true } } }]);
            model.json["bufferViews"][0]["buffer"] = json!(0);
            assert!(model.error().starts_with(&expected), "{}", model.error());
            model.json["bufferViews"][0] = json!({ "buffer": 0, "byteLength": 36 });
            model.json["extensionsRequired"] = json!([name]);
            assert!(
                model.error().starts_with(&format!("the file is compressed by {name}")),
                "{}",
                model.error()
            );
        }
    }

    #[test]
    fn primitives_that_only_draco_fills_are_refused_with_a_remedy() {
        let mut model = Model::triangle();
        model.json["meshes"][0]["name"] = json!("Duck");
        let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
        model.primitive()["extensions"] = draco;
        assert!(model.read().is_ok(), "what is there uncompressed too can be read");
        model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        let expected = "mesh \"Duck\", primitive 0, is compressed by KHR_draco_mesh_compression, which lumel does \
                        not read; export it without compression";
        assert!(model.error().starts_with(expected), "{}", model.error());
    }
}
