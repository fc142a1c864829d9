//! Viewpoints in project files.

use crate::decimal::decimal;
use glam::{DVec3, Vec3};
use lumel_scene::Camera;
use serde::{Deserialize, Serialize};

/// A viewpoint in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraEntry {
    /// Name; only the camera of a slot may leave it empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Position, metres.
    pub position: DVec3,
    /// A point it looks at.
    pub target: DVec3,
    /// The direction that is up in the picture.
    #[serde(default = "up")]
    pub up: Vec3,
    /// Vertical field of view, degrees.
    #[serde(default = "fov_deg")]
    pub fov_deg: f32,
}

fn up() -> Vec3 {
    Vec3::Y
}

fn fov_deg() -> f32 {
    60.0
}

impl CameraEntry {
    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera {
            name: self.name.clone(),
            position: self.position.as_vec3(),
            forward: (self.target - self.position).as_vec3(),
            up: self.up,
            fov_y: self.fov_deg.to_radians(),
        }
    }

    /// The viewpoint elsewhere.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        Self { position: self.position + by, target: self.target + by, ..self.clone() }
    }
}

impl From<&Camera> for CameraEntry {
    /// The entry whose [`camera`](CameraEntry::camera) is this one, up to rounding and the length of `forward`.
    fn from(camera: &Camera) -> Self {
        let forward = camera.forward.as_dvec3();
        let position = decimal(camera.position);
        // Far from the origin, a target close by would round to the position itself.
        let distance = forward.length().max(1e-3 * position.length());
        Self {
            name: camera.name.clone(),
            position,
            target: position + distance * forward.try_normalize().unwrap_or(DVec3::NEG_Z),
            up: camera.up,
            fov_deg: camera.fov_y.to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_survives_being_an_entry() {
        for scale in [1.0, 1e4] {
            let camera = Camera {
                name: "a".into(),
                position: Vec3::new(3.0, -2.0, 1.0) * scale,
                forward: Vec3::new(0.1, 0.2, -0.4),
                up: Vec3::X,
                fov_y: 0.7,
            };
            let back = CameraEntry::from(&camera).camera();
            assert_eq!((back.name, back.position, back.up), (camera.name, camera.position, camera.up));
            assert!((back.fov_y - camera.fov_y).abs() < 1e-6);
            // A millionth of the coordinates over a thousandth of them.
            assert!(back.forward.angle_between(camera.forward) < 1e-3, "{scale}");
        }
        let nowhere = Camera { forward: Vec3::ZERO, ..Camera::looking_at("b", Vec3::ONE, Vec3::ZERO, 1.0) };
        assert!(CameraEntry::from(&nowhere).camera().axes().is_some());
    }
}
