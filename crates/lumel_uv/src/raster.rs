//! Which lumels a triangle touches.

use glam::DVec2;

/// Calls `row(y, first, end)` for each row of lumels in which the triangle touches squares, with the first of them and the
/// one after the last.
///
/// The squares are those of lumels, larger by `reach` on each side, or smaller if it is negative. Exact up to rounding: in a
/// band of rows the triangle is convex, so that it meets all squares between its ends.
pub(crate) fn touched(corners: [DVec2; 3], reach: f64, mut row: impl FnMut(i64, i64, i64)) {
    let [a, b, c] = corners;
    let (min, max) = (a.min(b).min(c), a.max(b).max(c));
    if !(min.is_finite() && max.is_finite()) {
        return;
    }
    for y in first_square(min.y, reach)..end_square(max.y, reach) {
        let band = [y as f64 - reach, (y + 1) as f64 + reach];
        let Some([left, right]) = span_in_band(corners, band) else { continue };
        let (first, end) = (first_square(left, reach), end_square(right, reach));
        if first < end {
            row(y, first, end);
        }
    }
}

/// The first square that ends after `from`.
fn first_square(from: f64, reach: f64) -> i64 {
    (from - reach).floor() as i64
}

/// The square after the last one that begins before `to`.
fn end_square(to: f64, reach: f64) -> i64 {
    (to + reach).ceil() as i64
}

/// The ends of the part of a triangle that lies in a band of `y`.
fn span_in_band(corners: [DVec2; 3], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |x: f64| span = [span[0].min(x), span[1].max(x)];
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        if (low..=high).contains(&from.y) {
            add(from.x);
        }
        for at in [low, high] {
            if (from.y < at) != (to.y < at) {
                add(from.x + (to.x - from.x) * ((at - from.y) / (to.y - from.y)).clamp(0.0, 1.0));
            }
        }
    }
    (span[0] <= span[1]).then_some(span)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::clip_to_square;

    fn squares(corners: [DVec2; 3], reach: f64) -> Vec<[i64; 2]> {
        let mut found = Vec::new();
        touched(corners, reach, |y, first, end| found.extend((first..end).map(|x| [x, y])));
        found
    }

    fn triangle(numbers: [f64; 6]) -> [DVec2; 3] {
        let [a, b, c, d, e, f] = numbers;
        [DVec2::new(a, b), DVec2::new(c, d), DVec2::new(e, f)]
    }

    #[test]
    fn half_a_square_touches_its_squares_and_all_around_with_reach() {
        let corners = triangle([1.0, 1.0, 3.0, 1.0, 1.0, 3.0]);
        assert_eq!(squares(corners, -1e-3), [[1, 1], [2, 1], [1, 2]]);
        assert_eq!(squares(corners, 0.5).len(), 13, "four by four without three at the far corner");
    }

    #[test]
    fn what_is_thin_touches_what_it_passes_through() {
        assert_eq!(
            squares(triangle([0.5, 0.5, 3.5, 0.5, 2.0, 0.5]), -1e-3),
            [[0, 0], [1, 0], [2, 0], [3, 0]]
        );
        assert!(squares([DVec2::NAN; 3], 0.0).is_empty());
    }

    proptest::proptest! {
        #[test]
        fn squares_are_touched_where_clipping_leaves_something(
            numbers in proptest::array::uniform6(0.0_f64..12.0), reach in 0.0_f64..1.0
        ) {
            let corners = triangle(numbers);
            let found = squares(corners, reach);
            for (x, y) in (-2..14).flat_map(|x| (-2..14).map(move |y| (x, y))) {
                let min = DVec2::new(x as f64, y as f64) - reach;
                let area = clip_to_square(corners, min, 1.0 + 2.0 * reach).area().abs();
                if area > 1e-9 {
                    proptest::prop_assert!(found.contains(&[x, y]), "{:?} {} {}", [x, y], area, reach);
                }
                let inner = clip_to_square(corners, min - 1e-6, 1.0 + 2.0 * reach + 2e-6);
                if inner.corners().is_empty() {
                    proptest::prop_assert!(!found.contains(&[x, y]), "{:?}", [x, y]);
                }
            }
        }
    }
}
