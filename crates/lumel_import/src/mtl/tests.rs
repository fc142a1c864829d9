use crate::testing::{folder, load_with_warnings, png, png_row, try_load};
use crate::{ImportOptions, Imported, PathPolicy, load};
use glam::{Vec2, Vec3};
use lumel_scene::{AlphaMode, Encoding, Material, Radiance, TextureRef, Transparency, Wrap};
use proptest::prelude::*;

/// A triangle of material `m` from library `test.mtl`.
const TRIANGLE: &[u8] = b"mtllib test.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

fn mtl(text: &str) -> (Imported, Vec<String>) {
    let (red, bump) = (png([255, 0, 0, 255]), png([128, 128, 255, 255]));
    load_with_warnings(&[
        ("test.obj", TRIANGLE),
        ("test.mtl", text.as_bytes()),
        ("red.png", &red),
        ("tex/my normals.png", &bump),
    ])
}

fn material(text: &str) -> Material {
    mtl(&format!("newmtl m\n{text}\n")).0.scene.materials[0].clone()
}

fn warnings(text: &str) -> Vec<String> {
    mtl(&format!("newmtl m\n{text}\n")).1
}

#[test]
fn colours_are_read_and_everything_else_of_no_use_is_passed_over() {
    let text = "newmtl other\nKd 1 0 0\nnewmtl m\n\tKa 1 1 1 # ambient\n  Kd 0.1 0.2 0.3 # paint\nKs 1 1 1\nNs 3\n\
                Ke 1 2 3\nNi 1.5\nd 1\nTr 0\nPr 0.5\nPm 1\nillum 2\nmap_Ks absent.png\nrefl absent.png\n";
    let (imported, warnings) = mtl(text);
    let material = &imported.scene.materials[0];
    assert_eq!((material.name.as_str(), material.albedo), ("m", Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(material.emission, Radiance(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(warnings, [""; 0]);
    assert_eq!(imported.scene.materials.len(), 1, "only materials in use");
    assert_eq!(super::tests::material("Kd 0.25").albedo, Vec3::splat(0.25));
    assert_eq!(super::tests::material("Ks 1 1 1").albedo, Material::default().albedo);
}

#[test]
fn maps_multiply_their_colours_and_black_beside_a_map_counts_as_absent() {
    let given = material("Kd 0.5 0.5 0.5\nmap_Kd red.png\nKe 2 2 2\nmap_Ke red.png");
    assert_eq!((given.albedo, given.emission), (Vec3::splat(0.5), Radiance::splat(2.0)));
    assert!(given.albedo_texture.is_some() && given.emission_texture.is_some());
    let absent = material("map_Kd red.png\nmap_Ke red.png");
    assert_eq!((absent.albedo, absent.emission), (Vec3::ONE, Radiance::splat(1.0)));
    let black = "Kd 0 0 0\nmap_Kd red.png";
    assert_eq!(material(black).albedo, Vec3::ONE);
    assert_eq!(warnings(black), ["material \"m\": Kd is 0 beside map_Kd: the map is used as it is"]);
    assert_eq!(material("Kd 0 0 0").albedo, Vec3::ZERO, "black without a map is black");
}

#[test]
fn missing_textures_are_named_and_their_colours_used() {
    let text = "Kd 0.3 0.3 0.3\nmap_Kd absent file.png\nKe 0 0 0\nmap_Ke gone.png";
    let without = material(text);
    assert_eq!((without.albedo, without.emission), (Vec3::splat(0.3), Radiance::ZERO));
    assert_eq!(material("Kd 0 0 0\nmap_Kd gone.png").albedo, Material::default().albedo);
    let warnings = warnings(text);
    assert_eq!(warnings.len(), 2);
    let expected = "material \"m\": going on without a texture: \"absent file.png\" does not exist";
    assert!(warnings[0].starts_with(expected), "{warnings:?}");
}

#[test]
fn normal_maps_are_linear_and_come_before_height_maps() {
    let text =
        "Kd 1 1 1\nmap_Kd red.png\nnorm -bm 0.5 tex\\my normals.png\nmap_Bump -bm 0.2 red.png\ndisp red.png";
    let (imported, warnings) = mtl(&format!("newmtl m\n{text}\n"));
    let scene = &imported.scene;
    let map = scene.materials[0].normal_texture.unwrap();
    assert_eq!(map.scale, Vec2::splat(0.5));
    assert_eq!(scene.textures[map.image.texture.index()].bytes().unwrap().1, Encoding::Linear);
    assert_eq!(scene.textures.len(), 2, "the height map is not loaded");
    assert_eq!(warnings, ["test.obj: displacement is ignored, materials: m"]);
}

#[test]
fn height_maps_become_normal_maps() {
    for statement in ["map_bump", "bump", "map_Bump"] {
        let lost = "norm gone.png\n";
        for before in ["", lost] {
            let (imported, warnings) =
                mtl(&format!("newmtl m\nKd 1 1 1\n{before}{statement} -bm 0.2 red.png\n"));
            let scene = &imported.scene;
            let map = scene.materials[0].normal_texture.unwrap();
            assert_eq!(map.scale, Vec2::splat(0.2));
            let (texels, encoding) = scene.textures[map.image.texture.index()].bytes().unwrap();
            assert_eq!((texels[0], encoding), ([128, 128, 255, 255], Encoding::Linear));
            assert_eq!(warnings.len(), usize::from(!before.is_empty()), "{warnings:?}");
        }
    }
    let (_, warnings) = mtl("newmtl m\nKd 1 1 1\nbump gone.png\n");
    assert!(
        warnings[0].starts_with("material \"m\": going on without a texture: \"gone.png\""),
        "{warnings:?}"
    );
}

#[test]
fn what_a_diffuse_solver_cannot_do_is_said_once() {
    let opaque = [warnings("d 1\nTr 1"), warnings("Tr 0"), warnings("illum 2")];
    assert_eq!(opaque, [[""; 0]; 3], "d counts, and Tr 0 is opaque");
    for model in [4, 6, 7, 9] {
        let glass = warnings(&format!("Kd 0.5 0.5 0.5\nillum {model}"));
        assert_eq!(glass, ["test.obj: light passes straight through materials that refract: m"]);
    }
    let expected = "test.obj: materials that mirror or refract are treated as diffuse: m";
    assert_eq!(warnings("illum 5"), [expected]);
    let expected =
        "test.mtl: 1 colours skipped: spectral and xyz colours are not supported; use RGB, first in line 2";
    assert_eq!(warnings("Kd spectral glass.rfl"), [expected]);
}

/// The transparency of a material, and alpha at the left and right of its texture.
fn alpha(text: &str) -> (Transparency, Option<[f32; 2]>) {
    let of_alpha = png_row(&[[255, 255, 255, 51], [255, 255, 255, 255]]);
    let of_brightness = png_row(&[[51, 51, 51, 255], [255, 255, 255, 255]]);
    let mtl = format!("newmtl m\n{text}\n");
    let files: [(&str, &[u8]); 4] = [
        ("test.obj", TRIANGLE),
        ("test.mtl", mtl.as_bytes()),
        ("alpha.png", &of_alpha),
        ("grey.png", &of_brightness),
    ];
    let (imported, warnings) = load_with_warnings(&files);
    assert_eq!(warnings, [""; 0], "{text}");
    let scene = imported.scene;
    let transparency = scene.materials[0].transparency;
    let texels = |t: TextureRef| {
        let texture = &scene.textures[t.texture.index()];
        [texture.texel_alpha(0, 0), texture.texel_alpha(1, 0)]
    };
    (transparency, transparency.texture.map(texels))
}

#[test]
fn d_and_tr_and_map_d_are_alpha() {
    let opacity = |text| alpha(text).0;
    assert_eq!(opacity("d 1"), Transparency::default());
    for text in ["d 0.25", "Tr 0.75", "d -halo 0.25", "d 0.25\nTr 0.1"] {
        assert_eq!(opacity(text), Transparency::blend(0.25), "{text}");
    }
    for text in ["map_d grey.png", "map_d alpha.png", "map_Kd alpha.png\nmap_d alpha.png"] {
        let (transparency, texels) = alpha(text);
        assert_eq!((transparency.mode, transparency.alpha), (AlphaMode::Blend, 1.0), "{text}");
        assert_eq!(texels, Some([0.2, 1.0]), "{text}");
    }
    let (transparency, texels) = alpha("d 0.5\nmap_d grey.png");
    assert_eq!((transparency.alpha, texels), (0.5, Some([0.2, 1.0])));
}

#[test]
fn the_alpha_of_a_colour_map_counts_where_the_material_is_transparent() {
    assert_eq!(alpha("map_Kd alpha.png"), (Transparency::default(), None));
    assert_eq!(alpha("d 0.5\nmap_Kd alpha.png").1, Some([0.2, 1.0]));
    assert_eq!(alpha("d 0.5\nmap_Kd grey.png"), (Transparency::blend(0.5), None));
}

#[test]
fn glass_lets_through_what_it_does_not_absorb() {
    let glass = |text: &str| {
        let material = material(&format!("illum 7\n{text}"));
        (material.albedo, material.transparency.transmission)
    };
    assert_eq!(glass("Kd 0.5 0.25 0.125"), (Vec3::ZERO, Vec3::new(0.5, 0.25, 0.125)));
    assert_eq!(glass("Kd 0.1 0.1 0.1\nTf 0.5 1 1"), (Vec3::ZERO, Vec3::new(0.5, 1.0, 1.0)));
    assert_eq!(glass("Kd 0 0 0\nTf 1 1 1"), (Vec3::ZERO, Vec3::ONE));
    assert_eq!(glass("Kd 0.5 0.5 0.5\nKe 1 1 1"), (Vec3::splat(0.5), Vec3::ZERO), "a light is no glass");
    assert_eq!(glass("Kd 0.5 0.5 0.5\nd 0.5"), (Vec3::splat(0.5), Vec3::ZERO), "d says it");
}

#[test]
fn map_options_reach_the_texture() {
    let (imported, _) = mtl("newmtl m\nmap_Kd -clamp on -s 2 4 -o 0.5 0.25 red.png\nmap_Ke red.png\n");
    let scene = &imported.scene;
    let reference = scene.materials[0].albedo_texture.unwrap();
    assert_eq!(reference.transform.scale, Vec2::new(2.0, 4.0));
    let textures = &scene.textures;
    assert_eq!(textures.len(), 2, "one clamped, one repeated");
    assert_eq!((textures[0].wrap_u, textures[0].wrap_v), (Wrap::Clamp, Wrap::Clamp));
    assert_eq!(textures[1].wrap_u, Wrap::Repeat);
    assert!(warnings("map_Kd -mm 0.5 0.5 red.png")[0].contains("-mm"), "changed values are mentioned");
}

#[test]
fn damaged_libraries_are_warnings_with_lines() {
    let text = "Kd 1 0 0\nnewmtl m\nKd 0.1 x 0.3\nKe 1 2\nmap_Kd -bm 3\nKd 0.5 0.5 0.5\nd\n";
    let (imported, mut warnings) = mtl(text);
    assert_eq!(imported.scene.materials[0].albedo, Vec3::splat(0.5), "the rest of the material counts");
    warnings.sort();
    let expected = [
        "test.mtl: 1 maps skipped: no file is named, first in line 5",
        "test.mtl: 1 statements skipped: colours are one or three numbers, first in line 4",
        "test.mtl: 1 statements skipped: they come before the first newmtl, first in line 1",
        "test.mtl: 2 statements skipped: a number is expected, first in line 3, where \"x\" is not a number",
    ];
    assert_eq!(warnings, expected);
}

#[test]
fn libraries_are_found_by_one_name_or_several_with_blanks_or_without() {
    let library = |name: &str| format!("newmtl {name}\nKd 0 1 0\n").into_bytes();
    let (a, b, c) = (library("a"), library("b 1"), library("c"));
    let cases = [
        "mtllib a.mtl my library.mtl sub\\c.mtl",
        "mtllib a.mtl\nmtllib my library.mtl\nmtllib sub/c.mtl",
        "mtllib gone.mtl a.mtl lost too.mtl my library.mtl\nmtllib ./sub/c.mtl",
    ];
    for libraries in cases {
        let faces = "usemtl a\nf 1 2 3\nusemtl  b 1  \nf 1 2 3\nusemtl c\nf 1 2 3\n";
        // Libraries may also come after the faces that use them.
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}{libraries}\n");
        let files = [("t.obj", text.as_bytes()), ("a.mtl", &a), ("my library.mtl", &b), ("sub/c.mtl", &c)];
        let (imported, warnings) = load_with_warnings(&files);
        assert!(imported.scene.materials.iter().all(|m| m.albedo == Vec3::Y), "{libraries}: {warnings:?}");
        assert_eq!(imported.scene.materials.len(), 3);
        assert_eq!(warnings.len(), usize::from(libraries.contains("gone")), "{warnings:?}");
        if let [warning] = warnings.as_slice() {
            assert!(warning.starts_with("t.obj: material library \"gone.mtl\" does not exist"), "{warning}");
            assert!(warning.ends_with("(and 2 more); going on without"), "{warning}");
        }
    }
}

#[test]
fn unknown_materials_are_half_grey_under_their_own_names() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl x\nf 1 2 3\nusemtl y\nf 1 2 3\n";
    let (imported, warnings) = load_with_warnings(&[("t.obj", text)]);
    let scene = &imported.scene;
    let names: Vec<&str> =
        scene.objects[0].faces.iter().map(|f| scene.materials[f.material.index()].name.as_str()).collect();
    assert_eq!(names, ["default", "x", "y"]);
    assert!(scene.materials.iter().all(|m| m.albedo == Material::default().albedo));
    assert_eq!(warnings, ["t.obj: half-grey stands in for materials that no library has: x, y"]);
}

#[test]
fn textures_lie_beside_their_library_and_never_outside_the_scene() {
    let red = png([255, 0, 0, 255]);
    let mtl = b"newmtl m\nmap_Kd wood.png\nmap_Ke ../../secret.png\nnorm ../ok.png\n";
    let files = folder(&[
        ("scene/t.obj", b"mtllib lib/m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"),
        ("scene/lib/m.mtl", mtl),
        ("scene/lib/wood.png", &red),
        ("scene/ok.png", &red),
        ("secret.png", &red),
    ]);
    let path = files.path().join("scene/t.obj");
    let fenced = load(&path, &ImportOptions::default()).unwrap();
    let material = &fenced.scene.materials[0];
    assert!(material.albedo_texture.is_some() && material.normal_texture.is_some());
    assert_eq!(material.emission_texture, None);
    let warning = fenced.warnings.iter().next().unwrap().to_string();
    assert!(
        warning.contains("\"../../secret.png\"") && warning.contains("--allow-outside-paths"),
        "{warning}"
    );
    let free = load(&path, &ImportOptions { paths: PathPolicy::Anywhere }).unwrap();
    assert!(free.scene.materials[0].emission_texture.is_some());
    assert!(free.warnings.is_empty());
}

#[test]
fn a_thousand_uses_of_one_image_are_one_texture() {
    let mut obj = "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    let mut mtl = String::new();
    for i in 0..1000 {
        obj += &format!("usemtl m{i}\nf 1 2 3\n");
        mtl += &format!("newmtl m{i}\nmap_Kd {}red.png\n", "./".repeat(i % 3));
    }
    let red = png([255, 0, 0, 255]);
    let (imported, warnings) =
        load_with_warnings(&[("t.obj", obj.as_bytes()), ("t.mtl", mtl.as_bytes()), ("red.png", &red)]);
    assert_eq!((imported.scene.materials.len(), imported.scene.textures.len()), (1000, 1));
    assert!(warnings.is_empty());
}

#[test]
fn a_thousand_lost_textures_do_not_make_a_thousand_lines() {
    let mut obj = "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    let mut mtl = String::new();
    for i in 0..1000 {
        obj += &format!("usemtl m{i}\nf 1 2 3\n");
        mtl += &format!("newmtl m{i}\nmap_Kd lost{i}.png\n");
    }
    let (_, warnings) = load_with_warnings(&[("t.obj", obj.as_bytes()), ("t.mtl", mtl.as_bytes())]);
    assert_eq!(warnings.len(), 101);
    assert_eq!(warnings[100], "t.obj: 900 more warnings about materials");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_damage_to_a_library_panics(
        noise in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in any::<prop::sample::Index>(),
        whole in any::<bool>(),
    ) {
        let text = "newmtl m\nKd 0.1 0.2 0.3\nKe 1 1 1\nmap_Kd -s 1 2 3 -o 1 red.png -clamp on\nnorm -bm 2 a b.png\n\
                    d 0.5\nTr 0.2\nillum 7\nmap_Ke -mm 0 1 \\\nred.png\nbump x\n";
        let mut bytes = text.as_bytes().to_vec();
        for (index, byte) in noise {
            let index = index.index(bytes.len());
            bytes[index] = byte;
        }
        if !whole {
            bytes.truncate(cut.index(bytes.len()));
        }
        let red = png([255, 0, 0, 255]);
        // What is fully transparent is dropped; the other triangle stays.
        let obj = [TRIANGLE, b"usemtl none\nf 1 2 3\n"].concat();
        let imported = try_load(&[("test.obj", &obj), ("test.mtl", &bytes), ("red.png", &red)]);
        prop_assert!(imported.unwrap().scene.build().is_ok(), "a library never stops a scene");
    }
}
