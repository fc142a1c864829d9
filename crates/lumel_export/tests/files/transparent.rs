//! What light passes through is written so that it is read back.

use crate::scenes::{AtVertices, light_on};
use glam::{Vec2, Vec3};
use lumel_export::{ColorScale, write_glb, write_obj};
use lumel_import::{ImportOptions, load};
use lumel_scene::{
    AlphaMode, Encoding, Face, Material, MaterialId, ObjectMesh, Scene, SceneBuilder, Smoothing,
    SurfacePoint, Texture, TextureId, TextureRef, Transparency, TriId,
};
use std::path::Path;

/// Squares side by side: one half there, one with holes, one whose alpha is in a texture of its own.
pub(crate) fn cards() -> Scene {
    let rgba = |alpha: [u8; 2]| alpha.map(|alpha| [200, 100, 50, alpha]).to_vec();
    let texture = |name, alpha| Texture::from_bytes(name, 2, 1, rgba(alpha), Encoding::Srgb).unwrap();
    let map = |index| Some(TextureRef::plain(TextureId(index)));
    let mask =
        Transparency { mode: AlphaMode::Mask { cutoff: 0.5 }, texture: map(0), ..Transparency::default() };
    let blend = Transparency { texture: map(1), ..Transparency::blend(0.5) };
    let material = |name, transparency, albedo_texture| Material {
        transparency,
        albedo_texture,
        ..Material::diffuse(name, Vec3::splat(0.5))
    };
    let face =
        |material, vertices| Face { vertices, material: MaterialId(material), smoothing: Smoothing::Flat };
    let card = |i: u8| ObjectMesh {
        name: format!("card {i}"),
        positions: [[0.0, 0.0], [0.9, 0.0], [0.9, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(x + f32::from(i), y, 0.0))
            .to_vec(),
        uvs: [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(Vec2::from).to_vec(),
        faces: vec![face(u32::from(i), [0, 1, 2]), face(u32::from(i), [0, 2, 3])],
        ..ObjectMesh::default()
    };
    let builder = SceneBuilder {
        objects: (0..3).map(card).collect(),
        materials: vec![
            material("half", Transparency::blend(0.5), None),
            material("holes", mask, map(0)),
            material("veil", blend, map(0)),
        ],
        textures: vec![texture("leaf", [255, 0]), texture("veil", [255, 51])],
        ..SceneBuilder::new("cards")
    };
    builder.build().unwrap().0
}

/// Transmittance left and right of the middle of each card.
fn passed(scene: &Scene) -> Vec<f32> {
    let at = |tri, bary: [f32; 2]| SurfacePoint { tri: TriId(tri), bary: bary.into() };
    // Corners 0, 1 and 2 are lower left, lower right and upper right; texels have their centres at 1/4 and 3/4.
    let places = |card: u32| [at(2 * card, [0.75, 0.15]), at(2 * card, [0.25, 0.4])];
    (0..3).flat_map(places).map(|at| scene.transmittance(at).x).collect()
}

fn read(path: &Path) -> Scene {
    load(path, &ImportOptions::default()).unwrap().scene.build().unwrap().0
}

#[test]
fn alpha_comes_back_from_every_mesh_file() {
    let scene = cards();
    let expected = [0.5, 0.5, 0.0, 1.0, 0.5, 0.9];
    let close = |found: Vec<f32>| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01);
    assert!(close(passed(&scene)), "{:?}", passed(&scene));
    let folder = tempfile::tempdir().unwrap();
    let light = AtVertices(light_on(&scene));
    let (obj, glb) = (folder.path().join("a.obj"), folder.path().join("a.glb"));
    write_obj(&obj, &scene, &light, ColorScale::Auto).unwrap();
    write_glb(&glb, &scene, &light, ColorScale::Auto).unwrap();
    assert!(close(passed(&read(&obj))), "{:?}", passed(&read(&obj)));
    // Alpha that is not in the image of the colour is left out of a GLB.
    let from_glb = passed(&read(&glb));
    assert_eq!(from_glb[..5], [0.5, 0.5, 0.0, 1.0, 0.5]);
    let modes: Vec<AlphaMode> =
        read(&folder.path().join("a.glb")).materials().iter().map(|m| m.transparency.mode).collect();
    assert_eq!(modes, [AlphaMode::Blend, AlphaMode::Mask { cutoff: 0.5 }, AlphaMode::Blend]);
}

#[test]
fn alpha_of_vertices_comes_back_from_glb() {
    let card = ObjectMesh {
        positions: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec(),
        alphas: vec![0.25, 0.75, 0.75, 0.25],
        faces: [[0, 1, 2], [0, 2, 3]]
            .map(|vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Flat })
            .to_vec(),
        ..ObjectMesh::default()
    };
    let sides = lumel_scene::Sides::Both;
    let veil = Material { transparency: Transparency::blend(1.0), sides, ..Material::default() };
    let builder = SceneBuilder { objects: vec![card], materials: vec![veil], ..SceneBuilder::new("veil") };
    let scene = builder.build().unwrap().0;
    let folder = tempfile::tempdir().unwrap();
    let glb = folder.path().join("a.glb");
    write_glb(&glb, &scene, &AtVertices(light_on(&scene)), ColorScale::Auto).unwrap();
    let read = read(&glb);
    let alphas = |scene: &Scene| -> Vec<(f32, f32)> {
        let mut all: Vec<_> =
            scene.positions().iter().map(|p| p.x).zip(scene.alphas().iter().copied()).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    };
    assert_eq!(alphas(&read).len(), 8, "front and back");
    assert_eq!(alphas(&read), alphas(&scene));
    assert!(read.tints().iter().all(|&tint| tint == Vec3::ONE), "light is no albedo");
}
