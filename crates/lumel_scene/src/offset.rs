//! Pushing ray origins off the surfaces they start on.

use crate::{Scene, SurfacePoint, TriId, triangle};
use glam::{DVec3, Vec3};

/// Machine epsilon; rounding errs by at most half of it.
const EPSILON: f64 = f32::EPSILON as f64;

/// How many errors of each kind are allowed for: that of the point, and that of a neighbour in the same plane.
const SIDES: f64 = 2.0;

/// The error of a height above a triangle counts as at most this many epsilons of its longest edge: slivers have no
/// better one, and are not worth a step across a narrow gap.
const MOST: f64 = 64.0;

/// Of the way to the centre of a triangle, origins are moved at most this share.
const MOST_INSET: f64 = 0.25;

/// How far ray origins are pushed off a triangle along its normal, metres: just more than rounding can put them below it.
///
/// With unit roundoff `ε/2`, unit normal `n`, the largest coordinates `M` and the extents `E` of the corners per axis,
/// the longest edge `L` and the products of the edges `N = |e₁| × |e₂|` with all signs positive, an origin errs by
///
/// - `ε/2 Σ|nᵢ|Mᵢ`, as it is computed in f64 and then rounded; corners shared with neighbours in the same plane may have
///   been rounded away from it by as much;
/// - `4ε Σ NᵢEᵢ / |e₁ × e₂|`, the error of the height that a ray tracer computes: edges and the vector to a corner err
///   by `ε/2` each, products and sums of the cross product by `ε`, those of the dot product by `3/2 ε`, all of terms up to
///   `NᵢEᵢ`. It is zero for triangles along the axes, and large for slivers at a slant, where `64 ε L` has to do;
/// - `ε L`, so that it is never zero: what is as close as that to a triangle of such edges lies on it.
///
/// Twice the sum is the step. It scales with the coordinates: nothing is absolute.
///
/// Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., 3.1.
pub fn offset_from(corners: [Vec3; 3]) -> f32 {
    Margins::of(corners).offset as f32
}

/// [`offset_from`] the corners of a triangle along its normal.
pub fn lift_from(corners: [Vec3; 3]) -> Vec3 {
    (triangle::unit_normal(corners) * Margins::of(corners).offset).as_vec3()
}

/// How far ray origins are kept from a triangle, metres.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    /// Along its normal: [`offset_from`] its corners.
    pub offset: f64,
    /// From its edges: the offset from a wall of any direction that rises there, for which `Σ|nᵢ|Mᵢ` may be as much as
    /// `|M|`.
    pub clearance: f64,
}

impl Margins {
    /// Those of a triangle.
    pub fn of(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let cross = e1.cross(e2);
        let largest = a.abs().max(b.abs()).max(c.abs());
        let extent = a.max(b).max(c) - a.min(b).min(c);
        let longest = triangle::longest_edge(corners);
        let (p, q) = (e1.abs(), e2.abs());
        let products = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
        let double_area = cross.length().max(f64::MIN_POSITIVE);
        let rounding = cross.abs().dot(largest) / double_area;
        let height = (4.0 * products.dot(extent) / double_area).min(MOST * longest);
        let twice = |error: f64| SIDES * EPSILON * (error + height + longest);
        Self { offset: twice(rounding), clearance: twice(largest.length()) }
    }
}

impl Scene {
    /// [`offset_from`] the corners of a triangle.
    pub fn offset(&self, tri: TriId) -> f32 {
        offset_from(self.triangle_positions(tri))
    }

    /// The margins of a triangle.
    pub fn margins(&self, tri: TriId) -> Margins {
        Margins::of(self.triangle_positions(tri))
    }

    /// Where rays from the front of a triangle start.
    pub fn ray_origins(&self, tri: TriId) -> RayOrigins {
        RayOrigins::new(self.triangle_positions(tri))
    }

    /// Where rays from a point on the front of its triangle start.
    pub fn ray_origin(&self, at: SurfacePoint) -> Vec3 {
        self.ray_origins(at.tri).at(at.bary.weights())
    }

    /// Where rays from a point in world space start that lies on some surface with this unit normal.
    ///
    /// As nothing is known of its triangle, the step is 16 epsilons of its largest coordinate, relative to the scene's
    /// origin, and 16 of the root of the mean area of all triangles: more than [`offset_from`] comes to for such a triangle.
    pub fn ray_origin_at(&self, world: DVec3, normal: Vec3) -> Vec3 {
        let point = world - self.origin();
        let step = 16.0 * EPSILON * (point.abs().max_element() + self.usual_size());
        (point + normal.as_dvec3() * step).as_vec3()
    }
}

/// Origins of rays from the front of a triangle: its points, moved along its normal by [`offset_from`] its corners and
/// kept [clear](Margins::clearance) of its edges, where rounding would put them behind the next wall.
#[derive(Clone, Copy, Debug)]
pub struct RayOrigins {
    /// Of the triangle that origins lie on.
    corners: [DVec3; 3],
}

impl RayOrigins {
    /// Those of a triangle.
    pub fn new(corners: [Vec3; 3]) -> Self {
        let Margins { offset, clearance } = Margins::of(corners);
        let lift = triangle::unit_normal(corners) * offset;
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        // The centre of a triangle is a third of a height away from an edge.
        let height = triangle::least_height(corners);
        let inset = (3.0 * clearance / height).min(MOST_INSET);
        let centre = (a + b + c) / 3.0;
        Self { corners: [a, b, c].map(|p| p + (centre - p) * inset + lift) }
    }

    /// The origin at a point with these weights of the corners.
    #[inline]
    pub fn at(&self, weights: [f32; 3]) -> Vec3 {
        let ([a, b, c], [_, v, w]) = (self.corners, weights.map(f64::from));
        // Weights that do not sum to 1 would move the point by their error times its distance from zero.
        (a + (b - a) * v + (c - a) * w).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] =
        [Vec3::new(0.3, 0.1, -0.2), Vec3::new(1.1, 0.4, 0.3), Vec3::new(0.2, 0.9, 0.6)];

    #[test]
    fn the_offset_scales_with_the_scene_and_grows_with_its_distance() {
        let near = offset_from(CORNERS);
        assert!((2e-7..8e-6).contains(&near), "{near}");
        for scale in [1e-6, 1e-3, 1e3, 1e6] {
            let scaled = offset_from(CORNERS.map(|p| p * scale));
            assert!((scaled / (near * scale) - 1.0).abs() < 1e-4, "{scale}");
        }
        let far = offset_from(CORNERS.map(|p| p + 1000.0));
        assert!((2e-4..8e-4).contains(&far), "{far}");
    }

    #[test]
    fn the_offset_is_never_zero_and_of_needles_never_wide() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Z];
        assert_eq!(offset_from(flat), (2.0 * EPSILON * 2_f64.sqrt()) as f32);
        let needle = [Vec3::ZERO, Vec3::ONE, Vec3::ONE + Vec3::new(1e-6, 0.0, 0.0)];
        assert!(offset_from(needle) < 3e-5);
    }

    #[test]
    fn origins_lie_above_their_triangle_and_within_it() {
        let step = f64::from(offset_from(CORNERS));
        let normal = triangle::unit_normal(CORNERS);
        let [a, b, c] = CORNERS.map(|p| p.as_dvec3());
        for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.0], [0.2, 0.3, 0.5]] {
            let origin = RayOrigins::new(CORNERS).at(weights).as_dvec3();
            let height = (origin - a).dot(normal);
            assert!((0.8 * step..1.2 * step).contains(&height), "{weights:?}: {height} for {step}");
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let inward = normal.cross(q - p).normalize();
                assert!((origin - p).dot(inward) > 0.8 * step, "{weights:?}");
            }
        }
    }
}
