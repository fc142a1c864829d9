//! A default camera for scenes without one.

use crate::Lens;
use crate::framing::framed;
use glam::{Vec2, Vec3};
use lumel_accel::{Ray, RayTracer};
use lumel_basis::RandomPlaces;
use lumel_sample::uniform_sphere;
use lumel_scene::{Camera, FaceSide, Scene, SurfacePoint, TriId};

/// A camera for a scene: its first, or [`camera_chosen_for`] it and for a picture of this width over height.
pub fn camera_for(scene: &Scene, tracer: &dyn RayTracer, aspect: f32) -> Camera {
    scene.cameras().first().cloned().unwrap_or_else(|| camera_chosen_for(scene, tracer, aspect))
}

/// A camera that shows the inside of a room or the outside of an object in a picture of this width over height,
/// whatever cameras the scene has.
///
/// 256 rays are traced from each of five places: the middle of the bounds, and halfway to their sides. If at least
/// 60 % of the rays from three of them hit lit sides of surfaces, the scene is a room. Where light comes from outside the
/// bounds, or from nowhere, 70 % of the rays near the horizon must hit something as well, three walls of four: a house on
/// its ground is no room. Two-sided faces count only if all light comes from inside, because a vase with two-sided faces looks like a
/// room from inside; or if the scene is two metres high and light can come in, as in a court.
///
/// - Room: for 16 horizontal directions the camera stands at half the height, 1.7 m above the floor at most, backs
///   away from the middle by up to 90 % of the distance to the wall behind it and looks across, with a field of view of
///   70°. Where there is an opening behind it, as in a Cornell box, it stands outside and frames the whole scene. What
///   shows the largest share of all surfaces wins.
/// - Object: for 10 directions, the camera stands above and beside it, with a field of view of 40°, as near as the
///   whole of it fits. The front is +z, as in glTF. What shows the largest area wins, with advantage for views from
///   above in front.
///
/// Views along the axes, and from in front, come first: others must show a fifth, or a twentieth, more.
pub fn camera_chosen_for(scene: &Scene, tracer: &dyn RayTracer, aspect: f32) -> Camera {
    let eye = Eye { scene, tracer, aspect };
    let best = if eye.is_in_a_room() { eye.best_room_view() } else { eye.best_object_view() };
    best.unwrap_or_else(|| Camera::looking_at(NAME, Vec3::Z, Vec3::ZERO, ROOM_FOV_DEG.to_radians()))
}

pub(crate) const NAME: &str = "automatic";
const ROOM_FOV_DEG: f32 = 70.0;
const OBJECT_FOV_DEG: f32 = 40.0;

/// Fraction of the rays from a place that hit lit sides in a room.
const ENCLOSED: f32 = 0.6;

/// Fraction of the rays near the horizon that hit something in a room that is lit from outside: three walls of four.
const WALLED: f32 = 0.7;

/// Sines of elevations up to this one are near the horizon.
const HORIZON: f32 = 0.3;

/// Fraction of the rays that leave a court.
const OPEN: f32 = 0.01;

/// Lower scenes with two-sided faces that are lit from outside are vases, metres.
const COURT_HEIGHT: f32 = 2.0;

/// How much more a later candidate must show in a room: looking straight at a wall is worth a fifth.
const ROOM_GAIN: f32 = 1.2;

/// How much more a later view of an object must show.
const OBJECT_GAIN: f32 = 1.05;

/// Eyes are at most as high above the floor, metres.
const EYE_HEIGHT: f32 = 1.7;

/// The middle of no building is higher above its floor, metres: then units are others.
const TALLEST: f32 = 20.0;

/// Directions from an object to the camera, and what the area that is seen from there counts.
const OBJECT_VIEWS: [([f32; 3], f32); 10] = [
    ([0.6, 0.6, 1.0], 1.0),
    ([-0.6, 0.6, 1.0], 1.0),
    ([0.25, 0.2, 1.0], 1.0),
    ([1.0, 0.6, 0.6], 0.9),
    ([-1.0, 0.6, 0.6], 0.9),
    ([0.6, 0.6, -1.0], 0.8),
    ([-0.6, 0.6, -1.0], 0.8),
    ([1.0, 0.2, 0.25], 0.8),
    ([-1.0, 0.2, 0.25], 0.8),
    ([0.6, -0.6, 1.0], 0.5),
];

struct Eye<'a> {
    scene: &'a Scene,
    tracer: &'a dyn RayTracer,
    /// Width over height of the picture.
    aspect: f32,
}

/// What rays from a place meet.
struct Surroundings {
    /// Fraction of the rays that hit lit sides of one-sided faces.
    lit: f32,
    /// Fraction of the rays that hit two-sided faces.
    two_sided: f32,
    /// Fraction of the rays near the horizon that hit anything.
    walled: f32,
    /// Fraction of the rays that hit nothing.
    open: f32,
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
        let outside = !self.is_lit_from_inside();
        let bounds = self.scene.bounds();
        let size = bounds.max - bounds.min;
        let is_room = |place: Vec3| {
            let around = self.surroundings(place);
            let court = size.y >= COURT_HEIGHT && around.open >= OPEN;
            let two_sided = if outside && !court { 0.0 } else { around.two_sided };
            around.lit + two_sided >= ENCLOSED && (!outside || around.walled >= WALLED)
        };
        let steps = [Vec3::ZERO, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z];
        steps.iter().filter(|step| is_room(self.middle() + 0.25 * **step * size)).count() >= 3
    }

    fn surroundings(&self, place: Vec3) -> Surroundings {
        const SIDE: u32 = 16;
        let all = (SIDE * SIDE) as f32;
        let [mut lit, mut two_sided, mut walls, mut horizon, mut open] = [0.0; 5];
        for direction in grid(SIDE).map(|u| uniform_sphere(u.to_array())) {
            let hit = self.tracer.closest_hit(&Ray::new(place, direction));
            if direction.y.abs() <= HORIZON {
                horizon += 1.0;
                walls += f32::from(u8::from(hit.is_some()));
            }
            match hit {
                None => open += 1.0,
                Some(hit) if self.scene.is_two_sided(hit.at.tri) => two_sided += 1.0,
                Some(hit) if hit.side == FaceSide::Front => lit += 1.0,
                Some(_) => {}
            }
        }
        Surroundings { lit: lit / all, two_sided: two_sided / all, walled: walls / horizon, open: open / all }
    }

    /// Whether there is light, and all of it comes from inside the bounds.
    fn is_lit_from_inside(&self) -> bool {
        let bounds = self.scene.bounds();
        let outside = |p: Vec3| p.clamp(bounds.min, bounds.max) != p;
        let lights = self.scene.lights();
        let emits = |tri| self.scene.material(TriId(tri)).emits();
        self.scene.sky().is_zero()
            && !lights.iter().any(|light| light.position().is_none_or(outside))
            && (!lights.is_empty() || (0..self.scene.triangle_count() as u32).any(emits))
    }

    /// Where eyes are in a room: in its middle, and not above a standing person if it is measured in metres.
    fn eye(&self) -> Vec3 {
        let (middle, bottom) = (self.middle(), self.scene.bounds().min.y);
        let top = if middle.y - bottom <= TALLEST { bottom + EYE_HEIGHT } else { middle.y };
        Vec3 { y: middle.y.min(top), ..middle }
    }

    fn best_room_view(&self) -> Option<Camera> {
        const DIRECTIONS: u32 = 16;
        let (eye, diagonal) = (self.eye(), self.diagonal());
        let surfaces = self.surfaces();
        // Square to the axes first, as most walls are, and into the picture along -z, as cameras in files look.
        let order = [4, 2, 1].into_iter().flat_map(|step: u32| (0..DIRECTIONS).step_by(step as usize));
        let view = |i: u32| {
            let (sin, cos) = (i as f32 * 360.0 / DIRECTIONS as f32).to_radians().sin_cos();
            let ahead = Vec3::new(sin, 0.0, -cos);
            let Some(wall) = self.tracer.closest_hit(&Ray::new(eye, -ahead)) else {
                return framed(self.scene, ahead, OBJECT_FOV_DEG.to_radians(), self.aspect);
            };
            let back = 0.9 * wall.t.min(diagonal);
            let camera = Camera::looking_at(NAME, eye - back * ahead, eye, ROOM_FOV_DEG.to_radians());
            Camera { forward: ahead, ..camera }
        };
        best(ROOM_GAIN, order.map(view), |camera| self.share_seen(camera, &surfaces))
    }

    fn best_object_view(&self) -> Option<Camera> {
        let view = |([x, y, z], worth): ([f32; 3], f32)| {
            let towards_eye = Vec3::new(x, y, z);
            (framed(self.scene, -towards_eye, OBJECT_FOV_DEG.to_radians(), self.aspect), worth)
        };
        let seen = |(camera, worth): &(Camera, f32)| worth * self.area_seen(camera);
        best(OBJECT_GAIN, OBJECT_VIEWS.into_iter().map(view), seen).map(|(camera, _)| camera)
    }

    /// Points spread evenly over all surfaces.
    fn surfaces(&self) -> Vec<SurfacePoint> {
        const COUNT: u32 = 1024;
        let places = RandomPlaces::new(self.scene);
        let count = if places.area() > 0.0 { COUNT } else { 0 };
        (0..count).map(|i| places.place(i)).collect()
    }

    /// The share of `surfaces` that a camera sees.
    fn share_seen(&self, camera: &Camera, surfaces: &[SurfacePoint]) -> f32 {
        let Ok(lens) = Lens::new(camera, self.aspect) else { return 0.0 };
        let is_seen = |at: &&SurfacePoint| {
            let point = self.scene.position(**at);
            let in_picture =
                lens.project(point).is_some_and(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0);
            let from = camera.position - point;
            let faces = self.scene.geometric_normal(at.tri).dot(from) > 0.0;
            let to_camera = Ray { t_max: 1.0, ..Ray::new(self.scene.ray_origin(**at), from) };
            in_picture && faces && self.tracer.closest_hit(&to_camera.skipping(at.tri)).is_none()
        };
        surfaces.iter().filter(is_seen).count() as f32 / surfaces.len().max(1) as f32
    }

    /// The area of lit sides that a camera sees, as it appears at the distance of the middle, m².
    fn area_seen(&self, camera: &Camera) -> f32 {
        const SIDE: u32 = 24;
        let Ok(lens) = Lens::new(camera, self.aspect) else { return 0.0 };
        let is_seen = |at: &Vec2| {
            let hit = self.tracer.closest_hit(&lens.ray(*at));
            hit.is_some_and(|hit| self.scene.seen_side(hit.at, hit.side).is_some())
        };
        let share = grid(SIDE).filter(is_seen).count() as f32 / (SIDE * SIDE) as f32;
        let half = (0.5 * camera.fov_y).tan() * camera.position.distance(self.middle());
        share * 4.0 * half * half * self.aspect
    }
}

/// The candidate with the highest score; later ones must have `gain` times that of earlier ones.
fn best<T>(gain: f32, candidates: impl Iterator<Item = T>, score: impl Fn(&T) -> f32) -> Option<T> {
    let scored = candidates.map(|candidate| (score(&candidate), candidate));
    let best = scored.fold(None, |best: Option<(f32, T)>, next| match best {
        Some(best) if next.0 <= best.0 * gain => Some(best),
        _ => Some(next),
    });
    best.map(|(_, candidate)| candidate)
}

/// The centres of the cells of a square grid.
fn grid(side: u32) -> impl Iterator<Item = Vec2> {
    let center =
        move |i: u32| (Vec2::new((i % side) as f32, (i / side) as f32) + Vec2::splat(0.5)) / side as f32;
    (0..side * side).map(center)
}
