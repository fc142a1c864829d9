//! Cameras for scenes without one.

mod support;

use glam::Vec3;
use lumel_accel::Bvh;
use lumel_render_cpu::{Lens, camera_for};
use lumel_scene::{Camera, Light, PointLight, Radiance, Scene, SceneBuilder, Sides};
use support::*;

fn found(scene: &Scene) -> Camera {
    let camera = camera_for(scene, &Bvh::build(scene));
    assert!(camera.axes().is_some_and(|[_, up, _]| up.y > 0.0), "{camera:?}");
    camera
}

fn is_inside(scene: &Scene, p: Vec3) -> bool {
    let bounds = scene.bounds();
    p.clamp(bounds.min, bounds.max) == p
}

/// Whether all corners of the bounds are in a square picture.
fn shows_all(scene: &Scene, camera: &Camera) -> bool {
    let Ok(lens) = Lens::new(camera, 1.0) else { return false };
    let bounds = scene.bounds();
    (0..8).all(|i| {
        let pick = |bit: u32, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
        let (min, max) = (bounds.min, bounds.max);
        let corner = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
        lens.project(corner).is_some_and(|at| at.min_element() >= 0.0 && at.max_element() <= 1.0)
    })
}

const MIN: Vec3 = Vec3::new(10.0, 0.0, -4.0);
const MAX: Vec3 = Vec3::new(16.0, 2.5, 0.0);

#[test]
fn the_camera_of_the_scene_comes_first() {
    let mine = Camera::looking_at("mine", Vec3::X, Vec3::ZERO, 1.0);
    let builder = scene(room(MIN, MAX, 0), vec![grey(0.5)]);
    assert_eq!(found(&built(SceneBuilder { cameras: vec![mine.clone(), camera()], ..builder })), mine);
}

#[test]
fn rooms_are_seen_from_inside_along_their_length() {
    let scene = built(scene(room(MIN, MAX, 0), vec![grey(0.5)]));
    let camera = found(&scene);
    assert!(is_inside(&scene, camera.position), "{camera:?}");
    assert!(camera.forward.normalize().x.abs() > 0.5, "{camera:?}");
    assert!((camera.position - scene.bounds().center()).dot(camera.forward) < 0.0, "it backs away");
}

#[test]
fn objects_are_seen_from_outside_and_whole() {
    let scene = built(scene(cube(MIN, MAX, 0), vec![grey(0.5)]));
    let camera = found(&scene);
    assert!(!is_inside(&scene, camera.position) && shows_all(&scene, &camera), "{camera:?}");
    assert!(camera.position.y > MAX.y && camera.position.z > MAX.z, "from above and in front: {camera:?}");
}

#[test]
fn two_sided_boxes_are_rooms_or_objects_by_where_their_light_is() {
    let mut material = grey(0.5);
    material.sides = Sides::Both;
    let inside = |position, sky| {
        let light = Light::Point(PointLight { position, intensity: Vec3::ONE, range: f32::INFINITY });
        let builder = scene(cube(MIN, MAX, 0), vec![material.clone()]);
        let scene = built(SceneBuilder { lights: vec![light], sky: Radiance::into(sky), ..builder });
        is_inside(&scene, found(&scene).position)
    };
    let middle = 0.5 * (MIN + MAX);
    assert!(inside(middle, Radiance::ZERO));
    assert!(!inside(middle + 20.0 * Vec3::Y, Radiance::ZERO));
    assert!(!inside(middle, Radiance::splat(1.0)));
}

#[test]
fn a_flat_square_is_seen_from_its_front() {
    for (mesh, sign) in [(square(0.0, 1.0, 0), 1.0), (square_from_behind(0.0, 1.0, 0), -1.0)] {
        let scene = built(scene(vec![mesh], vec![grey(0.5)]));
        let camera = found(&scene);
        assert!(sign * camera.position.z > 0.0 && shows_all(&scene, &camera), "{camera:?}");
    }
}

#[test]
fn tiny_and_huge_scenes_have_cameras() {
    for size in [1e-6, 1e6] {
        let scene = built(scene(vec![square(0.0, size, 0)], vec![grey(0.5)]));
        let camera = found(&scene);
        assert!(Lens::new(&camera, 1.0).is_ok() && camera.position.is_finite(), "{camera:?}");
    }
}
