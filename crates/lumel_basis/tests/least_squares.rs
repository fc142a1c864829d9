//! Projections of known light onto vertices.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use glam::{DVec3, Quat, Vec3};
use lumel_basis::{Basis, Field, LeastSquares, NodeId, VertexBasis};
use lumel_scene::{Face, ObjectMesh, TriId};
use lumel_testkit::mesh::{Facing, cuboid, quad, sphere};
use lumel_testkit::scene::{grey, two_sided};
use lumel_testkit::{fitted_slope, hat_average, triangle_integral};
use std::sync::Arc;

fn basis(meshes: Vec<ObjectMesh>) -> VertexBasis {
    let scene = lumel_testkit::scene::scene(meshes, vec![grey(0.5, 0.0)], Vec::new());
    VertexBasis::new(Arc::new(scene.build().unwrap().0))
}

/// The unit square in the plane `z`, with `n × n` cells.
fn square(n: u32) -> ObjectMesh {
    quad([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)), [n; 2], 0)
}

/// Numbers from 0 to 1 that follow no pattern.
fn scattered(i: usize) -> f64 {
    (((i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)) >> 40) as f64 / f64::from(1 << 24)
}

/// A square whose inner vertices are moved by up to 0.4 of a cell.
fn irregular(n: u32) -> ObjectMesh {
    let mut mesh = square(n);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        if p.min_element() == 0.0 && p.truncate().min_element() > 0.0 && p.max_element() < 1.0 {
            let offset = [2 * i, 2 * i + 1].map(|i| (0.8 * scattered(i) - 0.4) as f32 / n as f32);
            *p += Vec3::new(offset[0], offset[1], 0.0);
        }
    }
    mesh
}

/// Cells that get ten times smaller from one side to the other.
fn graded(n: u32) -> ObjectMesh {
    let mut mesh = square(n);
    let warp = |x: f32| (10f32.powf(x) - 1.0) / 9.0;
    mesh.positions.iter_mut().for_each(|p| *p = Vec3::new(warp(p.x), warp(p.y), 0.0));
    mesh
}

/// A square of cells `aspect` times as long as wide.
fn stretched(n: u32, aspect: f32) -> ObjectMesh {
    let mut mesh = square(n);
    mesh.positions.iter_mut().for_each(|p| p.x *= aspect);
    mesh
}

/// Rows of slivers between rows of cells: 10⁵ times as long as high.
fn slivers(n: u32) -> ObjectMesh {
    let mut mesh = square(n);
    let row = |y: f32| (y * n as f32).round();
    for p in &mut mesh.positions {
        let y = row(p.y);
        p.y = if y % 2.0 == 0.0 { y } else { y - 1.0 + 1e-5 } / n as f32;
    }
    mesh
}

fn meshes() -> Vec<(&'static str, VertexBasis)> {
    vec![
        ("grid", basis(vec![square(32)])),
        ("irregular", basis(vec![irregular(32)])),
        ("graded", basis(vec![graded(32)])),
        ("stretched", basis(vec![stretched(24, 8.0)])),
        ("ball", basis(vec![sphere(Vec3::ZERO, 1.0, 4, Facing::Outward, 0)])),
        ("box", basis(cuboid(Vec3::ZERO, Vec3::ONE, 12, Facing::Inward, [0; 6]))),
        ("slivers", basis(vec![slivers(16)])),
        ("one triangle", basis(vec![ObjectMesh { faces: square(1).faces[..1].to_vec(), ..square(1) }])),
    ]
}

fn grey_field(values: &[f64]) -> Field {
    Field::from_values(values.iter().map(|&value| Vec3::splat(value as f32)).collect())
}

/// The means of `f` under the hat functions.
fn means(basis: &VertexBasis, f: &dyn Fn(DVec3) -> f64) -> Field {
    grey_field(&hat_average(basis.scene(), basis, 4, &|point, _| f(point)))
}

fn at_nodes(basis: &VertexBasis, f: &dyn Fn(DVec3) -> f64) -> Field {
    let position = |&vertex: &u32| basis.scene().positions()[vertex as usize].as_dvec3();
    grey_field(&basis.first_vertices().iter().map(|vertex| f(position(vertex))).collect::<Vec<_>>())
}

fn projected(basis: &VertexBasis, alpha: f64, means: &Field) -> Field {
    let mut field = means.clone();
    LeastSquares::new(basis, alpha).project(&mut field);
    field
}

/// The root of the integral of the squared difference.
fn error(basis: &VertexBasis, field: &Field, f: &dyn Fn(DVec3) -> f64) -> f64 {
    let scene = basis.scene();
    let of_triangle = |(tri, nodes): (u32, &[NodeId; 3])| {
        let corners = scene.triangle_positions(TriId(tri)).map(|p| p.as_dvec3());
        let values = nodes.map(|node| f64::from(field.node(node).0.x));
        let at = |u: f64, v: f64| {
            let weights = [u, v, 1.0 - u - v];
            let point: DVec3 = (0..3).map(|k| corners[k] * weights[k]).sum();
            (f(point) - (0..3).map(|k| values[k] * weights[k]).sum::<f64>()).powi(2)
        };
        f64::from(scene.area(TriId(tri))) * triangle_integral(8, at)
    };
    (0..).zip(basis.corner_nodes().unwrap()).map(of_triangle).sum::<f64>().sqrt()
}

/// As [`projected`], within its own limits.
fn limited(basis: &VertexBasis, means: &Field) -> Field {
    let least_squares = LeastSquares::new(basis, LeastSquares::ALPHA);
    let mut field = means.clone();
    least_squares.project_within(&least_squares.limits(means), &mut field);
    field
}

fn largest_difference(a: &Field, b: &Field) -> f64 {
    a.values().iter().zip(b.values()).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max).into()
}

fn range(field: &Field) -> [f32; 2] {
    let values = || field.values().iter().map(|value| value.x);
    [values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max)]
}

fn power(basis: &VertexBasis, field: &Field) -> DVec3 {
    field.weighted_sum(basis.node_areas().iter().map(|&area| Vec3::splat(area)))
}

fn smooth(p: DVec3) -> f64 {
    (3.0 * p.x + 1.0).sin() * (2.0 * p.y).cos()
}

/// How light at vertices is found from known light.
#[derive(Clone, Copy, Debug)]
enum Way {
    Point,
    Area,
    LeastSquares(f64),
}

impl Way {
    fn field(self, basis: &VertexBasis, f: &dyn Fn(DVec3) -> f64) -> Field {
        match self {
            Self::Point => at_nodes(basis, f),
            Self::Area => means(basis, f),
            Self::LeastSquares(alpha) => projected(basis, alpha, &means(basis, f)),
        }
    }
}

/// Errors of smooth light with edges of 1/8, 1/16 and 1/32, from a separate implementation.
const KNOWN: [(Way, [f64; 3]); 4] = [
    (Way::Point, [9.5e-3, 2.4e-3, 6.0e-4]),
    (Way::Area, [2.5e-2, 8.0e-3, 2.7e-3]),
    (Way::LeastSquares(0.0), [4.2e-3, 1.04e-3, 2.6e-4]),
    (Way::LeastSquares(0.1), [1.15e-2, 1.9e-3, 3.6e-4]),
];

#[test]
fn each_projection_has_its_error_and_order_for_smooth_light() {
    for (way, known) in KNOWN {
        let errors = [8, 16, 32].map(|n| {
            let basis = basis(vec![square(n)]);
            error(&basis, &way.field(&basis, &smooth), &smooth)
        });
        for (error, known) in errors.iter().zip(known) {
            assert!((error / known - 1.0).abs() < 0.15, "{way:?}: {errors:?}");
        }
        let order = -fitted_slope(&[(8.0, errors[0]), (16.0, errors[1]), (32.0, errors[2])]);
        let expected = match way {
            Way::Area => 1.6,
            Way::LeastSquares(alpha) if alpha > 0.0 => 2.5,
            _ => 2.0,
        };
        assert!((order - expected).abs() < 0.15, "{way:?}: order {order}");
    }
}

#[test]
fn errors_are_the_same_on_meshes_that_are_moved_turned_and_reordered() {
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let offset = Vec3::new(30.0, -12.0, 7.0);
    let back = |p: DVec3| turn.inverse().as_dquat() * (p - offset.as_dvec3());
    for (way, known) in KNOWN {
        let mut mesh = square(16);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p + offset);
        let mut faces: Vec<(f64, Face)> =
            mesh.faces.iter().enumerate().map(|(i, face)| (scattered(i), *face)).collect();
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        mesh.faces = faces.into_iter().map(|(_, face)| face).collect();
        let moved = basis(vec![mesh]);
        let origin = moved.scene().origin();
        let f = |p: DVec3| smooth(back(p + origin));
        let error = error(&moved, &way.field(&moved, &f), &f);
        assert!((error / known[1] - 1.0).abs() < 0.15, "{way:?}: {error}");
    }
}

#[test]
fn a_step_stays_in_range_over_areas_and_overshoots_less_with_a_regulariser() {
    let step = |p: DVec3| if p.y > 0.31 + 0.37 * p.x { 1.0 } else { 0.0 };
    let basis = basis(vec![square(32)]);
    let [low, high] = range(&Way::Area.field(&basis, &step));
    assert!(low >= 0.0 && high <= 1.0 + 1e-6, "{low} {high}");
    let overshoot = |alpha| {
        let [low, high] = range(&Way::LeastSquares(alpha).field(&basis, &step));
        (-low).max(high - 1.0)
    };
    let [free, damped] = [0.0, 0.1].map(overshoot);
    assert!((0.15..0.5).contains(&free) && (0.0..0.7 * free).contains(&damped), "{free} {damped}");
    for (way, known) in [
        (Way::Point, 7.6e-2),
        (Way::Area, 7.4e-2),
        (Way::LeastSquares(0.0), 6.4e-2),
        (Way::LeastSquares(0.1), 7.8e-2),
    ] {
        // Where the line cuts cells decides the rest.
        let error = error(&basis, &way.field(&basis, &step), &step);
        assert!((error / known - 1.0).abs() < 0.25, "{way:?}: {error}");
    }
}

/// A spot of 10 in light of 1, with an edge that is nowhere along those of the mesh.
fn spot(p: DVec3) -> f64 {
    if (p.x - 0.47).hypot(p.y - 0.52) < 0.26 { 10.0 } else { 1.0 }
}

#[test]
fn within_limits_no_ring_lies_round_a_spot() {
    for (name, mesh) in [("grid", square(32)), ("irregular", irregular(32)), ("graded", graded(32))] {
        let basis = basis(vec![mesh]);
        let means = means(&basis, &spot);
        let free = projected(&basis, LeastSquares::ALPHA, &means);
        let limited = limited(&basis, &means);
        let ([free_low, free_high], [low, high]) = (range(&free), range(&limited));
        assert!(free_low < 0.6 && free_high > 10.4, "{name}: {free_low} {free_high}");
        assert!(low > 0.88 && high < 11.1, "{name}: {low} {high}");
        // Nor is the spot blurred much for it: the ring has its share of the error.
        let [before, after] = [&free, &limited].map(|field| error(&basis, field, &spot));
        assert!(after < 1.06 * before, "{name}: {before} {after}");
        let [before, after] = [&means, &limited].map(|field| power(&basis, field).x);
        assert!((after / before - 1.0).abs() < 1e-6, "{name}: {before} {after}");
    }
}

#[test]
fn limits_leave_linear_and_smooth_light_alone() {
    let linear = |p: DVec3| 3.6 + 3.0 * p.x - 0.5 * p.y;
    let bright = |p: DVec3| 1.2 + smooth(p);
    // Waves that the long cells do not resolve are edges to them.
    for (name, basis) in meshes().into_iter().filter(|(name, _)| *name != "stretched") {
        for light in [&linear as &dyn Fn(DVec3) -> f64, &bright] {
            let means = means(&basis, light);
            let difference =
                largest_difference(&limited(&basis, &means), &projected(&basis, LeastSquares::ALPHA, &means));
            assert!(difference == 0.0, "{name}: {difference}");
        }
    }
}

#[test]
fn within_the_limits_of_one_light_others_add_up() {
    let basis = basis(vec![irregular(32)]);
    let least_squares = LeastSquares::new(&basis, LeastSquares::ALPHA);
    let [all, part] = [means(&basis, &spot), means(&basis, &|p| if p.x > 0.5 { spot(p) } else { 0.0 })];
    let rest = all.values().iter().zip(part.values()).map(|(all, part)| *all - *part);
    let limits = least_squares.limits(&all);
    let [all, part, rest] =
        [all.clone(), part.clone(), Field::from_values(rest.collect())].map(|mut field| {
            least_squares.project_within(&limits, &mut field);
            field
        });
    let sum = Field::sum(basis.node_count(), [&part, &rest]);
    assert!(largest_difference(&sum, &all) < 1e-5);
}

#[test]
fn constants_are_exact_and_power_is_conserved() {
    for (name, basis) in meshes() {
        let n = basis.node_count();
        for alpha in [0.0, LeastSquares::ALPHA] {
            let constant = grey_field(&vec![0.7; n]);
            assert!(largest_difference(&projected(&basis, alpha, &constant), &constant) < 1e-7, "{name}");
            let noise: Vec<f64> = (0..n).map(scattered).collect();
            let means = grey_field(&noise);
            let coefficients = projected(&basis, alpha, &means);
            let (before, after) = (power(&basis, &means), power(&basis, &coefficients));
            // Each coefficient and each area is rounded once to single precision: by at most half a unit in the last place.
            let at = |i: usize| [&coefficients, &means].map(|f| f64::from(f.node(NodeId(i as u32)).0.x));
            let squares = basis.node_areas().iter().enumerate().map(|(i, &area)| {
                let [coefficient, mean] = at(i);
                f64::from(area).powi(2) * (coefficient.powi(2) + (coefficient - mean).powi(2))
            });
            let deviation = 0.5 * f64::from(f32::EPSILON) * (squares.sum::<f64>() / 3.0).sqrt();
            assert!(
                (after - before).abs().max_element() < 4.0 * deviation,
                "{name}, {alpha}: {before} {after} {deviation:e}"
            );
        }
    }
}

#[test]
fn few_iterations_are_enough_on_any_mesh() {
    for (name, basis) in meshes() {
        let light = |p: DVec3| 1.0 + smooth(p) + if p.x + 0.3 * p.y > 0.5 { 1.0 } else { 0.0 };
        let noise: Vec<f64> = (0..basis.node_count()).map(scattered).collect();
        let irregular = usize::from(name == "slivers");
        for (alpha, most_for_light, most_for_noise) in
            [(0.0, 12 + irregular, 14), (LeastSquares::ALPHA, 32, 36)]
        {
            let least_squares = LeastSquares::new(&basis, alpha);
            let n = least_squares.project(&mut means(&basis, &light));
            assert!(n <= most_for_light, "{name}, {alpha}: {n} iterations");
            let mut found = grey_field(&noise);
            least_squares.unproject(&mut found);
            let n = least_squares.project(&mut found);
            let error = largest_difference(&found, &grey_field(&noise));
            // The means are rounded to single precision; a stiff regulariser makes much of it.
            let rounding = if alpha > 0.0 { 3e-5 } else { 5e-7 };
            assert!(n <= most_for_noise && error < rounding, "{name}, {alpha}: {n} iterations, {error}");
        }
    }
}

#[test]
fn linear_light_on_flat_pieces_is_exact_across_creases_too() {
    let box_basis = basis(cuboid(Vec3::ZERO, Vec3::ONE, 5, Facing::Inward, [0; 6]));
    let scene = box_basis.scene();
    // On each side another function: nothing is smoothed over the edges of the box.
    let light = |point: DVec3, normal: DVec3| {
        1.0 + point.dot(DVec3::new(0.3, -0.2, 0.4)) + 5.0 * normal.x + point.y * normal.z
    };
    let means = grey_field(&hat_average(scene, &box_basis, 4, &light));
    let normal = |&vertex: &u32| scene.normals()[vertex as usize].as_dvec3();
    let point = |&vertex: &u32| scene.positions()[vertex as usize].as_dvec3();
    let exact: Vec<f64> = box_basis.first_vertices().iter().map(|v| light(point(v), normal(v))).collect();
    for alpha in [0.0, LeastSquares::ALPHA] {
        let difference = largest_difference(&projected(&box_basis, alpha, &means), &grey_field(&exact));
        assert!(difference < 3e-6, "{alpha}: {difference}");
    }
    let irregular = basis(vec![irregular(9)]);
    let linear = |p: DVec3| 2.0 + 3.0 * p.x - p.y;
    let found = Way::LeastSquares(LeastSquares::ALPHA).field(&irregular, &linear);
    assert!(largest_difference(&found, &at_nodes(&irregular, &linear)) < 3e-6);
}

#[test]
fn nothing_is_smoothed_across_edges_of_three_faces() {
    // Three wings on the y axis that share its vertices: light is linear on each, with a bend at the axis.
    let mut mesh =
        quad([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)), [4; 2], 0);
    let wing = mesh.clone();
    for (turn, flips) in [(2.0, false), (4.0, true)] {
        let turn = Quat::from_rotation_y(turn);
        let at =
            |i: u32| if wing.positions[i as usize].x == 0.0 { i } else { mesh.positions.len() as u32 + i };
        let mut faces = wing.faces.clone();
        faces.iter_mut().for_each(|face| face.vertices = face.vertices.map(at));
        if flips {
            faces.iter_mut().for_each(|face| face.vertices.reverse());
        }
        mesh.positions.extend(wing.positions.iter().map(|p| turn * *p));
        mesh.uvs.extend(&wing.uvs);
        mesh.faces.extend(faces);
    }
    // Normals that agree everywhere, so that the wings share nodes.
    mesh.normals = vec![Vec3::Y; mesh.positions.len()];
    let basis = basis(vec![mesh]);
    let light = |p: DVec3| 1.0 + p.x.hypot(p.z) + 0.5 * p.y;
    let found = Way::LeastSquares(LeastSquares::ALPHA).field(&basis, &light);
    assert!(largest_difference(&found, &at_nodes(&basis, &light)) < 3e-6);
}

#[test]
fn the_two_sides_of_a_face_do_not_touch_each_other() {
    let scene = lumel_testkit::scene::scene(vec![square(6)], vec![two_sided(grey(0.5, 0.0))], Vec::new());
    let basis = VertexBasis::new(Arc::new(scene.build().unwrap().0));
    let is_front = |&vertex: &u32| basis.scene().normals()[vertex as usize].z > 0.0;
    let front: Vec<bool> = basis.first_vertices().iter().map(is_front).collect();
    assert_eq!(front.iter().filter(|front| **front).count(), 49);
    let noise = |(i, front): (usize, &bool)| if *front { scattered(i) } else { 0.0 };
    let found = projected(
        &basis,
        LeastSquares::ALPHA,
        &grey_field(&front.iter().enumerate().map(noise).collect::<Vec<_>>()),
    );
    assert!(found.values().iter().zip(&front).all(|(value, front)| *front != (*value == Vec3::ZERO)));
}

#[test]
fn slivers_spoil_nothing_around_them() {
    let basis = basis(vec![slivers(16)]);
    let noise = grey_field(&(0..basis.node_count()).map(scattered).collect::<Vec<_>>());
    let [low, high] = range(&projected(&basis, LeastSquares::ALPHA, &noise));
    assert!(low > -1.5 && high < 2.5, "{low} {high}");
    let found = Way::LeastSquares(LeastSquares::ALPHA).field(&basis, &smooth);
    let known = error(&basis, &Way::Area.field(&basis, &smooth), &smooth);
    assert!(error(&basis, &found, &smooth) < known);
}

#[test]
fn bits_are_the_same_on_any_number_of_threads() {
    let basis = basis(vec![irregular(80)]);
    let channels =
        (0..2 * basis.node_count()).map(|i| Vec3::new(scattered(i) as f32, 1.0, scattered(3 * i) as f32));
    let means = Field::with_channels(2, channels.collect());
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| projected(&basis, LeastSquares::ALPHA, &means))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(5));
    // Each channel and colour by itself.
    let first = Field::from_values(means.values().iter().step_by(2).copied().collect());
    let alone = projected(&basis, LeastSquares::ALPHA, &first);
    assert!(
        alone
            .values()
            .iter()
            .zip(one.values().iter().step_by(2))
            .all(|(a, b)| (*a - *b).abs().max_element() < 1e-6)
    );
}
