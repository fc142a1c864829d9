//! The part of a triangle inside a square.

use glam::DVec2;

/// A triangle has three corners, and each side of the square adds one.
const MOST_CORNERS: usize = 7;

/// A convex polygon of up to seven corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Polygon {
    corners: [DVec2; MOST_CORNERS],
    len: usize,
}

impl Polygon {
    pub(crate) fn corners(&self) -> &[DVec2] {
        &self.corners[..self.len]
    }

    /// Whichever way it is seen from.
    pub(crate) fn area(&self) -> f64 {
        let Some((&first, rest)) = self.corners().split_first() else { return 0.0 };
        rest.windows(2).map(|pair| 0.5 * (pair[0] - first).perp_dot(pair[1] - first)).sum::<f64>().abs()
    }

    fn push(&mut self, corner: DVec2) {
        // A convex polygon cannot exceed it, but one that rounding dents could.
        if self.len < MOST_CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// What lies where `distance` is not negative.
    fn cut(&self, distance: impl Fn(DVec2) -> f64) -> Self {
        let mut kept = Self::default();
        for (i, &from) in self.corners().iter().enumerate() {
            let to = self.corners[(i + 1) % self.len];
            let (a, b) = (distance(from), distance(to));
            if a >= 0.0 {
                kept.push(from);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                kept.push(from + (to - from) * (a / (a - b)));
            }
        }
        kept
    }
}

/// The part of a triangle inside the square whose smallest corner is `min` (Sutherland and Hodgman, 1974).
pub(crate) fn clip_to_square([a, b, c]: [DVec2; 3], min: DVec2, side: f64) -> Polygon {
    let mut polygon = Polygon::default();
    [a, b, c].into_iter().for_each(|corner| polygon.push(corner));
    let max = min + side;
    polygon.cut(|p| p.x - min.x).cut(|p| max.x - p.x).cut(|p| p.y - min.y).cut(|p| max.y - p.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_cut_off_a_large_triangle_leaves_five_corners() {
        let corners = [DVec2::new(-5.0, -5.0), DVec2::new(6.5, -5.0), DVec2::new(-5.0, 6.5)];
        let polygon = clip_to_square(corners, DVec2::ZERO, 1.0);
        assert_eq!(polygon.corners().len(), 5);
        assert!((polygon.area() - 0.875).abs() < 1e-12, "{}", polygon.area());
    }

    #[test]
    fn a_triangle_elsewhere_leaves_nothing() {
        let corners = [DVec2::new(2.0, 2.0), DVec2::new(3.0, 2.0), DVec2::new(2.0, 3.0)];
        assert!(clip_to_square(corners, DVec2::ZERO, 1.0).corners().is_empty());
    }

    proptest::proptest! {
        #[test]
        fn the_parts_in_all_squares_add_up_to_the_triangle(numbers in proptest::array::uniform6(0.0_f64..6.0)) {
            let [a, b, c, d, e, f] = numbers;
            let corners = [DVec2::new(a, b), DVec2::new(c, d), DVec2::new(e, f)];
            let whole = 0.5 * (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
            let squares = (0..6).flat_map(|x| (0..6).map(move |y| DVec2::new(f64::from(x), f64::from(y))));
            let sum: f64 = squares.map(|min| clip_to_square(corners, min, 1.0).area()).sum();
            proptest::prop_assert!((sum - whole).abs() < 1e-9, "{} {}", sum, whole);
        }
    }
}
