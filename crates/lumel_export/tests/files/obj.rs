use crate::scenes::{AtVertices, colourful, light_on};
use glam::{Vec2, Vec3};
use lumel_export::{ColorScale, ExportError, check_obj, write_obj, write_ply};
use lumel_import::{ImportOptions, load};
use lumel_scene::{
    Encoding, Face, Material, MaterialId, ObjectMesh, Radiance, Scene, SceneBuilder, Sides, Smoothing,
    SurfacePoint, Texture, TextureId, TextureRef, TriId, UvTransform, Wrap,
};
use std::fs;
use std::path::Path;

/// Writes a scene and reads it back.
fn written_and_read(scene: &Scene, path: &Path) -> Scene {
    write_obj(path, scene, &AtVertices(light_on(scene)), ColorScale::Auto).unwrap();
    let imported = load(path, &ImportOptions::default()).unwrap();
    let warnings: Vec<&str> = imported.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let expected = "lumel has baked its vertex colours: they are light and left out of the albedo";
    assert_eq!(warnings, [expected]);
    let mut scene = imported.scene;
    // The file has the backs of two-sided faces, and cannot say that others have none.
    scene.materials.iter_mut().for_each(|material| material.sides = Sides::Front);
    scene.build().unwrap().0
}

/// The triangles in the order of the file: by object, then by material.
fn in_file_order(scene: &Scene) -> Vec<TriId> {
    let mut triangles: Vec<TriId> = (0..scene.triangle_count() as u32).map(TriId).collect();
    triangles.sort_by_key(|&tri| (scene.object_id(tri), scene.material_id(tri)));
    triangles
}

fn value(scene: &Scene, texture: Option<TextureRef>, at: SurfacePoint) -> Vec3 {
    let sample = |t: TextureRef| scene.textures()[t.texture.index()].sample(t.transform.apply(scene.uv(at)));
    texture.map_or(Vec3::ONE, sample)
}

/// Albedo without the vertex's tint, and emission.
fn albedo_and_emission(scene: &Scene, at: SurfacePoint) -> (Vec3, Vec3) {
    let material = scene.material(at.tri);
    let albedo = material.albedo * value(scene, material.albedo_texture, at);
    (albedo, material.emission.0 * value(scene, material.emission_texture, at))
}

/// Checks that two scenes look the same in places all over their triangles.
fn assert_same_surfaces(ours: &Scene, theirs: &Scene) {
    assert_eq!(ours.triangle_count(), theirs.triangle_count());
    for (tri, back) in in_file_order(ours).into_iter().zip((0..).map(TriId)) {
        assert_eq!(ours.triangle_positions(tri), theirs.triangle_positions(back));
        assert_eq!(ours.material(tri).name, theirs.material(back).name);
        for bary in [[0.2, 0.3], [0.7, 0.2], [0.05, 0.9], [0.3, 0.35]] {
            let at = |tri| SurfacePoint { tri, bary: bary.into() };
            let (albedo, emission) = albedo_and_emission(ours, at(tri));
            let (read_albedo, read_emission) = albedo_and_emission(theirs, at(back));
            let name = &ours.material(tri).name;
            let off = (albedo - read_albedo).abs().max_element();
            assert!(off <= 1.0 / 255.0, "{name}: {albedo} {read_albedo}");
            let off = (emission - read_emission).abs().max_element();
            assert!(off <= emission.max_element() / 50.0, "{name}: {emission} {read_emission}");
        }
    }
}

fn area(scene: &Scene) -> f64 {
    (0..scene.triangle_count() as u32).map(|tri| f64::from(scene.area(TriId(tri)))).sum()
}

#[test]
fn our_importer_reads_the_scene_back() {
    let folder = tempfile::tempdir().unwrap();
    let scene = colourful();
    let back = written_and_read(&scene, &folder.path().join("a b.obj"));
    assert_same_surfaces(&scene, &back);
    assert_eq!(back.object_names(), scene.object_names());
    assert!((area(&scene) - area(&back)).abs() < 1e-6);
    assert!(back.positions().iter().all(|p| scene.positions().contains(p)));
    assert!(!back.materials().iter().any(|material| material.name == "unused"));
}

#[test]
fn another_reader_finds_meshes_materials_and_textures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let scene = colourful();
    write_obj(&path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    let (models, materials) = tobj::load_obj(&path, &tobj::LoadOptions::default()).unwrap();
    let indices: usize = models.iter().map(|model| model.mesh.indices.len()).sum();
    assert_eq!(indices, 3 * scene.triangle_count());
    let names: Vec<&str> = models.iter().map(|model| model.name.as_str()).collect();
    assert!(scene.object_names().iter().all(|name| names.contains(&name.as_str())), "{names:?}");
    for mesh in models.iter().map(|model| &model.mesh) {
        assert_eq!(mesh.vertex_color.len(), mesh.positions.len());
        assert!(!mesh.normals.is_empty() && !mesh.texcoords.is_empty());
    }
    let materials = materials.unwrap();
    assert_eq!(materials.len(), 6);
    let red = materials.iter().find(|material| material.name == "red \"wall\"").unwrap();
    assert_eq!(red.diffuse, Some([0.6, 0.05, 0.05]));
    let tiles = materials.iter().find(|material| material.name == "tiles").unwrap();
    let map = tiles.diffuse_texture.as_deref().unwrap();
    assert!(map.ends_with("a_textures/0_tiles.png"), "{map}");
}

#[test]
fn vertex_colours_are_those_of_ply() {
    let folder = tempfile::tempdir().unwrap();
    let scene = colourful();
    let [obj, ply] = ["a.obj", "a.ply"].map(|name| folder.path().join(name));
    let exposure = write_obj(&obj, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    assert_eq!(write_ply(&ply, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap(), exposure);
    let text = fs::read_to_string(&obj).unwrap();
    assert!(text.contains(&format!("radiance times {exposure}\n")));
    let ply = fs::read(ply).unwrap();
    let start = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let vertices = ply[start..].chunks(39);
    for (line, vertex) in text.lines().filter(|line| line.starts_with("v ")).zip(vertices) {
        let numbers: Vec<f32> = line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect();
        for (color, byte) in numbers[3..].iter().zip(&vertex[36..]) {
            assert!((255.0 * color - f32::from(*byte)).abs() < 0.52, "{line}");
        }
    }
}

#[test]
fn bytes_of_textures_stay_as_they_are_and_mirrored_ones_are_doubled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let scene = colourful();
    write_obj(&path, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    let textures = folder.path().join("a_textures");
    let picture = image::open(textures.join("0_tiles.png")).unwrap().into_rgb8();
    let (rgba, _) = scene.textures()[0].bytes().unwrap();
    assert_eq!((picture.width(), picture.height()), (4, 2));
    for (x, y, pixel) in picture.enumerate_pixels() {
        let texel = rgba[(2 * y + if x < 2 { x } else { 3 - x }) as usize];
        assert_eq!(pixel.0, texel[..3], "{x} {y}");
    }
    assert_eq!(fs::read_dir(&textures).unwrap().count(), 3, "one of each that is used");
}

/// A square whose coordinates leave the picture on all sides, with one texture laid on it in some way.
fn papered(wrap: Wrap, transform: UvTransform, material: impl Fn(TextureRef) -> Material) -> Scene {
    let bytes = (0..24u8).map(|i| [10 * i, 250 - 9 * i, i.wrapping_mul(41), 255]).collect();
    let mut texture = Texture::from_bytes("dir/paper é.jpeg", 6, 4, bytes, Encoding::Srgb).unwrap();
    (texture.wrap_u, texture.wrap_v) = (wrap, wrap);
    let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
    let mesh = ObjectMesh {
        name: "wall".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
        uvs: [[-1.3, 2.1], [1.9, 2.2], [2.0, -0.8], [-1.2, -1.1]].map(Vec2::from).to_vec(),
        faces: vec![face([0, 1, 2]), face([0, 2, 3])],
        ..ObjectMesh::default()
    };
    let builder = SceneBuilder {
        objects: vec![mesh],
        materials: vec![material(TextureRef { texture: TextureId(0), transform })],
        textures: vec![texture],
        ..SceneBuilder::default()
    };
    builder.build().unwrap().0
}

#[test]
fn textures_lie_on_surfaces_as_before_however_they_are_wrapped_and_turned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for rotation in [0.0, 0.6] {
            let transform =
                UvTransform { offset: Vec2::new(0.2, -0.4), rotation, scale: Vec2::new(0.7, -1.3) };
            for transform in [UvTransform { rotation, ..UvTransform::default() }, transform] {
                let wall = |map| Material {
                    albedo_texture: Some(map),
                    ..Material::diffuse("wall", Vec3::splat(0.8))
                };
                let scene = papered(wrap, transform, wall);
                assert_same_surfaces(&scene, &written_and_read(&scene, &path));
                let lamp = |map| Material {
                    emission: Radiance::splat(3.0),
                    emission_texture: Some(map),
                    ..wall(map)
                };
                let scene = papered(wrap, transform, lamp);
                assert_same_surfaces(&scene, &written_and_read(&scene, &path));
            }
        }
    }
}

#[test]
fn emission_that_is_turned_apart_from_the_albedo_is_its_mean() {
    let folder = tempfile::tempdir().unwrap();
    let turned = UvTransform { rotation: 1.0, ..UvTransform::default() };
    let scene = papered(Wrap::Repeat, UvTransform::default(), |map| Material {
        albedo_texture: Some(map),
        emission: Radiance::splat(2.0),
        emission_texture: Some(TextureRef { transform: turned, ..map }),
        ..Material::diffuse("screen", Vec3::splat(0.5))
    });
    let back = written_and_read(&scene, &folder.path().join("a.obj"));
    let at = SurfacePoint { tri: TriId(0), bary: [0.1, 0.4].into() };
    let ((albedo, _), (read, emission)) = (albedo_and_emission(&scene, at), albedo_and_emission(&back, at));
    assert!((albedo - read).abs().max_element() < 1.0 / 255.0);
    assert!((emission - 2.0 * scene.textures()[0].mean()).abs().max_element() < 1e-4, "{emission}");
}

#[test]
fn names_stay_apart_and_on_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = papered(Wrap::Repeat, UvTransform::default(), |_| Material::default());
    let red = Material::diffuse(" a\nb\\", Vec3::X);
    let mut builder = SceneBuilder {
        materials: vec![red.clone(), Material { albedo: Vec3::Y, ..red }, Material::diffuse("", Vec3::Z)],
        ..SceneBuilder::default()
    };
    for material in 0..3 {
        let face = Face { vertices: [0, 1, 2], material: MaterialId(material), smoothing: Smoothing::Crease };
        builder.objects.push(ObjectMesh {
            name: format!("part\t{material}\\"),
            positions: scene.positions()[..3].iter().map(|p| *p + material as f32).collect(),
            faces: vec![face],
            ..ObjectMesh::default()
        });
    }
    scene = builder.build().unwrap().0;
    let back = written_and_read(&scene, &folder.path().join("a.obj"));
    let materials: Vec<_> = back.materials().iter().map(|m| (m.name.as_str(), m.albedo)).collect();
    assert_eq!(materials, [("a b_", Vec3::X), ("a b_ 2", Vec3::Y), ("material", Vec3::Z)]);
    assert_eq!(back.object_names(), ["part 0_", "part 1_", "part 2_"]);
    assert!(!folder.path().join("a_textures").exists(), "nothing has a texture");
}

#[test]
fn files_of_others_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let scene = colourful();
    let write = |name: &str| write_obj(&file(name), &scene, &AtVertices(light_on(&scene)), ColorScale::Auto);
    fs::write(file("room.mtl"), "newmtl wood\n").unwrap();
    fs::write(file("b_textures"), "a file").unwrap();
    for (name, problem) in [("room.obj", "not from lumel"), ("b.obj", "folder"), ("c.mtl", "use .obj")] {
        let error = check_obj(&file(name)).unwrap_err();
        assert!(error.to_string().contains(problem), "{error}");
        assert!(matches!(write(name), Err(ExportError::Content { .. })), "{name}");
        assert!(!file(name).exists());
    }
    assert_eq!(fs::read_to_string(file("room.mtl")).unwrap(), "newmtl wood\n");
    for _ in 0..2 {
        write("mine.obj").unwrap();
    }
    assert!(write_obj(&file("d.obj"), &scene, &AtVertices(vec![Vec3::ONE]), ColorScale::Auto).is_err());
    assert!(!file("d.mtl").exists());
}
