//! Vertices that lie inside of other geometry.

use crate::solved;
use glam::{DVec3, Vec3};
use lumel_scene::{ObjectMesh, Radiance, SceneBuilder};
use lumel_solve::{SolveState, Stop};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{grey, scene};
use lumel_testkit::{Estimate, Method, Stage, Storage, form_factor, hat_average};
use lumel_transport::Plan;
use std::f64::consts::PI;

/// Edge of a floor cell.
const CELL: f64 = 0.25;

/// Half the diagonal of the box: it covers the middle of the floor and the four vertices next to it.
const HALF_DIAGONAL: f64 = 1.5 * CELL;
const HEIGHT: f64 = 0.5;

/// Sides and top of a box that stands on its corner lines, turned by 45 degrees.
fn box_faces() -> Vec<[DVec3; 4]> {
    let ring = |z: f64| {
        let d = HALF_DIAGONAL;
        [[d, 0.0], [0.0, d], [-d, 0.0], [0.0, -d]].map(|[x, y]| DVec3::new(x, y, z))
    };
    let (low, high) = (ring(0.0), ring(HEIGHT));
    let side = |k: usize| [low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]];
    (0..4).map(side).chain([high]).collect()
}

/// 8 × 8 cells under a sky of radiance one, with the box in the middle; all black.
fn floor_with_box() -> SceneBuilder {
    let floor = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let mut objects = vec![quad(floor, [8, 8], 0)];
    objects.extend(box_faces().into_iter().map(|face| quad(face.map(|p| p.as_vec3()), [1, 1], 0)));
    under_sky(objects)
}

fn under_sky(objects: Vec<ObjectMesh>) -> SceneBuilder {
    SceneBuilder { sky: Radiance::splat(1.0).into(), ..scene(objects, vec![grey(0.0, 0.0)], vec![]) }
}

fn covered(p: DVec3) -> bool {
    p.x.abs() + p.y.abs() < HALF_DIAGONAL
}

/// How far outside of the box's footprint.
fn distance(p: DVec3) -> f64 {
    // Beside a side the nearest point lies on it, elsewhere it is a corner.
    let (x, y) = (p.x.abs(), p.y.abs());
    let along = ((x - y) / HALF_DIAGONAL).clamp(-1.0, 1.0);
    let nearest = [0.5 * HALF_DIAGONAL * (1.0 + along), 0.5 * HALF_DIAGONAL * (1.0 - along)];
    (x - nearest[0]).hypot(y - nearest[1])
}

/// π less what the faces of the box that look at the point hide.
fn truth(point: DVec3, normal: DVec3) -> f64 {
    let hidden: f64 = box_faces().iter().map(|face| form_factor::polygon(face, point, normal)).sum();
    PI * (1.0 - hidden)
}

fn is_floor((p, n): &(Vec3, Vec3)) -> bool {
    p.z == 0.0 && n.z > 0.9
}

/// Direct light of several independent solves with so many rays.
fn runs(stage: &Stage, method: Method, n: u64, indirect_samples: u32) -> Vec<SolveState> {
    let plan = |seed| Plan { seed, indirect_samples, ..Plan::default() };
    (0..n).map(|seed| solved(stage, method, plan(seed), Stop::Bounces(0))).collect()
}

#[test]
fn exactly_the_vertices_under_a_box_are_hidden() {
    let stage = Stage::new(floor_with_box());
    let hidden = stage.nodes().iter().filter(|node| is_floor(node) && covered(node.0.as_dvec3())).count();
    assert_eq!(hidden, 5);
    for method in Method::AT_VERTICES {
        let state = &runs(&stage, method, 1, 256)[0];
        for (node, valid) in stage.nodes().iter().zip(&state.valid) {
            let expected = !is_floor(node) || !covered(node.0.as_dvec3());
            assert_eq!(*valid, expected, "{method} at {}", node.0);
        }
    }
}

#[test]
fn a_floor_under_a_box_keeps_its_light_one_cell_away() {
    let stage = Stage::new(floor_with_box());
    for method in Method::ALL {
        let state = &runs(&stage, method, 1, 4096)[0];
        let mut n = 0;
        for (node, e) in stage.nodes().iter().zip(state.bounces[0].values()) {
            let at = node.0.as_dvec3();
            if is_floor(node) && !covered(at) && distance(at) >= CELL {
                n += 1;
                let off = f64::from(e.x) / truth(at, DVec3::Z) - 1.0;
                assert!(off.abs() < 0.02, "{method} at {at}: {off:+.4}");
            }
        }
        assert!(n > 50, "most of the floor is exposed");
    }
}

#[test]
fn neighbours_of_hidden_vertices_are_not_darkened() {
    let stage = Stage::new(floor_with_box());
    for method in Method::ALL {
        let states = runs(&stage, method, 24, 1024);
        let operator = stage.operator(method, Plan::default());
        let expected: Vec<f64> = match method.storage {
            Storage::Vertex => stage.expected(&operator, &truth),
            Storage::VertexArea => {
                // The mean over what is exposed.
                let open = |p: DVec3| if covered(p) && p.z == 0.0 { 0.0 } else { 1.0 };
                let lit = |p: DVec3, n| if open(p) == 0.0 { 0.0 } else { truth(p, n) };
                let sums = hat_average(stage.scene(), &*operator.basis, 24, &lit);
                let shares = hat_average(stage.scene(), &*operator.basis, 24, &|p, _| open(p));
                // Of the few pieces that are left of a node which is all but hidden, too little is known.
                let mean = |(sum, share): (f64, f64)| if share > 0.1 { sum / share } else { f64::NAN };
                sums.into_iter().zip(shares).map(mean).collect()
            }
        };
        let exposed = |i: &usize| {
            let node = stage.nodes()[*i];
            let is_open = method.storage == Storage::VertexArea || !covered(node.0.as_dvec3());
            is_floor(&node) && is_open && expected[*i].is_finite()
        };
        let floor: Vec<usize> = (0..expected.len()).filter(exposed).collect();
        for &node in &floor {
            let estimate = Estimate::new(states.iter().map(|s| f64::from(s.bounces[0].values()[node].x)));
            // Pieces cut by the outline of the box are counted whole or not at all: 24² of them leave 1 %.
            let bound = if method.storage == Storage::VertexArea {
                0.01 * expected[node]
            } else {
                1e-3 * expected[node]
            };
            let at = stage.nodes()[node].0;
            estimate.assert_near_among(floor.len(), expected[node], bound, format!("{method} at {at}"));
        }
    }
}

#[test]
fn hidden_vertices_take_the_light_around_them() {
    let stage = Stage::new(floor_with_box());
    let state = &runs(&stage, Method::VERTEX, 1, 256)[0];
    let floor = |exposed: bool| {
        let nodes: Vec<f32> = stage
            .nodes()
            .iter()
            .zip(state.bounces[0].values())
            .filter(|(node, _)| {
                is_floor(node) && covered(node.0.as_dvec3()) != exposed && node.0.length() < 0.6
            })
            .map(|(_, e)| e.x)
            .collect();
        let low = nodes.iter().copied().fold(f32::MAX, f32::min);
        (low, nodes.into_iter().fold(f32::MIN, f32::max))
    };
    let ((low, high), (hidden_low, hidden_high)) = (floor(true), floor(false));
    assert!(hidden_low >= low && hidden_high <= high, "{hidden_low}..{hidden_high} within {low}..{high}");
}

#[test]
fn vertices_inside_a_thin_wall_are_hidden_and_their_neighbours_are_not() {
    // A wall of 2 cm stands over the middle line of the floor's vertices.
    let floor = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let (min, max) = (Vec3::new(-0.01, -1.5, -0.1), Vec3::new(0.01, 1.5, 0.5));
    let mut objects = vec![quad(floor, [8, 8], 0)];
    objects.extend(cuboid(min, max, 1, Facing::Outward, [0; 6]));
    let stage = Stage::new(under_sky(objects));
    let (near, far) = (f64::from(max.x), f64::from(max.y));
    let side = [[-far, 0.0], [far, 0.0], [far, 0.5], [-far, 0.5]].map(|[y, z]| DVec3::new(near, y, z));
    let states = runs(&stage, Method::VERTEX, 16, 256);
    for (i, node) in stage.nodes().iter().enumerate().filter(|(_, node)| is_floor(node)) {
        assert_eq!(states[0].valid[i], node.0.x != 0.0, "{}", node.0);
        if node.0.x != 0.0 {
            // Mirrored onto the side of the wall that was written down.
            let at = DVec3::new(f64::from(node.0.x.abs()), node.0.y.into(), 0.0);
            let e = PI * (1.0 - form_factor::polygon(&side, at, DVec3::Z));
            let estimate = Estimate::new(states.iter().map(|s| f64::from(s.bounces[0].values()[i].x)));
            // At the rim of the floor origins start a thousandth of a cell inside.
            estimate.assert_near_among(72, e, 1e-3 * e, node.0);
        }
    }
    let area = &runs(&stage, Method::AREA, 1, 1024)[0];
    let beside = |(node, e): &((Vec3, Vec3), &Vec3)| is_floor(node) && node.0.x == 0.0 && e.x < 1.0;
    let dark = stage.nodes().into_iter().zip(area.bounces[0].values()).filter(beside).count();
    assert_eq!(dark, 0, "beside a wall half of the sky is open");
}
