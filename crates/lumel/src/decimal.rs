//! Numbers as files should say them.

use glam::{DVec3, Vec3};

/// The shortest decimal numbers that are read as these.
pub fn decimal(position: Vec3) -> DVec3 {
    let shortest = |number: f32| number.to_string().parse().unwrap_or(f64::from(number));
    let [x, y, z] = position.to_array().map(shortest);
    DVec3::new(x, y, z)
}
