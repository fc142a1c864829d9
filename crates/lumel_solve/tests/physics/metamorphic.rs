//! What must not change, or change in a known way, when the scene does.

use crate::{solved, solved_by};
use glam::{Mat3, Quat, Vec3};
use lumel_basis::Field;
use lumel_scene::{Light, RectLight, SceneBuilder};
use lumel_solve::Stop;
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{ceiling_light, grey, scene, two_sided};
use lumel_testkit::{Estimate, Method, Stage, rms};
use lumel_transport::Plan;

const STOP: Stop = Stop::Bounces(3);

fn plan(seed: u64) -> Plan {
    Plan { seed, direct_samples: 64, indirect_samples: 64, ..Plan::default() }
}

/// A room with a box in it and up to two lights.
fn room(lights: &[RectLight]) -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::new(1.0, 1.2, 0.9), 3, Facing::Inward, [0, 0, 1, 0, 0, 0]);
    let (min, max) = (Vec3::new(0.31, 0.42, 0.1), Vec3::new(0.63, 0.77, 0.4));
    objects.extend(cuboid(min, max, 1, Facing::Outward, [1; 6]));
    scene(objects, vec![grey(0.6, 0.0), grey(0.3, 0.0)], lights.iter().copied().map(Light::Rect).collect())
}

/// The same without the box: nothing blocks light.
fn empty_room(lights: &[RectLight]) -> SceneBuilder {
    let mut builder = room(lights);
    builder.objects.truncate(6);
    builder
}

fn lamp() -> RectLight {
    ceiling_light(Vec3::new(0.4, 0.5, 0.85), 0.5, 0.4, 3.0)
}

fn other_lamp() -> RectLight {
    RectLight {
        u: Vec3::Z * 0.2,
        v: Vec3::Y * 0.3,
        ..ceiling_light(Vec3::new(0.95, 0.6, 0.4), 1.0, 1.0, 5.0)
    }
}

fn transformed(mut builder: SceneBuilder, matrix: Mat3) -> SceneBuilder {
    for object in &mut builder.objects {
        object.positions.iter_mut().for_each(|p| *p = matrix * *p);
    }
    for light in &mut builder.lights {
        if let Light::Rect(rect) = light {
            (rect.center, rect.u, rect.v) = (matrix * rect.center, matrix * rect.u, matrix * rect.v);
        }
    }
    builder
}

fn total(builder: SceneBuilder, method: Method, seed: u64) -> Field {
    solved(&Stage::new(builder), method, plan(seed), STOP).total()
}

fn relative_rms(a: &Field, b: &Field) -> f64 {
    let differences = a.values().iter().zip(b.values()).map(|(a, b)| f64::from(a.x - b.x));
    rms(differences) / rms(a.values().iter().map(|e| f64::from(e.x)))
}

#[test]
fn scaling_the_scene_changes_nothing_under_lights_of_given_radiance() {
    for method in Method::ALL {
        let original = total(room(&[lamp()]), method, 1);
        for scale in [0.25, 8.0, 100.0] {
            let scaled =
                total(transformed(room(&[lamp()]), Mat3::from_diagonal(Vec3::splat(scale))), method, 1);
            // The same samples: only rays that graze an edge may decide otherwise, one of a thousand of 64.
            let off = relative_rms(&original, &scaled);
            assert!(off < 2e-3, "{method}, scale {scale}: {off}");
        }
    }
}

#[test]
fn turning_the_scene_changes_nothing_but_noise() {
    let turn = Mat3::from_quat(Quat::from_euler(glam::EulerRot::XYZ, 0.7, -1.1, 2.3));
    for method in Method::ALL {
        let runs = |builder: SceneBuilder, from: u64| {
            let stage = Stage::new(builder);
            (from..from + 24).map(|seed| solved(&stage, method, plan(seed), STOP).total()).collect::<Vec<_>>()
        };
        let (straight, turned) = (runs(room(&[lamp()]), 0), runs(transformed(room(&[lamp()]), turn), 100));
        for node in 0..straight[0].node_count() {
            let (a, b) = (Estimate::of_node(&straight, node), Estimate::of_node(&turned, node));
            // Welch: the difference of two means.
            let difference = Estimate { mean: a.mean - b.mean, error: a.error.hypot(b.error), count: 24 };
            let bound = 1e-4 * a.mean;
            difference.assert_near_among(
                straight[0].node_count(),
                0.0,
                bound,
                format!("{method}, node {node}"),
            );
        }
    }
}

#[test]
fn twice_the_emission_is_exactly_twice_the_light() {
    let bright = RectLight { radiance: lamp().radiance * 2.0, ..lamp() };
    for method in Method::ALL {
        let (once, twice) = (total(room(&[lamp()]), method, 3), total(room(&[bright]), method, 3));
        assert!(once.values().iter().zip(twice.values()).all(|(a, b)| *a * 2.0 == *b), "{method}");
    }
}

#[test]
fn two_lights_are_the_sum_of_each() {
    for method in Method::ALL {
        let together = total(empty_room(&[lamp(), other_lamp()]), method, 5);
        let [one, two] = [lamp(), other_lamp()].map(|light| total(empty_room(&[light]), method, 5));
        let sum = Field::sum(one.node_count(), [&one, &two]);
        // Nothing blocks the lights, so their closed forms have no noise; the bounces are linear for given samples.
        assert!(relative_rms(&together, &sum) < 1e-6, "{method}: {}", relative_rms(&together, &sum));
    }
}

#[test]
fn two_lights_are_the_sum_of_each_behind_a_box_too() {
    for method in Method::ALL {
        let runs = |lights: &[RectLight], from: u64| {
            let stage = Stage::new(room(lights));
            let operator = |seed| stage.operator(method, plan(seed));
            (from..from + 24).map(|seed| solved_by(&operator(seed), &stage, STOP).total()).collect::<Vec<_>>()
        };
        let together = runs(&[lamp(), other_lamp()], 0);
        let (one, two) = (runs(&[lamp()], 100), runs(&[other_lamp()], 200));
        let sums: Vec<Field> =
            one.iter().zip(&two).map(|(a, b)| Field::sum(a.node_count(), [a, b])).collect();
        for node in 0..sums[0].node_count() {
            let (a, b) = (Estimate::of_node(&together, node), Estimate::of_node(&sums, node));
            let difference = Estimate { mean: a.mean - b.mean, error: a.error.hypot(b.error), count: 24 };
            let bound = 1e-5 * a.mean;
            difference.assert_near_among(sums[0].node_count(), 0.0, bound, format!("{method}, node {node}"));
        }
    }
}

#[test]
fn black_walls_send_nothing_back() {
    for method in Method::ALL {
        let mut builder = room(&[lamp()]);
        builder.materials = vec![grey(0.0, 0.0), grey(0.0, 0.0)];
        let state = solved(&Stage::new(builder), method, plan(0), STOP);
        assert!(state.bounces[0].values().iter().any(|e| e.x > 0.0));
        let indirect = state.bounces[1..].iter().flat_map(|field| field.values());
        assert!(indirect.into_iter().all(|e| *e == Vec3::ZERO), "{method}");
    }
}

#[test]
fn light_does_not_leak_through_a_thin_wall() {
    // A wall without thickness divides a black room; it reflects on both sides, and only x > 0.5 is lit. It reaches
    // through the walls of the room, so that there is no gap.
    let wall = [[-0.1, -0.1], [1.1, -0.1], [1.1, 1.1], [-0.1, 1.1]].map(|[y, z]| Vec3::new(0.5, y, z));
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 4, Facing::Inward, [0; 6]);
    objects.push(quad(wall, [4, 4], 1));
    let light = Light::Rect(ceiling_light(Vec3::new(0.8, 0.5, 0.9), 0.3, 0.5, 10.0));
    let builder = scene(objects, vec![grey(0.0, 0.0), two_sided(grey(0.9, 0.0))], vec![light]);
    let stage = Stage::new(builder);
    for method in Method::ALL {
        let total = solved(&stage, method, plan(2), STOP).total();
        let (mut lit, mut dark) = (0, 0);
        for ((position, normal), e) in stage.nodes().iter().zip(total.values()) {
            let inside = position.min_element() >= 0.0 && position.max_element() <= 1.0;
            if inside && (position.x > 0.51 || (position.x == 0.5 && normal.x > 0.9)) {
                lit += usize::from(e.x > 0.0);
            }
            // Area sampling measures the vertices on the dividing line over both of its sides.
            if inside && (position.x < 0.49 || (position.x == 0.5 && normal.x < -0.9)) {
                dark += 1;
                assert_eq!(*e, Vec3::ZERO, "{method} at {position}, normal {normal}");
            }
        }
        assert!(lit > 50 && dark > 50, "{lit} {dark}");
    }
}
