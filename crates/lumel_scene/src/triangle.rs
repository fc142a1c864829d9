//! Triangles by the positions of their corners, computed in f64.

use glam::{DVec3, Vec3};

/// Unit normal from the winding.
#[inline]
pub(crate) fn normal(corners: [Vec3; 3]) -> Vec3 {
    cross(corners).normalize_or(DVec3::Y).as_vec3()
}

/// Area, m².
#[inline]
pub(crate) fn area(corners: [Vec3; 3]) -> f64 {
    0.5 * cross(corners).length()
}

/// The normal times twice the area. Receivers over areas ask for it for every sample.
#[inline]
fn cross([a, b, c]: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
    (b - a).cross(c - a)
}

/// The angle at corner `k`, radians.
pub(crate) fn angle(corners: [Vec3; 3], k: usize) -> f64 {
    let p = corners.map(|p| p.as_dvec3());
    let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
    a.cross(b).length().atan2(a.dot(b))
}
