//! Points scattered over surfaces, and the functions around them.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use glam::{DVec3, Vec3};
use lumel_basis::{
    Basis, CloudLighting, CloudPoint, Field, Lighting, MeshlessBasis, NodeWeights, PointCloud, SurfaceSample,
    VertexLighting,
};
use lumel_scene::{Barycentrics, ObjectMesh, Scene, SurfacePoint, TriId};
use lumel_testkit::mesh::{Facing, cuboid, quad, sphere};
use lumel_testkit::scene::{grey, scene, two_sided};
use lumel_testkit::{Reference, random_surface_points};
use std::sync::Arc;

fn built(objects: Vec<ObjectMesh>) -> Arc<Scene> {
    Arc::new(scene(objects, vec![grey(0.5, 0.0)], vec![]).build().unwrap().0)
}

/// A square of 1 m in the plane y = 0, with its triangles in a grid of `cells` each way.
fn square(cells: [u32; 2]) -> ObjectMesh {
    quad([Vec3::ZERO, Vec3::Z, Vec3::X + Vec3::Z, Vec3::X], cells, 0)
}

fn room(cells: u32) -> Arc<Scene> {
    built(cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5), cells, Facing::Inward, [0; 6]))
}

/// The distance of the nearest two points of those that face the same way, over the spacing.
fn least_distance(basis: &MeshlessBasis) -> f32 {
    let points = basis.points();
    let pairs = points.iter().enumerate().flat_map(|(i, a)| points[i + 1..].iter().map(move |b| (a, b)));
    let near = pairs.filter(|(a, b)| a.normal.dot(b.normal) > 0.5);
    near.map(|(a, b)| a.position.distance(b.position)).fold(f32::INFINITY, f32::min) / basis.spacing()
}

/// How far the nearest point that faces about the same way is from a place, over the spacing.
fn distance_to(basis: &MeshlessBasis, at: SurfacePoint) -> f32 {
    let (position, normal) = (basis.scene().position(at), basis.scene().shading_normal(at));
    let alike = |point: &&SurfaceSample| point.normal.dot(normal) > 0.1;
    let distances = basis.points().iter().filter(alike).map(|point| point.position.distance(position));
    distances.fold(f32::INFINITY, f32::min) / basis.spacing()
}

fn corners(scene: &Scene) -> impl Iterator<Item = SurfacePoint> {
    (0..scene.triangle_count() as u32)
        .flat_map(|tri| Barycentrics::CORNERS.map(|bary| SurfacePoint { tri: TriId(tri), bary }))
}

/// A square with a strip of slivers beside it, and a thousand crumbs far smaller than the spacing.
fn slivers_and_crumbs() -> Arc<Scene> {
    let sliver =
        quad([Vec3::X, Vec3::X + Vec3::Z, Vec3::new(1.001, 0.0, 1.0), Vec3::new(1.001, 0.0, 0.0)], [7, 1], 0);
    let crumb = |i: usize| {
        let at = Vec3::new(i as f32 * 0.6, 3.0, 0.0);
        quad([at, at + Vec3::Z * 1e-3, at + Vec3::new(1e-3, 0.0, 1e-3), at + Vec3::X * 1e-3], [1, 1], 0)
    };
    built((0..1000).map(crumb).chain([square([3, 3]), sliver]).collect())
}

#[test]
fn points_keep_their_distance_and_cover_everything() {
    let ball = || built(vec![sphere(Vec3::ZERO, 1.0, 3, Facing::Outward, 0)]);
    for (name, scene, spacing) in [
        ("room", room(2), 0.05),
        ("room of large triangles", room(1), 0.02),
        ("coarse in a room", room(3), 0.7),
        ("ball", ball(), 0.08),
        ("slivers and crumbs", slivers_and_crumbs(), 0.04),
    ] {
        let basis = MeshlessBasis::new(Arc::clone(&scene), spacing);
        let least = least_distance(&basis);
        assert!(least >= 0.999, "{name}: points are {least} spacings apart");
        let places = random_surface_points(&scene, 2000, 7).into_iter().chain(corners(&scene).take(4000));
        let furthest = places.map(|at| distance_to(&basis, at)).fold(0.0, f32::max);
        assert!(furthest < 1.67, "{name}: a place is {furthest} spacings from the nearest point");
    }
}

#[test]
fn points_are_as_many_as_their_spacing_allows() {
    for (scene, spacing) in [(room(1), 0.02), (room(9), 0.02), (built(vec![square([1, 1])]), 0.01)] {
        let area: f32 = (0..scene.triangle_count() as u32).map(|tri| scene.area(TriId(tri))).sum();
        let basis = MeshlessBasis::new(Arc::clone(&scene), spacing);
        let density = basis.node_count() as f32 * spacing * spacing / area;
        assert!((0.62..0.72).contains(&density), "{density}");
        let expected = MeshlessBasis::count_for(&scene, spacing);
        assert!((0.9..1.1).contains(&(basis.node_count() as f32 / expected as f32)));
        assert!((MeshlessBasis::spacing_for(&scene, expected) / spacing - 1.0).abs() < 0.01);
    }
    // One for each crumb.
    let crumbs = MeshlessBasis::new(slivers_and_crumbs(), 0.5);
    assert!((1000..1030).contains(&crumbs.node_count()), "{}", crumbs.node_count());
}

#[test]
fn points_are_the_same_on_any_number_of_threads() {
    let scene = room(4);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| MeshlessBasis::new(Arc::clone(&scene), 0.03))
    };
    let [one, three] = [1, 3].map(on);
    assert_eq!(one.points(), three.points());
    assert_eq!(one.node_areas(), three.node_areas());
    assert_eq!(one.identity(), three.identity());
    assert_ne!(one.identity(), MeshlessBasis::new(Arc::clone(&scene), 0.031).identity());
}

/// The coefficients of a function of position and normal.
fn field(basis: &MeshlessBasis, f: impl Fn(DVec3, DVec3) -> f64) -> Field {
    let value = |point: &SurfaceSample| f(point.position.as_dvec3(), point.normal.as_dvec3());
    let mut field =
        Field::from_values(basis.points().iter().map(|point| Vec3::splat(value(point) as f32)).collect());
    if let Some(hierarchy) = basis.hierarchy() {
        hierarchy.analyze(&mut field, None);
    }
    field
}

fn wave(p: DVec3, _: DVec3) -> f64 {
    2.0 + (5.0 * p.x + 1.0).sin() * (4.0 * p.z).cos()
}

/// Root mean square error over the surfaces of a wave that is read from its values at the points.
fn error_of_wave(scene: &Arc<Scene>, spacing: f32) -> f64 {
    error_on(&MeshlessBasis::new(Arc::clone(scene), spacing))
}

fn error_on(basis: &MeshlessBasis) -> f64 {
    let scene = basis.scene();
    Reference::known(scene, 4000, 3, wave).error_of_field(basis, &field(basis, wave)).rms
}

#[test]
fn how_a_surface_is_cut_into_triangles_makes_no_difference() {
    let errors = [[1, 1], [37, 23], [1, 300]].map(|cells| error_of_wave(&built(vec![square(cells)]), 0.05));
    let [least, most] = [f64::min, f64::max].map(|pick| errors.into_iter().reduce(pick).unwrap());
    assert!(most < 1.15 * least, "{errors:?}");
}

#[test]
fn the_error_of_smooth_light_falls_with_the_spacing() {
    let square = built(vec![square([1, 1])]);
    let errors = [0.1, 0.05, 0.025, 0.0125].map(|spacing| error_of_wave(&square, spacing));
    for pair in errors.windows(2) {
        // Kernels that are normalised reproduce constants alone: first order, but symmetric inside.
        assert!((2.0..3.2).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn weights_sum_to_one_wherever_normals_turn() {
    // Around a coarse ball and the rim of a cone, interpolated normals differ by more than kernels reach over.
    for scene in [built(vec![sphere(Vec3::ZERO, 1.0, 0, Facing::Outward, 0)]), slivers_and_crumbs()] {
        for spacing in [3.0, 0.3] {
            let basis = MeshlessBasis::new(Arc::clone(&scene), spacing);
            for at in random_surface_points(&scene, 4000, 1).into_iter().chain(corners(&scene)) {
                let mut weights = NodeWeights::default();
                basis.weights_at(at, &mut weights);
                let sum: f64 = weights.iter().map(|(_, weight)| f64::from(weight)).sum();
                assert!((sum - 1.0).abs() < 1e-6, "{sum} at {at:?}");
            }
        }
    }
}

/// The values that are read of a field which is 1 where `is_lit` and 0 elsewhere.
fn values_of(basis: &MeshlessBasis, is_lit: impl Fn(Vec3, Vec3) -> bool) -> Vec<(f32, f32)> {
    let at = |at: DVec3, n: DVec3| f64::from(u8::from(is_lit(at.as_vec3(), n.as_vec3())));
    let (field, mut weights) = (field(basis, at), NodeWeights::default());
    let mut read = |at: SurfacePoint| {
        let (position, normal) = (basis.scene().position(at), basis.scene().geometric_normal(at.tri));
        (field.at(basis, at, &mut weights).0.x, f32::from(u8::from(is_lit(position, normal))))
    };
    random_surface_points(basis.scene(), 4000, 5).into_iter().map(&mut read).collect()
}

#[test]
fn light_leaks_neither_through_thin_walls_nor_around_corners() {
    let both_sides = scene(vec![square([2, 2])], vec![two_sided(grey(0.5, 0.0))], vec![]);
    let slab = cuboid(Vec3::ZERO, Vec3::new(1.0, 0.01, 1.0), 1, Facing::Outward, [0; 6]);
    for scene in [Arc::new(both_sides.build().unwrap().0), built(slab), room(1)] {
        for (levels, axis) in
            [1, 3].into_iter().flat_map(|n| [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (n, axis)))
        {
            let basis = MeshlessBasis::with_levels(Arc::clone(&scene), 0.1, levels);
            let values = values_of(&basis, |_, normal| normal.dot(axis) > 0.5);
            assert!(values.iter().all(|(read, lit)| (read - lit).abs() < 2e-6), "{axis}, {levels} levels");
        }
    }
}

#[test]
fn functions_lie_where_a_scene_is_moved_to() {
    let moved = |by: Vec3, size: f32| {
        let mut mesh = square([5, 5]);
        mesh.positions.iter_mut().for_each(|p| *p = *p * size + by);
        let scene = built(vec![mesh]);
        let basis = MeshlessBasis::new(Arc::clone(&scene), 0.04 * size);
        let least = basis.node_areas().iter().copied().fold(f32::INFINITY, f32::min) / (size * size);
        (basis.node_count() as f64, least, least_distance(&basis))
    };
    let (count, least_area, _) = moved(Vec3::ZERO, 1.0);
    assert!(least_area > 2e-4, "{least_area}");
    for (by, size) in [(Vec3::new(3000.0, -70.0, 500.0), 1.0), (Vec3::ZERO, 1e-4), (Vec3::ONE, 1e5)] {
        let (moved, least, distance) = moved(by, size);
        assert!((moved / count - 1.0).abs() < 0.05 && least > 2e-4, "{moved} {count} {least}");
        assert!(distance > 0.99, "{distance}");
    }
}

#[test]
fn levels_bring_the_order_that_kernels_lack() {
    let square = built(vec![square([1, 1])]);
    let spacing = |levels: u32| 0.25 * (1.0 - levels as f32).exp2();
    let errors: Vec<f64> = (1..=5)
        .map(|levels| error_on(&MeshlessBasis::with_levels(Arc::clone(&square), spacing(levels), levels)))
        .collect();
    let ratio = (errors[0] / errors[4]).powf(0.25);
    println!("{errors:?}, {ratio} from level to level");
    assert!(ratio > 2.8, "{errors:?}");
    let alone = error_of_wave(&square, spacing(5));
    assert!(alone > 3.0 * errors[4], "{alone} without levels, {} with them", errors[4]);
}

#[test]
fn constants_stand_in_the_coarsest_level_alone() {
    let basis = MeshlessBasis::with_levels(room(2), 0.06, 4);
    assert_eq!(basis.level_count(), 4);
    let coefficients = field(&basis, |_, _| 3.0);
    for level in 0..4 {
        let nodes = basis.nodes_of_level(level);
        assert_eq!(basis.radius_of_level(level), 0.12 * f32::from(1u8 << (3 - level)));
        let expected = if level == 0 { 3.0 } else { 0.0 };
        for node in nodes {
            let found = coefficients.values()[node as usize].x;
            assert!((found - expected).abs() < 3e-6, "{found} at level {level}");
        }
    }
    assert_eq!(basis.nodes_of_level(3).end as usize, basis.node_count());
}

#[test]
fn what_is_read_from_afar_is_what_coarse_levels_say() {
    let scene = room(1);
    let (fine, coarse) = (
        MeshlessBasis::with_levels(Arc::clone(&scene), 0.05, 3),
        MeshlessBasis::with_levels(Arc::clone(&scene), 0.1, 2),
    );
    let [of_fine, of_coarse] = [&fine, &coarse].map(|basis| field(basis, wave));
    let hierarchy = fine.hierarchy().unwrap();
    for at in random_surface_points(&scene, 500, 9) {
        let (mut weights, mut scratch) = (NodeWeights::default(), NodeWeights::default());
        hierarchy.weights_up_to(1, at, &mut weights);
        let afar: f32 = weights.iter().map(|(node, weight)| of_fine.node(node).0.x * weight).sum();
        assert!((afar - of_coarse.at(&coarse, at, &mut scratch).0.x).abs() < 1e-5);
    }
}

#[test]
fn points_without_their_surfaces_say_the_same_in_whatever_order() {
    let scene = built(vec![sphere(Vec3::ZERO, 1.0, 1, Facing::Outward, 0)]);
    let basis = MeshlessBasis::with_levels(Arc::clone(&scene), 0.2, 3);
    let (field, hierarchy) = (field(&basis, wave), basis.hierarchy().unwrap());
    let whole = PointCloud::of(&basis);
    let turned = |values: Vec<CloudPoint>| PointCloud::new(values.into_iter().rev().collect());
    let turned = turned(whole.points().to_vec());
    let backwards: Vec<Vec3> = field.values().iter().rev().copied().collect();
    let lift = vec![Vec3::X; scene.vertex_count()];
    let vertices = VertexLighting::new(&scene, &lift).unwrap();
    for finest in [0, 1, u32::MAX] {
        let lighting =
            CloudLighting { scene: &scene, cloud: &whole, values: field.values(), finest, vertices };
        let other = CloudLighting { cloud: &turned, values: &backwards, ..lighting };
        for at in random_surface_points(&scene, 500, 3) {
            let mut weights = NodeWeights::default();
            hierarchy.weights_up_to(finest, at, &mut weights);
            let read: Vec3 = weights.iter().map(|(node, w)| field.values()[node.index()] * w).sum();
            for lighting in [lighting, other] {
                let shown = lighting.irradiance(at, Vec3::ZERO).0 - Vec3::X;
                assert!((shown - read).length() < 1e-5, "level {finest}: {shown} and {read}");
            }
        }
    }
    let (none, at) = (PointCloud::new(vec![]), Vec3::ZERO);
    assert_eq!((none.level_count(), none.at(&[], at, Vec3::Y, 7)), (0, Vec3::ZERO));
}

/// The share of the nodes that are needed where a node of a level is only looked at if one that overlaps it has a coefficient above
/// `tolerance`, and the error over the surface.
fn followed(basis: &MeshlessBasis, tolerance: f32, f: impl Fn(DVec3, DVec3) -> f64 + Copy) -> [f64; 2] {
    let hierarchy = basis.hierarchy().unwrap();
    let mut known = vec![false; basis.node_count()];
    (0..basis.nodes_of_level(1).end as usize).for_each(|node| known[node] = true);
    let value = |point: &SurfaceSample| f(point.position.as_dvec3(), point.normal.as_dvec3());
    let values: Vec<Vec3> = basis.points().iter().map(|point| Vec3::splat(value(point) as f32)).collect();
    for level in 1.. {
        let mut field = Field::from_values(values.clone());
        hierarchy.analyze(&mut field, Some(&known));
        if level + 1 == basis.level_count() {
            let share = known.iter().filter(|known| **known).count() as f64 / known.len() as f64;
            let error = Reference::known(basis.scene(), 4000, 3, f).error_of_field(basis, &field);
            return [share, error.rms];
        }
        let large = |(value, known): (&Vec3, &bool)| *known && value.x.abs() > tolerance;
        let marked: Vec<bool> = field.values().iter().zip(&known).map(large).collect();
        hierarchy.finer(level, &marked).into_iter().for_each(|node| known[node.index()] = true);
    }
    unreachable!("a basis has a finest level")
}

#[test]
fn few_nodes_say_what_all_say_of_light_with_an_edge() {
    let basis = MeshlessBasis::with_levels(built(vec![square([1, 1])]), 0.25 / 16.0, 5);
    let step = |p: DVec3, _: DVec3| 1.0 + f64::from(u8::from(p.x + 0.3 * p.z > 0.6));
    let [all, error_of_all] = followed(&basis, -1.0, step);
    let [some, error] = followed(&basis, 0.1, step);
    println!("{some} of the nodes have an error of {error}, all of {error_of_all}");
    assert!(all == 1.0 && some < 0.45, "{some}");
    assert!(error < 1.02 * error_of_all, "{error} {error_of_all}");
    // Smooth light finds the level that is good enough, and no more.
    let [some, error] = followed(&basis, 0.02, wave);
    let [fewer, larger] = followed(&basis, 0.2, wave);
    println!("{some}: {error}, {fewer}: {larger}");
    assert!(fewer < 0.5 * some && error < 0.5 * larger, "{some} {error} {fewer} {larger}");
}
