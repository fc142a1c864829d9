//! What GLB files keep of a scene beside its surfaces.

use crate::glb::{Glb, number, validate};
use crate::lightmap::lightmap_of;
use crate::scenes::{AtVertices, colourful, light_on};
use glam::{DVec3, Vec2, Vec3};
use lumel_export::{
    ColorScale, GlbOptions, GltfMaterials, LightmapTarget, write_glb, write_lightmap_glb, write_unwrapped_glb,
};
use lumel_import::{ImportOptions, load};
use lumel_lightmap::LightmapLayer;
use lumel_scene::{
    Camera, DirectionalLight, DiskLight, EncodedImage, Filter, Gloss, GlossTexture, Light, Material,
    PointLight, Radiance, RectLight, Scene, SceneBuilder, Sky, SphereLight, SpotLight, SunLight, TextureId,
    TextureRef, UvTransform, Wrap,
};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

const POINT: PointLight =
    PointLight { position: Vec3::new(1.0, 2.0, 3.0), intensity: Vec3::new(4.0, 2.0, 1.0), range: 7.0 };

fn rect(radiance: f32, texture: Option<TextureId>) -> Light {
    let (center, u, v) = (Vec3::new(0.5, 5.0, 0.5), Vec3::X * 0.5, Vec3::Z * 0.25);
    Light::Rect(RectLight { center, u, v, radiance: Radiance::splat(radiance), texture })
}

/// A square with a shiny material under a light of each kind, seen by two cameras, at an origin of its own.
fn furnished() -> Scene {
    let base = colourful();
    let png = include_bytes!("../data/gloss.png").to_vec();
    let image = Arc::new(EncodedImage { name: "gloss".into(), mime_type: "image/png", bytes: png });
    let transform = UvTransform { scale: Vec2::splat(2.0), ..UvTransform::default() };
    let shiny = |name, wrap, albedo_texture| Material {
        albedo_texture,
        gloss: Gloss {
            metallic: 1.0,
            roughness: 0.25,
            texture: Some(GlossTexture {
                image: Arc::clone(&image),
                transform,
                wrap,
                filter: Filter::Linear,
            }),
        },
        ..Material::diffuse(name, Vec3::splat(0.5))
    };
    let paint = Some(TextureRef::plain(TextureId(0)));
    let materials = vec![shiny("shiny", [Wrap::Repeat; 2], paint), shiny("other", [Wrap::Repeat; 2], paint)];
    let mut builder = SceneBuilder {
        name: "furnished".into(),
        origin: DVec3::new(1e6, 0.0, 0.0),
        objects: vec![lumel_scene::ObjectMesh {
            name: "floor".into(),
            positions: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
                .map(|[x, z]| Vec3::new(x, 0.0, z))
                .to_vec(),
            uvs: vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X],
            faces: [([0, 1, 2], 0), ([0, 2, 3], 1)]
                .map(|(vertices, material)| lumel_scene::Face {
                    vertices,
                    material: lumel_scene::MaterialId(material),
                    smoothing: lumel_scene::Smoothing::Crease,
                })
                .to_vec(),
            ..lumel_scene::ObjectMesh::default()
        }],
        materials,
        textures: base.textures().to_vec(),
        cameras: vec![
            Camera::looking_at("door", Vec3::new(0.0, 1.0, 3.0), Vec3::new(0.5, 0.0, 0.5), 0.8),
            Camera::looking_at("above", Vec3::Y, Vec3::ZERO, 1.2),
        ],
        sky: Sky::Uniform(Radiance::splat(0.5)),
        ..SceneBuilder::default()
    };
    let parallel = DirectionalLight { direction: Vec3::new(0.0, -0.6, 0.8), irradiance: Vec3::ONE };
    let spot = SpotLight { point: POINT, direction: Vec3::NEG_Y, cos_inner: 0.9, cos_outer: -4e-8 };
    for (name, light) in [
        ("panel", rect(20.0, None)),
        ("window", rect(0.5, Some(TextureId(0)))),
        ("off", rect(0.0, None)),
        ("bulb", Light::Point(POINT)),
        ("spot", Light::Spot(spot)),
        ("far", Light::Directional(parallel)),
        ("sun", Light::Sun(SunLight { parallel, sin_half_angle: 0.005 })),
        ("globe", Light::Sphere(SphereLight::of_intensity(Vec3::ONE, 0.1, Vec3::splat(3.0)))),
        (
            "disk",
            Light::Disk(DiskLight {
                center: Vec3::Y,
                direction: Vec3::NEG_Y,
                radius: 0.1,
                radiance: Radiance::splat(1.0),
            }),
        ),
    ] {
        builder.add_named_light(name, light);
    }
    builder.build().unwrap().0
}

fn written(path: &Path, scene: &Scene, materials: GltfMaterials) -> Glb {
    let options = GlbOptions { materials, exposure: ColorScale::Factor(0.1) };
    write_glb(path, scene, &AtVertices(light_on(scene)), options).unwrap();
    validate(path);
    Glb::read(path)
}

fn node<'a>(glb: &'a Glb, name: &str) -> &'a Value {
    glb.json["nodes"].as_array().unwrap().iter().find(|node| node["name"] == name).unwrap()
}

#[test]
fn cameras_and_lights_come_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = furnished();
    for materials in [GltfMaterials::Unlit, GltfMaterials::Keep] {
        let glb = written(&path, &scene, materials);
        let again = load(&path, &ImportOptions::default()).unwrap().scene;
        let moved = (scene.origin() - again.origin).as_vec3();
        assert_eq!(again.cameras.len(), 2);
        for (ours, theirs) in scene.cameras().iter().zip(&again.cameras) {
            assert_eq!((&ours.name, ours.fov_y), (&theirs.name, theirs.fov_y));
            assert!((ours.position + moved - theirs.position).length() < 1e-5);
            let axes = [ours, theirs].map(|camera| camera.axes().unwrap());
            assert!((0..3).all(|k| (axes[0][k] - axes[1][k]).length() < 1e-6));
        }
        assert_eq!(again.light_names, ["bulb", "spot", "far", "sun", "globe"]);
        let Light::Point(bulb) = again.lights[0] else { panic!() };
        assert_eq!((bulb.intensity, bulb.range), (POINT.intensity, POINT.range));
        assert!((bulb.position - moved - POINT.position).length() < 1e-5);
        let Light::Spot(spot) = again.lights[1] else { panic!() };
        assert!(
            spot.direction.y < -0.999 && (spot.cos_inner - 0.9).abs() < 1e-5 && spot.cos_outer.abs() < 1e-6
        );
        let Light::Directional(sun) = again.lights[3] else { panic!() };
        assert!((sun.direction - Vec3::new(0.0, -0.6, 0.8)).length() < 1e-6 && sun.irradiance == Vec3::ONE);
        let Light::Point(globe) = again.lights[4] else { panic!() };
        assert!((globe.intensity - Vec3::splat(3.0)).length() < 1e-5);
        assert_eq!(glb.json["asset"]["extras"]["lights_left_out"], json!(["disk", "sky"]));
    }
}

#[test]
fn rectangles_are_surfaces_that_emit_as_brightly_as_the_rest_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = furnished();
    for (materials, scale) in [(GltfMaterials::Unlit, 0.1), (GltfMaterials::Keep, 1.0)] {
        let glb = written(&path, &scene, materials);
        for (name, radiance) in [("panel", 20.0), ("window", 0.5)] {
            let mesh = &glb.json["meshes"][number(&node(&glb, name)["mesh"])];
            let primitive = &mesh["primitives"][0];
            let material = glb.material(primitive);
            let strength = &material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
            let shown = material["emissiveFactor"][0].as_f64().unwrap() * strength.as_f64().unwrap_or(1.0);
            assert!((shown - scale * radiance).abs() < 1e-5, "{name}: {shown}");
            assert_eq!(material["emissiveTexture"].is_object(), name == "window");
            let [positions, normals] =
                ["POSITION", "NORMAL"].map(|name| glb.vectors(&primitive["attributes"][name]));
            let Light::Rect(light) = rect(1.0, None) else { panic!() };
            for (position, corner) in positions.iter().zip(light.corners()) {
                let lift = (*position - corner).dot(light.normal().unwrap());
                assert!(lift > 0.0 && (*position - corner).length() < 1e-3, "{position} {corner}");
            }
            let [a, b, c] = [0, 1, 2].map(|k| positions[k]);
            assert!((b - a).cross(c - a).normalize().dot(normals[0]) > 0.999);
            let uvs = glb.floats(&primitive["attributes"]["TEXCOORD_0"], 2, "VEC2");
            assert_eq!(uvs, [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        }
        assert!(glb.json["nodes"].as_array().unwrap().iter().all(|node| node["name"] != "off"));
    }
}

#[test]
fn kept_materials_have_metal_and_roughness_and_unlit_ones_have_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = furnished();
    let glb = written(&path, &scene, GltfMaterials::Keep);
    let mut images = Vec::new();
    for primitive in glb.primitives().filter(|p| p["attributes"]["_IRRADIANCE"].is_number()) {
        let material = glb.material(primitive);
        let surface = &material["pbrMetallicRoughness"];
        assert_eq!(
            (surface["metallicFactor"].as_f64(), surface["roughnessFactor"].as_f64()),
            (Some(1.0), Some(0.25))
        );
        assert!(material["extensions"]["KHR_materials_unlit"].is_null());
        let reference = &surface["metallicRoughnessTexture"];
        assert_eq!(reference["extensions"]["KHR_texture_transform"]["scale"], json!([2.0, 2.0]));
        let image = number(&glb.json["textures"][number(&reference["index"])]["source"]);
        assert_eq!(glb.view(&glb.json["images"][image]["bufferView"]), include_bytes!("../data/gloss.png"));
        assert!(primitive["attributes"]["COLOR_0"].is_null(), "white needs no tint");
        images.push(image);
    }
    assert_eq!((images.len(), images[0]), (2, images[1]), "materials share the image");
    let again = load(&path, &ImportOptions::default()).unwrap().scene;
    let gloss = &again.materials[0].gloss;
    assert_eq!((gloss.metallic, gloss.roughness), (1.0, 0.25));
    assert_eq!(gloss.texture.as_ref().unwrap().image.bytes, include_bytes!("../data/gloss.png"));
    let unlit = written(&path, &scene, GltfMaterials::Unlit);
    assert!(unlit.primitives().all(|p| unlit.material(p)["pbrMetallicRoughness"]["metallicFactor"] == 0.0));
}

#[test]
fn lights_whose_light_is_in_a_lightmap_are_apart_from_what_it_is_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let scene = furnished();
    let mut lightmap = lightmap_of(&scene);
    let values = lightmap.layers[0].values.clone();
    lightmap.layers.push(LightmapLayer { name: LightmapLayer::OCCLUSION.to_owned(), values });
    let names = |glb: &Glb, scene: usize| -> Vec<String> {
        let nodes = glb.json["scenes"][scene]["nodes"].as_array().unwrap();
        nodes.iter().map(|n| glb.json["nodes"][number(n)]["name"].as_str().unwrap().to_owned()).collect()
    };
    let (surfaces, lights) =
        (["floor", "panel", "window", "door", "above"], ["bulb", "spot", "far", "sun", "globe"]);
    for target in [LightmapTarget::Three, LightmapTarget::Any, LightmapTarget::Occlusion] {
        write_lightmap_glb(&path, &scene, &lightmap, target).unwrap();
        validate(&path);
        let glb = Glb::read(&path);
        if target == LightmapTarget::Occlusion {
            assert_eq!(names(&glb, 0), [&surfaces[..], &lights].concat());
        } else {
            assert_eq!(names(&glb, 0), surfaces);
            assert_eq!(names(&glb, 1), lights);
        }
    }
    write_unwrapped_glb(&path, &scene, &lightmap.atlas).unwrap();
    validate(&path);
    let glb = Glb::read(&path);
    assert_eq!(names(&glb, 0), [&["floor", "door", "above"][..], &lights].concat());
    let left_out = json!(["panel", "window", "disk", "sky"]);
    assert_eq!(glb.json["asset"]["extras"]["lights_left_out"], left_out, "they have no place in the atlas");
}
