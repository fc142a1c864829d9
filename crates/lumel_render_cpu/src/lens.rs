//! The pinhole projection, from points of the picture to rays and back.

use crate::PictureError;
use glam::{Vec2, Vec3};
use lumel_accel::Ray;
use lumel_scene::Camera;

/// Wider fields of view have no usable picture plane.
const MAX_FOV_DEG: f32 = 179.0;

/// A camera with the aspect ratio of its picture.
///
/// Points of the picture are `(x, y)` in 0..1, from its left and from its top. With right, up and forward the unit
/// axes of [`Camera::axes`] and `h = tan(fov_y / 2)`, the ray through one has the direction
/// `forward + (2x − 1) h aspect right + (1 − 2y) h up`, so that `t` counts metres along `forward`.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    position: Vec3,
    forward: Vec3,
    /// To the right edge of the picture, one metre ahead.
    right: Vec3,
    /// To its top edge.
    up: Vec3,
}

impl Lens {
    /// The projection of a camera to a picture of this width over height.
    ///
    /// # Errors
    /// [`PictureError::Camera`] if the camera has no direction, its numbers are not finite, or its vertical field of
    /// view is not between 0° and 179°.
    pub fn new(camera: &Camera, aspect: f32) -> Result<Self, PictureError> {
        let refuse = |problem| PictureError::Camera { name: camera.name.clone(), problem };
        if !(camera.position.is_finite() && camera.forward.is_finite() && camera.up.is_finite()) {
            return Err(refuse("its position and directions must be finite numbers"));
        }
        if !(camera.fov_y > 0.0 && camera.fov_y.to_degrees() <= MAX_FOV_DEG) {
            return Err(refuse("its vertical field of view must be between 0 and 179 degrees"));
        }
        let [right, up, forward] = camera.axes().ok_or_else(|| refuse("it looks nowhere"))?;
        let h = (0.5 * camera.fov_y).tan();
        Ok(Self { position: camera.position, forward, right: right * (h * aspect), up: up * h })
    }

    /// The ray through a point of the picture.
    #[inline]
    pub fn ray(&self, at: Vec2) -> Ray {
        let direction = self.forward + self.right * (2.0 * at.x - 1.0) + self.up * (1.0 - 2.0 * at.y);
        Ray::new(self.position, direction)
    }

    /// The position of a point in the picture; `None` if it lies behind the camera.
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let d = point - self.position;
        let depth = d.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let across = |axis: Vec3| d.dot(axis) / (axis.length_squared() * depth);
        Some(0.5 * Vec2::new(1.0 + across(self.right), 1.0 - across(self.up)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards_minus_z(fov_deg: f32) -> Camera {
        Camera::looking_at("c", Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, fov_deg.to_radians())
    }

    #[test]
    fn right_is_right_and_up_is_up() {
        let lens = Lens::new(&towards_minus_z(90.0), 2.0).unwrap();
        let at = |x, y, z| lens.project(Vec3::new(x, y, z)).unwrap();
        assert!((at(0.0, 0.0, 0.0) - Vec2::splat(0.5)).length() < 1e-6);
        // 90 degrees: five metres ahead the picture is 10 m high, and 20 m wide at an aspect of 2.
        assert!((at(0.0, 5.0, 0.0) - Vec2::new(0.5, 0.0)).length() < 1e-6, "the top");
        assert!((at(10.0, 0.0, 0.0) - Vec2::new(1.0, 0.5)).length() < 1e-6, "the right");
        assert!((at(2.5, -2.5, 0.0) - Vec2::new(0.625, 0.75)).length() < 1e-6);
        assert_eq!(lens.project(Vec3::new(0.0, 0.0, 6.0)), None);
    }

    #[test]
    fn rays_go_through_the_points_that_project_there() {
        let camera = Camera {
            up: Vec3::new(0.2, 1.0, 0.1),
            ..Camera::looking_at("c", Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 0.0), 0.8)
        };
        let lens = Lens::new(&camera, 1.6).unwrap();
        for at in [Vec2::new(0.1, 0.9), Vec2::new(0.5, 0.2), Vec2::new(0.99, 0.01)] {
            let ray = lens.ray(at);
            let back = lens.project(ray.origin + 7.0 * ray.direction).unwrap();
            assert!((back - at).length() < 1e-5, "{at} {back}");
        }
    }

    #[test]
    fn cameras_without_a_view_are_refused() {
        let good = towards_minus_z(45.0);
        let cameras = [
            Camera { forward: Vec3::ZERO, ..good.clone() },
            Camera { forward: Vec3::NAN, ..good.clone() },
            Camera { position: Vec3::new(f32::INFINITY, 0.0, 0.0), ..good.clone() },
            Camera { up: Vec3::NAN, ..good.clone() },
            Camera { fov_y: 0.0, ..good.clone() },
            Camera { fov_y: -1.0, ..good.clone() },
            Camera { fov_y: f32::NAN, ..good.clone() },
            Camera { fov_y: 180_f32.to_radians(), ..good.clone() },
        ];
        for camera in cameras {
            assert!(matches!(Lens::new(&camera, 1.0), Err(PictureError::Camera { .. })), "{camera:?}");
        }
        // Looking along its own up, or without any: some other up is found.
        for up in [-Vec3::Z, Vec3::ZERO] {
            assert!(Lens::new(&Camera { up, ..good.clone() }, 1.0).is_ok());
        }
    }
}
