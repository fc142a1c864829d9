//! Materials, lights and small scenes.

use crate::mesh::{self, Facing};
use glam::{Quat, Vec3};
use lumel_scene::{
    Light, Material, ObjectMesh, PointLight, Radiance, Radiosity, RectLight, SceneBuilder, Sides, Texture,
    TextureId, TextureRef, Wrap,
};

/// A grey one-sided material; `glow` is the radiosity it emits, W·m⁻².
pub fn grey(albedo: f32, glow: f32) -> Material {
    let mut material = Material::diffuse("grey", Vec3::splat(albedo));
    material.emission = Radiosity::splat(glow).radiance();
    material
}

/// The same with two lit sides.
pub fn two_sided(material: Material) -> Material {
    Material { sides: Sides::Both, ..material }
}

/// A scene in the making.
pub fn scene(objects: Vec<ObjectMesh>, materials: Vec<Material>, lights: Vec<Light>) -> SceneBuilder {
    SceneBuilder { name: "test".to_owned(), objects, materials, lights, ..SceneBuilder::default() }
}

/// A black square far below everything: a scene must have a surface.
pub fn backdrop() -> ObjectMesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, -1000.0));
    mesh::quad(corners, [1, 1], 0)
}

/// Lights in empty space above the black [`backdrop`].
pub fn lights_only(lights: Vec<Light>) -> SceneBuilder {
    scene(vec![backdrop()], vec![grey(0.0, 0.0)], lights)
}

/// A closed cube `[0, 1]³` whose walls −x, +x, −y, +y, −z, +z have given materials.
pub fn cube(cells: u32, walls: [Material; 6]) -> SceneBuilder {
    let meshes = mesh::cuboid(Vec3::ZERO, Vec3::ONE, cells, Facing::Inward, [0, 1, 2, 3, 4, 5]);
    scene(meshes, walls.into(), Vec::new())
}

/// A rectangle parallel to the xy plane that shines down.
pub fn ceiling_light(center: Vec3, width: f32, depth: f32, radiance: f32) -> RectLight {
    RectLight {
        center,
        u: Vec3::Y * (0.5 * depth),
        v: Vec3::X * (0.5 * width),
        radiance: Radiance::splat(radiance),
        texture: None,
    }
}

/// A point that sends `power`, W, evenly in all directions.
pub fn bulb(position: Vec3, power: f32) -> Light {
    let intensity = Vec3::splat(power / (4.0 * std::f32::consts::PI));
    Light::Point(PointLight { position, intensity, range: f32::INFINITY })
}

/// The unit sphere from inside with albedo `0.5 + 0.3 z` and emitted radiosity `1 + z`: irradiance is 2 everywhere.
pub fn varying_sphere(level: u32) -> SceneBuilder {
    let mut mesh = mesh::sphere(Vec3::ZERO, 1.0, level, Facing::Inward, 0);
    mesh.tints = mesh.positions.iter().map(|p| Vec3::splat((0.5 + 0.3 * p.z) / 0.8)).collect();
    // Look-up is linear between the centres of the two texels, at 1/4 and 3/4.
    mesh.uvs = mesh.positions.iter().map(|p| glam::Vec2::new(0.5, 0.5 - 0.25 * p.z)).collect();
    let mut ramp = Texture::from_floats("ramp", 1, 2, vec![[2.0; 3], [0.0; 3]]).expect("two texels");
    ramp.wrap_v = Wrap::Clamp;
    let mut material = grey(0.8, 1.0);
    material.emission_texture = Some(TextureRef::plain(TextureId(0)));
    SceneBuilder { textures: vec![ramp], ..scene(vec![mesh], vec![material], Vec::new()) }
}

/// The scene turned about its origin, then moved.
#[must_use]
pub fn placed(mut builder: SceneBuilder, turn: Quat, shift: Vec3) -> SceneBuilder {
    let place = |p: &mut Vec3| *p = turn * *p + shift;
    let turned = |v: &mut Vec3| *v = turn * *v;
    for object in &mut builder.objects {
        object.positions.iter_mut().for_each(place);
        object.normals.iter_mut().for_each(turned);
    }
    for light in &mut builder.lights {
        match light {
            Light::Rect(rect) => {
                place(&mut rect.center);
                [&mut rect.u, &mut rect.v].into_iter().for_each(turned);
            }
            Light::Point(point) => place(&mut point.position),
            Light::Spot(spot) => {
                place(&mut spot.point.position);
                turned(&mut spot.direction);
            }
            Light::Directional(sun) => turned(&mut sun.direction),
            Light::Sun(sun) => turned(&mut sun.parallel.direction),
            Light::Disk(disk) => {
                place(&mut disk.center);
                turned(&mut disk.direction);
            }
            Light::Sphere(sphere) => place(&mut sphere.center),
        }
    }
    builder
}

/// The scene `factor` times as large, with the same light: points and spots send its square as much.
#[must_use]
pub fn scaled(mut builder: SceneBuilder, factor: f32) -> SceneBuilder {
    let lengthened = |p: &mut Vec3| *p *= factor;
    builder.objects.iter_mut().flat_map(|object| &mut object.positions).for_each(lengthened);
    let brighten = |point: &mut PointLight| {
        point.position *= factor;
        point.range *= factor;
        point.intensity *= factor * factor;
    };
    for light in &mut builder.lights {
        match light {
            Light::Rect(rect) => {
                [&mut rect.center, &mut rect.u, &mut rect.v].into_iter().for_each(lengthened)
            }
            Light::Point(point) => brighten(point),
            Light::Spot(spot) => brighten(&mut spot.point),
            Light::Directional(_) | Light::Sun(_) => {}
            Light::Disk(disk) => {
                disk.center *= factor;
                disk.radius *= factor;
            }
            Light::Sphere(sphere) => {
                sphere.center *= factor;
                sphere.radius *= factor;
            }
        }
    }
    builder
}

/// The scene with its objects and faces the other way round, and each face beginning with another corner.
#[must_use]
pub fn reordered(mut builder: SceneBuilder) -> SceneBuilder {
    builder.objects.reverse();
    for object in &mut builder.objects {
        object.faces.reverse();
        object.faces.iter_mut().for_each(|face| face.vertices.rotate_left(1));
    }
    builder
}
