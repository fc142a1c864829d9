//! Form factors in closed form, f64.
//!
//! F is the share of a hemisphere, weighted by the cosine, that something fills: irradiance is F times its
//! radiosity. Formulas of elements and pairs of surfaces as in Howell's *Catalog of Radiation Heat Transfer
//! Configuration Factors*.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

/// Between equal opposed rectangles `a × b` at distance `c`.
pub fn parallel_rectangles(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (x1, y1) = (1.0 + x * x, 1.0 + y * y);
    let sum = 0.5 * (x1 * y1 / (x1 + y * y)).ln()
        + x * y1.sqrt() * (x / y1.sqrt()).atan()
        + y * x1.sqrt() * (y / x1.sqrt()).atan()
        - x * x.atan()
        - y * y.atan();
    2.0 * FRAC_1_PI / (x * y) * sum
}

/// From a rectangle of width `w` to one of height `h` at a right angle; both share an edge of length `l`.
pub fn perpendicular_rectangles(w: f64, h: f64, l: f64) -> f64 {
    let (w, h) = (w / l, h / l);
    let (w2, h2) = (w * w, h * h);
    let s = w2 + h2;
    let logarithm = ((1.0 + w2) * (1.0 + h2) / (1.0 + s)).ln()
        + w2 * (w2 * (1.0 + s) / ((1.0 + w2) * s)).ln()
        + h2 * (h2 * (1.0 + s) / ((1.0 + h2) * s)).ln();
    let sum =
        w * (1.0 / w).atan() + h * (1.0 / h).atan() - s.sqrt() * (1.0 / s.sqrt()).atan() + 0.25 * logarithm;
    FRAC_1_PI / w * sum
}

/// From an element to a parallel rectangle `a × b` at distance `c`, one corner above the element.
pub fn element_to_parallel_rectangle(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = (a / c, b / c);
    let (sa, sb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / sa * (b / sa).atan() + b / sb * (a / sb).atan()) / TAU
}

/// From an element to a rectangle that stands in a plane parallel to the element's normal: its height along the
/// normal, its width and its distance; the element lies in front of a lower corner.
pub fn element_to_standing_rectangle(height: f64, width: f64, distance: f64) -> f64 {
    let slant = height.hypot(distance);
    ((width / distance).atan() - distance / slant * (width / slant).atan()) / TAU
}

/// From an element to a parallel disk of radius `r` at height `h` whose axis passes the element at distance `s`.
pub fn element_to_disk(r: f64, h: f64, s: f64) -> f64 {
    if s == 0.0 {
        return r * r / (r * r + h * h);
    }
    let (h, r) = (h / s, r / s);
    let z = 1.0 + h * h + r * r;
    0.5 * (1.0 - (z - 2.0 * r * r) / (z * z - 4.0 * r * r).sqrt())
}

/// From an element to a sphere of radius `r` at distance `d` in a direction of cosine `cos`, wholly above the horizon.
pub fn element_to_sphere(r: f64, d: f64, cos: f64) -> f64 {
    (r / d).powi(2) * cos
}

/// From an element at `point` with unit `normal` to a flat polygon; zero behind it.
///
/// The corners run counter-clockwise seen from the front of the polygon; what lies below the element's horizon is
/// cut off. Lambert, *Photometria*, 1760.
pub fn polygon(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let seen: Vec<DVec3> = corners.iter().map(|c| *c - point).collect();
    let mut above = Vec::with_capacity(seen.len() + 1);
    for (a, b) in seen.iter().zip(seen.iter().cycle().skip(1)) {
        let (height_a, height_b) = (a.dot(normal), b.dot(normal));
        if height_a >= 0.0 {
            above.push(*a);
        }
        if height_a * height_b < 0.0 {
            above.push(*a + (*b - *a) * (height_a / (height_a - height_b)));
        }
    }
    let edge = |(a, b): (&DVec3, &DVec3)| {
        let cross = a.cross(*b);
        let area = cross.length();
        if area < 1e-15 * a.length() * b.length() {
            0.0
        } else {
            area.atan2(a.dot(*b)) * cross.dot(normal) / area
        }
    };
    let sum: f64 = above.iter().zip(above.iter().cycle().skip(1)).map(edge).sum();
    (-sum / TAU).max(0.0)
}

/// The corners of a rectangle in the plane `z` that faces down, for [`polygon`].
pub fn facing_down(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [[0, 0], [0, 1], [1, 1], [1, 0]].map(|[i, j]| DVec3::new(x[i], y[j], z))
}

/// The part of a downward rectangle at height `z` that an opaque rectangle at height `screen_z` hides from `point`,
/// as a downward rectangle; `None` if it hides nothing. Both are parallel to the xy plane and above `point`.
pub fn hidden_part(
    light: [[f64; 2]; 2],
    z: f64,
    screen: [[f64; 2]; 2],
    screen_z: f64,
    point: DVec3,
) -> Option<[DVec3; 4]> {
    let scale = (z - point.z) / (screen_z - point.z);
    let eye = [point.x, point.y];
    let overlap = [0, 1].map(|k| {
        let [low, high] = screen[k].map(|s| eye[k] + (s - eye[k]) * scale);
        [light[k][0].max(low), light[k][1].min(high)]
    });
    let [x, y] = overlap;
    (x[0] < x[1] && y[0] < y[1]).then(|| facing_down(x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_close(value: f64, known: f64) {
        assert!((value - known).abs() < 1e-11, "{value} is not {known}");
    }

    #[test]
    fn pairs_of_rectangles_have_the_catalogued_factors() {
        assert_close(parallel_rectangles(1.0, 1.0, 1.0), 0.199824895698);
        assert_close(parallel_rectangles(2.0, 1.0, 1.0), 0.285875384851);
        assert_close(parallel_rectangles(2.0, 2.0, 1.0), 0.415253283577);
        assert_close(perpendicular_rectangles(1.0, 1.0, 1.0), 0.200043776075);
        assert_close(perpendicular_rectangles(1.0, 2.0, 1.0), 0.232852602795);
        assert_close(perpendicular_rectangles(2.0, 1.0, 1.0), 0.116426301398);
    }

    #[test]
    fn the_walls_of_a_cube_close_it() {
        let sides = 4.0 * perpendicular_rectangles(1.0, 1.0, 1.0);
        assert_close(parallel_rectangles(1.0, 1.0, 1.0) + sides, 1.0);
    }

    #[test]
    fn elements_have_the_catalogued_factors() {
        assert_close(element_to_parallel_rectangle(1.0, 1.0, 1.0), 0.138531605995);
        assert_close(element_to_parallel_rectangle(2.0, 1.0, 0.5), 0.220777622335);
        assert_close(element_to_standing_rectangle(1.0, 1.0, 1.0), 0.055734197003);
        assert_close(element_to_standing_rectangle(2.0, 1.0, 0.5), 0.158774804514);
        assert_close(element_to_disk(1.0, 1.0, 0.0), 0.5);
        assert_close(element_to_disk(0.5, 2.0, 0.0), 0.058823529412);
        assert_close(element_to_disk(1.0, 1.0, 1.0), 0.276393202250);
        assert_close(element_to_sphere(1.0, 2.0, 0.5), 0.125);
    }

    #[test]
    fn the_polygon_formula_agrees_with_the_other_closed_forms() {
        let ceiling = facing_down([0.0, 2.0], [0.0, 1.0], 0.5);
        assert_close(polygon(&ceiling, DVec3::ZERO, DVec3::Z), element_to_parallel_rectangle(2.0, 1.0, 0.5));
        let wall = [[0.0, 0.0], [-1.0, 0.0], [-1.0, 2.0], [0.0, 2.0]].map(|[y, z]| DVec3::new(0.5, y, z));
        let standing = polygon(&wall, DVec3::ZERO, DVec3::Z);
        let mirrored = polygon(&[wall[3], wall[2], wall[1], wall[0]], DVec3::ZERO, DVec3::Z);
        assert_close(standing + mirrored, element_to_standing_rectangle(2.0, 1.0, 0.5));
        assert!(standing == 0.0 || mirrored == 0.0, "a polygon has one lit side");
    }

    #[test]
    fn a_polygon_with_many_corners_approaches_the_disk() {
        let n = 4000;
        let corner = |i: i32| {
            let (sin, cos) = (-TAU * f64::from(i) / f64::from(n)).sin_cos();
            DVec3::new(1.0 + cos, sin, 1.0)
        };
        let corners: Vec<DVec3> = (0..n).map(corner).collect();
        assert!((polygon(&corners, DVec3::ZERO, DVec3::Z) - element_to_disk(1.0, 1.0, 1.0)).abs() < 1e-6);
    }

    #[test]
    fn tilted_elements_lose_what_lies_below_their_horizon() {
        let light = facing_down([-1.0, 1.0], [-1.0, 1.0], 1.0);
        let known = [(30.0, 0.479887560075), (60.0, 0.289365194440), (90.0, 0.111468394005), (150.0, 0.0)];
        for (degrees, factor) in known {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            assert_close(polygon(&light, DVec3::ZERO, DVec3::new(sin, 0.0, cos)), factor);
        }
    }

    #[test]
    fn a_screen_hides_its_enlarged_shadow() {
        let light = [[-0.5, 0.5]; 2];
        let lit = polygon(&facing_down(light[0], light[1], 2.0), DVec3::new(0.25, 0.0, 0.0), DVec3::Z);
        let hidden = hidden_part(light, 2.0, [[0.0, 1.0], [-1.0, 1.0]], 1.0, DVec3::new(0.25, 0.0, 0.0));
        let hidden = polygon(&hidden.unwrap(), DVec3::new(0.25, 0.0, 0.0), DVec3::Z);
        assert!(((lit - hidden) / FRAC_1_PI - 0.049944845).abs() < 1e-9);
        assert!(hidden_part(light, 2.0, [[0.0, 1.0], [-1.0, 1.0]], 1.0, DVec3::NEG_X).is_none());
    }
}
