//! Samples in portions, and measuring some nodes only.

use glam::Vec3;
use lumel_basis::{AreaReceivers, Field, PointReceivers, Receivers, VertexBasis};
use lumel_scene::{Light, Scene};
use lumel_testkit::measure;
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_transport::{CachedTransport, CpuTransport, LightSampling, Plan, Source};
use std::sync::Arc;

/// A room with a lamp, and light on its walls that is not the same anywhere.
fn room() -> (Arc<Scene>, Arc<VertexBasis>, Field) {
    let walls = cuboid(Vec3::ZERO, Vec3::ONE, 5, Facing::Inward, [0; 6]);
    let light = Light::Rect(ceiling_light(Vec3::new(0.4, 0.5, 0.9), 0.3, 0.2, 1.0));
    let (scene, _) = scene(walls, vec![grey(0.5, 0.0)], vec![light]).build().expect("the room builds");
    let scene = Arc::new(scene);
    let basis = Arc::new(VertexBasis::new(Arc::clone(&scene)));
    let positions = basis.first_vertices().iter().map(|&v| scene.positions()[v as usize]);
    let field = Field::from_values(positions.collect());
    (scene, basis, field)
}

fn transport<R: Receivers + 'static>(
    basis: &Arc<VertexBasis>,
    receivers: R,
    plan: Plan,
) -> CpuTransport<VertexBasis, R> {
    let scene = Arc::clone(basis.scene());
    let tracer = lumel_testkit::tracer(&scene);
    CpuTransport::new(scene, tracer, Arc::clone(basis), Arc::new(receivers), plan)
}

const PLAN: Plan = Plan {
    sampler: lumel_sample::SamplerKind::Sobol,
    direct_samples: 16,
    indirect_samples: 16,
    seed: 5,
    // Points on lights that all count: the closed form would have a pilot in each half.
    light_sampling: LightSampling::Area,
    emitters: lumel_transport::EmitterSampling::Auto,
    portion: 0,
};

/// Fails unless `a` is `b`, which differ by the order of sums and the rounding of where stored rays end.
#[track_caller]
fn assert_same(a: &Field, b: &Field) {
    for (a, b) in a.values().iter().zip(b.values()) {
        assert!((*a - *b).abs().max_element() < 1e-5, "{a} is not {b}");
    }
}

#[test]
fn two_halves_of_the_samples_are_the_whole() {
    let (_, basis, field) = room();
    let all = vec![true; field.node_count()];
    let whole = Plan { direct_samples: 32, indirect_samples: 32, ..PLAN };
    let at_vertices = || transport(&basis, PointReceivers::at_vertices(&basis), PLAN);
    let plain = at_vertices();
    let cached = CachedTransport::new(at_vertices(), None);
    let second = Plan { portion: 1, ..PLAN };
    for source in [Source::Emitters(None), Source::Field(&field)] {
        let halves = [PLAN, second].map(|plan| measure(&plain.with_samples(plan, &all), source, 0).field);
        let stored = [PLAN, second].map(|plan| measure(&cached.with_samples(plan, &all), source, 0).field);
        // Stored rays are those of bounce 1, whatever the bounce.
        let expected = measure(&plain.with_samples(whole, &all), source, 0).field;
        let of_stored = measure(&cached.with_samples(whole, &all), source, 0).field;
        for (halves, whole) in [(halves, expected), (stored, of_stored)] {
            assert!(halves[0] != halves[1], "they are not two halves");
            let sum = Field::sum(whole.node_count(), &halves);
            let mean = Field::from_values(sum.values().iter().map(|&v| 0.5 * v).collect());
            assert_same(&mean, &whole);
        }
    }
}

#[test]
fn some_nodes_are_measured_as_they_are_among_all() {
    fn check<R: Receivers + 'static>(basis: &Arc<VertexBasis>, receivers: R, field: &Field) {
        let n_elements = receivers.element_count();
        let some: Vec<bool> = (0..field.node_count()).map(|node| node % 17 == 3).collect();
        let plain = transport(basis, receivers, PLAN);
        for source in [Source::Emitters(None), Source::Field(field)] {
            let all = measure(&plain, source, 0);
            let part = measure(&plain.with_samples(PLAN, &some), source, 0);
            let wanted = || (0..field.node_count()).filter(|&node| some[node]);
            assert!(wanted().all(|node| part.known[node]));
            assert!(part.known.contains(&false), "all were measured");
            for node in wanted() {
                assert_same(
                    &Field::from_values(vec![part.field.values()[node]]),
                    &Field::from_values(vec![all.field.values()[node]]),
                );
            }
        }
        let cached = CachedTransport::new(plain.with_samples(PLAN, &vec![true; field.node_count()]), None);
        assert!(cached.elements_towards(&some) < n_elements / 2);
        assert_eq!(cached.elements_towards(&vec![true; field.node_count()]), n_elements);
        assert_eq!(cached.elements_towards(&vec![false; field.node_count()]), 0);
    }
    let (_, basis, field) = room();
    check(&basis, PointReceivers::at_vertices(&basis), &field);
    check(&basis, AreaReceivers::new(basis.clone()), &field);
}
