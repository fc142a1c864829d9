//! The OBJ scenes of the shared test data.

#![allow(missing_docs, clippy::unwrap_used, reason = "a test")]

mod shared;

use glam::{Vec2, Vec3};
use lumel_scene::{Encoding, SceneBuilder};
use shared::{build, import, triangles_and_area};
use std::path::Path;

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
    let Some(folder) = shared::folder("scenes") else { return };
    let sponza = [("sponza-dabrovic/sponza.obj", 66454, 34)];
    for (file, triangles, objects) in SCENES.into_iter().chain(sponza) {
        let (builder, _) = import(&folder.join(file)).unwrap();
        assert_eq!(triangles_and_area(&builder).0, triangles, "{file}");
        assert_eq!(builder.objects.len(), objects, "{file}");
        let (scene, warnings) = build(&folder.join(file)).unwrap();
        let dropped = triangles - scene.traced_count();
        assert!(dropped as f64 <= MOST_DROPPED * triangles as f64, "{file}: {dropped} dropped");
        for warning in warnings.iter() {
            println!("{file}: {warning}");
        }
    }
}

#[test]
fn areas_and_counts_agree_with_an_independent_reader() {
    let Some(folder) = shared::folder("scenes") else { return };
    for (file, ..) in SCENES {
        let path = folder.join(file);
        let (builder, _) = import(&path).unwrap();
        let (count, area) = triangles_and_area(&builder);
        let options = tobj::LoadOptions { triangulate: true, ignore_lines: true, ..Default::default() };
        let (models, _) = tobj::load_obj(&path, &options).unwrap();
        let mut expected = (0, 0.0);
        for tobj::Model { mesh, .. } in &models {
            let corner = |i: &u32| Vec3::from_slice(&mesh.positions[3 * *i as usize..]).as_dvec3();
            for triangle in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [&triangle[0], &triangle[1], &triangle[2]].map(corner);
                expected = (expected.0 + 1, expected.1 + 0.5 * (b - a).cross(c - a).length());
            }
        }
        assert_eq!(count, expected.0, "{file}");
        assert!((area - expected.1).abs() <= 1e-6 * expected.1, "{file}: {area} {}", expected.1);
    }
}

#[test]
fn the_tessellated_box_keeps_the_vertices_of_its_file() {
    let Some(folder) = shared::folder("scenes/course-cornell") else { return };
    let path = folder.join("cornell-tessellated.obj");
    let text = std::fs::read_to_string(&path).unwrap();
    let numbers = |line: &str| Vec3::from_iter_of(line);
    let positions: Vec<Vec3> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    let normals: Vec<Vec3> = text.lines().filter(|line| line.starts_with("vn ")).map(numbers).collect();
    let (builder, warnings) = import(&path).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(builder.objects[0].normals, normals);
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
fn the_quilted_box_has_a_normal_map_and_not_its_height_map() {
    let Some(folder) = shared::folder("scenes/quilted-box") else { return };
    let path = folder.join("quilted-box.obj");
    let (builder, _) = import(&path).unwrap();
    let quilt = material(&builder, "quilt");
    let texture =
        |texture: Option<lumel_scene::TextureRef>| &builder.textures[texture.unwrap().texture.index()];
    assert!(texture(quilt.albedo_texture).name.ends_with("quilt_color.jpg"));
    assert_eq!(texture(quilt.albedo_texture).bytes().unwrap().1, Encoding::Srgb);
    assert!(texture(quilt.normal_texture).name.ends_with("quilt_normal.png"));
    assert_eq!(texture(quilt.normal_texture).bytes().unwrap().1, Encoding::Linear);
    assert_eq!(builder.textures.len(), 2);
    assert_eq!(material(&builder, "light").emission.0, Vec3::splat(15.0));
    assert_eq!(material(&builder, "light").albedo, Vec3::ZERO);
    let warnings = texts(&path);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("height maps are ignored"), "{warnings:?}");
}

#[test]
fn the_measured_box_is_as_large_as_measured_and_white_is_white() {
    let Some(folder) = shared::folder("scenes/cornell-measured") else { return };
    let (scene, warnings) = build(&folder.join("cornell_box.obj")).unwrap();
    assert!((scene.bounds().max - Vec3::new(556.0, 548.8, 559.2)).length() < 1.0, "{:?}", scene.bounds());
    assert!(warnings.iter().any(|w| w.message.contains("albedo")), "white walls are clamped: {warnings:?}");
}

#[test]
fn coordinates_of_the_textured_room_look_up_the_floor_they_should() {
    let Some(folder) = shared::folder("scenes/course-indirect-test") else { return };
    let (builder, _) = import(&folder.join("indirect-test_tex.obj")).unwrap();
    let textured = builder.materials.iter().filter(|material| material.albedo_texture.is_some()).count();
    assert_eq!((textured, builder.textures.len()), (1, 1));
    let inside = |uv: &Vec2| uv.is_finite() && uv.abs().max_element() < 100.0;
    assert!(builder.objects.iter().all(|object| object.uvs.iter().all(inside)));
}
