//! Small scenes.

use glam::{Vec2, Vec3};
use lumel_basis::Lighting;
use lumel_scene::{
    Encoding, Face, Irradiance, Material, MaterialId, ObjectMesh, Radiance, Scene, SceneBuilder, Sides,
    Smoothing, SurfacePoint, Texture, TextureId, TextureRef, UvTransform, Wrap,
};

/// A unit square at height `y` that faces up, its two triangles with a material each.
fn square(name: &str, y: f32, materials: [u32; 2]) -> ObjectMesh {
    let face =
        |vertices, material| Face { vertices, material: MaterialId(material), smoothing: Smoothing::Crease };
    ObjectMesh {
        name: name.to_owned(),
        positions: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, z]| Vec3::new(x, y, z)).to_vec(),
        uvs: vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X],
        faces: vec![face([0, 1, 2], materials[0]), face([0, 2, 3], materials[1])],
        ..ObjectMesh::default()
    }
}

/// One grey square: four vertices.
pub(crate) fn plain(name: &str) -> Scene {
    let builder = SceneBuilder {
        name: name.to_owned(),
        objects: vec![square("floor", 0.0, [0, 0])],
        materials: vec![Material::diffuse("grey", Vec3::splat(0.5))],
        ..SceneBuilder::default()
    };
    builder.build().unwrap().0
}

/// A square of two triangles with a material each.
pub(crate) fn textured_square(materials: Vec<Material>, textures: Vec<Texture>) -> Scene {
    let objects = vec![square("square", 0.0, [0, 1])];
    SceneBuilder { objects, materials, textures, ..SceneBuilder::default() }.build().unwrap().0
}

/// Squares with all that materials can have: two sides, two materials at one vertex, textures of every kind, tints and
/// lamps, and a material that nothing uses.
pub(crate) fn colourful() -> Scene {
    let bytes = vec![[255, 0, 0, 255], [0, 255, 0, 128], [10, 20, 30, 0], [188, 188, 188, 255]];
    let mut srgb = Texture::from_bytes("tiles", 2, 2, bytes.clone(), Encoding::Srgb).unwrap();
    srgb.wrap_u = Wrap::Mirror;
    let mut linear = Texture::from_bytes("linear", 4, 1, bytes, Encoding::Linear).unwrap();
    linear.wrap_v = Wrap::Clamp;
    let glow = Texture::from_floats("glow", 3, 1, vec![[0.5; 3], [4.0, 2.0, 1.0], [0.0; 3]]).unwrap();
    let with_texture = |name, texture| Material {
        albedo_texture: Some(TextureRef::plain(TextureId(texture))),
        ..Material::diffuse(name, Vec3::new(0.9, 0.8, 0.7))
    };
    let mut moved = with_texture("moved", 1);
    moved.albedo_texture = Some(TextureRef {
        texture: TextureId(1),
        transform: UvTransform { offset: Vec2::new(0.25, 0.5), rotation: 0.3, scale: Vec2::new(2.0, 3.0) },
    });
    let materials = vec![
        Material { sides: Sides::Both, ..Material::diffuse("red \"wall\"", Vec3::new(0.6, 0.05, 0.05)) },
        Material::diffuse("unused", Vec3::ONE),
        Material::diffuse("black", Vec3::ZERO),
        with_texture("tiles", 0),
        moved,
        Material {
            emission: Radiance(Vec3::new(15.0, 10.0, 5.0)),
            ..Material::diffuse("lamp", Vec3::splat(0.8))
        },
        Material {
            emission: Radiance::splat(2.0),
            emission_texture: Some(TextureRef::plain(TextureId(2))),
            ..Material::diffuse("screen", Vec3::ZERO)
        },
    ];
    let mut tinted = square("tinted", 4.0, [2, 0]);
    tinted.tints = vec![Vec3::ONE, Vec3::new(1.0, 0.5, 0.0), Vec3::ONE, Vec3::splat(0.25)];
    let builder = SceneBuilder {
        name: "bunte Räume\n".into(),
        objects: vec![
            square("shared", 0.0, [0, 2]),
            square("textured", 1.0, [3, 4]),
            square("lamp", 2.0, [5, 5]),
            square("screen", 3.0, [6, 3]),
            tinted,
        ],
        materials,
        textures: vec![srgb, linear, glow],
        ..SceneBuilder::default()
    };
    builder.build().unwrap().0
}

/// Different light at every vertex, in a smooth range with one bright spot.
pub(crate) fn light_on(scene: &Scene) -> Vec<Vec3> {
    let value = |vertex: usize| if vertex == 1 { 400.0 } else { 0.5 + (vertex % 7) as f32 };
    (0..scene.vertex_count()).map(|v| value(v) * Vec3::new(1.0, 0.75, 0.5)).collect()
}

/// Light at vertices, whether or not it fits a scene; nothing reads it elsewhere.
pub(crate) struct AtVertices(pub(crate) Vec<Vec3>);

impl Lighting for AtVertices {
    fn irradiance(&self, at: SurfacePoint, _normal: Vec3) -> Irradiance {
        panic!("{at:?} is read")
    }

    fn vertex_values(&self) -> Option<&[Vec3]> {
        Some(&self.0)
    }
}
