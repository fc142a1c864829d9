//! The watertight ray-triangle test.
//!
//! A ray that passes an edge meets exactly the triangles on one side of it (or both): neighbours evaluate the same
//! edge function on the same two shared vertices and can only differ in its sign.
//!
//! Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.

use glam::Vec3;
use lumel_scene::{Barycentrics, FaceSide};

/// A ray in the frame in which it runs along its longest axis, z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    origin: Vec3,
    /// The axis that becomes z; x and y follow it in turn.
    axis: usize,
    /// How far x, y and z are sheared per unit of the longest axis.
    shear: [f32; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    pub(crate) t: f32,
    pub(crate) bary: Barycentrics,
    pub(crate) side: FaceSide,
}

impl ShearedRay {
    /// `None` when there is no direction to shear along.
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Option<Self> {
        if !(origin.is_finite() && direction.is_finite()) {
            return None;
        }
        let axis = direction.abs().max_position();
        let longest = direction[axis];
        if longest == 0.0 {
            return None;
        }
        let shear = [direction[(axis + 1) % 3] / longest, direction[(axis + 2) % 3] / longest, 1.0 / longest];
        shear.iter().all(|s| s.is_finite()).then_some(Self { origin, axis, shear })
    }

    /// Meets a triangle at `0 < t <= t_max`; the caller breaks ties at `t_max`.
    #[inline]
    pub(crate) fn intersect(&self, corners: &[Vec3; 3], t_max: f32) -> Option<TriangleHit> {
        // With the axis known to the compiler, coordinates stay in registers.
        match self.axis {
            0 => self.intersect_along::<0>(corners, t_max),
            1 => self.intersect_along::<1>(corners, t_max),
            _ => self.intersect_along::<2>(corners, t_max),
        }
    }

    #[inline(always)]
    fn sheared<const Z: usize>(&self, p: Vec3) -> [f32; 3] {
        let p = (p - self.origin).to_array();
        let z = p[Z];
        [p[(Z + 1) % 3] - self.shear[0] * z, p[(Z + 2) % 3] - self.shear[1] * z, z]
    }

    #[inline(always)]
    fn intersect_along<const Z: usize>(&self, corners: &[Vec3; 3], t_max: f32) -> Option<TriangleHit> {
        let [a, b, c] = corners.map(|p| self.sheared::<Z>(p));
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            // On an edge f32 cannot tell the side: the products are exact in f64.
            u = exact_edge(&c, &b);
            v = exact_edge(&a, &c);
            w = exact_edge(&b, &a);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let t = (u * a[2] + v * b[2] + w * c[2]) * self.shear[2] * inverse;
        if !(t > 0.0 && t <= t_max) {
            return None;
        }
        // Looking against the axis mirrors the winding.
        let front = (det > 0.0) == (self.shear[2] > 0.0);
        let side = if front { FaceSide::Front } else { FaceSide::Back };
        Some(TriangleHit { t, bary: Barycentrics { u: u * inverse, v: v * inverse }, side })
    }
}

fn exact_edge(p: &[f32; 3], q: &[f32; 3]) -> f32 {
    (f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])) as f32
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
            let ray = ShearedRay::new(origin, target - origin).unwrap();
            let hit = ray.intersect(&TRIANGLE, 10.0).unwrap();
            assert!((hit.t - 1.0).abs() < 1e-6);
            assert!((hit.bary.u - weights[0]).abs() < 1e-5 && (hit.bary.v - weights[1]).abs() < 1e-5);
            // The normal is +z: the front is seen from above.
            assert_eq!(hit.side == FaceSide::Front, origin.z > 0.0, "{origin}");
        }
    }

    #[test]
    fn every_dominant_axis_and_sign_sees_the_same_side() {
        // The same triangle and ray turned through all axes keep their relation.
        let turn = |p: Vec3, k: usize| match k {
            0 => p,
            1 => Vec3::new(p.z, p.x, p.y),
            _ => Vec3::new(p.y, p.z, p.x),
        };
        for k in 0..3 {
            for sign in [1.0, -1.0] {
                let origin = turn(Vec3::new(0.4, 0.5, sign), k);
                let direction = turn(Vec3::new(0.01, 0.02, -sign), k);
                let corners = TRIANGLE.map(|p| turn(p, k));
                let hit = ShearedRay::new(origin, direction).unwrap().intersect(&corners, 9.0).unwrap();
                assert_eq!(hit.side == FaceSide::Front, sign > 0.0);
            }
        }
    }

    #[test]
    fn rays_without_direction_meet_nothing() {
        assert!(ShearedRay::new(Vec3::ZERO, Vec3::ZERO).is_none());
        assert!(ShearedRay::new(Vec3::ZERO, Vec3::new(f32::NAN, 0.0, 1.0)).is_none());
        assert!(ShearedRay::new(Vec3::splat(f32::INFINITY), Vec3::X).is_none());
        assert!(ShearedRay::new(Vec3::ZERO, Vec3::X * 1e-42).is_none());
    }

    #[test]
    fn a_triangle_seen_edge_on_is_not_met() {
        let ray = ShearedRay::new(Vec3::new(-1.0, 0.5, 0.0), Vec3::X).unwrap();
        assert!(ray.intersect(&TRIANGLE, 9.0).is_none());
    }
}
