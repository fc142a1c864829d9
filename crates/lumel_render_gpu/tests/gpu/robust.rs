//! Odd sizes, wrong light, numbers that are none, cameras without a view.

use crate::common::{irradiance, looks, radiance, renderer};
use crate::scenes;
use glam::Vec3;
use lumel_basis::VertexCountError;
use lumel_render_cpu::ToneMapper;
use lumel_render_gpu::{Frame, Look, RenderError, Samples};
use lumel_scene::{Camera, Irradiance, Radiance, SurfacePoint};

const SIZE: [u32; 2] = [64, 48];

#[test]
fn light_must_be_that_of_the_model() {
    let Some(renderer) = renderer() else { return };
    let (subject, other) = (scenes::everything(), scenes::cornell());
    let uploaded = subject.on(renderer);
    let (values, vertices) = (other.scene.vertex_count(), subject.scene.vertex_count());
    for scene in [&subject.scene, &other.scene] {
        let error = renderer.set_light(&uploaded.light, scene, &other.lighting()).unwrap_err();
        let expected = VertexCountError { values, vertices };
        assert!(matches!(error, RenderError::Light(error) if error == expected), "{error}");
    }
}

#[test]
fn new_light_is_dark() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let light = renderer.light(&uploaded.model);
    let frame =
        Frame { light: lumel_render_gpu::Lit::One((&light).into()), ..uploaded.frame(irradiance(8.0)) };
    assert!(uploaded.draw(SIZE, Samples::One, &frame).pixels().iter().all(|p| *p == [0; 3]));
}

#[test]
fn light_of_another_model_shows_the_background_only() {
    let Some(renderer) = renderer() else { return };
    let (subject, other) = (scenes::everything(), scenes::cornell());
    let (uploaded, other) = (subject.on(renderer), other.on(renderer));
    let frame =
        Frame { light: lumel_render_gpu::Lit::One((&other.light).into()), ..uploaded.frame(Look::Albedo) };
    assert!(uploaded.draw(SIZE, Samples::One, &frame).pixels().iter().all(|p| *p == [0; 3]));
}

#[test]
fn pictures_of_odd_sizes_can_be_drawn() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    for size in [[1, 1], [1, 2000], [2000, 1], [63, 65]] {
        for samples in [Samples::One, Samples::Four] {
            let frame = Frame { wireframe: true, ..uploaded.frame(radiance(0.0, ToneMapper::Agx)) };
            let picture = uploaded.draw(size, samples, &frame);
            assert_eq!([picture.width(), picture.height()], size);
            assert!(picture.pixels().iter().any(|p| *p != [0; 3]), "{size:?}");
        }
    }
}

#[test]
fn sizes_that_cannot_be_are_errors() {
    let Some(renderer) = renderer() else { return };
    for size in [[0, 5], [5, 0], [0, 0], [u32::MAX, 1], [1, 1 << 20]] {
        let error = renderer.target(size, Samples::One).unwrap_err();
        assert!(matches!(error, RenderError::Size { .. }), "{error}");
    }
}

#[test]
fn a_scene_sent_twice_is_two_models() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let (first, second) = (subject.on(renderer), subject.on(renderer));
    let before = first.show(SIZE, Samples::One, irradiance(0.0));
    let dark = |_: SurfacePoint, _: Vec3| Irradiance::ZERO;
    renderer.set_light(&second.light, &subject.scene, &dark).unwrap();
    drop(second);
    assert_eq!(first.show(SIZE, Samples::One, irradiance(0.0)), before);
}

#[test]
fn light_that_is_no_number_does_not_reach_other_triangles() {
    let Some(renderer) = renderer() else { return };
    let mut subject = scenes::everything();
    let all_looks: Vec<Look> = looks(0.0, [0.1, 5.0]).into_iter().chain([Look::Plain]).collect();
    // A vertex of the floor.
    let bad = 5;
    let spoiled = [Vec3::NAN, Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::splat(f32::MAX), Vec3::splat(-5.0)];
    let draw = |subject: &crate::common::Subject, look| subject.on(renderer).show(SIZE, Samples::Four, look);
    for look in all_looks {
        subject.light[bad] = Vec3::ZERO;
        let good = draw(&subject, look);
        for value in spoiled {
            subject.light[bad] = value;
            let picture = draw(&subject, look);
            let changed = picture.pixels().iter().zip(good.pixels()).filter(|(a, b)| a != b).count();
            let share = changed as f64 / good.pixels().len() as f64;
            // The six triangles around it.
            assert!(share < 0.25, "{look:?} {value}: {share}");
            assert!(!value.is_nan() || changed == 0, "{look:?}");
        }
    }
}

#[test]
fn cameras_without_a_view_show_the_background_only() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let good = &subject.camera;
    let cameras = [
        Camera { forward: Vec3::ZERO, ..good.clone() },
        Camera { position: Vec3::NAN, ..good.clone() },
        Camera { fov_y: 0.0, ..good.clone() },
        Camera { fov_y: f32::NAN, ..good.clone() },
    ];
    let target = renderer.target(SIZE, Samples::Four).unwrap();
    for camera in &cameras {
        for (look, color) in [(Look::Albedo, [0; 3]), (radiance(0.0, ToneMapper::None), [188, 255, 0])] {
            // Something else was there before.
            renderer.draw(&target, &uploaded.frame(Look::Normals));
            let sky = Radiance(Vec3::new(0.502_886, 7.0, 0.0));
            renderer.draw(&target, &Frame { camera, sky, wireframe: true, ..uploaded.frame(look) });
            let picture = renderer.read(&target).unwrap();
            assert!(picture.pixels().iter().all(|p| *p == color), "{:?} {camera:?}", picture.pixel(0, 0));
        }
    }
}

#[test]
fn settings_that_are_no_numbers_draw_something() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let show = |look| uploaded.show(SIZE, Samples::One, look);
    let (tone, white) = (ToneMapper::Reinhard, 4.0);
    let usual = show(Look::Radiance { stops: 0.0, tone, white });
    assert_eq!(show(Look::Radiance { stops: f32::NAN, tone, white }), usual);
    assert_eq!(show(Look::Radiance { stops: 0.0, tone, white: f32::NAN }), usual);
    let first = lumel_render_cpu::false_color_map()[0];
    for range in [[1.0, 1.0], [f32::NAN, 2.0], [5.0, f32::INFINITY]] {
        let picture = show(Look::FalseColor { range, scale: lumel_render_cpu::Scale::Linear });
        assert!(picture.pixels().iter().all(|p| *p == first || *p == [0; 3]), "{range:?}");
    }
}
