//! Triangulation of polygons.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// The largest number of corners of a polygon. Ear clipping is quadratic on hostile outlines; this limits it to
/// seconds.
pub(crate) const MAX_CORNERS: usize = 1 << 14;

/// What [`Tally`](crate::tally::Tally) calls polygons that [`Triangulator::triangulate`] refuses.
pub(crate) const TOO_FEW_CORNERS: &str = "faces dropped: fewer than three corners";
/// The other reason.
pub(crate) const NO_AREA: &str = "faces dropped: no area";

/// Twice the area of a polygon relative to the square of its extent, below which it has none: far below what
/// positions of 24 bits can express, so only exactly collinear or cancelling outlines fall under it.
const SMALLEST_AREA: f64 = 1e-14;

/// Splits polygons into triangles; reuses its memory.
pub(crate) struct Triangulator {
    earcut: Earcut<f64>,
    plane: Vec<[f64; 2]>,
    indices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Triangulator {
    /// An empty triangulator.
    pub(crate) fn new() -> Self {
        Self { earcut: Earcut::new(), plane: Vec::new(), indices: Vec::new(), triangles: Vec::new() }
    }

    /// Triangles that cover the polygon, as indices into `corners`, wound like it.
    ///
    /// Concave outlines and collinear corners are fine; self-intersecting outlines give some cover of the area
    /// they enclose. `None` for a polygon without area or with fewer than three corners. A single triangle is returned
    /// as it is, and so is the fan of a polygon whose corners are not all finite: whoever checks triangles drops it.
    /// The caller makes sure of at most [`MAX_CORNERS`] corners.
    pub(crate) fn triangulate(&mut self, corners: &[Vec3]) -> Option<&[[u32; 3]]> {
        self.triangles.clear();
        let n = corners.len() as u32;
        if n < 3 {
            return None;
        }
        if n == 3 || !corners.iter().all(|p| p.is_finite()) {
            self.triangles.extend((2..n).map(|i| [0, i - 1, i]));
            return Some(&self.triangles);
        }
        let normal = newell_normal(corners)?;
        self.project(corners, normal);
        match *self.plane.as_slice() {
            [a, b, c, d] if turns_left([a, b, c]) && turns_left([a, c, d]) => {
                self.triangles.extend([[0, 1, 2], [0, 2, 3]]);
            }
            [a, b, c, d] if turns_left([a, b, d]) && turns_left([b, c, d]) => {
                self.triangles.extend([[0, 1, 3], [1, 2, 3]]);
            }
            _ => self.clip_ears(),
        }
        (!self.triangles.is_empty()).then_some(&self.triangles)
    }

    /// Fills `plane` with the corners as seen against the normal: counter-clockwise, relative to the first.
    fn project(&mut self, corners: &[Vec3], normal: DVec3) {
        let right = normal.any_orthonormal_vector();
        let up = normal.cross(right);
        let origin = corners[0].as_dvec3();
        self.plane.clear();
        self.plane.extend(corners.iter().map(|p| {
            let p = p.as_dvec3() - origin;
            [p.dot(right), p.dot(up)]
        }));
    }

    fn clip_ears(&mut self) {
        self.earcut.earcut_slice::<u32>(&self.plane, &[], &mut self.indices);
        let plane = &self.plane;
        self.triangles.extend(self.indices.as_chunks::<3>().0.iter().map(|&[a, b, c]| {
            if doubled_area([a, b, c].map(|i| plane[i as usize])) < 0.0 { [a, c, b] } else { [a, b, c] }
        }));
    }
}

/// Unit normal of a polygon by its area vector, which needs no three particular corners to be well placed; `None`
/// where it has no area.
fn newell_normal(corners: &[Vec3]) -> Option<DVec3> {
    let origin = corners[0].as_dvec3();
    let (mut doubled_area, mut extent) = (DVec3::ZERO, 0.0_f64);
    for pair in corners.windows(2) {
        let [a, b] = [pair[0].as_dvec3() - origin, pair[1].as_dvec3() - origin];
        doubled_area += a.cross(b);
        extent = extent.max(b.length_squared());
    }
    (doubled_area.length() > SMALLEST_AREA * extent).then(|| doubled_area.try_normalize()).flatten()
}

fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec2::from_array);
    (b - a).perp_dot(c - a)
}

fn turns_left(triangle: [[f64; 2]; 3]) -> bool {
    doubled_area(triangle) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area_vector(triangles: &[[u32; 3]], corners: &[Vec3]) -> (f64, DVec3) {
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| corners[i as usize].as_dvec3());
            0.5 * (b - a).cross(c - a)
        });
        areas.fold((0.0, DVec3::ZERO), |(sum, vector), a| (sum + a.length(), vector + a))
    }

    fn flat(points: &[[f32; 2]]) -> Vec<Vec3> {
        points.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect()
    }

    /// A star outline of `n` corners at the given radii: simple, mostly concave, counter-clockwise seen from +z.
    fn star(radii: &[f32]) -> Vec<Vec3> {
        let angle = |i: usize| (i as f32 * 360.0 / radii.len() as f32).to_radians();
        radii
            .iter()
            .enumerate()
            .map(|(i, r)| Vec3::new(r * angle(i).cos(), r * angle(i).sin(), 0.0))
            .collect()
    }

    #[test]
    fn convex_quads_are_split_at_their_first_corner() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(Triangulator::new().triangulate(&square), Some(&[[0, 1, 2], [0, 2, 3]][..]));
    }

    #[test]
    fn a_concave_quad_is_split_inside_wherever_its_dent_is() {
        let arrow = flat(&[[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]]);
        for start in 0..4 {
            let mut corners = arrow.clone();
            corners.rotate_left(start);
            let mut triangulator = Triangulator::new();
            let (area, vector) = area_vector(triangulator.triangulate(&corners).unwrap(), &corners);
            assert!((area - 0.5).abs() < 1e-6 && vector.z > 0.0, "start {start}: {area}");
        }
    }

    #[test]
    fn collinear_corners_lose_no_area_even_far_from_the_origin() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0], [0.0, 1.0]];
        for offset in [0.0, 8192.0] {
            for reversed in [false, true] {
                let mut corners: Vec<Vec3> = flat(&points).iter().map(|p| *p + offset).collect();
                if reversed {
                    corners.reverse();
                }
                let mut triangulator = Triangulator::new();
                let (area, vector) = area_vector(triangulator.triangulate(&corners).unwrap(), &corners);
                assert!((area - 3.0).abs() < 1e-6, "{area}");
                assert_eq!(vector.z < 0.0, reversed);
            }
        }
    }

    #[test]
    fn polygons_without_area_are_refused() {
        let mut triangulator = Triangulator::new();
        let line = flat(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]);
        let bow_tie = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        for corners in [&line[..2], &[], &line, &bow_tie, &[Vec3::ONE; 5]] {
            assert_eq!(triangulator.triangulate(corners), None, "{corners:?}");
        }
        let tiny: Vec<Vec3> =
            flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).iter().map(|p| *p * 1e-12).collect();
        assert!(triangulator.triangulate(&tiny).is_some(), "size alone is no reason");
        let broken = flat(&[[0.0, 0.0], [1.0, 0.0], [f32::NAN, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulator.triangulate(&broken).map(<[_]>::len), Some(2), "left for build() to drop");
    }

    #[test]
    fn hostile_outlines_end_in_time() {
        let spiky: Vec<f32> = (0..MAX_CORNERS).map(|i| if i % 2 == 0 { 1.0 } else { 100.0 }).collect();
        let tangled: Vec<Vec3> = (0..MAX_CORNERS as u64)
            .map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15))
            .map(|h| Vec3::new((h >> 40) as f32, (h & 0xff_ffff) as f32, 0.0))
            .collect();
        for corners in [star(&spiky), tangled] {
            assert!(Triangulator::new().triangulate(&corners).is_some());
        }
    }

    proptest! {
        #[test]
        fn the_triangles_of_a_star_have_its_area(
            radii in prop::collection::vec(0.1f32..10.0, 5..40),
            shift in -1000.0f32..1000.0,
        ) {
            let corners: Vec<Vec3> = star(&radii).iter().map(|p| Vec3::new(p.x, 0.5 * p.x + shift, -p.y)).collect();
            let mut triangulator = Triangulator::new();
            let (area, vector) = area_vector(triangulator.triangulate(&corners).unwrap(), &corners);
            let expected = corners.windows(2).fold(DVec3::ZERO, |sum, p| {
                sum + 0.5 * (p[0] - corners[0]).as_dvec3().cross((p[1] - corners[0]).as_dvec3())
            });
            prop_assert!((area - expected.length()).abs() < 1e-3 * area, "{area} {}", expected.length());
            prop_assert!((vector - expected).length() < 1e-3 * area);
        }
    }
}
