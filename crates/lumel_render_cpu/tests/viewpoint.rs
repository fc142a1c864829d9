//! Cameras for scenes without one.

mod support;

use glam::{Vec2, Vec3};
use lumel_accel::Bvh;
use lumel_render_cpu::{Lens, camera_for};
use lumel_scene::{Camera, Light, PointLight, Radiance, Scene, SceneBuilder, Sides};
use support::*;

fn found(scene: &Scene) -> Camera {
    let camera = camera_for(scene, &Bvh::build(scene), 1.0);
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
fn an_open_box_is_seen_through_its_opening() {
    for scale in [1.0, 300.0] {
        let (min, max) = (MIN * scale, (MIN + Vec3::splat(2.5)) * scale);
        let mut walls = room(min, max, 0);
        walls.retain(|wall| wall.positions.iter().any(|p| p.z < max.z));
        assert_eq!(walls.len(), 5);
        let scene = built(scene(walls, vec![grey(0.5)]));
        let camera = found(&scene);
        assert!(camera.position.z > scene.bounds().max.z && shows_all(&scene, &camera), "{camera:?}");
        assert!(camera.forward.normalize().z < -0.99, "straight: {camera:?}");
    }
}

#[test]
fn a_house_on_its_ground_is_seen_from_above() {
    let mut meshes = cube(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0), 0);
    let ground = [[-20.0, 20.0], [20.0, 20.0], [20.0, -20.0], [-20.0, -20.0]];
    meshes.push(quad(ground.map(|[x, z]| Vec3::new(x, 0.0, z)), 0));
    let scene = built(SceneBuilder { sky: Radiance::splat(1.0).into(), ..scene(meshes, vec![grey(0.5)]) });
    let camera = found(&scene);
    assert!(camera.position.y > 2.0 && shows_all(&scene, &camera), "{camera:?}");
}

#[test]
fn all_of_an_object_fills_the_picture() {
    for size in [Vec3::ONE, Vec3::new(8.0, 1.0, 1.0), Vec3::new(1.0, 8.0, 1.0)] {
        let scene = built(scene(cube(MIN, MIN + size, 0), vec![grey(0.5)]));
        let camera = found(&scene);
        let lens = Lens::new(&camera, 1.0).unwrap();
        let places: Vec<_> = scene.positions().iter().map(|p| lens.project(*p).unwrap()).collect();
        let (lo, hi) = places.iter().fold((Vec2::ONE, Vec2::ZERO), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        assert!(
            lo.min_element() > 0.04 && hi.max_element() < 0.96 && (hi - lo).max_element() > 0.88,
            "{lo} {hi}"
        );
        assert!((lo + hi - Vec2::ONE).abs().max_element() < 0.1, "it is about in the middle: {lo} {hi}");
    }
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
