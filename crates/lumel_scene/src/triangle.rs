//! Triangles by the positions of their corners, computed in f64.

use glam::{DVec3, Vec3};
use std::cmp::Ordering;

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

/// The longest of some edges of a triangle, each by the corner that it begins at; of equally long ones that opposite the
/// smallest position, so that the order of the corners does not matter.
pub(crate) fn longest(corners: [Vec3; 3], edges: impl Iterator<Item = usize>) -> Option<usize> {
    let edge = |k: usize| (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
    edges.max_by(|&i, &j| {
        let ((a, b, opposite), (p, q, other)) = (edge(i), edge(j));
        let by_position = || other.to_array().partial_cmp(&opposite.to_array());
        length_squared(a, b)
            .total_cmp(&length_squared(p, q))
            .then_with(|| by_position().unwrap_or(Ordering::Equal))
    })
}

/// Squared length; the same bits from both ends. In f64, where squares of f32 neither overflow nor vanish.
pub(crate) fn length_squared(a: Vec3, b: Vec3) -> f64 {
    (b.as_dvec3() - a.as_dvec3()).length_squared()
}

/// The midpoint; the same bits from both ends.
pub(crate) fn middle(a: Vec3, b: Vec3) -> Vec3 {
    (0.5 * (a.as_dvec3() + b.as_dvec3())).as_vec3()
}

/// A needle is this many times as long as it is wide.
const NEEDLE: f64 = 8.0;

/// The corner of a needle between its shorter edges, from which its plane is known best: the cross product of two long edges
/// that are nearly parallel is mostly rounding. The first corner of other triangles.
pub(crate) fn widest_corner(corners: [Vec3; 3]) -> usize {
    if longest_edge(corners) < NEEDLE * least_height(corners) {
        return 0;
    }
    let opposite = |k: usize| length_squared(corners[(k + 1) % 3], corners[(k + 2) % 3]);
    (1..3).fold(0, |widest, k| if opposite(k) > opposite(widest) { k } else { widest })
}
