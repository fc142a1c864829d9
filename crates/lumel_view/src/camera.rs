//! The camera one flies with.

use glam::{EulerRot, Quat, Vec2, Vec3};
use lumel::Camera;
use serde::{Deserialize, Serialize};

/// Steeper views than this would turn the horizon over.
const MAX_PITCH_DEG: f32 = 89.9;

/// Narrowest and widest vertical field of view, degrees.
pub const FOV_DEG: [f32; 2] = [5.0, 150.0];

/// A camera as three angles, which is how one flies: the horizon stays level until one rolls on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlyCamera {
    /// Position, metres.
    pub position: Vec3,
    /// To the left about +Y, degrees; 0 looks along -z.
    pub yaw_deg: f32,
    /// Upwards, degrees.
    pub pitch_deg: f32,
    /// Clockwise about the line of sight, degrees.
    pub roll_deg: f32,
    /// Vertical field of view, degrees.
    pub fov_deg: f32,
}

/// The side that a scene is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ViewSide {
    /// From +Z.
    Front,
    /// From -Z.
    Back,
    /// From +X.
    Right,
    /// From -X.
    Left,
    /// From +Y.
    Top,
    /// From -Y.
    Bottom,
}

impl ViewSide {
    /// All sides.
    pub const ALL: [Self; 6] = [Self::Front, Self::Back, Self::Right, Self::Left, Self::Top, Self::Bottom];

    /// Unit vector towards the eye.
    pub fn direction(self) -> Vec3 {
        match self {
            Self::Front => Vec3::Z,
            Self::Back => Vec3::NEG_Z,
            Self::Right => Vec3::X,
            Self::Left => Vec3::NEG_X,
            Self::Top => Vec3::Y,
            Self::Bottom => Vec3::NEG_Y,
        }
    }
}

impl Default for FlyCamera {
    fn default() -> Self {
        Self { position: Vec3::ZERO, yaw_deg: 0.0, pitch_deg: 0.0, roll_deg: 0.0, fov_deg: 60.0 }
    }
}

impl FlyCamera {
    /// The same view; `None` for a camera that looks nowhere.
    pub fn from_camera(camera: &Camera) -> Option<Self> {
        let [right, up, forward] = camera.axes()?;
        if !camera.position.is_finite() {
            return None;
        }
        let level = Self {
            position: camera.position,
            // Adding zero turns -0 into 0.
            yaw_deg: (-forward.x).atan2(-forward.z).to_degrees() + 0.0,
            pitch_deg: forward.y.clamp(-1.0, 1.0).asin().to_degrees(),
            roll_deg: 0.0,
            fov_deg: camera.fov_y.to_degrees().clamp(FOV_DEG[0], FOV_DEG[1]),
        };
        // Straight up or down, where yaw and roll are one, the level camera decides what is up.
        let roll = up.dot(level.right()).atan2(up.dot(level.up()));
        debug_assert!(right.is_finite());
        let pitch_deg = level.pitch_deg.clamp(-MAX_PITCH_DEG, MAX_PITCH_DEG);
        Some(Self { roll_deg: roll.to_degrees(), pitch_deg, ..level })
    }

    /// The camera for drawing.
    pub fn camera(&self) -> Camera {
        Camera {
            name: "viewer".to_owned(),
            position: self.position,
            forward: self.forward(),
            up: self.up(),
            fov_y: self.fov_deg.to_radians(),
        }
    }

    fn orientation(&self) -> Quat {
        let angles = [self.yaw_deg, self.pitch_deg, -self.roll_deg].map(f32::to_radians);
        Quat::from_euler(EulerRot::YXZ, angles[0], angles[1], angles[2])
    }

    /// Unit vector along the line of sight.
    pub fn forward(&self) -> Vec3 {
        self.orientation() * Vec3::NEG_Z
    }

    /// Unit vector to the right of the picture.
    pub fn right(&self) -> Vec3 {
        self.orientation() * Vec3::X
    }

    /// Unit vector to the top of the picture.
    pub fn up(&self) -> Vec3 {
        self.orientation() * Vec3::Y
    }

    /// Turns by a way on the picture, degrees to the right and up.
    pub fn look(&mut self, delta_deg: Vec2) {
        // What is dragged to the right goes to the right on the picture, rolled or not.
        let (sin, cos) = self.roll_deg.to_radians().sin_cos();
        let level = Vec2::new(cos * delta_deg.x + sin * delta_deg.y, cos * delta_deg.y - sin * delta_deg.x);
        self.yaw_deg = wrapped(self.yaw_deg - level.x);
        self.pitch_deg = (self.pitch_deg + level.y).clamp(-MAX_PITCH_DEG, MAX_PITCH_DEG);
    }

    /// Turns around a point, which stays where it is on the picture, by a way on the picture, degrees to the right and up.
    pub fn orbit(&mut self, pivot: Vec3, delta_deg: Vec2) {
        let before = self.orientation();
        self.look(delta_deg);
        self.position = pivot + self.orientation() * (before.inverse() * (self.position - pivot));
    }

    /// Looks at a point from a direction, unit length, as far away as before and with a level horizon.
    pub fn look_from(&mut self, target: Vec3, towards_eye: Vec3) {
        let distance = self.position.distance(target);
        let Vec3 { x, y, z } = towards_eye;
        // Straight down, -z is at the top.
        self.yaw_deg = if x.hypot(z) > 1e-4 { x.atan2(z).to_degrees() } else { 0.0 };
        self.pitch_deg = (-y).clamp(-1.0, 1.0).asin().to_degrees().clamp(-MAX_PITCH_DEG, MAX_PITCH_DEG);
        self.roll_deg = 0.0;
        self.position = target - self.forward() * distance;
    }

    /// Takes another field of view, and a place from which what is at a point is as large as before.
    pub fn zoom_about(&mut self, target: Vec3, fov_deg: f32) {
        let half = |degrees: f32| (0.5 * degrees).to_radians().tan();
        self.position = target + (self.position - target) * (half(self.fov_deg) / half(fov_deg));
        self.fov_deg = fov_deg;
    }

    /// Moves until a sphere just fits the picture, whose width over height is `aspect`.
    pub fn frame(&mut self, center: Vec3, radius: f32, aspect: f32) {
        let half = (0.5 * self.fov_deg).to_radians().tan() * aspect.min(1.0);
        self.position = center - self.forward() * (radius.max(1e-6) / half.atan().sin());
    }

    /// Moves towards a point: `factor` 2 halves the distance.
    pub fn approach(&mut self, target: Vec3, factor: f32) {
        self.position = target + (self.position - target) / factor;
    }

    /// Moves along its right, the world's up and its forward, metres.
    pub fn fly(&mut self, [right, up, forward]: [f32; 3]) {
        self.position += self.right() * right + Vec3::Y * up + self.forward() * forward;
    }

    /// Moves in the plane of the picture, metres to its right and its top.
    pub fn pan(&mut self, delta: Vec2) {
        self.position += self.right() * delta.x + self.up() * delta.y;
    }

    /// Rolls clockwise, degrees.
    pub fn roll(&mut self, delta_deg: f32) {
        self.roll_deg = wrapped(self.roll_deg + delta_deg);
    }

    /// Makes the horizon level.
    pub fn align_up(&mut self) {
        self.roll_deg = 0.0;
    }
}

/// The angle within ±180°.
fn wrapped(degrees: f32) -> f32 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-4
    }

    #[test]
    fn cameras_survive_the_way_through_angles() {
        let up = Vec3::new(0.3, 1.0, -0.2);
        for target in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 0.1), Vec3::new(0.0, -3.0, 0.5)] {
            let camera = Camera {
                up,
                ..Camera::looking_at("c", Vec3::new(0.5, 1.0, -2.0), target, 45_f32.to_radians())
            };
            let back = FlyCamera::from_camera(&camera).unwrap().camera();
            let ([r, u, f], [r2, u2, f2]) = (camera.axes().unwrap(), back.axes().unwrap());
            assert!(close(r, r2) && close(u, u2) && close(f, f2), "{camera:?} {back:?}");
            assert!((back.fov_y - camera.fov_y).abs() < 1e-6);
        }
        let nowhere = Camera::looking_at("c", Vec3::ZERO, Vec3::ZERO, 1.0);
        assert_eq!(FlyCamera::from_camera(&nowhere), None);
    }

    #[test]
    fn dragging_to_the_right_looks_to_the_right_of_the_picture() {
        for roll_deg in [0.0, 90.0, -37.0, 180.0] {
            let before = FlyCamera { roll_deg, yaw_deg: 20.0, ..FlyCamera::default() };
            let mut after = before;
            after.look(Vec2::new(5.0, 0.0));
            assert!(after.forward().dot(before.right()) > 0.08, "{roll_deg}");
            assert!(after.forward().dot(before.up()).abs() < 0.01, "{roll_deg}");
            let mut after = before;
            after.look(Vec2::new(0.0, 5.0));
            assert!(after.forward().dot(before.up()) > 0.08, "{roll_deg}");
        }
    }

    #[test]
    fn one_cannot_look_past_the_zenith() {
        let mut camera = FlyCamera::default();
        camera.look(Vec2::new(0.0, 1000.0));
        assert!(camera.pitch_deg < 90.0 && camera.up().y > 0.0);
        camera.look(Vec2::new(725.0, -10.0));
        assert!(camera.yaw_deg.abs() <= 180.0);
    }

    #[test]
    fn an_orbit_keeps_the_pivot_where_it_is_on_the_picture() {
        let pivot = Vec3::new(1.0, 0.5, -4.0);
        let before = FlyCamera { roll_deg: 20.0, yaw_deg: 10.0, ..FlyCamera::default() };
        let mut after = before;
        after.orbit(pivot, Vec2::new(35.0, -20.0));
        let seen = |camera: &FlyCamera| {
            let to = pivot - camera.position;
            Vec3::new(to.dot(camera.right()), to.dot(camera.up()), to.dot(camera.forward()))
        };
        assert!(close(seen(&before), seen(&after)) && before.position.distance(after.position) > 1.0);
    }

    #[test]
    fn views_along_axes_keep_the_distance_and_have_a_level_horizon() {
        let target = Vec3::new(1.0, 2.0, 3.0);
        let distance = target.length();
        for (towards_eye, up) in [(Vec3::Z, Vec3::Y), (Vec3::NEG_X, Vec3::Y), (Vec3::Y, Vec3::NEG_Z)] {
            let mut camera = FlyCamera { roll_deg: 40.0, ..FlyCamera::default() };
            camera.look_from(target, towards_eye);
            // Straight down is a tenth of a degree away, so that there is a horizon.
            let error = camera.position - (target + towards_eye * distance);
            assert!(error.length() < 0.01 * distance, "{towards_eye}: {}", camera.position);
            assert!(camera.up().dot(up) > 0.999, "{towards_eye}: {}", camera.up());
        }
    }

    #[test]
    fn a_framed_sphere_just_fits() {
        let mut camera = FlyCamera { yaw_deg: 30.0, pitch_deg: -20.0, ..FlyCamera::default() };
        for aspect in [0.5, 1.0, 2.0] {
            camera.frame(Vec3::ONE, 2.0, aspect);
            let distance = camera.position.distance(Vec3::ONE);
            assert!(close(camera.position + camera.forward() * distance, Vec3::ONE));
            let half = (2.0 / distance).asin().tan();
            assert!((half / (30_f32.to_radians().tan() * aspect.min(1.0)) - 1.0).abs() < 1e-4, "{aspect}");
        }
    }

    #[test]
    fn a_narrower_view_from_farther_away_shows_the_target_as_large() {
        let mut camera = FlyCamera::default();
        let target = Vec3::new(0.0, 0.0, -4.0);
        camera.zoom_about(target, 5.0);
        let size = |distance: f32, fov: f32| distance * (0.5 * fov).to_radians().tan();
        assert!((size(camera.position.distance(target), 5.0) / size(4.0, 60.0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn flying_goes_where_one_looks_and_up_is_the_worlds() {
        let mut camera = FlyCamera { yaw_deg: 90.0, roll_deg: 30.0, ..FlyCamera::default() };
        camera.fly([0.0, 2.0, 3.0]);
        assert!(close(camera.position, Vec3::new(-3.0, 2.0, 0.0)), "{}", camera.position);
        camera.align_up();
        camera.pan(Vec2::new(0.0, 1.0));
        assert!(close(camera.position, Vec3::new(-3.0, 3.0, 0.0)));
    }
}
