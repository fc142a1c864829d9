//! Viewpoints.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A pinhole camera or a camera bookmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The name users choose it by.
    pub name: String,
    /// Where it is.
    pub position: Vec3,
    /// Where it looks; any length but zero.
    pub forward: Vec3,
    /// What is up in the picture; need not be perpendicular to `forward`.
    pub up: Vec3,
    /// Vertical field of view, radians.
    pub fov_y: f32,
}

impl Camera {
    /// A camera at `position` that looks at `target`, +Y up.
    pub fn looking_at(name: &str, position: Vec3, target: Vec3, fov_y: f32) -> Self {
        Self { name: name.to_owned(), position, forward: target - position, up: Vec3::Y, fov_y }
    }

    /// The camera's unit axes: right, up, forward. `None` when `forward` is zero or not finite.
    ///
    /// A camera that looks along its own `up` gets some other one.
    pub fn axes(&self) -> Option<[Vec3; 3]> {
        let forward = self.forward.try_normalize()?;
        let right = forward
            .cross(self.up)
            .try_normalize()
            .or_else(|| forward.cross(Vec3::Z).try_normalize())
            .or_else(|| forward.cross(Vec3::X).try_normalize())?;
        Some([right, right.cross(forward), forward])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        let camera = Camera::looking_at("c", Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 0.0), 0.8);
        let [right, up, forward] = camera.axes().unwrap();
        assert!((right.cross(up) + forward).length() < 1e-6);
        assert!(up.y > 0.0);
    }

    #[test]
    fn a_camera_looking_straight_down_still_has_axes() {
        let camera = Camera::looking_at("c", Vec3::Y, Vec3::ZERO, 0.8);
        let [right, up, _] = camera.axes().unwrap();
        assert!(right.is_normalized() && up.is_normalized());
    }
}
