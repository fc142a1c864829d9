//! Triangulation of polygons.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// The largest number of corners of a polygon. Ear clipping is quadratic on hostile outlines; this limits it to
/// seconds.
pub(crate) const MAX_CORNERS: usize = 1 << 14;

/// What [`Tally`](crate::tally::Tally) calls polygons that [`Triangulator::triangulate`] refuses.
pub(crate) const TOO_FEW_CORNERS: &str = "faces dropped: fewer than three corners";
/// Another reason.
pub(crate) const NO_AREA: &str = "faces dropped: no area";
/// The last reason.
pub(crate) const TWISTED: &str =
    "faces dropped: their outline crosses itself and encloses as much on either side; split them";
/// What it calls polygons that are covered in some way.
pub(crate) const CROSSES: &str = "faces whose outline crosses itself are covered in some way; split them";

/// The most corners of an outline that is checked for crossings, which takes time by their square.
const MAX_CHECKED: usize = 64;

/// Twice the area of a polygon relative to the square of its extent, below which it has none: far below what
/// positions of 24 bits can express, so only exactly collinear or cancelling outlines fall under it.
const SMALLEST_AREA: f64 = 1e-14;

/// Splits polygons into triangles; reuses its memory.
pub(crate) struct Triangulator {
    earcut: Earcut<f64>,
    plane: Vec<[f64; 2]>,
    indices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    crosses: bool,
}

impl Triangulator {
    /// An empty triangulator.
    pub(crate) fn new() -> Self {
        Self {
            earcut: Earcut::new(),
            plane: Vec::new(),
            indices: Vec::new(),
            triangles: Vec::new(),
            crosses: false,
        }
    }

    /// Triangles that cover the polygon, as indices into `corners`, wound like it.
    ///
    /// Concave outlines and collinear corners are fine; self-intersecting outlines give some cover of the area
    /// they enclose, and [`Self::crosses`] says so. A single triangle is returned
    /// as it is, and so is the fan of a polygon whose corners are not all finite: whoever checks triangles drops it.
    /// The caller makes sure of at most [`MAX_CORNERS`] corners.
    ///
    /// # Errors
    /// Why there are no triangles: fewer than three corners, or no area.
    pub(crate) fn triangulate(&mut self, corners: &[Vec3]) -> Result<&[[u32; 3]], &'static str> {
        self.triangles.clear();
        self.crosses = false;
        let n = corners.len() as u32;
        if n < 3 {
            return Err(TOO_FEW_CORNERS);
        }
        if n == 3 || !corners.iter().all(|p| p.is_finite()) {
            self.triangles.extend((2..n).map(|i| [0, i - 1, i]));
            return Ok(&self.triangles);
        }
        let normal = newell_normal(corners).ok_or(if is_line(corners) { NO_AREA } else { TWISTED })?;
        self.project(corners, normal);
        match *self.plane.as_slice() {
            [a, b, c, d] if turns_left([a, b, c]) && turns_left([a, c, d]) => {
                self.triangles.extend([[0, 1, 2], [0, 2, 3]]);
            }
            [a, b, c, d] if turns_left([a, b, d]) && turns_left([b, c, d]) => {
                self.triangles.extend([[0, 1, 3], [1, 2, 3]]);
            }
            _ => {
                self.crosses = self.plane.len() <= MAX_CHECKED && crosses_itself(&self.plane);
                self.clip_ears();
            }
        }
        if self.triangles.is_empty() { Err(NO_AREA) } else { Ok(&self.triangles) }
    }

    /// Whether the outline of the last polygon crosses itself, as far as that is checked.
    pub(crate) fn crosses(&self) -> bool {
        self.crosses
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

/// Whether all corners lie on one line.
fn is_line(corners: &[Vec3]) -> bool {
    let origin = corners[0].as_dvec3();
    let arms = || corners.iter().map(|p| p.as_dvec3() - origin);
    let longest =
        arms().fold(DVec3::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    arms().all(|arm| longest.cross(arm).length() <= SMALLEST_AREA * longest.length_squared())
}

/// Whether two edges of an outline cross inside both.
fn crosses_itself(outline: &[[f64; 2]]) -> bool {
    let n = outline.len();
    let edge = |i: usize| [outline[i], outline[(i + 1) % n]];
    let apart = |[a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]| {
        doubled_area([a, b, c]) * doubled_area([a, b, d]) < 0.0
    };
    (0..n).any(|i| (i + 2..n).any(|j| apart(edge(i), edge(j)) && apart(edge(j), edge(i))))
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
        assert_eq!(Triangulator::new().triangulate(&square), Ok(&[[0, 1, 2], [0, 2, 3]][..]));
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
        let five = [Vec3::ONE; 5];
        let cases: [(&[Vec3], &str); 5] = [
            (&line[..2], TOO_FEW_CORNERS),
            (&[], TOO_FEW_CORNERS),
            (&line, NO_AREA),
            (&bow_tie, TWISTED),
            (&five, NO_AREA),
        ];
        for (corners, reason) in cases {
            assert_eq!(triangulator.triangulate(corners), Err(reason), "{corners:?}");
        }
        let tiny: Vec<Vec3> =
            flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).iter().map(|p| *p * 1e-12).collect();
        assert!(triangulator.triangulate(&tiny).is_ok(), "size alone is no reason");
        let broken = flat(&[[0.0, 0.0], [1.0, 0.0], [f32::NAN, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulator.triangulate(&broken).map(<[_]>::len), Ok(2), "left for build() to drop");
    }

    #[test]
    fn outlines_that_cross_themselves_are_told_from_those_that_do_not() {
        let crosses = |points: &[[f32; 2]]| {
            let mut triangulator = Triangulator::new();
            assert!(triangulator.triangulate(&flat(points)).is_ok());
            triangulator.crosses()
        };
        assert!(crosses(&[[0.0, 0.0], [3.0, 2.0], [3.0, 0.0], [0.0, 1.0]]), "a bow tie");
        assert!(crosses(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [3.0, 1.0], [0.0, 1.0]]));
        assert!(!crosses(&[[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]]), "concave");
        assert!(
            !crosses(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]),
            "corners that touch an edge"
        );
    }

    #[test]
    fn hostile_outlines_end_in_time() {
        let spiky: Vec<f32> = (0..MAX_CORNERS).map(|i| if i % 2 == 0 { 1.0 } else { 100.0 }).collect();
        let tangled: Vec<Vec3> = (0..MAX_CORNERS as u64)
            .map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15))
            .map(|h| Vec3::new((h >> 40) as f32, (h & 0xff_ffff) as f32, 0.0))
            .collect();
        for corners in [star(&spiky), tangled] {
            assert!(Triangulator::new().triangulate(&corners).is_ok());
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
