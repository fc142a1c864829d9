//! Triangles by the positions of their corners, computed in f64.

use glam::{DVec3, Vec3};

/// Unit normal from the winding.
#[inline]
pub(crate) fn normal(corners: [Vec3; 3]) -> Vec3 {
    unit_normal(corners).as_vec3()
}

/// The same before it is rounded.
#[inline]
pub(crate) fn unit_normal(corners: [Vec3; 3]) -> DVec3 {
    cross(corners).normalize_or(DVec3::Y)
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

/// Length of the longest edge, metres.
pub(crate) fn longest_edge(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    [b - a, c - b, a - c].into_iter().map(DVec3::length_squared).fold(0.0, f64::max).sqrt()
}

/// The least distance of a corner from the opposite edge, metres.
pub(crate) fn least_height(corners: [Vec3; 3]) -> f64 {
    2.0 * area(corners) / longest_edge(corners).max(f64::MIN_POSITIVE)
}

/// The angle at corner `k`, radians.
pub(crate) fn angle(corners: [Vec3; 3], k: usize) -> f64 {
    let p = corners.map(|p| p.as_dvec3());
    let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
    a.cross(b).length().atan2(a.dot(b))
}
