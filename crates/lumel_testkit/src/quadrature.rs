//! Integrals over triangles and over the basis functions of vertices.

use glam::DVec3;
use lumel_basis::{Basis, NodeWeights};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

/// The mean of `f` under each node's hat function: what area sampling measures.
///
/// `f` gets a point and the geometric normal there. Each triangle is cut into `pieces²`, with a rule of degree two on
/// each: the error falls with the fourth power of `pieces` where `f` is smooth.
pub fn hat_average(
    scene: &Scene,
    basis: &dyn Basis,
    pieces: u32,
    f: &dyn Fn(DVec3, DVec3) -> f64,
) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); basis.node_count()];
    let mut nodes = NodeWeights::default();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let corners = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let normal = scene.geometric_normal(tri).as_dvec3();
        let area = f64::from(scene.area(tri));
        for ([u, v], share) in triangle_points(pieces) {
            let point = corners[0] * u + corners[1] * v + corners[2] * (1.0 - u - v);
            let value = f(point, normal);
            nodes.clear();
            let bary = Barycentrics { u: u as f32, v: v as f32 };
            basis.weights_at(SurfacePoint { tri, bary }, &mut nodes);
            for (node, weight) in nodes.iter() {
                let (whole, sum) = &mut sums[node.index()];
                *whole += f64::from(weight) * area * share;
                *sum += f64::from(weight) * area * share * value;
            }
        }
    }
    sums.into_iter().map(|(whole, sum)| sum / whole).collect()
}

/// The mean of `f` over the barycentrics `u, v` of a triangle; times its area it is the integral.
pub fn triangle_integral(pieces: u32, f: impl Fn(f64, f64) -> f64) -> f64 {
    triangle_points(pieces).map(|([u, v], share)| share * f(u, v)).sum()
}

/// Barycentrics and shares of the area: three points in each of `pieces²` triangles.
pub(crate) fn triangle_points(pieces: u32) -> impl Iterator<Item = ([f64; 2], f64)> {
    let n = f64::from(pieces);
    let share = 1.0 / (3.0 * n * n);
    (0..pieces).flat_map(move |i| {
        (0..pieces - i).flat_map(move |j| {
            let (u, v) = (f64::from(i) / n, f64::from(j) / n);
            let inside = |s: f64, t: f64| ([u + s / n, v + t / n], share);
            let upright =
                [inside(1.0 / 6.0, 1.0 / 6.0), inside(2.0 / 3.0, 1.0 / 6.0), inside(1.0 / 6.0, 2.0 / 3.0)];
            let flipped =
                [inside(5.0 / 6.0, 5.0 / 6.0), inside(1.0 / 3.0, 5.0 / 6.0), inside(5.0 / 6.0, 1.0 / 3.0)];
            upright.into_iter().chain(flipped.into_iter().filter(move |_| i + j + 1 < pieces))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_quadratics() {
        for pieces in [1, 2, 5] {
            assert!((triangle_integral(pieces, |_, _| 1.0) - 1.0).abs() < 1e-12);
            assert!((triangle_integral(pieces, |u, v| u - 2.0 * v) + 1.0 / 3.0).abs() < 1e-12);
            assert!((triangle_integral(pieces, |u, v| u * v) - 1.0 / 12.0).abs() < 1e-12);
        }
    }
}
