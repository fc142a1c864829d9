//! The smallest rectangle around points.

use glam::DVec2;

/// The direction, unit length, of the longer side of the smallest rectangle around points; the x axis if they have no
/// extent.
///
/// One of its sides lies on an edge of the convex hull.
pub(crate) fn long_side(points: impl IntoIterator<Item = DVec2>) -> DVec2 {
    let hull = hull(points.into_iter().collect());
    let mut best = (f64::INFINITY, DVec2::X);
    for (i, &from) in hull.iter().enumerate() {
        let Some(along) = (hull[(i + 1) % hull.len()] - from).try_normalize() else { continue };
        let [width, height] = [along, along.perp()].map(|axis| extent(&hull, axis));
        // Areas that differ by rounding are equal: the first edge wins.
        if width * height < best.0 * (1.0 - 1e-6) {
            best = (width * height, if width >= height { along } else { along.perp() });
        }
    }
    best.1
}

fn extent(points: &[DVec2], axis: DVec2) -> f64 {
    let along = points.iter().map(|point| point.dot(axis));
    let (min, max) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    max - min
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain). The work of [`long_side`] is the square
/// of their number, which is thinned out where a round chart has thousands.
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    const MOST: usize = 256;
    let step = hull.len().div_ceil(MOST).max(1);
    hull.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_is_found() {
        let along = DVec2::from_angle(0.7);
        let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0), (1.5, 0.5)];
        let found = long_side(corners.map(|(x, y)| along * x + along.perp() * y));
        assert!(found.dot(along).abs() > 1.0 - 1e-12, "{found}");
    }

    #[test]
    fn points_without_extent_have_a_direction() {
        assert_eq!(long_side([DVec2::ONE; 4]), DVec2::X);
        assert_eq!(long_side([]), DVec2::X);
        assert!(long_side([DVec2::ZERO, DVec2::Y, DVec2::Y * 2.0]).y.abs() > 0.999);
    }
}
