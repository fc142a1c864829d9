//! The contents of a scene, as text and as JSON.

mod edges;
mod text;

use crate::load::Auto;
use edges::EdgeReport;
use glam::Vec3;
use lumel::{Emitter, Light, LightLayer, Scene, Settings, Sky, light_layers};
use lumel_scene::{
    AlphaMode, Barycentrics, Material, MaterialId, Sides, SurfacePoint, TextureRef, Transparency, TriId,
};
use serde::Serialize;

/// The contents of a scene. Lengths in metres, light in W and W·m⁻²·sr⁻¹ (lumen and nits if it is photometric).
#[derive(Debug, Serialize)]
pub(crate) struct SceneReport {
    name: String,
    triangles: Triangles,
    vertices: usize,
    edges: EdgeReport,
    /// What `--max-edge auto` would make of it, where nothing else is asked for.
    auto: Option<AutoReport>,
    objects: Vec<String>,
    materials: Vec<MaterialReport>,
    /// In world space.
    bounds: [[f64; 3]; 2],
    size: [f32; 3],
    /// Area of all lit sides, m².
    area: f64,
    lights: Vec<LightReport>,
    /// What `--layers lights` tells apart, for `render --light NAME`.
    layers: Vec<LayerReport>,
    emissive: Emissive,
    /// The mean over all directions.
    sky: [f32; 3],
    sky_kind: &'static str,
    cameras: Vec<CameraReport>,
    warnings: Vec<String>,
}

/// How many triangles.
#[derive(Debug, Serialize)]
struct Triangles {
    total: usize,
    /// Those that rays can hit.
    traced: usize,
    /// Back faces of two-sided triangles.
    back_sides: usize,
    /// Those that rays can hit and light passes through.
    transparent: usize,
}

#[derive(Debug, Serialize)]
struct AutoReport {
    /// Null if the mesh would stay as it is.
    max_edge: Option<f32>,
    vertices: usize,
}

#[derive(Debug, Serialize)]
struct MaterialReport {
    name: String,
    /// Before textures.
    albedo: [f32; 3],
    /// Radiance before textures.
    emission: [f32; 3],
    /// "front", "both", or "shape": what it is used for has one side or two by its shape.
    sides: &'static str,
    /// How many of the triangles are back faces.
    back_sides: usize,
    /// What lets light through: "mask", "blend", "transmission".
    transparency: Vec<&'static str>,
    textures: Vec<TextureReport>,
    triangles: usize,
    area: f64,
}

#[derive(Debug, Serialize)]
struct TextureReport {
    role: &'static str,
    name: String,
    size: [u32; 2],
}

#[derive(Debug, Serialize)]
struct LightReport {
    name: String,
    #[serde(flatten)]
    kind: LightKind,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum LightKind {
    Rect { center: [f64; 3], size: [f32; 2], normal: [f32; 3], radiance: [f32; 3], power: [f32; 3] },
    Point { position: [f64; 3], intensity: [f32; 3], power: [f32; 3] },
    Spot { position: [f64; 3], direction: [f32; 3], intensity: [f32; 3], outer_angle_deg: f32 },
    Directional { direction: [f32; 3], irradiance: [f32; 3] },
    Sun { direction: [f32; 3], irradiance: [f32; 3], angle_deg: f32 },
    Disk { center: [f64; 3], radius: f32, normal: [f32; 3], radiance: [f32; 3], power: [f32; 3] },
    Sphere { center: [f64; 3], radius: f32, radiance: [f32; 3], power: [f32; 3] },
}

/// Emitters that share a name.
#[derive(Debug, Serialize)]
struct LayerReport {
    name: String,
    /// Lights and emissive materials that make it; the sky counts as a light.
    lights: usize,
    materials: usize,
}

/// Emissive surfaces.
#[derive(Debug, Serialize)]
struct Emissive {
    triangles: usize,
    area: f64,
    power: [f64; 3],
}

#[derive(Debug, Serialize)]
struct CameraReport {
    name: String,
    position: [f64; 3],
    forward: [f32; 3],
    fov_deg: f32,
}

impl SceneReport {
    /// Describes a scene.
    pub(crate) fn new(scene: &Scene, auto: Option<&Auto>, warnings: Vec<String>) -> Self {
        let tris = || (0..scene.triangle_count() as u32).map(TriId);
        let bounds = scene.bounds();
        let traced = tris().filter(|&tri| scene.traced(tri) == tri).count();
        Self {
            name: scene.name().to_owned(),
            triangles: Triangles {
                total: scene.triangle_count(),
                traced,
                back_sides: scene.triangle_count() - traced,
                transparent: scene.transparent_count(),
            },
            vertices: scene.vertex_count(),
            edges: EdgeReport::of(scene),
            auto: auto.map(|&Auto { max_edge, vertices }| AutoReport { max_edge, vertices }),
            objects: scene.object_names().to_vec(),
            materials: materials(scene),
            bounds: [bounds.min, bounds.max].map(|corner| world(scene, corner)),
            size: (bounds.max - bounds.min).to_array(),
            area: tris().map(|tri| f64::from(scene.area(tri))).sum(),
            lights: scene
                .lights()
                .iter()
                .zip(scene.light_names())
                .map(|light| light_report(scene, light))
                .collect(),
            layers: light_layers(scene, &Settings::default()).iter().map(layer).collect(),
            emissive: Emissive::of(scene),
            sky: scene.sky().mean().0.to_array(),
            sky_kind: match scene.sky() {
                Sky::Uniform(_) => "uniform",
                Sky::Gradient(_) => "gradient",
                Sky::Image(_) => "image",
            },
            cameras: scene.cameras().iter().map(|camera| camera_report(scene, camera)).collect(),
            warnings,
        }
    }

    /// What had to be left out.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

fn materials(scene: &Scene) -> Vec<MaterialReport> {
    let mut reports: Vec<MaterialReport> = scene
        .materials()
        .iter()
        .map(|material| {
            let texture = |role, texture: Option<TextureRef>| {
                let texture = &scene.textures()[texture?.texture.index()];
                let (width, height) = texture.size();
                Some(TextureReport { role, name: texture.name.clone(), size: [width, height] })
            };
            let textures = [
                texture("albedo", material.albedo_texture),
                texture("emission", material.emission_texture),
                texture("normal", material.normal_texture.map(|map| map.image)),
            ];
            MaterialReport {
                name: material.name.clone(),
                albedo: material.albedo.to_array(),
                emission: material.emission.0.to_array(),
                sides: match material.sides {
                    Sides::Front => "front",
                    Sides::Both => "both",
                    Sides::Shape => "shape",
                },
                back_sides: 0,
                transparency: transparency(material),
                textures: textures.into_iter().flatten().collect(),
                triangles: 0,
                area: 0.0,
            }
        })
        .collect();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let MaterialId(id) = scene.material_id(tri);
        let report = &mut reports[id as usize];
        report.triangles += 1;
        report.back_sides += usize::from(scene.traced(tri) != tri);
        report.area += f64::from(scene.area(tri));
    }
    reports
}

fn transparency(material: &Material) -> Vec<&'static str> {
    let Transparency { mode, transmission, .. } = material.transparency;
    let alpha = match mode {
        AlphaMode::Opaque => None,
        AlphaMode::Mask { .. } => Some("mask"),
        AlphaMode::Blend => Some("blend"),
    };
    let transmits = (transmission != lumel::Vec3::ZERO).then_some("transmission");
    alpha.into_iter().chain(transmits).collect()
}

impl Emissive {
    fn of(scene: &Scene) -> Self {
        let mut all = Self { triangles: 0, area: 0.0, power: [0.0; 3] };
        for tri in (0..scene.triangle_count() as u32).map(TriId).filter(|&tri| scene.material(tri).emits()) {
            let middle = SurfacePoint { tri, bary: Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 } };
            all.triangles += 1;
            all.area += f64::from(scene.area(tri));
            let emission = if scene.is_transparent(tri) {
                lumel_scene::Radiance(scene.emission(middle).0 * scene.opacity(middle))
            } else {
                scene.emission(middle)
            };
            let power = emission.power(scene.area(tri));
            for (sum, channel) in all.power.iter_mut().zip(power.to_array()) {
                *sum += f64::from(channel);
            }
        }
        all
    }
}

fn layer(layer: &LightLayer) -> LayerReport {
    let materials = layer.emitters.iter().filter(|emitter| matches!(emitter, Emitter::Surfaces(_))).count();
    LayerReport { name: layer.name.clone(), lights: layer.emitters.len() - materials, materials }
}

/// A point of the scene in world space; as it is written where it is the same.
fn world(scene: &Scene, local: Vec3) -> [f64; 3] {
    (scene.origin() + lumel::decimal(local)).to_array()
}

fn light_report(scene: &Scene, (light, name): (&Light, &String)) -> LightReport {
    LightReport { name: name.clone(), kind: kind(scene, light) }
}

fn kind(scene: &Scene, light: &Light) -> LightKind {
    match light {
        Light::Rect(rect) => LightKind::Rect {
            center: world(scene, rect.center),
            size: [2.0 * rect.u.length(), 2.0 * rect.v.length()],
            normal: rect.normal().unwrap_or_default().to_array(),
            radiance: rect.radiance.0.to_array(),
            power: rect.radiance.power(rect.area()).to_array(),
        },
        Light::Point(point) => LightKind::Point {
            position: world(scene, point.position),
            intensity: point.intensity.to_array(),
            power: lumel_scene::Radiance(4.0 * point.intensity).radiosity().0.to_array(),
        },
        Light::Spot(spot) => LightKind::Spot {
            position: world(scene, spot.point.position),
            direction: spot.direction.to_array(),
            intensity: spot.point.intensity.to_array(),
            outer_angle_deg: spot.cos_outer.acos().to_degrees(),
        },
        Light::Directional(sun) => LightKind::Directional {
            direction: sun.direction.to_array(),
            irradiance: sun.irradiance.to_array(),
        },
        Light::Sun(sun) => LightKind::Sun {
            direction: sun.parallel.direction.to_array(),
            irradiance: sun.parallel.irradiance.to_array(),
            angle_deg: 2.0 * sun.sin_half_angle.asin().to_degrees(),
        },
        Light::Disk(disk) => LightKind::Disk {
            center: world(scene, disk.center),
            radius: disk.radius,
            normal: disk.direction.to_array(),
            radiance: disk.radiance.0.to_array(),
            power: disk.radiance.power(disk.area()).to_array(),
        },
        Light::Sphere(sphere) => LightKind::Sphere {
            center: world(scene, sphere.center),
            radius: sphere.radius,
            radiance: sphere.radiance.0.to_array(),
            power: sphere.radiance.power(sphere.area()).to_array(),
        },
    }
}

fn camera_report(scene: &Scene, camera: &lumel::Camera) -> CameraReport {
    CameraReport {
        name: camera.name.clone(),
        position: world(scene, camera.position),
        forward: camera.forward.normalize_or_zero().to_array(),
        fov_deg: camera.fov_y.to_degrees(),
    }
}
