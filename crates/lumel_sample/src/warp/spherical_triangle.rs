//! Uniform sampling of the solid angle of a triangle.

use glam::{DVec3, Vec3};

use crate::bits::unit_from_f64;

/// A triangle seen from a point, sampled uniformly in solid angle.
///
/// The factor cos θₗ / r² of area sampling is gone from the estimator. Both sides of the triangle count.
///
/// Set up and evaluated in f64; directions are accurate to f32 rounding.
///
/// Arvo, *Stratified sampling of spherical triangles*, SIGGRAPH 1995, with half-angle formulas that do not cancel for
/// small triangles.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    /// Unit directions to the corners.
    a: DVec3,
    b: DVec3,
    c: DVec3,
    /// Unit direction, orthogonal to a, in which the arc from a to c sets out.
    towards_c: DVec3,
    /// Sine and cosine of the internal angle at a.
    sin_alpha: f64,
    cos_alpha: f64,
    /// Tangent of half the arc from a to b.
    tan_half_ab: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle `a`, `b`, `c` as seen from `from`; all in world space, metres.
    ///
    /// Returns `None`, and the caller samples the area instead, if the triangle is degenerate, if `from` lies in its
    /// plane, or if the solid angle is outside of 3e-4..=6.22 sr.
    ///
    /// Solid angle: Van Oosterom, Strackee, *The solid angle of a plane triangle*, 1983.
    #[must_use]
    pub fn new(a: Vec3, b: Vec3, c: Vec3, from: Vec3) -> Option<Self> {
        let direction = |corner: Vec3| (corner.as_dvec3() - from.as_dvec3()).try_normalize();
        let (a, b, c) = (direction(a)?, direction(b)?, direction(c)?);
        let volume = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        // Written so that NaN fails.
        if !(3e-4..=6.22).contains(&solid_angle) {
            return None;
        }
        let towards = |corner: DVec3| (corner - a * a.dot(corner)).try_normalize();
        let (towards_b, towards_c) = (towards(b)?, towards(c)?);
        Some(Self {
            a,
            b,
            c,
            towards_c,
            sin_alpha: towards_b.cross(towards_c).length(),
            cos_alpha: towards_b.dot(towards_c),
            tan_half_ab: tan_half_arc(a, b),
            solid_angle,
        })
    }

    /// Solid angle of the triangle, sr.
    #[inline]
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// Density of [`sample`](Self::sample), sr⁻¹: one over the solid angle, anywhere on the triangle.
    #[inline]
    #[must_use]
    pub fn pdf(&self) -> f64 {
        1.0 / self.solid_angle
    }

    /// A unit direction from `from` into the triangle, uniform in solid angle.
    ///
    /// `u[0]` moves a corner c′ along the arc from a to c, such that the triangle a, b, c′ has its share E of the solid
    /// angle; `u[1]` moves along the arc from b to c′. The two sides at a and the angle α between them give
    /// `tan(E/2) = t sin α / (1 + t cos α)` with `t = tan(ab/2) tan(ac′/2)`; hence
    /// `tan(ac′/2) = sin(E/2) / (tan(ab/2) sin(α − E/2))`.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        let (sin, cos) = (0.5 * f64::from(u[0]) * self.solid_angle).sin_cos();
        let tan_half = sin / (self.tan_half_ab * (self.sin_alpha * cos - self.cos_alpha * sin));
        let squared = tan_half * tan_half;
        let c = (self.a * (1.0 - squared) + self.towards_c * (2.0 * tan_half)) / (1.0 + squared);

        let to_c = c - self.b;
        let towards = (to_c - self.b * self.b.dot(to_c)).normalize_or_zero();
        // One minus the cosine of the arc from b, uniform between zero and its value at c′.
        let rise = f64::from(u[1]) * 0.5 * to_c.length_squared();
        (self.b * (1.0 - rise) + towards * (rise * (2.0 - rise)).sqrt()).as_vec3()
    }

    /// The point of the unit square that [`sample`](Self::sample) maps to `direction`, of any length.
    ///
    /// The direction to corner b gives `[0, 0]`; directions beside the triangle are clamped.
    #[inline]
    #[must_use]
    pub fn inverse(&self, direction: Vec3) -> [f32; 2] {
        let Some(direction) = direction.as_dvec3().try_normalize() else { return [0.0; 2] };
        // c′ is where the great circle through b and the direction meets the one through a and c, on their side.
        let meeting = self.b.cross(direction).cross(self.a.cross(self.towards_c)).try_normalize();
        let Some(meeting) = meeting else { return [0.0; 2] };
        let c = if meeting.dot(self.a + self.c) < 0.0 { -meeting } else { meeting };

        let t = self.tan_half_ab * tan_half_arc(self.a, c);
        let area = 2.0 * (t * self.sin_alpha).atan2(1.0 + t * self.cos_alpha);
        let rise = (direction - self.b).length_squared() / (c - self.b).length_squared();
        [unit_from_f64(area / self.solid_angle), unit_from_f64(rise)]
    }
}

/// Tangent of half the angle between two unit vectors, accurate for small ones.
#[inline]
fn tan_half_arc(a: DVec3, b: DVec3) -> f64 {
    (b - a).length() / (b + a).length()
}
