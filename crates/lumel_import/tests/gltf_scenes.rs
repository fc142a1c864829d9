//! Whole glTF scenes, of the repository and shared: everything in them arrives.

#![allow(missing_docs, reason = "a test")]

mod support;

use glam::Vec3;
use lumel_scene::{FaceSide, Light, Radiance, Scene, Sides, SurfacePoint, TriId};
use lumel_testkit::shared;
use std::f32::consts::FRAC_PI_8;
use std::path::Path;

/// Builds a shared scene; `None` without the shared scenes.
fn scene(file: &str) -> Option<Scene> {
    let path = shared::path_or_skip("scenes")?.join(file);
    Some(build(&path))
}

fn build(path: &Path) -> Scene {
    support::build(path).unwrap_or_else(|error| panic!("{error}")).0
}

/// Triangles of a scene, before any without area are dropped.
fn triangles(folder: &Path, file: &str) -> usize {
    let (builder, _) = support::import(&folder.join(file)).unwrap_or_else(|error| panic!("{error}"));
    support::triangles_and_area(&builder).0
}

#[test]
fn the_khronos_and_engine_samples_have_the_triangles_of_their_table() {
    let Some(folder) = shared::path_or_skip("scenes/gltf-samples") else { return };
    let table = [
        ("Box.glb", 12),
        ("BoxVertexColors.glb", 12),
        ("BoxTextured.glb", 12),
        ("Duck.glb", 4_212),
        ("DamagedHelmet.glb", 15_452),
        ("FlightHelmet/FlightHelmet.gltf", 94_722),
        ("NormalTangentTest.glb", 7_774),
        ("AlphaBlendModeTest.glb", 61),
        // The table counts nine meshes; twelve nodes show them.
        ("TextureTransformTest/TextureTransformTest.gltf", 24),
        ("TwoSidedPlane.glb", 2),
        ("PrimitiveModeNormalsTest.glb", 2_562),
        ("Lights.glb", 12),
        // The table counts one cube; 125 instances show it.
        ("simple-instancing.glb", 1_500),
        ("bevy-CornellBox.glb", 36),
        ("bevy-IrradianceVolumeExample.glb", 32),
        ("bevy-MixedLightingExample/MixedLightingExample.gltf", 40_898),
        ("tile-game-room6.glb", 88),
        ("lumrapido-cornell_box.glb", 1_936),
        ("fazil-cornell-box.glb", 1_040),
    ];
    for (file, expected) in table {
        assert_eq!(triangles(&folder, file), expected, "{file}");
    }
}

#[test]
fn the_rooms_have_the_triangles_of_their_table() {
    let Some(folder) = shared::path_or_skip("scenes") else { return };
    let table = [
        ("bathroom/bathroom.glb", 380_280),
        ("country-kitchen/country-kitchen.glb", 1_021_815),
        ("vr-gallery/vr-gallery.glb", 1_930),
        ("house-lightmap-uv/house.glb", 10_497),
        ("quilted-box/quilted-box.glb", 22),
    ];
    for (file, expected) in table {
        assert_eq!(triangles(&folder, file), expected, "{file}");
    }
}

#[test]
fn a_room_is_the_same_as_gltf_and_as_obj() {
    let [gltf, obj] = ["room.gltf", "room.obj"].map(|file| build(&support::own(file)));
    assert_eq!((gltf.traced_count(), obj.traced_count()), (22, 22));
    let total = |scene: &Scene, measure: &dyn Fn(&Scene, TriId) -> Vec3| {
        (0..scene.traced_count() as u32).map(|tri| measure(scene, TriId(tri))).sum::<Vec3>()
    };
    let centre = |scene: &Scene, tri| {
        scene.position(SurfacePoint { tri, bary: [1.0 / 3.0, 1.0 / 3.0].into() }) * scene.area(tri)
    };
    let facing = |scene: &Scene, tri| scene.geometric_normal(tri) * scene.area(tri);
    let emitted = |scene: &Scene, tri| {
        let at = SurfacePoint { tri, bary: [1.0 / 3.0, 1.0 / 3.0].into() };
        scene.emission(at).0 * scene.area(tri)
    };
    let reflected = |scene: &Scene, tri| {
        let at = SurfacePoint { tri, bary: [0.4, 0.35].into() };
        scene.albedo(at).0 * scene.area(tri)
    };
    for measure in [&centre as &dyn Fn(&Scene, TriId) -> Vec3, &facing, &emitted, &reflected] {
        let (a, b) = (total(&gltf, measure), total(&obj, measure));
        assert!((a - b).length() < 1e-3, "{a} {b}");
    }
    assert_eq!(gltf.cameras()[0].name, "camera");
    assert_eq!(gltf.cameras()[0].forward, Vec3::NEG_Z);
    let lamp = gltf.materials().iter().find(|m| m.name == "lamp").unwrap();
    assert_eq!(lamp.emission, Radiance::splat(15.0));
    let tiles = gltf.materials().iter().find(|m| m.name == "tiles").unwrap();
    assert!(tiles.albedo_texture.is_some() && tiles.normal_texture.is_some());
}

#[test]
fn the_sample_lights_shine_where_blender_put_them() {
    let Some(scene) = scene("gltf-samples/Lights.glb") else { return };
    let [Light::Point(point), Light::Spot(wide), Light::Spot(narrow), Light::Directional(sun)] =
        scene.lights()
    else {
        panic!("{:?}", scene.lights())
    };
    assert_eq!(point.intensity, Vec3::new(5.0, 0.0, 0.0));
    assert!((point.position - Vec3::new(2.598_804, 3.568_508, -1.005_454)).length() < 1e-5);
    assert!(
        (wide.direction - Vec3::NEG_Y).length() < 1e-5 && (narrow.direction - Vec3::NEG_Y).length() < 1e-5
    );
    assert!((wide.cos_outer - FRAC_PI_8.cos()).abs() < 1e-6);
    assert!((sun.irradiance - Vec3::new(0.0, 1.0, 1.0)).length() < 1e-5);
    assert!(sun.direction.is_normalized());
    let camera = &scene.cameras()[0];
    assert!(camera.forward.dot(-camera.position) > 0.0, "it looks towards the cube at the origin");
}

#[test]
fn two_sided_cornell_walls_have_backs_and_the_lamp_its_strength() {
    let Some(scene) = scene("gltf-samples/bevy-CornellBox.glb") else { return };
    assert!(scene.materials().iter().all(|material| material.sides == Sides::Both));
    assert_eq!((scene.traced_count(), scene.triangle_count()), (36, 72));
    assert!(scene.seen_side(SurfacePoint::default(), FaceSide::Back).is_some());
    let brightest = scene.materials().iter().map(|m| m.emission.0.max_element()).fold(0.0, f32::max);
    assert_eq!(brightest, 100.0);
    let names = scene.object_names();
    assert!(names.iter().all(|name| !name.is_empty()) && names.len() == 4, "{names:?}");
}

#[test]
fn the_bathroom_has_its_camera_bulbs_and_textures() {
    let Some(scene) = scene("bathroom/bathroom.glb") else { return };
    assert_eq!(scene.cameras()[0].fov_y, 0.959_931_1);
    let bulbs: Vec<_> = scene.materials().iter().filter(|material| material.emits()).collect();
    assert_eq!(bulbs.len(), 1);
    assert!((bulbs[0].emission.0 - Vec3::new(20.0, 15.4, 10.8)).length() < 1e-5);
    let textured = scene.materials().iter().filter(|m| m.albedo_texture.is_some()).count();
    assert_eq!((textured, scene.textures().len()), (8, 7), "two materials share a picture");
}
