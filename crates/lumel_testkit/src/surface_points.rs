//! Random points on surfaces.

use lumel_sample::{Dim, Sampler, StreamKey, uniform_triangle};
use lumel_scene::{Scene, SurfacePoint, TriId};

/// `n` independent points, uniform by area over all surfaces of a scene; both sides of a two-sided one count.
pub fn random_surface_points(scene: &Scene, n: u32, seed: u64) -> Vec<SurfacePoint> {
    let mut ends = Vec::with_capacity(scene.triangle_count());
    let mut area = 0.0;
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        area += f64::from(scene.area(tri));
        ends.push(area);
    }
    let point = |i: u32| {
        let [coarse, fine, u, v] = unit_4d(seed, i);
        // Two numbers of 24 bits each: one would miss small triangles among many.
        let target = area * (f64::from(coarse) + f64::from(fine) / f64::from(1 << 24));
        let tri = ends.partition_point(|end| *end <= target).min(ends.len() - 1) as u32;
        SurfacePoint { tri: TriId(tri), bary: uniform_triangle([u, v]).into() }
    };
    (0..n).map(point).collect()
}

/// `per_triangle` independent points on each triangle, triangle by triangle.
pub(crate) fn points_on_triangles(
    scene: &Scene,
    per_triangle: u32,
    seed: u64,
) -> impl Iterator<Item = SurfacePoint> {
    (0..scene.triangle_count() as u32).flat_map(move |tri| {
        (0..per_triangle).map(move |i| {
            let [u, v, ..] = unit_4d(seed, tri * per_triangle + i);
            SurfacePoint { tri: TriId(tri), bary: uniform_triangle([u, v]).into() }
        })
    })
}

/// Random point number `i` of the 4-D unit cube.
pub(crate) fn unit_4d(seed: u64, i: u32) -> [f32; 4] {
    Sampler::Random.sample_4d(StreamKey::new(seed).element(i), 0, Dim::Hemisphere)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::quad;
    use crate::scene::{grey, scene, two_sided};
    use glam::Vec3;

    #[test]
    fn points_are_uniform_by_area_and_lie_on_both_sides() {
        // Two rows of cells; the second is three times as high.
        let strip = |y: [f32; 2]| {
            let corners = [[0.0, y[0]], [4.0, y[0]], [4.0, y[1]], [0.0, y[1]]];
            quad(corners.map(|[x, y]| Vec3::new(x, y, 0.0)), [4, 1], 0)
        };
        let builder =
            scene(vec![strip([0.0, 1.0]), strip([1.0, 4.0])], vec![two_sided(grey(0.5, 0.0))], vec![]);
        let (scene, _) = builder.build().unwrap();
        let n = 40_000;
        let points = random_surface_points(&scene, n, 1);
        let share = |is_in: &dyn Fn(SurfacePoint) -> bool| {
            points.iter().filter(|at| is_in(**at)).count() as f64 / f64::from(n)
        };
        // Shares are known to at most 0.0025; four of that.
        assert!((share(&|at| scene.position(at).y > 1.0) - 0.75).abs() < 0.01);
        assert!((share(&|at| scene.position(at).x > 1.0) - 0.75).abs() < 0.01);
        assert!((share(&|at| scene.geometric_normal(at.tri).z > 0.0) - 0.5).abs() < 0.01);
        assert_eq!(points, random_surface_points(&scene, n, 1));
        assert_ne!(points, random_surface_points(&scene, n, 2));
    }
}
