//! Warps from the unit square to triangles, disks, hemispheres and spheres.
//!
//! Each warp keeps areas in proportion to its density and is continuous, so well-spread points stay well spread.
//! Each has an inverse: `inverse(warp(u)) = u` to f32 rounding, except where a whole edge of the square meets in
//! one point. Spheres and hemispheres have z up; a [`Frame`](crate::Frame) turns them.

mod equirectangular;
mod mixed_hemisphere;
mod spherical_cap;
mod spherical_rectangle;
mod spherical_triangle;

pub use equirectangular::Equirectangular;
pub use mixed_hemisphere::{mixed_hemisphere, mixed_hemisphere_inverse, mixed_hemisphere_pdf};
pub use spherical_cap::SphericalCap;
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::SphericalTriangle;

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

use glam::{Vec2, Vec3};

use crate::bits::ONE_MINUS_EPS;

/// Barycentrics `[u, v]` of a uniform point of a triangle: the weights of corners 0 and 1.
///
/// Corner 2 gets `1 − u − v`, which is never negative. The edge `u[0] = 0` of the square meets in corner 2. The
/// density is 1/area, in m⁻² for an area in m².
///
/// Turk, *Generating random points in triangles*, Graphics Gems, 1990.
#[inline]
#[must_use]
pub fn uniform_triangle(u: [f32; 2]) -> [f32; 2] {
    // At most 1 − 2⁻²⁴, as u[0] is. The weights are rounded by less than what is missing to one.
    let both = u[0].sqrt();
    let v = both * u[1];
    [both - v, v]
}

/// The point of the unit square that [`uniform_triangle`] maps to `bary`. Corner 2 itself gives `[0, 0]`.
#[inline]
#[must_use]
pub fn uniform_triangle_inverse(bary: [f32; 2]) -> [f32; 2] {
    let both = bary[0] + bary[1];
    [in_unit(both * both), if both > 0.0 { in_unit(bary[1] / both) } else { 0.0 }]
}

/// A uniform point of the unit disk; density 1/π. Concentric squares become concentric circles.
///
/// Shirley, Chiu, *A low distortion map between disk and square*, JGT 2(3), 1997.
#[inline]
#[must_use]
pub fn concentric_disk(u: [f32; 2]) -> Vec2 {
    concentric_from_centred(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0)
}

/// The concentric map on the square `[-1, 1]²`. The result has length `max(|a|, |b|)`.
#[inline]
fn concentric_from_centred(a: f32, b: f32) -> Vec2 {
    if a.abs() > b.abs() {
        let (sin, cos) = (FRAC_PI_4 * (b / a)).sin_cos();
        Vec2::new(a * cos, a * sin)
    } else if b != 0.0 {
        let (sin, cos) = (FRAC_PI_4 * (a / b)).sin_cos();
        Vec2::new(b * sin, b * cos)
    } else {
        Vec2::ZERO
    }
}

/// The point of the unit square that [`concentric_disk`] maps to `point`.
#[inline]
#[must_use]
pub fn concentric_disk_inverse(point: Vec2) -> [f32; 2] {
    let Vec2 { x, y } = point;
    let radius = point.length();
    let (a, b) = if x.abs() > y.abs() {
        let a = radius.copysign(x);
        (a, a * (y / x).atan() / FRAC_PI_4)
    } else if y != 0.0 {
        let b = radius.copysign(y);
        (b * (x / y).atan() / FRAC_PI_4, b)
    } else {
        (0.0, 0.0)
    };
    [in_unit(0.5 + 0.5 * a), in_unit(0.5 + 0.5 * b)]
}

/// A unit direction with density cos θ / π per steradian around +z. Its z is greater than zero for any `u`.
///
/// The concentric disk lifted onto the hemisphere (Malley's method); see [`cosine_hemisphere_pdf`].
#[inline]
#[must_use]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let (point, below_one) = inside_disk(u);
    point.extend(below_one.sqrt())
}

/// A uniform point inside the unit disk, and how far its squared length is below one: more than zero.
#[inline]
fn inside_disk(u: [f32; 2]) -> (Vec2, f32) {
    // A coordinate of zero stands for [0, 2⁻²⁴): its middle keeps the point off the circle.
    let centred = |x: f32| 2.0 * x.clamp(f32::EPSILON / 4.0, ONE_MINUS_EPS) - 1.0;
    let (a, b) = (centred(u[0]), centred(u[1]));
    let radius = a.abs().max(b.abs());
    // (1 − r)(1 + r) is free of the cancellation that 1 − x² − y² suffers at the horizon.
    (concentric_from_centred(a, b), (1.0 - radius) * (1.0 + radius))
}

/// Density of [`cosine_hemisphere`] in sr⁻¹; `cos` is the cosine to +z. Zero below the horizon.
#[inline]
#[must_use]
pub fn cosine_hemisphere_pdf(cos: f32) -> f32 {
    cos.max(0.0) * FRAC_1_PI
}

/// The point of the unit square that [`cosine_hemisphere`] maps to the unit `direction`.
#[inline]
#[must_use]
pub fn cosine_hemisphere_inverse(direction: Vec3) -> [f32; 2] {
    concentric_disk_inverse(direction.truncate())
}

/// A unit direction with z > 0, uniform in solid angle: density 1/2π per steradian.
#[inline]
#[must_use]
pub fn uniform_hemisphere(u: [f32; 2]) -> Vec3 {
    around_axis(1.0 - u[0], (u[0] * (2.0 - u[0])).sqrt(), u[1])
}

/// Density of [`uniform_hemisphere`] in sr⁻¹; `cos` is the cosine to +z. Zero at and below the horizon.
#[inline]
#[must_use]
pub fn uniform_hemisphere_pdf(cos: f32) -> f32 {
    if cos > 0.0 { 1.0 / TAU } else { 0.0 }
}

/// The point of the unit square that [`uniform_hemisphere`] maps to the unit `direction`. The pole gives `[0, 0]`.
#[inline]
#[must_use]
pub fn uniform_hemisphere_inverse(direction: Vec3) -> [f32; 2] {
    [in_unit(1.0 - direction.z), turn_of(direction)]
}

/// A unit direction, uniform over the sphere: density 1/4π per steradian.
#[inline]
#[must_use]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    around_axis(1.0 - 2.0 * u[0], 2.0 * (u[0] * (1.0 - u[0])).sqrt(), u[1])
}

/// Density of [`uniform_sphere`] in sr⁻¹.
#[inline]
#[must_use]
pub const fn uniform_sphere_pdf() -> f32 {
    0.5 / TAU
}

/// The point of the unit square that [`uniform_sphere`] maps to the unit `direction`. The poles give `u[1] = 0`.
#[inline]
#[must_use]
pub fn uniform_sphere_inverse(direction: Vec3) -> [f32; 2] {
    [in_unit(0.5 - 0.5 * direction.z), turn_of(direction)]
}

/// The direction at height `z`, distance `radius` from the axis, `turn` of a full turn from +x to +y.
#[inline]
fn around_axis(z: f32, radius: f32, turn: f32) -> Vec3 {
    let (sin, cos) = (TAU * turn).sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}

/// How far `direction` is turned from +x to +y, in full turns, `[0, 1)`.
#[inline]
fn turn_of(direction: Vec3) -> f32 {
    let turn = direction.y.atan2(direction.x) / TAU;
    in_unit(if turn < 0.0 { turn + 1.0 } else { turn })
}

/// Clamps to `[0, 1)`.
#[inline]
fn in_unit(x: f32) -> f32 {
    x.clamp(0.0, ONE_MINUS_EPS)
}
