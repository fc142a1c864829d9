//! Our own charts: parts of the surface that are nearly flat, seen from their front.

use crate::chart::Chart;
use crate::overlap::overlapping;
use crate::topology::{NONE, Topology};
use glam::{DVec2, DVec3};
use lumel_scene::Scene;
use std::collections::VecDeque;

/// How much a face may turn from the first one of its chart: its area shrinks to no less than this.
pub(crate) const MOST_TURNED: f64 = 0.9;

/// How far triangles of a chart may lie on each other, as part of the side of a mean triangle: rounding leaves less.
const TOLERANCE: f64 = 0.02;

/// Charts over `faces` of an object. Always ends: what overlaps is halved, down to single triangles.
///
/// Triangles are projected along the normal of the largest of their chart, and the chart is enlarged by what their areas
/// lose on average, so that the areas of triangles are true within a factor of 0.9 to 1.12.
pub(crate) fn charts(scene: &Scene, topology: &Topology, faces: &[u32]) -> Vec<Chart> {
    let frames = Frames::new(scene, topology);
    let mut marks = vec![false; topology.len()];
    let mut charts = Vec::new();
    for group in grow(topology, &frames, faces) {
        let seed = group[0];
        let mut rest = VecDeque::from([group]);
        while let Some(group) = rest.pop_front() {
            let corners = project(topology, &frames, seed, &group);
            if group.len() > 1 && lies_on_itself(&corners) {
                let (first, second) = group.split_at(group.len() / 2);
                rest.extend(topology.parts_of(first, &mut marks));
                rest.extend(topology.parts_of(second, &mut marks));
                continue;
            }
            let triangles = group.iter().map(|&face| topology.tri(face)).collect();
            charts.push(Chart::new(topology.object, triangles, &corners));
        }
    }
    charts
}

/// A chart for each triangle: what is left when nothing else is without fault.
pub(crate) fn single_triangles(scene: &Scene, topology: &Topology) -> Vec<Chart> {
    let frames = Frames::new(scene, topology);
    let chart = |face: u32| {
        Chart::new(topology.object, vec![topology.tri(face)], &project(topology, &frames, face, &[face]))
    };
    (0..topology.len() as u32).map(chart).collect()
}

/// Normals and areas of the triangles.
struct Frames {
    normals: Vec<DVec3>,
    areas: Vec<f64>,
}

impl Frames {
    fn new(scene: &Scene, topology: &Topology) -> Self {
        let tris = || (0..topology.len() as u32).map(|face| topology.tri(face));
        Self {
            normals: tris().map(|tri| scene.geometric_normal(tri).as_dvec3()).collect(),
            areas: tris().map(|tri| f64::from(scene.area(tri))).collect(),
        }
    }
}

/// Groups of connected triangles, the first of which is the largest: none turns too far from it.
fn grow(topology: &Topology, frames: &Frames, faces: &[u32]) -> Vec<Vec<u32>> {
    let mut is_free = vec![false; topology.len()];
    faces.iter().for_each(|&face| is_free[face as usize] = true);
    let mut seeds = faces.to_vec();
    seeds.sort_by(|&a, &b| frames.areas[b as usize].total_cmp(&frames.areas[a as usize]).then(a.cmp(&b)));
    let mut groups = Vec::new();
    for seed in seeds {
        if !std::mem::take(&mut is_free[seed as usize]) {
            continue;
        }
        let mut group = vec![seed];
        let mut next = 0;
        while let Some(&face) = group.get(next) {
            next += 1;
            for other in topology.across[face as usize] {
                let belongs = |other: usize| {
                    is_free[other] && frames.normals[other].dot(frames.normals[seed as usize]) > MOST_TURNED
                };
                if other != NONE && belongs(other as usize) {
                    is_free[other as usize] = false;
                    group.push(other);
                }
            }
        }
        groups.push(group);
    }
    groups
}

/// The corners of a group in the plane of the triangle that it grew from.
fn project(topology: &Topology, frames: &Frames, seed: u32, group: &[u32]) -> Vec<[DVec2; 3]> {
    let normal = frames.normals[seed as usize].try_normalize().unwrap_or(DVec3::Z);
    let (x, y) = normal.any_orthonormal_pair();
    let sum = |value: &dyn Fn(usize) -> f64| group.iter().map(|&face| value(face as usize)).sum::<f64>();
    let seen = sum(&|face| frames.areas[face] * frames.normals[face].dot(normal));
    let whole = sum(&|face| frames.areas[face]);
    let enlarged = if seen > 0.0 { (whole / seen).sqrt() } else { 1.0 };
    let origin = topology.positions[topology.corners[seed as usize][0] as usize].as_dvec3();
    let flat = |corner: u32| {
        let from_origin = topology.positions[corner as usize].as_dvec3() - origin;
        DVec2::new(from_origin.dot(x), from_origin.dot(y)) * enlarged
    };
    group.iter().map(|&face| topology.corners[face as usize].map(flat)).collect()
}

/// Whether triangles lie on each other, or upside down.
pub(crate) fn lies_on_itself(corners: &[[DVec2; 3]]) -> bool {
    let area: f64 = corners.iter().map(|&t| crate::chart::signed_area(t)).sum();
    let mean_side = (area / corners.len() as f64).sqrt();
    if mean_side.is_nan() || mean_side == 0.0 {
        return false;
    }
    let scaled: Vec<[DVec2; 3]> = corners.iter().map(|t| t.map(|c| c / mean_side)).collect();
    !overlapping(&scaled, TOLERANCE).is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{scene_of, spiral};
    use glam::Vec3;
    use lumel_scene::TriId;
    use lumel_testkit::mesh::{Facing, sphere};

    fn of_all(scene: &Scene) -> Vec<Chart> {
        let topology = Topology::new(scene, 0..scene.traced_count() as u32);
        charts(scene, &topology, &(0..topology.len() as u32).collect::<Vec<_>>())
    }

    #[test]
    fn areas_on_a_sphere_are_true_within_a_tenth() {
        let scene = scene_of(vec![sphere(Vec3::ZERO, 1.0, 4, Facing::Outward, 0)]);
        let charts = of_all(&scene);
        let mut n_triangles = 0;
        for chart in &charts {
            for (&tri, corners) in chart.triangles.iter().zip(&chart.corners) {
                let stretch =
                    crate::chart::signed_area(corners.map(|c| c.as_dvec2())) / f64::from(scene.area(tri));
                assert!((0.9..1.12).contains(&stretch), "{stretch}");
                n_triangles += 1;
            }
        }
        assert_eq!(n_triangles, scene.triangle_count());
        assert!((12..120).contains(&charts.len()), "{}", charts.len());
    }

    #[test]
    fn the_turns_of_a_spiral_ramp_do_not_lie_on_each_other() {
        let scene = scene_of(vec![spiral(3)]);
        let charts = of_all(&scene);
        assert!(charts.len() >= 3, "{}", charts.len());
        for chart in &charts {
            let corners: Vec<_> = chart.corners.iter().map(|t| t.map(|c| c.as_dvec2())).collect();
            assert!(!lies_on_itself(&corners));
        }
        let n: usize = charts.iter().map(|chart| chart.triangles.len()).sum();
        assert_eq!(n, scene.triangle_count());
        assert!(charts.iter().any(|chart| chart.triangles.contains(&TriId(0))));
    }
}
