//! The closed form of a polygon's light.

use glam::{DMat3, DVec3, Vec3};
use lumel_basis::{HARMONICS, integrals_of_harmonics};
use smallvec::SmallVec;

/// Unblocked irradiance of a flat polygon per unit of its constant radiance, at `point` with unit `normal`: the form
/// factor times pi.
///
/// The corners run counter-clockwise seen from the lit side; points behind the polygon get nothing. The part of it
/// below the receiver's horizon is clipped off. Exact to about 1e-12, relative error 1e-6 for polygons that subtend
/// more than 1e-3.
///
/// Lambert, *Photometria*, 1760; Arvo, *Analytic Methods for Simulated Light Transport*, 1995, 2.3.
pub(crate) fn unit_irradiance(corners: &[Vec3], point: Vec3, normal: Vec3) -> f64 {
    let normal = normal.as_dvec3();
    Clipped::new(corners, point, normal).unit_irradiance(normal).max(0.0)
}

/// The same for all channels of light by direction: irradiance, and the integrals of the harmonics over the part of the polygon
/// above the horizon.
///
/// Axial moments of the directions of a polygon have closed forms in any degree; these are those up to the second.
/// Arvo, *Applications of Irradiance Tensors to the Simulation of Non-Lambertian Phenomena*, 1995.
pub(crate) fn unit_moments(corners: &[Vec3], point: Vec3, normal: Vec3) -> [f64; 1 + HARMONICS] {
    let normal = normal.as_dvec3();
    let (solid_angle, first, second) = Clipped::new(corners, point, normal).moments();
    let mut moments = [first.dot(normal).max(0.0); 1 + HARMONICS];
    moments[1..].copy_from_slice(&integrals_of_harmonics(solid_angle, first, second));
    moments
}

/// Whether [`unit_irradiance`] is above zero: the point lies in front of the polygon, and a part of it above the horizon.
pub(crate) fn is_lit(corners: &[Vec3], point: Vec3, normal: Vec3) -> bool {
    let from = point.as_dvec3();
    let [a, b, .., last] = corners else { return false };
    let [a, b, last] = [a, b, last].map(|corner| corner.as_dvec3() - from);
    let is_in_front = (b - a).cross(last - a).dot(a) < 0.0;
    is_in_front && corners.iter().any(|corner| (corner.as_dvec3() - from).dot(normal.as_dvec3()) > 0.0)
}

/// A polygon of up to five corners above the horizon, as seen from the origin.
#[derive(Default)]
struct Clipped {
    corners: [DVec3; 8],
    len: usize,
}

impl Clipped {
    fn new(corners: &[Vec3], point: Vec3, normal: DVec3) -> Self {
        let from = point.as_dvec3();
        let mut polygon = Self::default();
        for (i, corner) in corners.iter().enumerate() {
            let a = corner.as_dvec3() - from;
            let b = corners[(i + 1) % corners.len()].as_dvec3() - from;
            polygon.push_edge(a, b, normal);
        }
        polygon
    }

    /// The integrals of 1, of directions and of their products.
    fn moments(&self) -> (f64, DVec3, DMat3) {
        let corners: SmallVec<[DVec3; 8]> =
            self.corners[..self.len].iter().filter_map(|corner| corner.try_normalize()).collect();
        let (mut solid_angle, mut first, mut products) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for (i, a) in corners.iter().enumerate() {
            let (apex, b) = (corners[0], corners[(i + 1) % corners.len()]);
            // Van Oosterom and Strackee, 1983.
            let below = 1.0 + apex.dot(*a) + a.dot(b) + b.dot(apex);
            solid_angle += 2.0 * apex.dot(b.cross(*a)).atan2(below);
            let cross = b.cross(*a);
            let length = cross.length();
            if length > 0.0 {
                let inwards = cross / length;
                first += 0.5 * length.atan2(a.dot(b)) * inwards;
                // The integral of directions along the edge: their sum times the tangent of half of its angle.
                let along = (*a + b) * (length / (1.0 + a.dot(b)));
                let product = |u: DVec3, v: DVec3| DMat3::from_cols(u * v.x, u * v.y, u * v.z);
                products += 0.5 * (product(inwards, along) + product(along, inwards));
            }
        }
        let second = (products + DMat3::from_diagonal(DVec3::splat(solid_angle))) * (1.0 / 3.0);
        (solid_angle, first, second)
    }

    fn push(&mut self, corner: DVec3) {
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// One step of Sutherland and Hodgman's clipping against the horizon.
    fn push_edge(&mut self, a: DVec3, b: DVec3, normal: DVec3) {
        let (above_a, above_b) = (a.dot(normal), b.dot(normal));
        if above_a >= 0.0 {
            self.push(a);
        }
        if (above_a > 0.0 && above_b < 0.0) || (above_a < 0.0 && above_b > 0.0) {
            self.push(a.lerp(b, above_a / (above_a - above_b)));
        }
    }

    fn unit_irradiance(&self, normal: DVec3) -> f64 {
        let corners = &self.corners[..self.len];
        let mut sum = 0.0;
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            // The angle by atan2 keeps its digits for short edges, where acos loses half of them.
            let cross = b.cross(*a);
            let length = cross.length();
            if length > 0.0 {
                sum += length.atan2(a.dot(b)) * cross.dot(normal) / length;
            }
        }
        0.5 * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_basis::spherical_harmonics;
    use std::f64::consts::PI;

    /// A rectangle with given minimum and maximum corner in the plane z, shining down.
    fn ceiling(x: [f32; 2], y: [f32; 2], z: f32) -> [Vec3; 4] {
        [[0, 0], [0, 1], [1, 1], [1, 0]].map(|[i, j]| Vec3::new(x[i], y[j], z))
    }

    fn form_factor(corners: &[Vec3], normal: Vec3) -> f64 {
        unit_irradiance(corners, Vec3::ZERO, normal) / PI
    }

    #[test]
    fn form_factors_of_elements_and_rectangles_are_the_known_ones() {
        let corner = ceiling([0.0, 1.0], [0.0, 1.0], 1.0);
        assert!((form_factor(&corner, Vec3::Z) - 0.138531605995).abs() < 1e-12);
        let center = ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0);
        assert!((form_factor(&center, Vec3::Z) - 0.554126423980).abs() < 1e-12);
        let near = ceiling([0.0, 2.0], [0.0, 1.0], 0.5);
        assert!((form_factor(&near, Vec3::Z) - 0.220777622335).abs() < 1e-12);
        let standing = |height: f32, width: f32, d: f32| {
            [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|[y, z]| Vec3::new(d, -y, z))
        };
        assert!((form_factor(&standing(1.0, 1.0, 1.0), Vec3::Z) - 0.055734197003).abs() < 1e-12);
        assert!((form_factor(&standing(2.0, 1.0, 0.5), Vec3::Z) - 0.158774804514).abs() < 1e-12);
    }

    #[test]
    fn tilted_receivers_see_the_polygon_above_their_horizon_only() {
        let light = ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0);
        let known = [
            (30.0, 0.479887560075),
            (60.0, 0.289365194440),
            (90.0, 0.111468394005),
            (120.0, 0.012301982450),
            (150.0, 0.0),
        ];
        for (degrees, factor) in known {
            let angle = f64::to_radians(degrees);
            let normal = DVec3::new(angle.sin(), 0.0, angle.cos()).as_vec3();
            // The normal is rounded to f32: 6e-8.
            assert!((form_factor(&light, normal) - factor).abs() < 1e-7, "{degrees}");
        }
    }

    /// The moments of the part of a triangle above the horizon, by quadrature.
    fn by_quadrature([a, b, c]: [DVec3; 3], normal: DVec3) -> [f64; 1 + HARMONICS] {
        let (n, mut sums) = (700, [0.0; 1 + HARMONICS]);
        let area = 0.5 * (b - a).cross(c - a).length();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [s, t] = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let point = a + (b - a) * s + (c - b) * (s * t);
            let direction = point.normalize();
            let cos = direction.dot(normal);
            if cos > 0.0 {
                let weight = 2.0 * s * area * direction.z / point.length_squared() / f64::from(n * n);
                sums[0] += weight * cos;
                for (sum, y) in sums[1..].iter_mut().zip(spherical_harmonics(direction.as_vec3())) {
                    *sum += weight * f64::from(y);
                }
            }
        }
        sums
    }

    #[test]
    fn moments_are_those_of_the_part_above_the_horizon() {
        let light = ceiling([-1.0, 0.7], [-0.5, 1.0], 0.8);
        for tilt in [0.0f32, 0.9, 1.7] {
            let normal = Vec3::new(tilt.sin(), 0.0, tilt.cos());
            let of = |k: [usize; 3]| by_quadrature(k.map(|k| light[k].as_dvec3()), normal.as_dvec3());
            let (first, second) = (of([0, 1, 2]), of([0, 2, 3]));
            let [triangle, whole] =
                [&light[..3], &light].map(|corners| unit_moments(corners, Vec3::ZERO, normal));
            for k in 0..=HARMONICS {
                assert!((triangle[k] - first[k]).abs() < 1e-3, "{tilt} {k}: {triangle:?} {first:?}");
                assert!((whole[k] - first[k] - second[k]).abs() < 1e-3, "{tilt} {k}: {whole:?}");
            }
            assert!((whole[0] - unit_irradiance(&light, Vec3::ZERO, normal)).abs() < 1e-12);
        }
        // Nearly all of the sky: c₀₀ and c₁₀ of a hemisphere, and nothing in band 2.
        let sky = unit_moments(&ceiling([-1e4, 1e4], [-1e4, 1e4], 1.0), Vec3::ZERO, Vec3::Z);
        for (found, expected) in
            sky.iter().zip([PI, 1.772_453_851, 0.0, 1.534_990_062, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        {
            assert!((found - expected).abs() < 1e-3, "{sky:?}");
        }
    }

    #[test]
    fn the_back_of_a_polygon_is_dark() {
        let mut light = ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0);
        light.reverse();
        assert_eq!(form_factor(&light, Vec3::Z), 0.0);
    }

    #[test]
    fn points_are_lit_exactly_where_light_arrives() {
        let mut lit = 0;
        for (x, y, z, tilt) in [-1.5_f32, -0.2, 0.4, 2.0].into_iter().flat_map(|x| {
            [-0.5_f32, 1.5].into_iter().flat_map(move |y| {
                [-1.0_f32, 0.5, 1.5]
                    .into_iter()
                    .flat_map(move |z| (0..12).map(move |tilt| (x, y, z, 0.5 * tilt as f32 + 0.1)))
            })
        }) {
            let (point, normal) = (Vec3::new(x, y, z), Vec3::new(tilt.sin(), 0.0, tilt.cos()));
            let light = ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0);
            for corners in [&light[..], &light[..3]] {
                let arrives = unit_irradiance(corners, point, normal) > 0.0;
                assert_eq!(is_lit(corners, point, normal), arrives, "{point} {normal}");
                lit += usize::from(arrives);
            }
        }
        assert!((100..400).contains(&lit), "{lit}");
    }
}
