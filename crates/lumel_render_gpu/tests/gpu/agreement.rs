//! The device draws what the CPU draws.

use crate::common::{Subject, Uploaded, differences, keep, looks, radiance, renderer, share_beyond};
use crate::scenes;
use glam::Vec3;
use lumel_render_cpu::{Picture, ToneMapper};
use lumel_render_gpu::{Look, Samples};
use lumel_scene::{Camera, Irradiance, Radiance, Sky, SkyGradient, SkyImage, SurfacePoint, Texture};

/// Of the pixels; the rest are those whose centre lies on an edge.
const EXCEPTIONS: f64 = 0.005;

pub(crate) fn assert_same(device: &Picture, cpu: &Picture, what: &str) {
    let share = share_beyond(device, cpu, 1);
    let worst = differences(device, cpu).into_iter().max().unwrap_or(0);
    println!("{what}: {:.3} % beyond 1/255, worst {worst}", 100.0 * share);
    if share > EXCEPTIONS {
        keep("agreement device", device);
        keep("agreement cpu", cpu);
        panic!("{what}: {:.2} % of the pixels differ by more than 1/255", 100.0 * share);
    }
}

fn agrees(subject: &Subject, looks: &[Look]) {
    let Some(renderer) = renderer() else { return };
    let uploaded = subject.on(renderer);
    let size = [173, 120];
    for &look in looks {
        let device = uploaded.show(size, Samples::One, look);
        assert_same(&device, &subject.traced(size, look), &format!("{} {look:?}", subject.scene.name()));
    }
}

#[test]
fn the_cornell_box_looks_as_on_the_cpu() {
    agrees(scenes::cornell(), &looks(0.5, [0.05, 8.0]));
}

#[test]
fn textures_and_normal_maps_look_as_on_the_cpu() {
    agrees(&scenes::leather(), &looks(-0.5, [0.1, 6.0]));
}

#[test]
fn all_that_a_scene_can_have_looks_as_on_the_cpu() {
    agrees(&scenes::everything(), &looks(0.25, [0.2, 7.0]));
}

#[test]
fn skies_look_as_on_the_cpu() {
    for subject in [scenes::everything(), scenes::far_open_box()] {
        skies_agree(&subject);
    }
}

fn skies_agree(subject: &Subject) {
    let texels: Vec<[f32; 3]> = (0..64 * 32)
        .map(|i| [(i % 64) as f32 / 32.0, (i / 64) as f32 / 16.0, (i % 7) as f32 / 7.0])
        .collect();
    let texture = Texture::from_floats("sky", 64, 32, texels).unwrap();
    let image = SkyImage::new(texture, 100.0, 0.7);
    let gradient = SkyGradient {
        zenith: Radiance(Vec3::new(0.1, 0.4, 1.5)),
        horizon: Radiance::splat(0.9),
        ground: Radiance(Vec3::new(0.3, 0.2, 0.1)),
    };
    let skies = [gradient.into(), image.with(-0.4, 2.0).into(), image.into()];
    let size = [173, 120];
    let mut shown: Option<Uploaded<'_>> = None;
    let subjects = skies.map(|sky: Sky| {
        let scene = subject.scene.under_sky(sky).unwrap();
        Subject { light: subject.light.clone(), scene, camera: subject.camera.clone() }
    });
    for subject in &subjects {
        for tilt in [0.0, 0.9] {
            let forward = (subject.camera.forward + Vec3::Y * tilt).normalize();
            let camera = Camera { forward, ..subject.camera.clone() };
            let subject = Subject { light: subject.light.clone(), scene: subject.scene.clone(), camera };
            agrees(&subject, &[radiance(-0.3, ToneMapper::Agx)]);
        }
        // What another sky has left is changed.
        let Some(renderer) = renderer() else { return };
        let before = shown.take().and_then(|shown| shown.backdrop);
        let mut uploaded = subject.on(renderer);
        uploaded.backdrop = renderer.backdrop(subject.scene.sky(), before).unwrap();
        let look = radiance(0.0, ToneMapper::None);
        assert_same(&uploaded.show(size, Samples::One, look), &subject.traced(size, look), "a changed sky");
        shown = Some(uploaded);
    }
}

#[test]
fn bright_and_dim_light_look_as_on_the_cpu() {
    let subject = scenes::everything();
    // Numbers that 16 bits cannot hold without the exposure.
    for (power, stops) in [(1e-9_f32, 30.0), (1e9, -30.0)] {
        let light = subject.light.iter().map(|e| *e * power).collect();
        let subject = Subject { light, scene: subject.scene.clone(), camera: subject.camera.clone() };
        agrees(&subject, &[crate::common::irradiance(stops)]);
        let range = [0.2 * power, 7.0 * power];
        agrees(&subject, &[Look::FalseColor { range, scale: lumel_render_cpu::Scale::Log }]);
    }
}

#[test]
fn light_of_any_kind_is_drawn_as_it_is_at_the_vertices() {
    let Some(renderer) = renderer() else { return };
    let mut subject = scenes::everything();
    let (scene, look, size) = (subject.scene.clone(), crate::common::irradiance(0.0), [173, 120]);
    let rings = |position: Vec3, normal: Vec3| {
        Vec3::splat(2.0 + (9.0 * position.length()).sin()) * (1.5 + 0.5 * normal)
    };
    let lighting = |at: SurfacePoint, normal: Vec3| Irradiance(rings(scene.position(at), normal));
    let vertices = scene.positions().iter().zip(scene.normals());
    subject.light = vertices.map(|(position, normal)| rings(*position, *normal)).collect();
    let uploaded = subject.on(renderer);
    let stored = uploaded.show(size, Samples::One, look);
    renderer.set_light(&uploaded.light, &scene, &|_: SurfacePoint, _: Vec3| Irradiance::ZERO).unwrap();
    renderer.set_light(&uploaded.light, &scene, &lighting).unwrap();
    let sampled = uploaded.show(size, Samples::One, look);
    assert_eq!(sampled, stored);
    assert_same(&sampled, &subject.traced(size, look), "light at the vertices");
    // What lies between the vertices is seen by the CPU alone.
    let exact = subject.traced_under(&lighting, size, look);
    assert!(share_beyond(&sampled, &exact, 8) > 0.1);
}
