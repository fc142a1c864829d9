//! Little scenes and the pictures of them.

#![allow(dead_code, reason = "every test binary uses its own part")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use glam::{Vec2, Vec3};
use lumel_accel::BruteForce;
use lumel_basis::Lighting;
use lumel_render_cpu::{Display, Exposure, Picture, PictureError, Resolution, ToneMapper, View, draw};
use lumel_scene::{
    Camera, Face, Light, Material, MaterialId, ObjectMesh, Radiance, RectLight, Scene, SceneBuilder,
    Smoothing,
};
use std::sync::atomic::AtomicBool;

/// A rectangle with a material; corners counter-clockwise, texture coordinates as in an image seen from the front.
pub(crate) fn quad(corners: [Vec3; 4], material: u32) -> ObjectMesh {
    let face = |vertices| Face { vertices, material: MaterialId(material), smoothing: Smoothing::Flat };
    ObjectMesh {
        name: "quad".to_owned(),
        positions: corners.into(),
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.0)],
        faces: vec![face([0, 1, 2]), face([0, 2, 3])],
        ..ObjectMesh::default()
    }
}

/// A square of the plane at `z`, from `-half` to `half`, that faces +z.
pub(crate) fn square(z: f32, half: f32, material: u32) -> ObjectMesh {
    quad(
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x * half, y * half, z)),
        material,
    )
}

/// The same, facing -z.
pub(crate) fn square_from_behind(z: f32, half: f32, material: u32) -> ObjectMesh {
    quad(
        [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, y]| Vec3::new(x * half, y * half, z)),
        material,
    )
}

/// The faces of a box, looking out of it.
pub(crate) fn cube(min: Vec3, max: Vec3, material: u32) -> Vec<ObjectMesh> {
    let at = |x: bool, y: bool, z: bool| {
        Vec3::new(if x { max.x } else { min.x }, if y { max.y } else { min.y }, if z { max.z } else { min.z })
    };
    let (o, i) = (false, true);
    [
        [at(o, o, i), at(i, o, i), at(i, i, i), at(o, i, i)],
        [at(i, o, o), at(o, o, o), at(o, i, o), at(i, i, o)],
        [at(i, o, i), at(i, o, o), at(i, i, o), at(i, i, i)],
        [at(o, o, o), at(o, o, i), at(o, i, i), at(o, i, o)],
        [at(o, i, i), at(i, i, i), at(i, i, o), at(o, i, o)],
        [at(o, o, o), at(i, o, o), at(i, o, i), at(o, o, i)],
    ]
    .map(|corners| quad(corners, material))
    .into()
}

/// The same faces, looking in.
pub(crate) fn room(min: Vec3, max: Vec3, material: u32) -> Vec<ObjectMesh> {
    let mut walls = cube(min, max, material);
    for wall in &mut walls {
        wall.positions.reverse();
    }
    walls
}

pub(crate) fn grey(albedo: f32) -> Material {
    Material::diffuse("grey", Vec3::splat(albedo))
}

pub(crate) fn scene(objects: Vec<ObjectMesh>, materials: Vec<Material>) -> SceneBuilder {
    SceneBuilder { name: "test".to_owned(), objects, materials, ..SceneBuilder::default() }
}

pub(crate) fn built(builder: SceneBuilder) -> Scene {
    let (scene, warnings) = builder.build().unwrap();
    assert!(warnings.is_empty());
    scene
}

/// A rectangle light of radiance 1 that shines along `-normal` of nothing: `u × v`.
pub(crate) fn rect_light(center: Vec3, u: Vec3, v: Vec3) -> Light {
    Light::Rect(RectLight { center, u, v, radiance: Radiance::splat(1.0), texture: None })
}

/// At (0, 0, 5), looking along -z, 90° high: 5 m ahead the picture shows -5..5.
pub(crate) fn camera() -> Camera {
    Camera::looking_at("test", Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 90_f32.to_radians())
}

/// No exposure, no tone mapper: what is linear stays so.
pub(crate) fn plain() -> Display {
    Display { exposure: Exposure::Stops(0.0), tone: ToneMapper::None, ..Display::default() }
}

pub(crate) fn shoot(
    view: &View<'_>,
    camera: &Camera,
    n: u32,
    display: &Display,
) -> Result<Picture, PictureError> {
    let resolution = Resolution { samples_per_pixel: 4, ..Resolution::new(n, n) };
    draw(view, camera, &resolution, display, &AtomicBool::new(false))
}

/// An `n × n` picture through [`camera`] under some lighting, backs looked through.
pub(crate) fn picture(scene: &Scene, lighting: &dyn Lighting, n: u32, display: &Display) -> Picture {
    let tracer = BruteForce::new(scene);
    shoot(&View::new(scene, &tracer, lighting), &camera(), n, display).unwrap()
}
