//! Whole OBJ scenes, of the repository and shared.

#![allow(missing_docs, clippy::unwrap_used, reason = "a test")]

mod support;

use glam::{Vec2, Vec3};
use lumel_scene::{Encoding, SceneBuilder};
use lumel_testkit::shared;
use std::path::Path;
use support::{build, coincident, import, own, triangles_and_area};

/// Scene, triangles after triangulation, objects.
const SCENES: [(&str, usize, usize); 19] = [
    ("cornell-measured/cornell_box.obj", 36, 8),
    ("cornell-variants/CornellBox-Empty-CO.obj", 12, 6),
    ("cornell-variants/CornellBox-Empty-RG.obj", 12, 6),
    ("cornell-variants/CornellBox-Empty-Squashed.obj", 12, 6),
    ("cornell-variants/CornellBox-Empty-White.obj", 12, 6),
    ("cornell-variants/CornellBox-Glossy-Floor.obj", 1112, 8),
    ("cornell-variants/CornellBox-Glossy.obj", 1112, 8),
    ("cornell-variants/CornellBox-Mirror.obj", 36, 7),
    ("cornell-variants/CornellBox-Original.obj", 36, 7),
    ("cornell-variants/CornellBox-Sphere.obj", 2188, 8),
    ("cornell-variants/CornellBox-Water.obj", 7088, 9),
    ("cornell-variants/water.obj", 4900, 1),
    ("course-cornell/cornell.obj", 32, 1),
    ("course-cornell/cornell-tessellated.obj", 60416, 1),
    ("course-cornell/cornell_chesterfield.obj", 32, 1),
    ("course-indirect-test/indirect-test_mat.obj", 40936, 4),
    ("course-indirect-test/indirect-test_tex.obj", 40938, 5),
    ("gazebo/gazebo.obj", 730, 1),
    ("quilted-box/quilted-box.obj", 22, 7),
];

/// Degenerate triangles that `build` may drop, as a share of all.
const MOST_DROPPED: f64 = 0.001;

#[test]
fn every_scene_loads_with_the_triangles_its_readme_gives() {
    let Some(folder) = shared::path_or_skip("scenes") else { return };
    let sponza = [("sponza-dabrovic/sponza.obj", 66454, 34)];
    for (file, triangles, objects) in SCENES.into_iter().chain(sponza) {
        let (builder, _) = import(&folder.join(file)).unwrap();
        assert_eq!(triangles_and_area(&builder).0, triangles, "{file}");
        assert_eq!(builder.objects.len(), objects, "{file}");
        let (scene, warnings) = build(&folder.join(file)).unwrap();
        let dropped = triangles - scene.traced_count() - coincident(&warnings);
        assert!(dropped as f64 <= MOST_DROPPED * triangles as f64, "{file}: {dropped} dropped");
        for warning in warnings.iter() {
            println!("{file}: {warning}");
        }
    }
}

#[test]
fn areas_and_counts_agree_with_an_independent_reader() {
    assert_agrees_with_tobj(&own("room.obj"));
    assert_eq!(triangles_and_area(&import(&own("room.obj")).unwrap().0).0, 22);
}

#[test]
fn areas_and_counts_of_shared_scenes_agree_with_an_independent_reader() {
    let Some(folder) = shared::path_or_skip("scenes") else { return };
    for (file, ..) in SCENES {
        assert_agrees_with_tobj(&folder.join(file));
    }
}

fn assert_agrees_with_tobj(path: &Path) {
    let (builder, _) = import(path).unwrap();
    let (count, area) = triangles_and_area(&builder);
    let options = tobj::LoadOptions { triangulate: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj(path, &options).unwrap();
    let mut expected = (0, 0.0);
    for tobj::Model { mesh, .. } in &models {
        let corner = |i: &u32| Vec3::from_slice(&mesh.positions[3 * *i as usize..]).as_dvec3();
        for triangle in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [&triangle[0], &triangle[1], &triangle[2]].map(corner);
            expected = (expected.0 + 1, expected.1 + 0.5 * (b - a).cross(c - a).length());
        }
    }
    let file = path.display();
    assert_eq!(count, expected.0, "{file}");
    assert!((area - expected.1).abs() <= 1e-6 * expected.1, "{file}: {area} {}", expected.1);
}

#[test]
fn the_tessellated_box_keeps_the_vertices_of_its_file() {
    let Some(folder) = shared::path_or_skip("scenes/course-cornell") else { return };
    let path = folder.join("cornell-tessellated.obj");
    let text = std::fs::read_to_string(&path).unwrap();
    let numbers = |line: &str| Vec3::from_iter_of(line);
    let positions: Vec<Vec3> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    let normals: Vec<Vec3> = text.lines().filter(|line| line.starts_with("vn ")).map(numbers).collect();
    let (builder, warnings) = import(&path).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(builder.objects[0].normals, normals);
    let mut builder = builder;
    // A wall that stands alone has two sides otherwise.
    builder.materials.iter_mut().for_each(|material| material.sides = lumel_scene::Sides::Front);
    let (scene, warnings) = builder.build().unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.vertex_count(), scene.triangle_count()), (31440, 60416));
    assert!(scene.positions() == positions, "positions differ from the file's");
}

/// Reads the numbers of a statement the plain way.
trait FromStatement {
    fn from_iter_of(line: &str) -> Self;
}

impl FromStatement for Vec3 {
    fn from_iter_of(line: &str) -> Self {
        let values: Vec<f32> = line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
        Self::from_slice(&values)
    }
}

fn material<'a>(builder: &'a SceneBuilder, name: &str) -> &'a lumel_scene::Material {
    builder.materials.iter().find(|material| material.name == name).unwrap()
}

fn texts(path: &Path) -> Vec<String> {
    import(path).unwrap().1.iter().map(ToString::to_string).collect()
}

#[test]
fn a_normal_map_is_told_from_a_height_map() {
    let path = own("room.obj");
    let (builder, _) = import(&path).unwrap();
    let tiles = material(&builder, "tiles");
    let texture =
        |texture: Option<lumel_scene::TextureRef>| &builder.textures[texture.unwrap().texture.index()];
    assert!(texture(tiles.albedo_texture).name.ends_with("tiles-color.png"));
    assert_eq!(texture(tiles.albedo_texture).bytes().unwrap().1, Encoding::Srgb);
    assert!(texture(tiles.normal_texture.map(|map| map.image)).name.ends_with("tiles-normal.png"));
    assert_eq!(texture(tiles.normal_texture.map(|map| map.image)).bytes().unwrap().1, Encoding::Linear);
    assert_eq!(builder.textures.len(), 2);
    assert_eq!(material(&builder, "lamp").emission.0, Vec3::splat(15.0));
    assert_eq!(material(&builder, "lamp").albedo, Vec3::ZERO);
    assert_eq!(texts(&path), [""; 0]);
}

#[test]
fn the_measured_box_is_as_large_as_measured_and_white_is_white() {
    let Some(folder) = shared::path_or_skip("scenes/cornell-measured") else { return };
    let (scene, warnings) = build(&folder.join("cornell_box.obj")).unwrap();
    assert!((scene.bounds().max - Vec3::new(556.0, 548.8, 559.2)).length() < 1.0, "{:?}", scene.bounds());
    assert!(warnings.iter().any(|w| w.message.contains("albedo")), "white walls are clamped: {warnings:?}");
}

#[test]
fn coordinates_of_the_textured_room_look_up_the_floor_they_should() {
    let Some(folder) = shared::path_or_skip("scenes/course-indirect-test") else { return };
    let (builder, _) = import(&folder.join("indirect-test_tex.obj")).unwrap();
    let textured = builder.materials.iter().filter(|material| material.albedo_texture.is_some()).count();
    assert_eq!((textured, builder.textures.len()), (1, 1));
    let inside = |uv: &Vec2| uv.is_finite() && uv.abs().max_element() < 100.0;
    assert!(builder.objects.iter().all(|object| object.uvs.iter().all(inside)));
}
