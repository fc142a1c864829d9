//! Dots, lines and edges over the picture.

use crate::common::{Uploaded, differences, irradiance, radiance, renderer};
use crate::scenes;
use glam::{Vec2, Vec3};
use lumel_render_cpu::{Lens, Picture, ToneMapper};
use lumel_render_gpu::{Frame, Hidden, Mark, Overlay, Samples};

const SIZE: [u32; 2] = [160, 120];
const GREEN: [u8; 4] = [20, 240, 30, 255];

/// On the back wall of the Cornell box, and on its light's side of the tall block but behind it.
const SEEN: Vec3 = Vec3::new(0.1, 0.4, 0.559);
const BEHIND_THE_BLOCK: Vec3 = Vec3::new(0.39, 0.1, 0.55);

fn with(uploaded: &Uploaded<'_>, samples: Samples, stops: f32, overlay: &Overlay) -> Picture {
    let frame = Frame { overlay: Some(overlay), ..uploaded.frame(irradiance(stops)) };
    uploaded.draw(SIZE, samples, &frame)
}

fn pixel_of(uploaded: &Uploaded<'_>, place: Vec3) -> Vec2 {
    let lens = Lens::new(&uploaded.subject.camera, SIZE[0] as f32 / SIZE[1] as f32).unwrap();
    lens.project(place).unwrap() * Vec2::new(SIZE[0] as f32, SIZE[1] as f32)
}

fn color_at(picture: &Picture, at: Vec2) -> [u8; 3] {
    picture.pixel(at.x as u32, at.y as u32).unwrap()
}

#[test]
fn dots_have_their_colour_at_their_place_whatever_the_exposure() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    let overlay = Overlay::new(renderer.gpu(), &[Mark { position: SEEN, color: GREEN }], &[]);
    for samples in [Samples::One, Samples::Four] {
        for stops in [-8.0, 0.0, 8.0] {
            let plain = uploaded.show(SIZE, samples, irradiance(stops));
            let picture = with(&uploaded, samples, stops, &overlay);
            let at = pixel_of(&uploaded, SEEN);
            assert_eq!(color_at(&picture, at), [20, 240, 30]);
            let changed: Vec<Vec2> = differences(&plain, &picture)
                .iter()
                .enumerate()
                .filter(|(_, d)| **d > 0)
                .map(|(i, _)| Vec2::new((i as u32 % SIZE[0]) as f32, (i as u32 / SIZE[0]) as f32) + 0.5)
                .collect();
            assert!((16..=36).contains(&changed.len()), "{} pixels", changed.len());
            assert!(changed.iter().all(|p| p.distance(at) < 3.8), "{at} {changed:?}");
        }
    }
}

#[test]
fn dots_behind_surfaces_are_hidden_or_faint() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    let at = pixel_of(&uploaded, BEHIND_THE_BLOCK);
    for samples in [Samples::One, Samples::Four] {
        let plain = uploaded.show(SIZE, samples, irradiance(0.0));
        let overlay = Overlay::new(renderer.gpu(), &[Mark { position: BEHIND_THE_BLOCK, color: GREEN }], &[]);
        assert_eq!(with(&uploaded, samples, 0.0, &overlay), plain);
        let faint = with(&uploaded, samples, 0.0, &overlay.with_hidden(Hidden::Faint));
        let (before, after) = (color_at(&plain, at), color_at(&faint, at));
        for c in 0..3 {
            let expected = 0.75 * f32::from(before[c]) + 0.25 * f32::from(GREEN[c]);
            assert!((f32::from(after[c]) - expected).abs() <= 1.5, "{before:?} {after:?}");
        }
    }
}

#[test]
fn dots_that_are_seen_do_not_show_what_is_behind_surfaces_too() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    let translucent = Mark { position: SEEN, color: [20, 240, 30, 128] };
    let overlay = Overlay::new(renderer.gpu(), &[translucent], &[]);
    let seen = with(&uploaded, Samples::One, 0.0, &overlay);
    assert_eq!(with(&uploaded, Samples::One, 0.0, &overlay.with_hidden(Hidden::Faint)), seen);
}

#[test]
fn dots_on_a_slanted_surface_are_whole() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    // On the floor, which the camera sees under a small angle.
    let position = Vec3::new(0.2, 0.0, 0.02);
    let overlay = Overlay::new(renderer.gpu(), &[Mark { position, color: GREEN }], &[]);
    let picture = with(&uploaded, Samples::One, 0.0, &overlay);
    let at = pixel_of(&uploaded, position);
    for offset in [Vec2::ZERO, Vec2::X, -Vec2::X, Vec2::Y, -Vec2::Y] {
        assert_eq!(color_at(&picture, at + offset), [20, 240, 30], "{offset}");
    }
}

#[test]
fn lines_join_their_ends_and_pass_the_eye() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    let mark = |position| Mark { position, color: GREEN };
    let ends = [Vec3::new(0.1, 0.4, 0.5), Vec3::new(0.5, 0.45, 0.3)];
    let overlay = Overlay::new(renderer.gpu(), &[], &[ends.map(mark)]);
    let picture = with(&uploaded, Samples::One, 0.0, &overlay);
    let is_green = |[r, g, b]: [u8; 3]| g > 150 && r < 130 && b < 130;
    for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let [a, b] = ends.map(|end| pixel_of(&uploaded, end));
        let at = a.lerp(b, share);
        let around = [-1.0, 0.0, 1.0].map(|dy| color_at(&picture, at + Vec2::new(0.0, dy)));
        assert!(around.into_iter().any(is_green), "{share}: {around:?}");
    }
    // From behind the eye to the back wall.
    let eye = uploaded.subject.camera.position;
    let passing = [eye + Vec3::new(0.05, 0.05, -1.0), SEEN - Vec3::Z * 0.01];
    let overlay = Overlay::new(renderer.gpu(), &[], &[passing.map(mark)]);
    let picture = with(&uploaded, Samples::Four, 0.0, &overlay);
    let greens = picture.pixels().iter().filter(|p| is_green(**p)).count();
    assert!((20..400).contains(&greens), "{greens}");
    // Wholly behind it: nothing.
    let behind = [eye - Vec3::Z, eye + Vec3::new(1.0, 0.0, -0.5)];
    let overlay = Overlay::new(renderer.gpu(), &[mark(eye - Vec3::Z)], &[behind.map(mark), [mark(SEEN); 2]]);
    let greens =
        with(&uploaded, Samples::One, 0.0, &overlay).pixels().iter().filter(|p| is_green(**p)).count();
    assert!(greens < 4, "{greens}");
}

#[test]
fn marks_nowhere_are_left_out() {
    let Some(renderer) = renderer() else { return };
    let uploaded = scenes::cornell().on(renderer);
    let nowhere = Mark { position: Vec3::new(0.0, f32::NAN, 0.0), color: GREEN };
    let overlay =
        Overlay::new(renderer.gpu(), &[nowhere], &[[nowhere, Mark { position: SEEN, color: GREEN }]]);
    assert_eq!(
        with(&uploaded, Samples::One, 0.0, &overlay),
        uploaded.show(SIZE, Samples::One, irradiance(0.0))
    );
}

#[test]
fn wireframes_change_the_pixels_of_edges() {
    let Some(renderer) = renderer() else { return };
    if !renderer.gpu().draws_wireframes() {
        return;
    }
    let subject = scenes::everything();
    let uploaded = subject.on(renderer);
    let look = radiance(0.0, ToneMapper::None);
    for samples in [Samples::One, Samples::Four] {
        let plain = uploaded.show(SIZE, samples, look);
        let wired = uploaded.draw(SIZE, samples, &Frame { wireframe: true, ..uploaded.frame(look) });
        let differences = differences(&plain, &wired);
        let changed = differences.iter().filter(|d| **d > 5).count() as f64 / differences.len() as f64;
        assert!((0.03..0.5).contains(&changed), "{changed}");
        // A corner of the floor's cells and the middle of one of its triangles.
        let change = |place: Vec3| {
            let at = pixel_of(&uploaded, place);
            differences[at.y as usize * SIZE[0] as usize + at.x as usize]
        };
        assert!(change(Vec3::new(-2.0 / 3.0, 0.0, 2.0 / 3.0)) > 5);
        assert_eq!(change(Vec3::new(-0.2, 0.0, 1.1)), 0);
    }
}
