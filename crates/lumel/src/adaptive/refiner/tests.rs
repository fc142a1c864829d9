use super::*;
use glam::{DVec3, Vec3};
use lumel_scene::{Scene, SceneBuilder, SurfacePoint};
use lumel_testkit::scene::{grey, scene};
use lumel_testkit::{form_factor, mesh};
use std::convert::Infallible;
use std::f64::consts::PI;
use std::sync::Arc;

/// A rectangle of two triangles in the plane z = 0.
fn plane([x0, x1]: [f32; 2], [y0, y1]: [f32; 2]) -> Arc<Scene> {
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let builder: SceneBuilder = scene(vec![mesh::quad(corners, [1, 1], 0)], vec![grey(0.5, 0.0)], vec![]);
    Arc::new(builder.build().unwrap().0)
}

fn refined(
    scene: &Arc<Scene>,
    error: f64,
    max_vertices: usize,
    probe: impl Fn(DVec3) -> Probe,
) -> (Refiner, RefinementEnd) {
    let mut refiner = Refiner::new(Bisection::new(Arc::clone(scene)), error, max_vertices);
    let measure = |points: &[SurfacePoint]| {
        Ok::<_, Infallible>(points.iter().map(|&at| probe(scene.position(at).as_dvec3())).collect())
    };
    let Ok(end) = refiner.refine(measure, &mut |_| {});
    (refiner, end)
}

fn exact(light: f64) -> Probe {
    Probe { light, ..Probe::NONE }
}

/// Root mean square of the difference of a function and what is linear between its values at vertices, over its own.
fn error(scene: &Scene, mesh: &Bisection, f: impl Fn(DVec3) -> f64) -> f64 {
    let (mut squares, mut power) = (0.0, 0.0);
    for part in mesh.parts() {
        let corners = part.vertices.map(|vertex| mesh.position(vertex).as_dvec3());
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let at_corners = corners.map(&f);
        for weights in [[1.0, 1.0, 4.0], [1.0, 4.0, 1.0], [4.0, 1.0, 1.0], [2.0, 2.0, 2.0]] {
            let weights = weights.map(|weight: f32| weight / 6.0);
            let linear: f64 = at_corners.iter().zip(weights).map(|(light, w)| light * f64::from(w)).sum();
            let value = f(scene.position(part.at(weights)).as_dvec3());
            squares += area * (value - linear).powi(2);
            power += area * value * value;
        }
    }
    (squares / power).sqrt()
}

/// No edge is longer than it may be, whatever the light.
fn coarsest(scene: &Arc<Scene>) -> usize {
    let mut refiner = Refiner::new(Bisection::new(Arc::clone(scene)), 0.01, usize::MAX);
    assert_eq!(refiner.split_long(), RefinementEnd::Reached);
    refiner.mesh.vertex_count()
}

#[test]
fn linear_light_and_noise_split_nothing() {
    let scene = plane([0.0, 2.0], [0.0, 1.0]);
    let linear = |p: DVec3| exact(3.0 + 2.0 * p.x - p.y);
    let (refiner, end) = refined(&scene, 1e-3, usize::MAX, linear);
    assert_eq!((refiner.mesh.vertex_count(), end), (coarsest(&scene), RefinementEnd::Reached));
    // A tenth of the light, and known to be as uncertain.
    let noisy = |p: DVec3| {
        let noise = 0.1 * (1e4 * (p.x + 3.0 * p.y)).sin();
        Probe { light: 1.0 + noise, variance: 0.01, ..Probe::NONE }
    };
    assert_eq!(refined(&scene, 1e-3, usize::MAX, noisy).0.mesh.vertex_count(), coarsest(&scene));
    let certain = |p: DVec3| Probe { variance: 1e-8, ..noisy(p) };
    assert!(refined(&scene, 1e-3, 20_000, certain).0.mesh.vertex_count() > 10_000);
}

#[test]
fn edges_along_a_parabola_become_as_short_as_its_curvature_demands() {
    let scene = plane([0.0, 1.0], [0.0, 1.0]);
    let mut counts = Vec::new();
    for tolerance in [0.01, 0.0025] {
        let (refiner, end) = refined(&scene, tolerance, usize::MAX, |p| exact(p.x * p.x));
        assert_eq!(end, RefinementEnd::Reached);
        let floor = refiner.floor.unwrap();
        for ends in refiner.mesh.parts().flat_map(edges) {
            let [a, b] = ends.map(|vertex| f64::from(refiner.mesh.position(vertex).x));
            // The difference in the middle is a quarter of the square of the distance in x.
            let allowed =
                tolerance * (0.5 * (a * a + b * b)).max(floor) / (64.0 * refiner.mesh.relative_length(ends));
            let difference = 0.25 * (a - b) * (a - b);
            assert!(difference <= 1.02 * allowed, "{difference} of {allowed} between {a} and {b}");
        }
        counts.push(refiner.mesh.vertex_count());
    }
    assert!(counts[1] > counts[0], "{counts:?}");
}

/// Light of a square above a plane, half of it hidden by a screen half-way.
fn shadow(scale: f64) -> impl Fn(DVec3) -> f64 {
    let half = 0.5 * scale;
    let light = [[-half, half], [-half, half]];
    move |point: DVec3| {
        let lit = form_factor::polygon(&form_factor::facing_down(light[0], light[1], 2.0), point, DVec3::Z);
        let hidden = form_factor::hidden_part(light, 2.0, [[0.0, 1.0], [-1.0, 1.0]], 1.0, point);
        PI * (lit - hidden.map_or(0.0, |corners| form_factor::polygon(&corners, point, DVec3::Z)))
    }
}

#[test]
fn shadows_take_a_part_of_the_vertices_of_a_uniform_mesh() {
    let scene = plane([-1.0, 3.0], [-2.0, 2.0]);
    // Vertices and errors of second differences in a prototype, with soft and with sharp shadows.
    for (scale, tolerance, vertices, expected) in [
        (1.0, 0.04, 490, 4.7e-3),
        (1.0, 0.006, 1572, 1.5e-3),
        (0.1, 0.08, 1293, 2.1e-2),
        (0.1, 0.03, 5055, 6.3e-3),
    ] {
        let f = shadow(scale);
        let (refiner, _) = refined(&scene, tolerance, usize::MAX, |p| exact(f(p)));
        let (found, n) = (error(&scene, &refiner.mesh, &f), refiner.mesh.vertex_count());
        println!(
            "light of {scale}, {tolerance}: {n} vertices, error {found:.2e}; {vertices} and {expected:.1e}"
        );
        assert!(n <= vertices * 6 / 5, "{n} vertices, not {vertices}");
        assert!(found < 1.2 * expected, "{found}, not {expected}");
    }
}

#[test]
fn a_small_bright_patch_within_a_large_triangle_is_found() {
    // Far from all vertices and edges of the coarsest mesh.
    let scene = plane([0.0, 1.0], [0.0, 1.0]);
    let at = {
        let mut refiner = Refiner::new(Bisection::new(Arc::clone(&scene)), 0.01, usize::MAX);
        refiner.split_long();
        let part = *refiner.mesh.parts().nth(7).unwrap();
        scene.position(part.at(WITHIN[3])).as_dvec3()
    };
    let patch = |p: DVec3| exact(1.0 + if p.distance(at) < 0.01 { 100.0 } else { 0.0 });
    let before = coarsest(&scene);
    assert_eq!(refined(&scene, 0.01, usize::MAX, |_| exact(1.0)).0.mesh.vertex_count(), before);
    let (refiner, _) = refined(&scene, 0.01, usize::MAX, patch);
    println!("{} vertices of {before}", refiner.mesh.vertex_count());
    assert!(refiner.mesh.vertex_count() > before + 20);
}

#[test]
fn a_light_that_disappears_along_an_edge_splits_it_however_dim_it_is() {
    let scene = plane([0.0, 1.0], [0.0, 1.0]);
    let step = |p: DVec3| Probe { visible: u32::from(p.x > 0.4), ..exact(1.0) };
    let (refiner, _) = refined(&scene, 0.5, usize::MAX, step);
    assert!(refiner.mesh.vertex_count() > coarsest(&scene) + 5);
    for ends in refiner.mesh.parts().flat_map(edges) {
        let [a, b] = ends.map(|vertex| refiner.mesh.position(vertex).x > 0.4);
        assert!(a == b || refiner.mesh.relative_length(ends) <= 1.0 / 32.0);
    }
}

#[test]
fn no_more_vertices_are_made_than_allowed_and_the_worst_edges_come_first() {
    let scene = plane([-1.0, 3.0], [-2.0, 2.0]);
    let f = shadow(0.1);
    let (refiner, end) = refined(&scene, 0.01, 1500, |p| exact(f(p)));
    assert_eq!(end, RefinementEnd::Vertices);
    let n = refiner.mesh.vertex_count();
    assert!((1480..=1500).contains(&n), "{n}");
    let few = error(&scene, &refiner.mesh, &f);
    assert!(few < 2.5e-2, "{few}");
}

#[test]
fn after_a_bounce_only_what_is_measured_to_bend_is_split() {
    let scene = plane([0.0, 1.0], [0.0, 1.0]);
    let bump = |p: DVec3| 1.0 + 3.0 * (-200.0 * (p - DVec3::new(0.5, 0.5, 0.0)).length_squared()).exp();
    let after = |noise: f64, f: &dyn Fn(DVec3) -> f64| {
        let mut refiner = Refiner::new(Bisection::new(Arc::clone(&scene)), 0.02, usize::MAX);
        refiner.split_long();
        let position = |vertex: u32| refiner.mesh.position(vertex).as_dvec3();
        let light: Vec<Vec3> = (0..refiner.mesh.vertex_count() as u32)
            .map(|v| Vec3::splat((f(position(v)) + noise * (37.0 * f64::from(v)).sin()) as f32))
            .collect();
        let measure = |points: &[SurfacePoint]| {
            let at = |at: &SurfacePoint| exact(f(scene.position(*at).as_dvec3()));
            Ok::<_, Infallible>(points.iter().map(at).collect())
        };
        let before = refiner.mesh.vertex_count();
        let Ok(end) = refiner.refine_after_bounce(0.02, &light, measure, &mut |_| {});
        assert_eq!(end, RefinementEnd::Reached);
        (refiner.mesh.vertex_count() - before, error(&scene, &refiner.mesh, f))
    };
    let (new, error) = after(0.0, &bump);
    println!("{new} vertices, error {error:.2e}");
    assert!(new > 50 && error < 6e-3, "{new} {error}");
    // Light that is noisy at vertices bends everywhere, until it is looked at.
    assert_eq!(after(0.2, &|_| 1.0).0, 0);
}
