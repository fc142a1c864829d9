//! Pictures of a built-in scene in every way of showing it, under light that is only roughly right.
//!
//! `cargo run -p lumel_render_cpu --example gallery -- FOLDER [SCENE]`

use glam::Vec3;
use lumel_accel::{Bvh, Ray, RayTracer};
use lumel_basis::VertexLighting;
use lumel_render_cpu::{
    Display, FalseColor, Legend, Picture, Resolution, Scale, Show, ToneMapper, View, camera_for, draw,
};
use lumel_scene::{Camera, Light, Scene, SunLight};
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let folder = args.next().ok_or("usage: gallery FOLDER [SCENE]")?;
    let name = args.next().unwrap_or_else(|| "cornell-box".to_owned());
    let (scene, _) = lumel_builtin::scene(&name, 0).ok_or("no such scene")?.build()?;
    let bvh = Bvh::build(&scene);
    let values = rough_light(&scene, &bvh);
    let light = VertexLighting::new(&scene, &values)?;
    let view = View::new(&scene, &bvh, &light);
    let save =
        |what: &str, picture: &Picture| save(&Path::new(&folder).join(format!("{name}-{what}.png")), picture);
    let shot = |camera: &Camera, display: &Display| {
        draw(&view, camera, &Resolution::new(480, 480), display, &AtomicBool::new(false))
    };

    let camera = camera_for(&scene, &bvh, 1.0);
    let shows =
        Show::ALL.iter().map(|&show| Ok(shot(&camera, &Display::of(show))?.labelled(&show.to_string())));
    save("shows", &Picture::beside(&shows.collect::<Result<Vec<_>, Box<dyn Error>>>()?)?)?;

    let tones = ToneMapper::ALL.iter().map(|&tone| {
        let picture = shot(&camera, &Display { tone, ..Display::default() })?;
        let stops = picture.stops().unwrap_or_default();
        Ok(picture.labelled(&format!("{tone}: {stops:+} stops")))
    });
    save("tones", &Picture::beside(&tones.collect::<Result<Vec<_>, Box<dyn Error>>>()?)?)?;

    let scales = [Legend::Drawn, Legend::Hidden].map(|legend| {
        let false_color = FalseColor { scale: Scale::Log, legend, ..FalseColor::default() };
        shot(&camera, &Display { false_color, ..Display::of(Show::FalseColor) })
    });
    save("log", &Picture::beside(&scales.into_iter().collect::<Result<Vec<_>, _>>()?)?)?;

    let mut bare = lumel_builtin::scene(&name, 0).ok_or("no such scene")?;
    bare.cameras.clear();
    let found = camera_for(&bare.build()?.0, &bvh, 1.0);
    save("automatic", &shot(&found, &Display::default())?)?;
    Ok(())
}

/// Direct light of rectangles and points and a bit of everything else.
fn rough_light(scene: &Scene, tracer: &dyn RayTracer) -> Vec<Vec3> {
    const SIDE: u32 = 6;
    let at_vertex = |(position, normal): (&Vec3, &Vec3)| {
        let origin = scene.ray_origin_at(position.as_dvec3(), *normal);
        let mut irradiance = Vec3::splat(0.25) * (1.2 + 0.8 * normal.y);
        let mut add = |from: Vec3, strength: &dyn Fn(Vec3) -> Vec3| {
            if !tracer.occluded(&Ray::between(origin, from)) {
                irradiance +=
                    strength(from - origin) * normal.dot((from - origin).normalize_or_zero()).max(0.0);
            }
        };
        for light in scene.lights() {
            match light {
                Light::Rect(light) => {
                    let share = light.area() / (SIDE * SIDE) as f32;
                    for i in 0..SIDE * SIDE {
                        let u = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
                        add(light.point(u), &|d| {
                            let out = -d.normalize_or_zero().dot(light.normal().unwrap_or(Vec3::Y));
                            light.radiance.0 * (share * out.max(0.0) / d.length_squared())
                        });
                    }
                }
                Light::Point(light) => add(light.position, &|d| light.normal_irradiance(d.length())),
                Light::Spot(light) => add(light.point.position, &|d| {
                    light.point.normal_irradiance(d.length()) * light.falloff(-d.normalize_or_zero())
                }),
                Light::Sun(SunLight { parallel: light, .. }) | Light::Directional(light) => {
                    let far = origin - light.direction * scene.bounds().diagonal();
                    add(far, &|_| light.irradiance);
                }
                // As points; what this example draws has none.
                Light::Disk(light) => add(light.center, &|d| {
                    let out = -d.normalize_or_zero().dot(light.direction);
                    light.radiance.0 * (light.area() * out.max(0.0) / d.length_squared())
                }),
                Light::Sphere(light) => add(light.center, &|d| light.intensity() / d.length_squared()),
            }
        }
        irradiance
    };
    scene.positions().iter().zip(scene.normals()).map(at_vertex).collect()
}

fn save(path: &Path, picture: &Picture) -> Result<(), Box<dyn Error>> {
    let bytes = picture.pixels().as_flattened();
    image::save_buffer(path, bytes, picture.width(), picture.height(), image::ColorType::Rgb8)?;
    Ok(())
}
