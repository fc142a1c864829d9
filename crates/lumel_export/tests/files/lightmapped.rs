use crate::glb::{Glb, decode, number, validate};
use crate::lightmap::lightmap_of;
use crate::scenes::{colourful, plain};
use crate::transparent::cards;
use glam::{Vec2, Vec3};
use lumel_export::{ExportError, LightmapTarget, write_lightmap_glb};
use lumel_import::{ImportOptions, load};
use lumel_lightmap::Lightmap;
use lumel_scene::{Barycentrics, Irradiance, Scene, SurfacePoint, TriId};
use lumel_uv::{Coverage, Piece};
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

const BOTH: [LightmapTarget; 2] = [LightmapTarget::Three, LightmapTarget::Any];

fn written(scene: &Scene, lightmap: &Lightmap, target: LightmapTarget) -> Glb {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_lightmap_glb(&path, scene, lightmap, target).unwrap();
    Glb::read(&path)
}

/// A page as a reader sees it.
struct Shown {
    size: [usize; 2],
    pixels: Vec<u8>,
    scale: f32,
    /// Textures of emission are on the sRGB curve.
    is_srgb: bool,
}

impl Shown {
    fn of(glb: &Glb, material: &Value) -> Self {
        let is_srgb = material["emissiveTexture"]["texCoord"] == 1;
        let (reference, scale) = if is_srgb {
            let strength = &material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
            assert_eq!(material["emissiveFactor"], serde_json::json!([1.0, 1.0, 1.0]));
            assert_eq!(material["pbrMetallicRoughness"]["baseColorFactor"][0], 0.0);
            assert_eq!(material["extensions"]["KHR_materials_specular"]["specularFactor"], 0.0);
            (&material["emissiveTexture"], strength)
        } else {
            let lightmap = &material["extensions"]["MOZ_lightmap"];
            assert_eq!(lightmap["texCoord"], 1);
            (lightmap, &lightmap["intensity"])
        };
        let texture = &glb.json["textures"][number(&reference["index"])];
        let sampler = &glb.json["samplers"][number(&texture["sampler"])];
        assert_eq!((number(&sampler["minFilter"]), number(&sampler["wrapS"])), (9729, 33071), "no mip maps");
        let image = &glb.json["images"][number(&texture["source"])];
        let (pixels, (width, height)) = decode(glb.view(&image["bufferView"]));
        let (size, scale) = ([width as usize, height as usize], scale.as_f64().unwrap() as f32);
        Self { size, pixels, scale, is_srgb }
    }

    fn texel(&self, x: usize, y: usize) -> Vec3 {
        let at = 3 * (y * self.size[0] + x);
        let code = |k: usize| f32::from(self.pixels[at + k]) / 255.0;
        let light = |code: f32| if self.is_srgb { linear(code) } else { code };
        Vec3::from([0, 1, 2].map(|k| light(code(k)))) * self.scale
    }

    /// Bilinear, as glTF defines it.
    fn sample(&self, uv: Vec2) -> Vec3 {
        let at = uv * Vec2::new(self.size[0] as f32, self.size[1] as f32) - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        let texel = |dx: f32, dy: f32| {
            let clamp = |at: f32, size: usize| (at as i64).clamp(0, size as i64 - 1) as usize;
            self.texel(clamp(low.x + dx, self.size[0]), clamp(low.y + dy, self.size[1]))
        };
        let rows = [0.0, 1.0].map(|dy| texel(0.0, dy).lerp(texel(1.0, dy), part.x));
        rows[0].lerp(rows[1], part.y)
    }
}

/// The linear value of a place on the sRGB curve (IEC 61966-2-1).
fn linear(code: f32) -> f32 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// Every vertex of the file: the image that its material shows, its place there, and the corner of the scene.
fn each_vertex(
    scene: &Scene,
    lightmap: &Lightmap,
    glb: &Glb,
    mut look: impl FnMut(&Shown, Vec2, SurfacePoint),
) {
    let key = |position: Vec3, place: Vec2| {
        (position.to_array().map(f32::to_bits), place.to_array().map(f32::to_bits))
    };
    let mut corners = HashMap::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let places = lightmap.atlas.texture_coordinates(tri);
        for (k, bary) in Barycentrics::CORNERS.into_iter().enumerate() {
            corners.insert(key(scene.triangle_positions(tri)[k], places[k]), SurfacePoint { tri, bary });
        }
    }
    let mut n = 0;
    for primitive in glb.primitives() {
        let shown = Shown::of(glb, glb.material(primitive));
        let attributes = &primitive["attributes"];
        let positions = glb.vectors(&attributes["POSITION"]);
        let places = glb.floats(&attributes["TEXCOORD_1"], 2, "VEC2");
        assert_eq!(glb.floats(&attributes["TEXCOORD_0"], 2, "VEC2").len(), places.len());
        for (position, place) in positions.into_iter().zip(places.as_chunks().0) {
            let place = Vec2::from(*place);
            look(&shown, place, corners[&key(position, place)]);
            n += 1;
        }
    }
    assert!(n >= corners.len() / 2);
}

#[test]
fn three_js_reads_the_irradiance_of_every_vertex() {
    let scene = colourful();
    let lightmap = lightmap_of(&scene);
    assert!(lightmap.atlas.pages().len() > 1);
    let glb = written(&scene, &lightmap, LightmapTarget::Three);
    each_vertex(&scene, &lightmap, &glb, |shown, place, at| {
        let (read, is) = (shown.sample(place), lightmap.at(0, at).0);
        assert!((read - is).abs().max_element() < shown.scale / 255.0, "{read} {is} of {}", shown.scale);
    });
    let lamp = glb.json["materials"].as_array().unwrap().iter().find(|material| material["name"] == "lamp");
    assert!(lamp.unwrap()["emissiveFactor"][0].as_f64().unwrap() > 0.9, "emission stays");
    let strength = &lamp.unwrap()["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
    assert_eq!(strength.as_f64(), Some(15.0));
    assert!(glb.json["extensionsUsed"].as_array().unwrap().contains(&"MOZ_lightmap".into()));
}

#[test]
fn images_of_irradiance_have_the_same_light_in_32_bits_beside_them() {
    let scene = colourful();
    let lightmap = lightmap_of(&scene);
    let glb = written(&scene, &lightmap, LightmapTarget::Three);
    let mut pages = BTreeSet::new();
    for primitive in glb.primitives() {
        let material = glb.material(primitive);
        let shown = Shown::of(&glb, material);
        let source =
            &glb.json["textures"][number(&material["extensions"]["MOZ_lightmap"]["index"])]["source"];
        let fine = &glb.json["images"][number(source)]["extras"]["rgb9e5"];
        assert_eq!(fine["size"], serde_json::json!(shown.size));
        let page = number(&primitive["extras"]["lightmap_page"]);
        let light = &lightmap.layers[0].values[lightmap.atlas.first_lumel(page)..];
        let words = glb.view(&fine["bufferView"]).as_chunks().0;
        assert_eq!(words.len(), shown.size[0] * shown.size[1]);
        for (word, is) in words.iter().map(|&word| u32::from_le_bytes(word)).zip(light) {
            let mantissas = Vec3::from([0, 9, 18].map(|shift| (word >> shift & 511) as f32));
            let read = mantissas * ((word >> 27) as f32 - 24.0).exp2() * shown.scale;
            assert!((read - is).abs().max_element() <= is.max_element() / 500.0, "{read} {is}");
        }
        pages.insert(page);
    }
    assert_eq!(pages.len(), lightmap.atlas.pages().len());
}

#[test]
fn any_reader_sees_the_radiance_of_every_triangle() {
    let scene = colourful();
    let lightmap = lightmap_of(&scene);
    let glb = written(&scene, &lightmap, LightmapTarget::Any);
    let mut n_lamps = 0;
    each_vertex(&scene, &lightmap, &glb, |shown, _, SurfacePoint { tri, .. }| {
        // Where albedo and emission are the same everywhere, reading between lumels is exact.
        if scene.uniform_albedo(tri).is_none() || scene.material(tri).emission_texture.is_some() {
            return;
        }
        // At corners, lumels may hold other materials, too.
        let at = SurfacePoint { tri, bary: [1.0 / 3.0; 2].into() };
        let place = lightmap.atlas.texture_coordinates(tri).into_iter().sum::<Vec2>() / 3.0;
        let light: Irradiance = lightmap.at(0, at);
        let is = light.reflected(scene.albedo(at)).radiance().0 + scene.emission(at).0;
        let read = shown.sample(place);
        // The last step of the sRGB curve is the largest.
        let step = 1.0 - linear(254.0 / 255.0);
        assert!((read - is).abs().max_element() < 1.01 * shown.scale * step, "{read} {is}");
        n_lamps += usize::from(scene.material(tri).emits());
    });
    assert!(n_lamps > 0);
}

#[test]
fn radiance_has_the_textures_of_albedo_and_emission() {
    let scene = colourful();
    let lightmap = lightmap_of(&scene);
    let glb = written(&scene, &lightmap, LightmapTarget::Any);
    let (atlas, coverage) = (&lightmap.atlas, Coverage::new(&lightmap.atlas));
    let mut n = 0;
    for primitive in glb.primitives() {
        let material = glb.material(primitive);
        if !["tiles", "screen"].contains(&material["name"].as_str().unwrap()) {
            continue;
        }
        let shown = Shown::of(&glb, material);
        for (place, &lumel) in coverage.lumels().iter().enumerate() {
            let share = coverage.shares(place)[0];
            let (page, [x, y]) = atlas.column_and_row(lumel as usize);
            let is_ours = scene.material(share.tri).name == material["name"]
                && page == primitive["extras"]["lightmap_page"].as_u64().unwrap() as usize;
            if !is_ours || share.area < 1.0 {
                continue;
            }
            let piece = Piece::new(atlas, share.tri, [x, y]).unwrap();
            let (at, _) = piece.at(glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            let light = Irradiance(lightmap.layers[0].values[lumel as usize]);
            let is = light.reflected(scene.albedo(at)).radiance().0 + scene.emission(at).0;
            let read = shown.texel(x as usize, y as usize);
            // Textures bend within a lumel.
            assert!(
                (read - is).abs().max_element() < 0.03 * shown.scale + 0.03 * is.max_element(),
                "{read} {is}"
            );
            n += 1;
        }
    }
    assert!(n > 500, "{n}");
}

#[test]
fn what_emits_leaves_others_all_steps_of_their_image() {
    let scene = colourful();
    let mut lightmap = lightmap_of(&scene);
    lightmap.layers[0].values.iter_mut().for_each(|value| *value *= 0.01);
    let glb = written(&scene, &lightmap, LightmapTarget::Any);
    let n_pages = lightmap.atlas.pages().len();
    let mut images = BTreeSet::new();
    for material in glb.json["materials"].as_array().unwrap() {
        let shown = Shown::of(&glb, material);
        assert!(shown.pixels.contains(&255));
        let emits = material["name"] == "lamp" || material["name"] == "screen";
        let reflected = lightmap.layers[0].values.iter().map(|value| value.max_element()).fold(0.0, f32::max)
            / std::f32::consts::PI;
        assert!(emits || shown.scale <= reflected, "{} of {reflected}", shown.scale);
        images.insert((emits, shown.scale.to_bits()));
    }
    let of = |emits: bool| images.iter().filter(|image| image.0 == emits).count();
    assert!(of(true) >= 1 && of(false) >= 2 && of(true) + of(false) <= 2 * n_pages, "{images:?}");
    let lightmaps = glb.json["images"].as_array().unwrap().iter();
    let lightmaps = lightmaps.filter(|image| image["name"].as_str().unwrap().starts_with("lightmap"));
    assert_eq!(lightmaps.count(), images.len(), "each image is there once, and no others");
}

#[test]
fn a_constant_is_every_byte_255() {
    let scene = plain("plain");
    let mut lightmap = lightmap_of(&scene);
    lightmap.layers[0].values.fill(Vec3::splat(0.37));
    for (target, scale) in BOTH.into_iter().zip([0.37, 0.37 * 0.5 / std::f32::consts::PI]) {
        let glb = written(&scene, &lightmap, target);
        let shown = Shown::of(&glb, &glb.json["materials"][0]);
        assert!(shown.pixels.iter().all(|&byte| byte == 255));
        assert!((shown.scale - scale).abs() < 1e-7, "{}", shown.scale);
    }
}

#[test]
fn what_light_passes_through_stays_so() {
    let scene = cards();
    let lightmap = lightmap_of(&scene);
    let glb = written(&scene, &lightmap, LightmapTarget::Any);
    let modes: BTreeSet<&str> =
        glb.json["materials"].as_array().unwrap().iter().filter_map(|m| m["alphaMode"].as_str()).collect();
    assert_eq!(modes, BTreeSet::from(["BLEND", "MASK"]));
    for material in glb.json["materials"].as_array().unwrap() {
        let surface = &material["pbrMetallicRoughness"];
        let has_alpha_image = material["name"] != "half";
        assert_eq!(surface["baseColorTexture"].is_object(), has_alpha_image, "{material}");
        assert_eq!(surface["baseColorFactor"][0], 0.0);
    }
}

#[test]
fn readers_of_one_set_of_coordinates_find_the_light() {
    for scene in [colourful(), cards()] {
        let glb = written(&scene, &lightmap_of(&scene), LightmapTarget::Any);
        let mut n_same = 0;
        for primitive in glb.primitives() {
            let is_textured = glb.material(primitive)["pbrMetallicRoughness"]["baseColorTexture"].is_object();
            let of = |name: &str| glb.floats(&primitive["attributes"][name], 2, "VEC2");
            let is_same = of("TEXCOORD_0") == of("TEXCOORD_1");
            assert_eq!(is_same, !is_textured, "{}", glb.material(primitive)["name"]);
            n_same += usize::from(is_same);
        }
        assert!(n_same > 0);
    }
}

fn in_files(check: impl Fn(&Scene, &Path)) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for scene in [plain("plain"), colourful(), cards()] {
        let lightmap = lightmap_of(&scene);
        for target in BOTH {
            write_lightmap_glb(&path, &scene, &lightmap, target).unwrap();
            check(&scene, &path);
        }
    }
}

#[test]
fn our_importer_reads_lightmapped_scenes() {
    in_files(|scene, path| {
        let imported = load(path, &ImportOptions::default()).unwrap();
        let (back, _) = imported.scene.build().unwrap();
        assert_eq!(back.triangle_count(), scene.triangle_count());
    });
}

#[test]
fn the_khronos_validator_finds_nothing_in_lightmapped_scenes() {
    in_files(|_, path| validate(path));
}

#[test]
fn a_lightmap_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for target in BOTH {
        let error =
            write_lightmap_glb(&path, &plain("plain"), &lightmap_of(&colourful()), target).unwrap_err();
        assert!(matches!(error, ExportError::Content { .. }));
        assert!(error.to_string().contains("does not belong to a scene with 2"), "{error}");
    }
    assert!(!path.exists());
}
