//! The ray-triangle test: what decides, and what is measured.
//!
//! Whether a ray passes through a triangle is decided by the signs of three edge functions, and these must not be
//! wrong: a ray that two neighbours both let through leaks. Single precision is enough for nearly all rays; it comes
//! with a bound of its error, and what lies within the bound is decided by [`passes`], exactly. So nothing passes
//! between neighbours, and the answer does not depend on who asks.
//!
//! Distance and barycentrics come from single precision, by the same operations in the same order in all kernels. So
//! the hit of a ray does not depend on how it was traced.

use glam::{DVec3, Vec3};
use lumel_scene::{Barycentrics, FaceSide};
use robust::{Coord3D, orient3d};

/// Bound of the error of the three edge functions in single precision, relative to the product of the largest
/// components of edge, corner and direction.
///
/// With unit roundoff ε/2 a component of a cross product of edge and corner errs by 7/2 ε of that product: both
/// factors by ε/2, each of two products and their difference by as much of twice the size. A dot product of three such
/// with the direction errs by 33/2 ε, the third function, a difference of three dot products, by 123/2 ε.
pub(crate) const EDGE_ERROR: f32 = 64.0 * f32::EPSILON;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    pub(crate) t: f32,
    /// Weights of corners 1 and 2.
    pub(crate) weights: [f32; 2],
    pub(crate) side: FaceSide,
}

impl TriangleHit {
    /// Rounding may have put the weights outside of the triangle, far if it is tiny.
    pub(crate) fn bary(&self) -> Barycentrics {
        let second = self.weights[0].clamp(0.0, 1.0);
        let third = self.weights[1].clamp(0.0, 1.0 - second);
        Barycentrics { u: 1.0 - second - third, v: second }
    }
}

/// Whether rays have a direction, and an origin.
#[inline]
pub(crate) fn is_traceable(origin: Vec3, direction: Vec3) -> bool {
    // One over anything longer than 2⁻¹²⁸ is finite.
    const TOO_SHORT: f32 = f32::MIN_POSITIVE / 4.0;
    origin.is_finite() && direction.is_finite() && direction.abs().max_element() > TOO_SHORT
}

/// Whether the line of a ray passes through a triangle, edges included; exact.
///
/// It does if it has all edges on the same side of it. Neighbours evaluate the same determinant for the edge they
/// share, but for its sign.
///
/// Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, 1997.
#[cold]
pub(crate) fn passes(corners: &[Vec3; 3], origin: Vec3, direction: Vec3) -> bool {
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let [a, b, c] = corners.map(|p| point(p.as_dvec3()));
    // Two points of the line. If the sum is rounded, it is for all triangles alike.
    let (start, ahead) = (point(origin.as_dvec3()), point(origin.as_dvec3() + direction.as_dvec3()));
    let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| orient3d(p, q, ahead, start));
    let inside = sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
    inside && sides.iter().any(|&s| s != 0.0)
}

/// Whether a ray that passes through a triangle still does if it is moved a little, always the same way.
///
/// Of the triangles around a point of a surface that share the edge or the vertex which a ray passes through, this holds
/// for one: what is to count each surface once asks for it. Exact on edges; a ray that is not on one is not moved off.
pub(crate) fn owns(corners: &[Vec3; 3], origin: Vec3, direction: Vec3) -> bool {
    // As good as any that no edge runs along.
    const MOVES: [DVec3; 2] =
        [DVec3::new(0.613_746, 0.358_107, 0.703_935), DVec3::new(-0.281_193, 0.912_346, 0.297_518)];
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (start, ahead) = (origin.as_dvec3(), origin.as_dvec3() + direction.as_dvec3());
    let edges = [(b, c), (c, a), (a, b)];
    let sides = edges.map(|(p, q)| orient3d(point(p), point(q), point(ahead), point(start)));
    if sides.iter().all(|&side| side != 0.0) {
        return true;
    }
    let inside = sides.iter().sum::<f64>().signum();
    edges.iter().zip(sides).filter(|(_, side)| *side == 0.0).all(|(&(p, q), _)| {
        // How that side changes as the line moves: neighbours get the same but for its sign.
        let normal = (q - p).cross(ahead - start);
        let change = MOVES.map(|step| normal.dot(step)).into_iter().find(|&change| change != 0.0);
        change.is_some_and(|change| change * inside > 0.0)
    })
}

/// The test of one ray and one triangle: `0 < t <= limit`.
///
/// Möller, Trumbore, *Fast, minimum storage ray/triangle intersection*, 1997, with the triple products grouped so that
/// all that does not depend on the direction can be shared by rays of one origin.
pub(crate) fn intersect(
    corners: &[Vec3; 3],
    origin: Vec3,
    direction: Vec3,
    limit: f32,
) -> Option<TriangleHit> {
    let [a, b, c] = *corners;
    let (e1, e2, to_corner) = (b - a, c - a, a - origin);
    let normal = cross(e1, e2);
    let height = dot(normal, to_corner);
    let det = dot(normal, direction);
    let (second, third) = (dot(cross(e2, to_corner), direction), dot(cross(to_corner, e1), direction));
    let inverse = 1.0 / det;
    let t = height * inverse;
    if !(t > 0.0 && t <= limit && passes(corners, origin, direction)) {
        return None;
    }
    let side = if height < 0.0 { FaceSide::Front } else { FaceSide::Back };
    Some(TriangleHit { t, weights: [second * inverse, third * inverse], side })
}

/// One rounding per component for the difference: the kernels do the same.
fn cross(a: Vec3, b: Vec3) -> Vec3 {
    let component = |i: usize, j: usize| a[i].mul_add(b[j], -(a[j] * b[i]));
    Vec3::new(component(1, 2), component(2, 0), component(0, 1))
}

fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] =
        [Vec3::new(0.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];

    #[test]
    fn barycentrics_weigh_corners_zero_and_one() {
        let weights = [0.5, 0.3, 0.2];
        let target = TRIANGLE[0] * weights[0] + TRIANGLE[1] * weights[1] + TRIANGLE[2] * weights[2];
        for origin in [Vec3::new(0.3, -1.0, 5.0), Vec3::new(4.0, 2.0, -3.0), Vec3::new(0.1, 0.2, 0.7)] {
            let hit = intersect(&TRIANGLE, origin, target - origin, 10.0).unwrap();
            assert!((hit.t - 1.0).abs() < 1e-6);
            assert!((hit.bary().u - weights[0]).abs() < 1e-5 && (hit.bary().v - weights[1]).abs() < 1e-5);
            // The normal is +z: the front is seen from above.
            assert_eq!(hit.side == FaceSide::Front, origin.z > 0.0, "{origin}");
        }
    }

    #[test]
    fn rays_without_direction_are_not_traced() {
        assert!(is_traceable(Vec3::ZERO, Vec3::X * 1e-30));
        assert!(!is_traceable(Vec3::ZERO, Vec3::ZERO));
        assert!(!is_traceable(Vec3::ZERO, Vec3::new(f32::NAN, 0.0, 1.0)));
        assert!(!is_traceable(Vec3::splat(f32::INFINITY), Vec3::X));
        assert!(!is_traceable(Vec3::ZERO, Vec3::X * 1e-42));
    }

    #[test]
    fn a_triangle_seen_edge_on_is_not_met() {
        assert!(intersect(&TRIANGLE, Vec3::new(-1.0, 0.5, 0.0), Vec3::X, 9.0).is_none());
    }

    #[test]
    fn lines_through_an_edge_pass_one_of_its_two_triangles_or_both() {
        let across = [TRIANGLE[2], TRIANGLE[1], Vec3::new(2.0, 3.0, 0.5)];
        for i in 0..10_000u16 {
            let s = f32::from(i) / 10_000.0;
            let origin = Vec3::new(s, 1.0 - s * s, 3.0 + s);
            let target = TRIANGLE[1].lerp(TRIANGLE[2], s);
            let [one, two] = [TRIANGLE, across].map(|t| passes(&t, origin, target - origin));
            assert!(one || two, "{origin} to {target}");
        }
    }
}
