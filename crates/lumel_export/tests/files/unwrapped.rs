use crate::glb::{Glb, number, validate};
use crate::scenes::{colourful, plain};
use glam::{Vec2, Vec3};
use lumel_export::{ExportError, write_atlas_png, write_unwrapped_glb};
use lumel_import::{ImportOptions, load};
use lumel_scene::{Scene, TriId};
use lumel_uv::{Atlas, Density, Pace, UnwrapSettings, unwrap};
use std::collections::BTreeSet;
use std::path::Path;

fn atlas_of(scene: &Scene, page_size: u32) -> Atlas {
    let settings =
        UnwrapSettings { density: Density::PerMetre(40.0), page_size, ..UnwrapSettings::default() };
    unwrap(scene, &settings, &|| Pace::Go).unwrap().atlas
}

fn written(scene: &Scene, atlas: &Atlas) -> Glb {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_unwrapped_glb(&path, scene, atlas).unwrap();
    Glb::read(&path)
}

/// Numbers that tell a corner: position, normal and place.
fn key(position: Vec3, normal: Vec3, place: Vec2) -> Vec<u32> {
    let numbers = position.to_array().into_iter().chain(normal.to_array()).chain(place.to_array());
    numbers.map(f32::to_bits).collect()
}

#[test]
fn every_corner_has_its_place_in_the_atlas() {
    let scene = colourful();
    let atlas = atlas_of(&scene, 256);
    let glb = written(&scene, &atlas);
    let mut found = Vec::new();
    for primitive in glb.primitives() {
        let attributes = &primitive["attributes"];
        let (positions, normals) = (glb.vectors(&attributes["POSITION"]), glb.vectors(&attributes["NORMAL"]));
        let places = glb.floats(&attributes["TEXCOORD_1"], 2, "VEC2");
        assert_eq!(glb.floats(&attributes["TEXCOORD_0"], 2, "VEC2").len(), places.len());
        assert!(places.iter().all(|x| (0.0..=1.0).contains(x)));
        let indices = glb.words(&primitive["indices"], 1).into_iter().map(u32::from_le_bytes);
        for i in indices.map(|i| i as usize) {
            found.push(key(positions[i], normals[i], Vec2::new(places[2 * i], places[2 * i + 1])));
        }
    }
    let mut expected = Vec::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        for (vertex, place) in scene.triangle(tri).into_iter().zip(atlas.texture_coordinates(tri)) {
            let vertex = vertex as usize;
            expected.push(key(scene.positions()[vertex], scene.normals()[vertex], place));
        }
    }
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}

#[test]
fn a_square_in_one_chart_keeps_its_four_vertices() {
    let scene = plain("floor");
    let glb = written(&scene, &atlas_of(&scene, 256));
    let positions = &glb.primitives().next().unwrap()["attributes"]["POSITION"];
    assert_eq!(glb.vectors(positions).len(), 4);
}

#[test]
fn what_lies_on_several_pages_has_primitives_that_name_them() {
    let scene = colourful();
    let atlas = atlas_of(&scene, 64);
    assert!(atlas.pages().len() > 1, "{:?}", atlas.pages());
    let glb = written(&scene, &atlas);
    let pages: BTreeSet<usize> =
        glb.primitives().map(|primitive| number(&primitive["extras"]["lightmap_page"])).collect();
    assert_eq!(pages, (0..atlas.pages().len()).collect());
    let lightmap = &glb.json["asset"]["extras"]["lightmap"];
    assert_eq!(lightmap["pages"], serde_json::json!(atlas.pages()));
    assert_eq!(lightmap["hash"], atlas.identity().to_hex().as_str());
}

#[test]
fn our_importer_reads_the_scene_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = colourful();
    write_unwrapped_glb(&path, &scene, &atlas_of(&scene, 256)).unwrap();
    let imported = load(&path, &ImportOptions::default()).unwrap();
    assert_eq!(imported.warnings.len(), 0, "{:?}", imported.warnings);
    let (back, _) = imported.scene.build().unwrap();
    assert_eq!(back.triangle_count(), scene.triangle_count());
    for material in back.materials() {
        let ours = scene.materials().iter().find(|ours| ours.name == material.name).unwrap();
        assert!((material.albedo - ours.albedo).length() < 1e-6, "{}", ours.name);
        assert_eq!(material.emits(), ours.emits(), "{}", ours.name);
    }
    assert!(back.tints().iter().any(|tint| *tint != Vec3::ONE), "tints stay");
}

#[test]
fn the_khronos_validator_finds_nothing_in_unwrapped_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for (scene, page_size) in [(plain("plain"), 256), (colourful(), 256), (colourful(), 64)] {
        write_unwrapped_glb(&path, &scene, &atlas_of(&scene, page_size)).unwrap();
        validate(&path);
    }
}

#[test]
fn an_atlas_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let error = write_unwrapped_glb(&path, &plain("plain"), &atlas_of(&colourful(), 256)).unwrap_err();
    assert!(matches!(error, ExportError::Content { .. }));
    assert!(error.to_string().contains("does not belong to a scene with 2"), "{error}");
    assert!(!path.exists());
}

fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

#[test]
fn a_picture_of_an_atlas_shows_its_charts_and_what_is_free() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let scene = plain("floor");
    let atlas = atlas_of(&scene, 256);
    write_atlas_png(&path, &atlas, 0).unwrap();
    let picture = pixels(&path);
    let [width, height] = atlas.pages()[0];
    assert_eq!(picture.dimensions(), (8 * width, 8 * height), "small pages are enlarged");
    let chart = atlas.charts()[0];
    let at = |[x, y]: [u32; 2]| picture.get_pixel(8 * x + 3, 8 * y + 6).0;
    let inside = at([(chart.min[0] + chart.max[0]) / 2, chart.min[1] + 5]);
    assert!(inside.iter().any(|&channel| channel > 150), "{inside:?}");
    let beside = at([chart.min[0] - 1, chart.min[1] + 5]);
    assert!(beside.iter().all(|&channel| channel < 60), "{beside:?}");
    let error = write_atlas_png(&path, &atlas, 1).unwrap_err();
    assert!(error.to_string().starts_with("the atlas has no page 1"), "{error}");
}
