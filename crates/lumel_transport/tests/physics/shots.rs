//! What a part of the nodes sends: the columns of stored rows, and points that receivers connect to.

use glam::Vec3;
use lumel_basis::{Field, NodeId};
use lumel_scene::SceneBuilder;
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::{grey, scene, two_sided, varying_sphere};
use lumel_testkit::{Estimate, Method, ROUNDING, Stage, assert_nodes_near, measure, replicates};
use lumel_testkit::{fitted_slope, rms};
use lumel_transport::{Plan, Source};

/// A room with a box that floats in it, and a sheet with two lit sides; one wall is black.
fn room() -> SceneBuilder {
    let materials = vec![grey(0.7, 0.0), grey(0.3, 0.0), grey(0.0, 0.0), two_sided(grey(0.5, 0.0))];
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 3, Facing::Inward, [0, 1, 0, 2, 0, 1]);
    objects.extend(cuboid(Vec3::splat(0.3), Vec3::new(0.6, 0.5, 0.5), 1, Facing::Outward, [1; 6]));
    let sheet = [[0.6, 0.6], [0.6, 0.9], [0.9, 0.9], [0.9, 0.6]];
    objects.push(quad(sheet.map(|[x, y]| Vec3::new(x, y, 0.6)), [2, 2], 3));
    scene(objects, materials, Vec::new())
}

fn all_nodes(field: &Field) -> Vec<NodeId> {
    (0..field.node_count() as u32).map(NodeId).collect()
}

fn only(field: &Field, nodes: &[NodeId]) -> Field {
    let mut part = Field::zeros(field.node_count());
    nodes.iter().for_each(|&node| part.coefficients_mut(node)[0] = field.node(node).0);
    part
}

/// The largest difference of two fields by the largest value.
fn difference(a: &Field, b: &Field) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = Vec3>| {
        f64::from(values.map(|value| value.abs().max_element()).fold(0.0, f32::max))
    };
    let pairs = a.values().iter().zip(b.values());
    largest(&mut pairs.map(|(a, b)| *a - *b)) / largest(&mut b.values().iter().copied())
}

fn plan(indirect_samples: u32, seed: u64) -> Plan {
    Plan { indirect_samples, seed, ..Plan::default() }
}

#[test]
fn shots_of_all_nodes_add_up_to_one_of_all_and_on_stored_rays_to_a_bounce() {
    for (scene, samples) in [(room(), 64), (varying_sphere(2), 4096)] {
        let stage = Stage::new(scene);
        let field = stage.field(|p, n| 2.0 + p.x - 0.5 * n.y);
        for method in Method::ALL {
            let operator = stage.operator(method, plan(samples, 1));
            let shot = |nodes: &[NodeId]| {
                let part = only(&field, nodes);
                measure(&*operator.transport, Source::Shot(&part, nodes), 0).field
            };
            let nodes = all_nodes(&field);
            let whole = shot(&nodes);
            let part = |k: u32| shot(&nodes.iter().copied().filter(|n| n.0 % 3 == k).collect::<Vec<_>>());
            let sum = Field::sum(field.node_count(), &[part(0), part(1), part(2)]);
            let off = difference(&sum, &whole);
            assert!(off < ROUNDING, "{method}: {off:e}");
            if method.traced() != method {
                let bounce = measure(&*operator.transport, Source::Field(&field), 0).field;
                let off = difference(&whole, &bounce);
                assert!(off < ROUNDING, "{method}: {off:e}");
            }
            if samples > 64 {
                // More samples than one pattern has: once is enough.
                break;
            }
        }
    }
}

#[test]
fn nodes_that_are_not_measured_get_nothing_from_a_shot() {
    let stage = Stage::new(room());
    let field = stage.field(|_, _| 1.0);
    let nodes = all_nodes(&field);
    for method in Method::AT_VERTICES {
        let operator = stage.operator(method, plan(16, 1));
        let active: Vec<bool> = (0..field.node_count()).map(|node| node % 2 == 0).collect();
        let job = lumel_transport::Job {
            source: Source::Shot(&field, &nodes),
            bounce: 1,
            pass: 0,
            active: Some(&active),
        };
        let control = lumel_transport::Control::default();
        let measured = lumel_transport::accumulate(&*operator.transport, &job, &control, None).unwrap();
        assert_eq!(measured.known, active, "{method}");
    }
}

#[test]
fn connected_points_bring_what_a_bounce_brings() {
    let stage = Stage::new(room());
    let field = stage.field(|p, n| 2.0 + p.x - 0.5 * n.y);
    let nodes = all_nodes(&field);
    for method in [Method::VERTEX.traced(), Method::AREA.traced()] {
        let shot = |samples: u32, seed: u64| {
            let operator = stage.operator(method, plan(samples, seed));
            measure(&*operator.transport, Source::Shot(&field, &nodes), 0).field
        };
        // Rays of a bounce, many of them.
        let bounce =
            replicates(&*stage.operator(method, plan(1 << 12, 99)).transport, Source::Field(&field), 2);
        let exact: Vec<f64> = (0..field.node_count())
            .map(|node| bounce.iter().map(|field| f64::from(field.values()[node].x)).sum::<f64>() / 2.0)
            .collect();
        let shots: Vec<Field> = (0..16).map(|seed| shot(64, seed)).collect();
        assert_nodes_near(&shots, &exact, 0.01, method);
        // The difference falls as that of random samples does, or faster.
        let error = |samples: u32| {
            let off = |seed: u64| {
                let found = shot(samples, seed);
                rms(found.values().iter().zip(&exact).map(|(value, exact)| f64::from(value.x) - exact))
            };
            (f64::from(samples), (0..4).map(off).sum::<f64>() / 4.0)
        };
        let errors = [16, 64, 256, 1024].map(error);
        println!("{method}: {errors:?}");
        let slope = fitted_slope(&errors);
        assert!(slope < -0.45, "{method}: {slope}, {errors:?}");
    }
}

#[test]
fn in_built_in_scenes_connections_and_rays_differ_by_their_noise_alone() {
    for name in ["cornell-box", "atrium"] {
        let stage = Stage::new(lumel_builtin::scene(name, 0).expect("it is built in"));
        let field = stage.field(|p, n| 2.0 + (3.0 * p.x).sin() - 0.5 * n.y);
        let nodes: Vec<NodeId> = all_nodes(&field).into_iter().filter(|node| node.0 % 31 == 0).collect();
        let part = only(&field, &nodes);
        let method = Method::VERTEX.traced();
        let shots: Vec<Field> = (0..4)
            .map(|seed| {
                let operator = stage.operator(method, plan(32, seed));
                measure(&*operator.transport, Source::Shot(&part, &nodes), 0).field
            })
            .collect();
        let bounces = replicates(&*stage.operator(method, plan(16, 99)).transport, Source::Field(&part), 4);
        let estimate = |fields: &[Field], node| Estimate::of_node(fields, node);
        let (mut squares, mut variances, mut sums) = (0.0, 0.0, [0.0; 2]);
        for node in 0..field.node_count() {
            let [a, b] = [estimate(&shots, node), estimate(&bounces, node)];
            squares += (a.mean - b.mean).powi(2);
            variances += a.error.powi(2) + b.error.powi(2);
            sums[0] += a.mean;
            sums[1] += b.mean;
        }
        let (ratio, off) = (squares / variances, sums[0] / sums[1] - 1.0);
        // Neighbours have samples of their own, so that the sums over all nodes know the mean light well.
        let error = variances.sqrt() / sums[1];
        println!("{name}: {ratio:.3} of the variance, means {off:+.5} apart, standard error {error:.5}");
        assert!((0.8..1.2).contains(&ratio), "{name}: {ratio}");
        assert!(off.abs() < 4.0 * error, "{name}: {off} with a standard error of {error}");
    }
}
