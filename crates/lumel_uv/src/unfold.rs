//! Narrow charts laid out together with their neighbours.

use crate::chart::Chart;
use crate::planar::lies_on_itself;
use glam::{DVec2, DVec3};
use lumel_scene::{Edges, Scene, TriId, Weld};
use std::collections::VecDeque;

/// How much a triangle may turn from the first chart: its area shrinks to no less than this.
const MOST_TURNED: f64 = 0.8;

/// Charts of one object, those that continue each other's surface across creases in one, seen from their front, as far as they
/// turn little from the first. What would lie on itself stays as it is.
pub(crate) fn unfolded(scene: &Scene, mut charts: Vec<Chart>) -> Vec<Chart> {
    // The largest first: the others turn to it.
    charts.sort_by(|a, b| b.area.total_cmp(&a.area).then_with(|| a.triangles.cmp(&b.triangles)));
    let normals: Vec<Vec<DVec3>> = charts
        .iter()
        .map(|chart| chart.triangles.iter().map(|&tri| scene.geometric_normal(tri).as_dvec3()).collect())
        .collect();
    let beside = neighbours(scene, &charts);
    let mut is_free = vec![true; charts.len()];
    let mut found = Vec::with_capacity(charts.len());
    for seed in 0..charts.len() {
        if !std::mem::take(&mut is_free[seed]) {
            continue;
        }
        let mut group = vec![seed];
        let mean = normals[seed].iter().zip(&charts[seed].triangles);
        let mean: DVec3 = mean.map(|(normal, &tri)| *normal * f64::from(scene.area(tri))).sum();
        let turns_little =
            |chart: usize, to: DVec3| normals[chart].iter().all(|normal| normal.dot(to) > MOST_TURNED);
        if let Some(normal) = mean.try_normalize().filter(|normal| turns_little(seed, *normal)) {
            let mut waiting = VecDeque::from([seed]);
            while let Some(chart) = waiting.pop_front() {
                for &other in &beside[chart] {
                    if is_free[other] && turns_little(other, normal) {
                        is_free[other] = false;
                        group.push(other);
                        waiting.push_back(other);
                    }
                }
            }
            if group.len() > 1
                && let Some(whole) = seen_from(scene, &charts, &group, normal)
            {
                found.push(whole);
                continue;
            }
        }
        found.extend(group.iter().map(|&chart| charts[chart].clone()));
    }
    found
}

/// For each chart, those that have an edge in common with it and run along it the other way.
fn neighbours(scene: &Scene, charts: &[Chart]) -> Vec<Vec<usize>> {
    let mut weld = Weld::default();
    let all =
        charts.iter().enumerate().flat_map(|(i, chart)| chart.triangles.iter().map(move |&tri| (i, tri)));
    let (owners, tris): (Vec<usize>, Vec<TriId>) = all.unzip();
    let places = tris.iter().map(|&tri| scene.triangle_positions(tri).map(|p| weld.number(p)));
    let mut beside = vec![Vec::new(); charts.len()];
    for edge in Edges::new(places).each() {
        let [a, b] = edge else { continue };
        let [i, j] = [a, b].map(|side| owners[side.tri as usize]);
        if i != j && a.forward != b.forward {
            beside[i].push(j);
            beside[j].push(i);
        }
    }
    beside
}

/// The triangles of several charts as one, seen along a normal and enlarged by what they lose; `None` if they lie on each other.
fn seen_from(scene: &Scene, charts: &[Chart], group: &[usize], normal: DVec3) -> Option<Chart> {
    let (x, y) = normal.any_orthonormal_pair();
    let triangles: Vec<TriId> =
        group.iter().flat_map(|&chart| charts[chart].triangles.iter().copied()).collect();
    let areas = |tri: TriId| f64::from(scene.area(tri));
    let whole: f64 = triangles.iter().map(|&tri| areas(tri)).sum();
    let seen: f64 =
        triangles.iter().map(|&tri| areas(tri) * scene.geometric_normal(tri).as_dvec3().dot(normal)).sum();
    let enlarged = (whole / seen).sqrt();
    let origin = scene.triangle_positions(triangles[0])[0].as_dvec3();
    let flat = |tri: TriId| {
        scene.triangle_positions(tri).map(|p| {
            let from_origin = p.as_dvec3() - origin;
            DVec2::new(from_origin.dot(x), from_origin.dot(y)) * enlarged
        })
    };
    let corners: Vec<[DVec2; 3]> = triangles.iter().map(|&tri| flat(tri)).collect();
    let object = charts[group[0]].object;
    (!lies_on_itself(&corners)).then(|| Chart::new(object, triangles, &corners))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::signed_area;
    use crate::testing::{cube, scene_of};
    use glam::Vec3;
    use lumel_scene::{Face, MaterialId, ObjectMesh, Smoothing};

    /// A chart for each pair of triangles, which lie in one plane.
    fn pairs(scene: &Scene) -> Vec<Chart> {
        let chart = |first: u32| {
            let tris = [first, first + 1].map(TriId);
            let (x, y) = scene.geometric_normal(tris[0]).as_dvec3().any_orthonormal_pair();
            let flat = |p: Vec3| DVec2::new(p.as_dvec3().dot(x), p.as_dvec3().dot(y));
            let corners = tris.map(|tri| scene.triangle_positions(tri).map(flat));
            Chart::new(scene.object_id(tris[0]), tris.into(), &corners)
        };
        (0..scene.traced_count() as u32).step_by(2).map(chart).collect()
    }

    /// The side of a prism of many sides, flat one by one.
    fn prism(sides: u32) -> Scene {
        let at = |i: u32, z: f32| {
            let angle = (i as f32 / sides as f32 * 360.0).to_radians();
            Vec3::new(angle.cos(), angle.sin(), z)
        };
        let positions = (0..sides).flat_map(|i| [at(i, 0.0), at(i, 2.0)]).collect();
        let side = |i: u32| {
            let (a, b) = (2 * i, 2 * ((i + 1) % sides));
            [[a, b, b + 1], [a, b + 1, a + 1]]
        };
        let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Flat };
        let faces = (0..sides).flat_map(side).map(face).collect();
        scene_of(vec![ObjectMesh { name: "prism".into(), positions, faces, ..ObjectMesh::default() }])
    }

    #[test]
    fn the_sides_of_a_round_prism_hang_together_in_few_charts_and_those_of_a_cube_do_not() {
        let scene = prism(36);
        let charts = unfolded(&scene, pairs(&scene));
        assert!((4..=8).contains(&charts.len()), "{}", charts.len());
        assert_eq!(charts.iter().map(|chart| chart.triangles.len()).sum::<usize>(), 72);
        for chart in &charts {
            let area: f64 = chart.triangles.iter().map(|&tri| f64::from(scene.area(tri))).sum();
            assert!((chart.area / area - 1.0).abs() < 1e-3, "areas are true on average");
            assert!(chart.corners.iter().all(|t| signed_area(t.map(|c| c.as_dvec2())) > 0.0));
        }
        let cube = scene_of(vec![cube()]);
        assert_eq!(unfolded(&cube, pairs(&cube)).len(), 6);
    }

    #[test]
    fn what_would_lie_on_itself_stays_as_it_is() {
        // Steps of a spiral stair above each other, each a chart.
        let scene = scene_of(vec![crate::testing::spiral(3)]);
        let steps = pairs(&scene);
        let n = steps.len();
        assert_eq!(unfolded(&scene, steps).len(), n);
    }
}
