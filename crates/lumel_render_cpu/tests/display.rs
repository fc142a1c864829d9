//! Known light gives known bytes.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use glam::Vec3;
use lumel_accel::BruteForce;
use lumel_basis::VertexLighting;
use lumel_render_cpu::*;
use lumel_scene::{Irradiance, Material, Radiance, SceneBuilder, SurfacePoint, luminance};
use std::f32::consts::PI;
use support::*;

/// A square of albedo 0.5 under an irradiance of π: radiance 0.5.
fn lit_square_pixel(display: &Display) -> [u8; 3] {
    let scene = built(scene(vec![square(0.0, 9.0, 0)], vec![grey(0.5)]));
    let light = vec![Radiance::splat(1.0).cosine_sample().0; scene.vertex_count()];
    let light = VertexLighting::new(&scene, &light).unwrap();
    picture(&scene, &light, 5, display).pixel(2, 2).unwrap()
}

#[test]
fn half_radiance_has_the_byte_of_every_tone_mapper_and_exposure() {
    // By the formulas of the documentation in double precision, for -3, -1, 0, +1 and +3 stops.
    let expected = [
        (ToneMapper::None, [71, 137, 188, 255, 255]),
        (ToneMapper::Reinhard, [69, 124, 158, 193, 255]),
        (ToneMapper::Aces, [54, 142, 189, 222, 249]),
        (ToneMapper::Agx, [66, 136, 170, 197, 233]),
    ];
    for (tone, bytes) in expected {
        for (stops, byte) in [-3.0, -1.0, 0.0, 1.0, 3.0].into_iter().zip(bytes) {
            let display = Display { tone, exposure: Exposure::Stops(stops), ..Display::default() };
            assert_eq!(lit_square_pixel(&display), [byte; 3], "{tone} {stops}");
        }
    }
}

#[test]
fn colours_have_the_bytes_of_every_tone_mapper() {
    let expected = [
        (ToneMapper::None, [203, 149, 63]),
        (ToneMapper::Reinhard, [180, 131, 55]),
        (ToneMapper::Aces, [202, 157, 66]),
        (ToneMapper::Agx, [184, 149, 72]),
    ];
    for (tone, bytes) in expected {
        let display = Display { tone, ..Display::default() };
        assert_eq!(display.light_pixel(0.0, Vec3::new(0.6, 0.3, 0.05)), bytes, "{tone}");
    }
}

#[test]
fn irradiance_ignores_albedo_and_looks_like_a_white_wall() {
    // E/π = 1: white, whatever the albedo.
    assert_eq!(lit_square_pixel(&Display { show: Show::Irradiance, ..plain() }), [255; 3]);
    let half = Display { show: Show::Irradiance, exposure: Exposure::Stops(-1.0), ..plain() };
    assert_eq!(lit_square_pixel(&half), [188; 3]);
}

#[test]
fn albedo_ignores_light_exposure_and_tone_mapper() {
    for (stops, tone) in [(0.0, ToneMapper::None), (5.0, ToneMapper::Aces)] {
        let display = Display { tone, exposure: Exposure::Stops(stops), ..Display::of(Show::Albedo) };
        assert_eq!(lit_square_pixel(&display), [188; 3]);
    }
}

/// The left half of the picture shows a square of irradiance `level`, the right half nothing.
fn half_picture(level: Irradiance, n: u32, display: &Display) -> Picture {
    let mut left = square(0.0, 9.0, 0);
    for p in &mut left.positions {
        p.x = p.x.min(0.0);
    }
    let scene = built(scene(vec![left], vec![grey(0.5)]));
    picture(&scene, &move |_: SurfacePoint, _: Vec3| level, n, display)
}

#[test]
fn twice_the_light_is_exposed_exactly_one_stop_less() {
    let level = Irradiance(Vec3::new(0.3, 0.2, 0.7));
    let once = half_picture(level, 24, &Display::default());
    let twice = half_picture(level * 2.0, 24, &Display::default());
    let hundredths = |picture: &Picture| (100.0 * picture.stops().unwrap()).round() as i32;
    assert_eq!(hundredths(&twice), hundredths(&once) - 100);
    assert_eq!(once.pixels(), twice.pixels());
    // The background does not count: what is seen becomes middle grey.
    let y = luminance(level.reflected(lumel_scene::Albedo::splat(0.5)).radiance().0);
    assert!((once.stops().unwrap() - (0.18 / y).log2()).abs() < 0.006);
}

#[test]
fn a_picture_is_repeated_by_asking_for_its_exposure() {
    let level = Irradiance(Vec3::new(0.3, 0.2, 0.7));
    let auto = half_picture(level, 24, &Display::default());
    let exposure = auto.stops().unwrap().to_string().parse().unwrap();
    assert_eq!(half_picture(level, 24, &Display { exposure, ..Display::default() }), auto);
}

#[test]
fn lamps_in_view_do_not_darken_the_picture() {
    // A glowing surface beside one that is lit, and a lamp in front of both.
    let level = Irradiance(Vec3::splat(0.5));
    let stops = |glowing: f32, lamp: f32| {
        let glow = Material { emission: Radiance::splat(900.0), ..grey(0.5) };
        let mut meshes = vec![square(0.0, 9.0, 0), square(0.0, 9.0, 1)];
        let edge = 5.0 - 10.0 * glowing;
        for (mesh, [lo, hi]) in meshes.iter_mut().zip([[-9.0, edge], [edge, 9.0]]) {
            mesh.positions.iter_mut().for_each(|p| p.x = p.x.clamp(lo, hi));
        }
        let lights = vec![rect_light(Vec3::new(-0.5, 0.0, 1.0), lamp * Vec3::X, lamp * Vec3::Y)];
        let builder = SceneBuilder { lights, ..scene(meshes, vec![grey(0.5), glow]) };
        picture(&built(builder), &move |_: SurfacePoint, _: Vec3| level, 24, &Display::default())
            .stops()
            .unwrap()
    };
    let grey = stops(0.0, 1e-3);
    assert!((grey - (0.18f32 / (0.25 / PI)).log2()).abs() < 0.006, "{grey}");
    assert_eq!(stops(0.4, 1e-3), grey);
    assert_eq!(stops(0.4, 0.4), grey);
    // It is what the picture shows, and no lamp, if there is little else.
    assert!(stops(0.8, 1e-3) < -6.0);
}

#[test]
fn automatic_exposure_is_the_same_for_every_size_and_quantity() {
    let scene = lumel_builtin::scene("cornell-box", 0).unwrap().build().unwrap().0;
    let tracer = lumel_accel::Bvh::build(&scene);
    let lighting = |at: SurfacePoint, _: Vec3| Irradiance(Vec3::splat(scene.position(at).y));
    let view = View::new(&scene, &tracer, &lighting);
    let stops = |n, show| shoot(&view, &scene.cameras()[0], n, &Display::of(show)).unwrap().stops().unwrap();
    let expected = stops(64, Show::Radiance);
    assert_eq!(stops(17, Show::Radiance), expected);
    assert_eq!(stops(64, Show::Irradiance), expected);
    assert_eq!(meter(&view, &scene.cameras()[0], 1.0), Ok(expected));
    // Nearly the same for a picture of another shape.
    let wide = meter(&view, &scene.cameras()[0], 1.01).unwrap();
    assert!((wide - expected).abs() < 0.1, "{wide} {expected}");
}

#[test]
fn false_colours_are_places_in_the_range() {
    let level = Irradiance(Vec3::new(1.0, 2.0, 4.0));
    let y = luminance(level.0);
    let with = |scale, range| {
        let false_color = FalseColor { range: Some(range), scale, legend: Legend::Hidden };
        let picture = half_picture(level, 9, &Display { false_color, ..Display::of(Show::FalseColor) });
        assert_eq!(picture.range(), Some(range));
        // Half of the middle column shows the square.
        let half = picture.pixel(4, 4).unwrap();
        let full = picture.pixel(1, 4).unwrap().map(|byte| srgb_from_byte(byte) * 0.5).map(srgb_byte);
        assert_eq!(half, full, "coverage");
        assert_eq!(picture.pixel(7, 4), Some([0; 3]));
        picture.pixel(1, 4).unwrap()
    };
    assert_eq!(with(Scale::Linear, [0.0, 2.0 * y]), false_color_map()[128]);
    assert_eq!(with(Scale::Linear, [0.0, 4.0 * y]), false_color_map()[64]);
    assert_eq!(with(Scale::Linear, [0.0, 0.5 * y]), false_color_map()[255]);
    assert_eq!(with(Scale::Log, [0.1 * y, 1000.0 * y]), false_color_map()[64]);
}

#[test]
fn light_that_is_no_number_is_black_and_disturbs_nothing() {
    let scene = built(scene(vec![square(0.0, 9.0, 0)], vec![grey(0.5)]));
    let tracer = BruteForce::new(&scene);
    let lighting = |at: SurfacePoint, _: Vec3| match scene.position(at).x {
        x if x < -2.0 => Irradiance::splat(f32::NAN),
        x if x < 0.0 => Irradiance::splat(f32::INFINITY),
        _ => Irradiance::splat(1.0),
    };
    for &show in Show::ALL {
        for &tone in ToneMapper::ALL {
            let display = Display { tone, ..Display::of(show) };
            let picture = shoot(&View::new(&scene, &tracer, &lighting), &camera(), 20, &display).unwrap();
            assert!(picture.stops().is_none_or(f32::is_finite));
            assert!(picture.range().is_none_or(|[lo, hi]| lo < hi && hi.is_finite()));
            if show.is_exposed() {
                assert_eq!(picture.pixel(1, 10), Some([0; 3]), "{show} {tone}");
            }
        }
    }
}
