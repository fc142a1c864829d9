//! Samples, dividers, and pictures of the same thing twice.

use crate::common::{another_renderer, differences, irradiance, radiance, renderer, share_beyond};
use crate::scenes;
use glam::Vec3;
use lumel_basis::VertexLighting;
use lumel_render_cpu::{Picture, ToneMapper};
use lumel_render_gpu::{Frame, Lit, Look, Samples};
use lumel_scene::{Camera, RectLight};

const SIZE: [u32; 2] = [120, 90];

/// The pixels around one, itself included; fewer at the edges of the picture.
fn around(picture: &Picture, x: u32, y: u32) -> Vec<[u8; 3]> {
    let near = |n: u32| n.saturating_sub(1)..=n + 1;
    near(y).flat_map(|y| near(x).filter_map(move |x| picture.pixel(x, y))).collect()
}

#[test]
fn four_samples_smooth_edges_and_leave_the_rest() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let uploaded = subject.on(renderer);
    // Large areas of one colour.
    let one = uploaded.show(SIZE, Samples::One, Look::Albedo);
    let four = uploaded.show(SIZE, Samples::Four, Look::Albedo);
    let mut smoothed = 0;
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        let [single, mean] = [&one, &four].map(|picture| picture.pixel(x, y).unwrap());
        let neighbours = around(&one, x, y);
        for c in 0..3 {
            let least = neighbours.iter().map(|p| p[c]).min().unwrap();
            let most = neighbours.iter().map(|p| p[c]).max().unwrap();
            assert!((least..=most).contains(&mean[c]), "{x} {y}: {mean:?} among {neighbours:?}");
        }
        smoothed += u32::from(mean != single);
    }
    assert!((50..1500).contains(&smoothed), "{smoothed} pixels are on edges");
}

#[test]
fn false_colours_of_edges_are_those_of_the_surface_dimmed() {
    let Some(renderer) = renderer() else { return };
    let mut subject = scenes::everything();
    subject.light.fill(Vec3::ONE);
    let look = Look::FalseColor { range: [0.0, 2.0], scale: lumel_render_cpu::Scale::Linear };
    let uploaded = subject.on(renderer);
    let full = lumel_render_cpu::false_color(0.5);
    let shades: Vec<[u8; 3]> = (0..=4)
        .map(|n| {
            full.map(|c| lumel_render_cpu::srgb_byte(lumel_render_cpu::srgb_from_byte(c) * n as f32 / 4.0))
        })
        .collect();
    let picture = uploaded.show(SIZE, Samples::Four, look);
    let near = |pixel: &[u8; 3]| {
        shades.iter().any(|shade| shade.iter().zip(pixel).all(|(a, b)| a.abs_diff(*b) <= 1))
    };
    assert!(picture.pixels().iter().all(near), "other colours than {shades:?}");
    for shade in [shades[0], shades[2], shades[4]] {
        assert!(picture.pixels().contains(&shade), "{shade:?} is missing");
    }
}

#[test]
fn edges_of_glaring_surfaces_are_white() {
    let Some(renderer) = renderer() else { return };
    let mut subject = scenes::everything();
    subject.light.fill(Vec3::splat(1e12));
    let uploaded = subject.on(renderer);
    for &tone in ToneMapper::ALL {
        let (stops, white) = (9.0, ToneMapper::DEFAULT_WHITE);
        let picture = uploaded.show(SIZE, Samples::Four, Look::Irradiance { stops, tone, white });
        let is_sharp = |pixel: &[u8; 3]| *pixel == [0; 3] || pixel.iter().all(|c| *c >= 254);
        assert!(picture.pixels().iter().all(is_sharp), "{tone}");
        assert!(picture.pixels().iter().any(|pixel| pixel[0] > 0), "{tone}");
    }
}

#[test]
fn two_devices_draw_the_same_bytes() {
    let (Some(renderer), Some(other)) = (renderer(), another_renderer()) else { return };
    let subject = scenes::everything();
    for samples in [Samples::One, Samples::Four] {
        for look in [radiance(0.0, ToneMapper::Agx), Look::Normals, Look::Plain] {
            let pictures = [renderer, &other].map(|renderer| subject.on(renderer).show(SIZE, samples, look));
            assert_eq!(pictures[0], pictures[1], "{samples:?} {look:?}");
        }
    }
}

#[test]
fn a_divider_shows_one_light_left_of_it_and_another_right_of_it() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let dim = renderer.light(&uploaded.model);
    let values: Vec<Vec3> = subject.light.iter().map(|e| 0.2 * *e).collect();
    let dimmed = VertexLighting::new(&subject.scene, &values).unwrap();
    renderer.set_light(&dim, &subject.scene, &dimmed).unwrap();
    let lit = uploaded.frame(irradiance(0.0));
    let at =
        |at| Frame { light: Lit::Split { left: (&uploaded.light).into(), right: (&dim).into(), at }, ..lit };
    let whole = uploaded.draw(SIZE, Samples::Four, &lit);
    let other = uploaded.draw(SIZE, Samples::Four, &Frame { light: Lit::One((&dim).into()), ..lit });
    assert!(share_beyond(&whole, &other, 1) > 0.5);
    for (share, columns) in
        [(0.5, 60), (0.254, 30), (0.0, 0), (1.0, 120), (-3.0, 0), (9.0, 120), (f32::NAN, 0)]
    {
        let split = uploaded.draw(SIZE, Samples::Four, &at(share));
        for (i, pixel) in split.pixels().iter().enumerate() {
            let expected = if i as u32 % SIZE[0] < columns { &whole } else { &other };
            assert_eq!(pixel, &expected.pixels()[i], "pixel {i} at {share}");
        }
    }
}

#[test]
fn rect_lights_are_those_of_the_frame() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let look = radiance(0.0, ToneMapper::None);
    let with = uploaded.show(SIZE, Samples::One, look);
    let frame = Frame { rect_lights: &[], ..uploaded.frame(look) };
    let without = uploaded.draw(SIZE, Samples::One, &frame);
    let lit = share_beyond(&with, &without, 1);
    assert!((0.01..0.2).contains(&lit), "{lit}");
    // Rectangle lights with area but no place for them, an unknown image, or no area are no reason to stop.
    let rect_light = uploaded.rect_lights[0];
    let odd = [
        RectLight { texture: Some(lumel_scene::TextureId(99)), ..rect_light },
        RectLight { center: Vec3::NAN, ..rect_light },
        RectLight { u: Vec3::ZERO, ..rect_light },
    ];
    let frame = Frame { rect_lights: &odd, ..uploaded.frame(look) };
    let odd = uploaded.draw(SIZE, Samples::One, &frame);
    let frame = Frame { rect_lights: &uploaded.rect_lights[..1], ..uploaded.frame(look) };
    assert_eq!(odd, uploaded.draw(SIZE, Samples::One, &frame));
}

#[test]
fn a_rect_light_in_the_plane_of_a_surface_is_seen() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let uploaded = subject.on(renderer);
    // 30 µm behind the back wall, seen from 1.3 m: less than a ten-thousandth of the way. And 1 mm behind it.
    let behind = |distance: f32| RectLight {
        center: Vec3::new(0.1, 0.45, 0.5592 + distance),
        u: Vec3::X * -0.05,
        v: Vec3::Y * 0.05,
        radiance: lumel_scene::Radiance::splat(100.0),
        texture: None,
    };
    let look = radiance(0.0, ToneMapper::None);
    let draw = |rect_lights: &[RectLight]| {
        uploaded.draw(SIZE, Samples::One, &Frame { rect_lights, ..uploaded.frame(look) })
    };
    let none = draw(&[]);
    assert!(share_beyond(&draw(&[behind(3e-5)]), &none, 1) > 0.002);
    assert_eq!(draw(&[behind(1e-3)]), none);
}

#[test]
fn the_plain_look_shades_the_colours_by_how_they_face_the_eye() {
    let Some(renderer) = renderer() else { return };
    let mut subject = scenes::everything();
    subject.light.fill(Vec3::new(1.0, 0.5, 0.25));
    // Straight down at the floor.
    subject.camera = Camera::looking_at("down", Vec3::new(-0.5, 1.0, -1.5), Vec3::new(-0.5, 0.0, -1.5), 0.2);
    let uploaded = subject.on(renderer);
    let facing = uploaded.show([9, 9], Samples::One, Look::Plain);
    let full = [1.0, 0.5, 0.25].map(lumel_render_cpu::srgb_byte);
    assert_eq!(facing.pixel(4, 4), Some(full));
    // Towards the floor at 60°: 0.35 + 0.65 / 2.
    let away =
        Camera::looking_at("slant", Vec3::new(-0.5, 0.1, -1.5), Vec3::new(-0.5, 0.0, -1.5 - 0.173_205), 0.2);
    let frame = Frame { camera: &away, ..uploaded.frame(Look::Plain) };
    let slanted = uploaded.draw([9, 9], Samples::One, &frame).pixel(4, 4).unwrap();
    let expected = [1.0, 0.5, 0.25].map(|c| lumel_render_cpu::srgb_byte(c * 0.675));
    assert!(slanted.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{slanted:?} {expected:?}");
}

#[test]
fn a_target_may_be_drawn_on_again_with_anything_else() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let target = renderer.target(SIZE, Samples::Four).unwrap();
    let read = |look| {
        renderer.draw(&target, &uploaded.frame(look));
        renderer.read(&target).unwrap()
    };
    let first = read(Look::Normals);
    let other = read(radiance(3.0, ToneMapper::Aces));
    assert!(share_beyond(&first, &other, 1) > 0.5);
    assert!(differences(&first, &read(Look::Normals)).iter().all(|d| *d == 0));
}
