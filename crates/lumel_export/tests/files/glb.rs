use crate::scenes::{AtVertices, colourful, light_on, plain, textured_square};
use crate::tools::run_if_installed;
use glam::{Vec2, Vec3};
use lumel_basis::{Coefficients, Directional, IncidentRadiance, VertexLighting};
use lumel_export::{ColorScale, ExportError, write_glb};
use lumel_import::{ImportOptions, load};
use lumel_scene::{
    Albedo, Encoding, Filter, Irradiance, Material, NormalMap, Radiance, Scene, Sides, SurfacePoint, Texture,
    TextureId, TextureRef, TriId, UvTransform,
};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A GLB file taken apart, with every number checked to be where its description says.
pub(crate) struct Glb {
    pub(crate) json: Value,
    binary: Vec<u8>,
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

impl Glb {
    pub(crate) fn read(path: &Path) -> Self {
        let bytes = fs::read(path).unwrap();
        assert_eq!(&bytes[..8], b"glTF\x02\0\0\0");
        assert_eq!(u32_at(&bytes, 8), bytes.len());
        let json_length = u32_at(&bytes, 12);
        assert_eq!((&bytes[16..20], json_length % 4), (b"JSON".as_slice(), 0));
        let (json, chunk) = bytes[20..].split_at(json_length);
        assert_eq!(&chunk[4..8], b"BIN\0");
        let binary = chunk[8..].to_vec();
        assert_eq!((u32_at(chunk, 0), binary.len() % 4), (binary.len(), 0));
        let glb = Self { json: serde_json::from_slice(json).unwrap(), binary };
        assert_eq!(glb.json["buffers"][0]["byteLength"], glb.binary.len());
        glb.check_views();
        glb
    }

    /// Views follow each other without overlap.
    fn check_views(&self) {
        let mut end = 0;
        for view in self.json["bufferViews"].as_array().unwrap() {
            let (offset, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
            assert!(offset >= end && offset < end + 4 && offset % 4 == 0 && length > 0);
            end = offset + length;
        }
        assert_eq!(end.next_multiple_of(4), self.binary.len());
    }

    pub(crate) fn view(&self, index: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][number(index)];
        &self.binary[number(&view["byteOffset"])..][..number(&view["byteLength"])]
    }

    /// The four-byte words of an accessor, `width` to an element.
    pub(crate) fn words(&self, index: &Value, width: usize) -> Vec<[u8; 4]> {
        let accessor = &self.json["accessors"][number(index)];
        let bytes = self.view(&accessor["bufferView"]);
        let bytes = &bytes[number(&accessor["byteOffset"])..][..4 * width * number(&accessor["count"])];
        bytes.as_chunks().0.to_vec()
    }

    pub(crate) fn floats(&self, index: &Value, width: usize, kind: &str) -> Vec<f32> {
        let accessor = &self.json["accessors"][number(index)];
        assert_eq!((number(&accessor["componentType"]), &accessor["type"]), (5126, &Value::from(kind)));
        self.words(index, width).into_iter().map(f32::from_le_bytes).collect()
    }

    pub(crate) fn vectors(&self, index: &Value) -> Vec<Vec3> {
        self.floats(index, 3, "VEC3").chunks(3).map(Vec3::from_slice).collect()
    }

    pub(crate) fn primitives(&self) -> impl Iterator<Item = &Value> {
        self.json["meshes"].as_array().unwrap().iter().flat_map(|m| m["primitives"].as_array().unwrap())
    }

    pub(crate) fn material(&self, primitive: &Value) -> &Value {
        &self.json["materials"][number(&primitive["material"])]
    }

    fn material_named(&self, name: &str) -> &Value {
        self.json["materials"].as_array().unwrap().iter().find(|m| m["name"] == name).unwrap()
    }
}

pub(crate) fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_default() as usize
}

fn written(scene: &Scene, exposure: ColorScale) -> (Glb, f32) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let exposure = write_glb(&path, scene, &AtVertices(light_on(scene)), exposure).unwrap();
    (Glb::read(&path), exposure)
}

#[test]
fn light_by_direction_is_in_attributes_of_vertices() {
    let scene = plain("box");
    let irradiance = light_on(&scene);
    for kind in [Directional::Sh1, Directional::Sh2] {
        let of = |vertex: usize, k: usize| Vec3::new(1.0, 0.5, 0.25) * (1.0 + vertex as f32 - 0.3 * k as f32);
        let n = kind.harmonics();
        let values = (0..n * scene.vertex_count()).map(|i| of(i / n, i % n)).collect();
        let coefficients = Coefficients::new(kind, values).unwrap();
        let lighting = VertexLighting::new(&scene, &irradiance).unwrap();
        let lighting = lighting.with_incident(Some(&coefficients)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        write_glb(&path, &scene, &lighting, ColorScale::Auto).unwrap();
        let glb = Glb::read(&path);
        let mut found = 0;
        for primitive in glb.primitives() {
            let attributes = &primitive["attributes"];
            let positions = glb.vectors(&attributes["POSITION"]);
            let four = |name: &str| {
                glb.words(&attributes[name], 4).into_iter().map(f32::from_le_bytes).collect::<Vec<_>>()
            };
            let [green, blue] = [four("_SH1G"), four("_SH1B")];
            let direction = glb.vectors(&attributes["_DIRECTION"]);
            for (i, position) in positions.iter().enumerate() {
                let at = |v: &usize| {
                    scene.positions()[*v] == *position && (green[4 * i] - of(*v, 0).y).abs() < 1e-6
                };
                let Some(vertex) = (0..scene.vertex_count()).find(at) else { continue };
                found += 1;
                let expected = [0, 1, 2, 3].map(|k| of(vertex, k).z);
                assert_eq!(blue[4 * i..][..4], expected);
                let light = IncidentRadiance::new(coefficients.of(vertex)).unwrap();
                assert_eq!(direction[i], light.dominant());
                if kind == Directional::Sh2 {
                    assert_eq!(four("_SH2R")[4 * i + 1], of(vertex, 5).x);
                    assert_eq!(glb.vectors(&attributes["_SH22"])[i], of(vertex, 8));
                }
            }
            assert_eq!(attributes.get("_SH2G").is_some(), kind == Directional::Sh2);
        }
        assert!(found >= scene.vertex_count());
        assert!(glb.json["asset"]["extras"]["_SH1R"].is_string());
    }
    let (glb, _) = written(&scene, ColorScale::Auto);
    assert!(glb.primitives().all(|primitive| primitive["attributes"].get("_SH1R").is_none()));
}

#[test]
fn every_number_is_where_its_description_says() {
    let scene = colourful();
    let (glb, _) = written(&scene, ColorScale::Auto);
    let mut n_triangles = 0;
    for primitive in glb.primitives() {
        let attributes = &primitive["attributes"];
        let positions = glb.vectors(&attributes["POSITION"]);
        let indices = glb.words(&primitive["indices"], 1).into_iter().map(u32::from_le_bytes);
        let indices: Vec<usize> = indices.map(|i| i as usize).collect();
        assert_eq!(indices.len() % 3, 0);
        assert!(indices.iter().all(|&index| index < positions.len()));
        assert!((0..positions.len()).all(|vertex| indices.contains(&vertex)));
        n_triangles += indices.len() / 3;
        let accessor = &glb.json["accessors"][number(&attributes["POSITION"])];
        let bounds = lumel_scene::Bounds::around(positions.iter().copied());
        assert_eq!(accessor["min"], serde_json::json!(bounds.min.to_array()));
        assert_eq!(accessor["max"], serde_json::json!(bounds.max.to_array()));
        let normals = glb.vectors(&attributes["NORMAL"]);
        assert!(normals.iter().all(|n| n.is_normalized()));
        // Triangles face the way their normals point, backs too.
        for tri in indices.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|k| positions[tri[k]]);
            assert!((b - a).cross(c - a).dot(normals[tri[0]]) > 0.0);
        }
        let colors = glb.vectors(&attributes["COLOR_0"]);
        assert!(colors.iter().all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0));
        let lengths = [normals.len(), colors.len(), glb.vectors(&attributes["_IRRADIANCE"]).len()];
        assert_eq!(lengths, [positions.len(); 3]);
        let material = glb.material(primitive);
        let slots = [&material["pbrMetallicRoughness"]["baseColorTexture"], &material["emissiveTexture"]];
        let textured = slots.iter().any(|slot| !slot.is_null());
        assert_eq!(!attributes["TEXCOORD_0"].is_null(), textured);
        if textured {
            let uvs = glb.floats(&attributes["TEXCOORD_0"], 2, "VEC2");
            let expected = positions.iter().flat_map(|p| [p.x, p.z]);
            assert!(expected.eq(uvs));
        }
    }
    assert_eq!(n_triangles, scene.triangle_count());
}

#[test]
fn irradiance_is_exact_and_what_is_seen_is_displayed_radiance() {
    let scene = colourful();
    let light = light_on(&scene);
    let (glb, exposure) = written(&scene, ColorScale::Factor(0.3));
    assert_eq!(exposure, 0.3);
    let mut n_reflecting = 0;
    for primitive in glb.primitives() {
        let material = glb.material(primitive);
        let attributes = &primitive["attributes"];
        let (positions, normals) = (glb.vectors(&attributes["POSITION"]), glb.vectors(&attributes["NORMAL"]));
        let (irradiance, colors) =
            (glb.vectors(&attributes["_IRRADIANCE"]), glb.vectors(&attributes["COLOR_0"]));
        let base = &material["pbrMetallicRoughness"]["baseColorFactor"];
        let base = Vec3::from_array([0, 1, 2].map(|k| base[k].as_f64().unwrap() as f32));
        for i in 0..positions.len() {
            let here = |v: &usize| scene.positions()[*v] == positions[i] && scene.normals()[*v] == normals[i];
            let vertex = (0..scene.vertex_count()).find(|v| here(v) && light[*v] == irradiance[i]).unwrap();
            if material["extras"]["emission"][0] == 0.0 {
                let albedo = Albedo(base * scene.tints()[vertex]);
                let radiance = Irradiance(light[vertex]).reflected(albedo).radiance().0;
                let seen = base * colors[i];
                let expected = (radiance * exposure).min(base);
                assert!((seen - expected).length() < 1e-6, "{seen} {expected}");
                n_reflecting += 1;
            }
        }
    }
    assert!(n_reflecting > 20);
}

#[test]
fn lamps_and_screens_are_bright() {
    let (glb, _) = written(&colourful(), ColorScale::Factor(0.5));
    let lamp = glb.material_named("lamp");
    assert_eq!(lamp["pbrMetallicRoughness"]["baseColorFactor"], serde_json::json!([1.0, 1.0, 1.0, 1.0]));
    let emission = lamp["extras"]["emission"].clone();
    assert_eq!(emission, serde_json::json!([15.0, 10.0, 5.0]));
    assert_eq!(lamp["emissiveFactor"][0], 1.0);
    assert_eq!(lamp["extensions"], serde_json::json!({ "KHR_materials_unlit": {} }), "unlit has no strength");
    for primitive in glb.primitives().filter(|p| glb.material(p)["name"] == "lamp") {
        let colors = glb.vectors(&primitive["attributes"]["COLOR_0"]);
        assert!(colors.iter().all(|c| *c == Vec3::ONE), "{colors:?}");
    }
    let screen = glb.material_named("screen");
    assert_eq!(screen["pbrMetallicRoughness"]["baseColorFactor"], serde_json::json!([0.0, 0.0, 0.0, 1.0]));
    assert!(screen["pbrMetallicRoughness"]["baseColorTexture"].is_null());
    // Twice the largest texel, which is 4, times the exposure.
    assert_eq!(screen["emissiveFactor"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(
        screen["extensions"],
        serde_json::json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } })
    );
    let texture = &glb.json["textures"][number(&screen["emissiveTexture"]["index"])];
    let image = &glb.json["images"][number(&texture["source"])];
    assert_eq!(image["name"], "glow");
    // Scaled by a quarter so that the brightest texel fits: 0.5 / 4 and 1 on the sRGB curve.
    let (pixels, size) = decode(glb.view(&image["bufferView"]));
    assert_eq!((size, &pixels[..6]), ((3, 1), [99, 99, 99, 255, 188, 137].as_slice()));
}

pub(crate) fn decode(png: &[u8]) -> (Vec<u8>, (u32, u32)) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    (pixels, (reader.info().width, reader.info().height))
}

#[test]
fn textures_keep_their_texels_wrapping_and_placement() {
    let (glb, _) = written(&colourful(), ColorScale::Auto);
    let texture_of = |name: &str| {
        let reference = &glb.material_named(name)["pbrMetallicRoughness"]["baseColorTexture"];
        let texture = &glb.json["textures"][number(&reference["index"])];
        let image = &glb.json["images"][number(&texture["source"])];
        let sampler = &glb.json["samplers"][number(&texture["sampler"])];
        assert_eq!(image["mimeType"], "image/png");
        (
            reference,
            decode(glb.view(&image["bufferView"])),
            number(&sampler["wrapS"]),
            number(&sampler["wrapT"]),
        )
    };
    let (reference, (pixels, size), wrap_s, wrap_t) = texture_of("tiles");
    assert_eq!((size, wrap_s, wrap_t), ((2, 2), 33648, 10497));
    assert_eq!(pixels, [255, 0, 0, 0, 255, 0, 10, 20, 30, 188, 188, 188]);
    assert!(reference["extensions"].is_null());
    let (reference, (pixels, size), wrap_s, wrap_t) = texture_of("moved");
    assert_eq!((size, wrap_s, wrap_t), ((4, 1), 10497, 33071));
    // Linear 188/255 on the sRGB curve.
    assert_eq!(&pixels[9..], [223, 223, 223]);
    let transform = &reference["extensions"]["KHR_texture_transform"];
    assert_eq!((&transform["scale"][1], &transform["offset"][0]), (&Value::from(3.0), &Value::from(0.25)));
    assert_eq!(
        glb.json["extensionsUsed"],
        serde_json::json!([
            "KHR_materials_emissive_strength",
            "KHR_materials_unlit",
            "KHR_texture_transform"
        ])
    );
}

#[test]
fn albedo_and_emission_keep_textures_of_their_own() {
    let texel = |rgb: [u8; 3]| vec![[rgb[0], rgb[1], rgb[2], 255]];
    let texture = |name, rgb| Texture::from_bytes(name, 1, 1, texel(rgb), Encoding::Srgb).unwrap();
    let mut glow = texture("glow", [0, 0, 255]);
    glow.filter = Filter::Nearest;
    let offset = UvTransform { offset: Vec2::new(0.5, 0.0), ..UvTransform::default() };
    let screen = Material {
        albedo_texture: Some(TextureRef::plain(TextureId(0))),
        emission: Radiance(Vec3::new(3.0, 6.0, 12.0)),
        emission_texture: Some(TextureRef { texture: TextureId(1), transform: offset }),
        ..Material::diffuse("screen", Vec3::splat(0.5))
    };
    let painted = Material { emission_texture: None, name: "painted".into(), ..screen.clone() };
    let scene = textured_square(vec![screen, painted], vec![texture("paint", [255, 0, 0]), glow]);
    let (glb, _) = written(&scene, ColorScale::Factor(1.0));
    let image_of = |slot: &Value| {
        let texture = &glb.json["textures"][number(&slot["index"])];
        let sampler = &glb.json["samplers"][number(&texture["sampler"])];
        (glb.json["images"][number(&texture["source"])]["name"].clone(), number(&sampler["magFilter"]))
    };
    for name in ["screen", "painted"] {
        let material = glb.material_named(name);
        let base = &material["pbrMetallicRoughness"];
        assert_eq!(image_of(&base["baseColorTexture"]), (Value::from("paint"), 9729));
        assert_eq!(base["baseColorFactor"], serde_json::json!([0.5, 0.5, 0.5, 1.0]));
        assert_eq!(material["emissiveFactor"], serde_json::json!([0.25, 0.5, 1.0]));
        let strength = &material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
        assert_eq!(strength, &Value::from(12.0));
        assert!(material["extensions"]["KHR_materials_unlit"].is_null());
    }
    let emissive = &glb.material_named("screen")["emissiveTexture"];
    assert_eq!(image_of(emissive), (Value::from("glow"), 9728));
    assert_eq!(emissive["extensions"]["KHR_texture_transform"]["offset"], serde_json::json!([0.5, 0.0]));
    assert!(glb.material_named("painted")["emissiveTexture"].is_null());
    // What is reflected is beside it, whatever is emitted.
    for primitive in glb.primitives() {
        let (light, colors) =
            ["_IRRADIANCE", "COLOR_0"].map(|name| glb.vectors(&primitive["attributes"][name])).into();
        assert!(colors.iter().zip(&light).all(|(c, e)| (c.x / c.y - e.x / e.y).abs() < 1e-5 || c.x == 1.0));
    }
}

#[test]
fn our_importer_reads_materials_back_and_takes_no_light_for_albedo() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = colourful();
    write_glb(&path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    let imported = load(&path, &ImportOptions::default()).unwrap();
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("lumel has baked these vertex colours"), "{warnings:?}");
    assert!(imported.scene.objects.iter().all(|object| object.tints.is_empty()));
    let back = imported.scene;
    for material in &back.materials {
        let ours = scene.materials().iter().find(|ours| ours.name == material.name).unwrap();
        assert!((material.albedo - ours.albedo).length() < 1e-6, "{}", ours.name);
        let pairs = [
            (material.albedo_texture, ours.albedo_texture),
            (material.emission_texture, ours.emission_texture),
        ];
        for (read, written) in pairs {
            assert_eq!(read.map(|t| t.transform), written.map(|t| t.transform), "{}", ours.name);
            let name = |textures: &[Texture], t: Option<TextureRef>| {
                t.map(|t| textures[t.texture.index()].name.clone())
            };
            assert_eq!(name(&back.textures, read), name(scene.textures(), written), "{}", ours.name);
        }
        // An image holds a texture over its largest texel, four.
        let scale = if ours.emission_texture.is_some() { 4.0 } else { 1.0 };
        assert!((material.emission.0 - ours.emission.0 * scale).length() < 1e-4, "{}", ours.name);
    }
}

#[test]
fn objects_materials_and_origin_are_named() {
    let scene = colourful();
    let (glb, exposure) = written(&scene, ColorScale::Auto);
    let names = |list: &str| -> Vec<String> {
        glb.json[list].as_array().unwrap().iter().map(|n| n["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names("nodes"), ["shared", "textured", "lamp", "screen", "tinted"]);
    assert_eq!(names("materials"), ["red \"wall\"", "black", "tiles", "moved", "lamp", "screen"]);
    let extras = &glb.json["asset"]["extras"];
    assert_eq!(extras["scene"], "bunte Räume\n");
    assert_eq!(extras["geometry_hash"], scene.hash().geometry.to_hex().as_str());
    assert_eq!(extras["exposure"].as_f64().unwrap() as f32, exposure);
    for material in glb.json["materials"].as_array().unwrap() {
        assert_eq!(material["doubleSided"], false);
        let lit = material["name"] == "screen";
        assert_eq!(material["extensions"]["KHR_materials_unlit"].is_object(), !lit);
    }
}

#[test]
fn an_untextured_scene_needs_no_texture_coordinates() {
    let (glb, _) = written(&plain("plain"), ColorScale::Auto);
    assert!(glb.json["textures"].is_null() && glb.json["images"].is_null());
    assert_eq!(glb.json["extensionsUsed"], serde_json::json!(["KHR_materials_unlit"]));
    assert_eq!(glb.json["bufferViews"].as_array().unwrap().len(), 5);
}

#[test]
fn equal_scenes_are_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.glb", "b.glb"].map(|name| folder.path().join(name));
    for path in &paths {
        let scene = colourful();
        write_glb(path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    }
    assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
}

#[test]
fn light_that_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = plain("box");
    let refused = |light: Vec3, n, exposure| {
        let error = write_glb(&path, &scene, &AtVertices(vec![light; n]), exposure).unwrap_err();
        assert!(matches!(error, ExportError::Content { .. }));
        error.to_string()
    };
    let message = refused(Vec3::ONE, 5, ColorScale::Auto);
    assert!(message.starts_with("light at 5 vertices does not belong to a scene with 4 vertices: \""));
    assert!(refused(Vec3::INFINITY, 4, ColorScale::Auto).contains("at vertex 0 is not a finite number"));
    assert!(refused(Vec3::ONE, 4, ColorScale::Factor(0.0)).contains("exposure is 0"));
    assert!(!path.exists());
}

#[test]
fn nothing_is_clipped_if_that_is_wanted() {
    let scene = colourful();
    let (glb, exposure) = written(&scene, ColorScale::Unclipped);
    let light = light_on(&scene);
    let mut brightest = 0.0_f32;
    for primitive in glb.primitives() {
        let colors = glb.vectors(&primitive["attributes"]["COLOR_0"]);
        brightest = colors.iter().fold(brightest, |most, color| most.max(color.max_element()));
    }
    assert!((brightest - 1.0).abs() < 1e-6);
    // The spot of 400 on a white surface.
    let white = Irradiance(light[1]).reflected(Albedo::splat(1.0)).radiance().0.max_element();
    assert!((exposure * white - 1.0).abs() < 1e-6, "{exposure} {white}");
    // An exposure that clips shows the same but for that.
    let (clipped, factor) = written(&scene, ColorScale::Auto);
    assert!(factor > 10.0 * exposure);
    let pairs = glb.primitives().zip(clipped.primitives());
    for (all, part) in pairs {
        let [all, part] =
            [(&glb, all), (&clipped, part)].map(|(glb, p)| glb.vectors(&p["attributes"]["COLOR_0"]));
        for (all, part) in all.iter().zip(part) {
            assert!(((*all * (factor / exposure)).min(Vec3::ONE) - part).length() < 1e-4);
        }
    }
}

/// Lets Khronos' validator look at a file, where it is installed.
pub(crate) fn validate(path: &Path) {
    let script = r#"
const { validateBytes } = require("gltf-validator");
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[1]));
validateBytes(bytes).then((report) => {
  const worst = report.issues.messages.filter((m) => m.severity <= 1);
  console.log(JSON.stringify(report.issues, null, 1));
  process.exit(worst.length);
});
"#;
    let probe = ["-e", "require.resolve('gltf-validator')"];
    if let Some(report) = run_if_installed("node", &probe, &["-e", script, path.to_str().unwrap()]) {
        println!("{report}");
    }
}

#[test]
fn the_khronos_validator_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for scene in [plain("plain"), colourful()] {
        write_glb(&path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
        validate(&path);
    }
}

#[test]
fn normal_maps_come_back_with_their_tangents() {
    let transform = UvTransform { rotation: 0.4, scale: Vec2::new(-2.0, 2.0), ..UvTransform::default() };
    let image = TextureRef { texture: TextureId(0), transform };
    let texels = vec![[200, 100, 220, 255], [60, 128, 230, 255], [128, 128, 255, 255], [128, 60, 240, 255]];
    let bumps = Texture::from_bytes("bumps", 2, 2, texels, Encoding::Linear).unwrap();
    let bumpy = |map| Material { normal_texture: Some(map), ..Material::diffuse("bumpy", Vec3::splat(0.5)) };
    let up = NormalMap { image, scale: Vec2::splat(0.75) };
    let materials = vec![Material { sides: Sides::Both, ..bumpy(up) }, bumpy(up.flipped())];
    let scene = textured_square(materials, vec![bumps]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_glb(&path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    validate(&path);
    let again = load(&path, &ImportOptions::default()).unwrap();
    assert!(again.warnings.iter().all(|warning| warning.subject == "COLOR_0"));
    let again = again.scene.build().unwrap().0;
    assert_eq!((again.triangle_count(), again.traced_count()), (scene.triangle_count(), 3));
    let mut seen = Vec::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let found = (0..again.triangle_count() as u32).map(TriId);
        let same = |other: &TriId| {
            again.triangle_positions(*other) == scene.triangle_positions(tri)
                && again.geometric_normal(*other) == scene.geometric_normal(tri)
        };
        let other = found.into_iter().find(same).unwrap();
        for (u, v) in [(0.2, 0.3), (0.7, 0.1)] {
            let [ours, theirs] = [(&scene, tri), (&again, other)].map(|(scene, tri)| {
                scene.mapped_normal(SurfacePoint { tri, bary: [u, v].into() }, Vec2::ONE).unwrap()
            });
            // Flipped bytes are off by one.
            assert!((ours - theirs).length() < 0.01, "{ours} {theirs}");
            seen.push(ours);
        }
    }
    assert!(seen.iter().any(|n| n.y < 0.0) && seen.iter().all(|n| n.y.abs() < 0.999), "{seen:?}");
}
