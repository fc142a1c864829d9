//! A default camera for scenes without one.

use crate::Lens;
use glam::{Vec2, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_sample::uniform_sphere;
use lumel_scene::{Camera, Scene};

/// A camera for a scene: its first, or one that shows the inside of a room or the outside of an object.
///
/// 256 rays are traced from the centre of the bounds. If at least 60 % hit lit sides of surfaces, the scene is a room.
/// Sides of two-sided faces count only if all light comes from inside the bounds, because a vase with two-sided faces
/// looks like a room from inside.
///
/// - Room: for 16 horizontal directions the camera backs away from the centre by up to 90 % of the distance to the wall
///   behind it and looks across, with a field of view of 70°. If there is an opening behind it, it backs away by at
///   most the diagonal of the bounds.
/// - Object: for 8 directions, the camera stands above and beside it, with a field of view of 40°, far enough away
///   for the bounding sphere to fit. The front is +z, as in glTF.
///
/// The camera with the most rays that hit lit sides wins; in rooms, rays are weighted by their length (up to the
/// diagonal). Ties go to the first.
pub fn camera_for(scene: &Scene, tracer: &dyn RayTracer) -> Camera {
    if let Some(camera) = scene.cameras().first() {
        return camera.clone();
    }
    let eye = Eye { scene, tracer };
    let candidates = if eye.is_in_a_room() { eye.room_views() } else { eye.object_views() };
    let scored = candidates.into_iter().map(|candidate| (eye.score(&candidate), candidate));
    let best = scored.fold(None, |best: Option<(f32, Candidate)>, next| match best {
        // A gain of 1 % is required, so that ties go to the first candidate despite rounding.
        Some(best) if next.0 <= best.0 * 1.01 => Some(best),
        _ => Some(next),
    });
    best.map_or_else(
        || Camera::looking_at(NAME, Vec3::Z, Vec3::ZERO, ROOM_FOV_DEG.to_radians()),
        |(_, c)| c.camera,
    )
}

const NAME: &str = "automatic";
const ROOM_FOV_DEG: f32 = 70.0;
const OBJECT_FOV_DEG: f32 = 40.0;

/// Fraction of the rays from the centre that hit lit sides in a room.
const ENCLOSED: f32 = 0.6;

struct Eye<'a> {
    scene: &'a Scene,
    tracer: &'a dyn RayTracer,
}

struct Candidate {
    camera: Camera,
    /// Distance at which a ray has full weight; zero if all rays have the same weight.
    depth: f32,
}

impl Eye<'_> {
    fn middle(&self) -> Vec3 {
        self.scene.bounds().center()
    }

    /// Never zero, so that the camera can always be placed.
    fn diagonal(&self) -> f32 {
        self.scene.bounds().diagonal().max(1e-3)
    }

    fn is_in_a_room(&self) -> bool {
        const SIDE: u32 = 16;
        let outside = self.is_lit_from_outside();
        let sees_a_wall = |direction: &Vec3| {
            let Some(hit) = self.tracer.closest_hit(&Ray::new(self.middle(), *direction)) else {
                return false;
            };
            let counts = !self.scene.is_two_sided(hit.at.tri) || !outside;
            counts && self.scene.seen_side(hit.at, hit.side).is_some()
        };
        let n = grid(SIDE).map(|u| uniform_sphere(u.to_array())).filter(sees_a_wall).count();
        n as f32 >= ENCLOSED * (SIDE * SIDE) as f32
    }

    fn is_lit_from_outside(&self) -> bool {
        let bounds = self.scene.bounds();
        let outside = |p: Vec3| p.clamp(bounds.min, bounds.max) != p;
        !self.scene.sky().is_zero()
            || self.scene.lights().iter().any(|light| light.position().is_none_or(outside))
    }

    fn room_views(&self) -> Vec<Candidate> {
        const DIRECTIONS: u32 = 16;
        let (middle, diagonal) = (self.middle(), self.diagonal());
        let view = |i: u32| {
            // Into the picture along -z first, as cameras in files do.
            let (sin, cos) = (i as f32 * 360.0 / DIRECTIONS as f32).to_radians().sin_cos();
            let ahead = Vec3::new(sin, 0.0, -cos);
            let wall = self.tracer.closest_hit(&Ray::new(middle, -ahead));
            let back = wall.map_or(diagonal, |hit| 0.9 * hit.t.min(diagonal));
            let camera = Camera::looking_at(NAME, middle - back * ahead, middle, ROOM_FOV_DEG.to_radians());
            Candidate { camera: Camera { forward: ahead, ..camera }, depth: diagonal }
        };
        (0..DIRECTIONS).map(view).collect()
    }

    fn object_views(&self) -> Vec<Candidate> {
        let middle = self.middle();
        let fov = OBJECT_FOV_DEG.to_radians();
        let distance = 0.5 * self.diagonal() / (0.5 * fov).sin();
        let sides = [[0.6, 1.0], [-0.6, 1.0], [1.0, 0.6], [-1.0, 0.6], [0.6, -1.0], [-0.6, -1.0]];
        let mut directions: Vec<Vec3> = sides.map(|[x, z]| Vec3::new(x, 0.6, z)).into();
        directions.extend([Vec3::new(0.3, 1.0, 0.3), Vec3::new(0.6, -0.6, 1.0)]);
        let view = |towards_eye: Vec3| {
            let eye = middle + distance * towards_eye.normalize_or(Vec3::Z);
            Candidate { camera: Camera::looking_at(NAME, eye, middle, fov), depth: 0.0 }
        };
        directions.into_iter().map(view).collect()
    }

    fn score(&self, candidate: &Candidate) -> f32 {
        let Ok(lens) = Lens::new(&candidate.camera, 4.0 / 3.0) else { return 0.0 };
        let worth = |at: Vec2| {
            let ray = lens.ray(at);
            let Some(hit) = self.tracer.closest_hit(&ray) else { return 0.0 };
            if self.scene.seen_side(hit.at, hit.side).is_none() {
                return 0.0;
            }
            if candidate.depth == 0.0 { 1.0 } else { (hit.t / candidate.depth).min(1.0) }
        };
        grid(24).map(worth).sum()
    }
}

/// The centres of the cells of a square grid.
fn grid(side: u32) -> impl Iterator<Item = Vec2> {
    let center =
        move |i: u32| (Vec2::new((i % side) as f32, (i / side) as f32) + Vec2::splat(0.5)) / side as f32;
    (0..side * side).map(center)
}
