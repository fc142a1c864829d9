//! Triangles by the positions of their corners, computed in f64.

use glam::{DVec3, Vec3};

/// Unit normal from the winding.
pub(crate) fn normal(corners: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or(DVec3::Y).as_vec3()
}

/// Area, m².
pub(crate) fn area(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

/// The angle at corner `k`, radians.
pub(crate) fn angle(corners: [Vec3; 3], k: usize) -> f64 {
    let p = corners.map(|p| p.as_dvec3());
    let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
    a.cross(b).length().atan2(a.dot(b))
}
