//! Samples in portions, and measuring some nodes only.

use glam::Vec3;
use lumel_basis::{AreaVertexBasis, Basis, Field, NodeId, VertexBasis};
use lumel_scene::{Light, Scene};
use lumel_testkit::measure;
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_transport::{CachedTransport, CpuTransport, LightSampling, Plan, Source};
use std::sync::Arc;

/// A room with a lamp, and light on its walls that is not the same anywhere.
fn room() -> (Arc<Scene>, VertexBasis, Field) {
    let walls = cuboid(Vec3::ZERO, Vec3::ONE, 5, Facing::Inward, [0; 6]);
    let light = Light::Rect(ceiling_light(Vec3::new(0.4, 0.5, 0.9), 0.3, 0.2, 1.0));
    let (scene, _) = scene(walls, vec![grey(0.5, 0.0)], vec![light]).build().expect("the room builds");
    let scene = Arc::new(scene);
    let basis = VertexBasis::new(Arc::clone(&scene));
    let mut values = vec![Vec3::ZERO; scene.vertex_count()];
    for (&NodeId(node), position) in basis.node_of_vertex().iter().zip(scene.positions()) {
        values[node as usize] = *position;
    }
    (scene, basis, Field::from_values(values))
}

fn transport<B: Basis>(scene: &Arc<Scene>, basis: B, plan: Plan) -> CpuTransport<B> {
    let (tracer, basis) = (Arc::new(lumel_testkit::tracer(scene)), Arc::new(basis));
    CpuTransport::new(Arc::clone(scene), tracer, Arc::clone(&basis), basis, plan)
}

const PLAN: Plan = Plan {
    sampler: lumel_sample::SamplerKind::Sobol,
    direct_samples: 16,
    indirect_samples: 16,
    seed: 5,
    // Points on lights that all count: the closed form would have a pilot in each half.
    light_sampling: LightSampling::Area,
    emitters: lumel_transport::EmitterSampling::Auto,
    second_half: false,
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
    let (scene, basis, field) = room();
    let all = vec![true; field.len()];
    let whole = Plan { direct_samples: 32, indirect_samples: 32, ..PLAN };
    let plain = transport(&scene, basis.clone(), PLAN);
    let cached = CachedTransport::new(transport(&scene, basis, PLAN), None);
    let second = Plan { second_half: true, ..PLAN };
    for source in [Source::Emitters, Source::Field(&field)] {
        let halves = [PLAN, second].map(|plan| measure(&plain.with_samples(plan, &all), source, 0).field);
        let stored = [PLAN, second].map(|plan| measure(&cached.with_samples(plan, &all), source, 0).field);
        // Stored rays are those of bounce 1, whatever the bounce.
        let expected = measure(&plain.with_samples(whole, &all), source, 0).field;
        let of_stored = measure(&cached.with_samples(whole, &all), source, 0).field;
        for (halves, whole) in [(halves, expected), (stored, of_stored)] {
            assert!(halves[0] != halves[1], "they are not two halves");
            let sum = Field::sum(whole.len(), &halves);
            let mean = Field::from_values(sum.values().iter().map(|&v| 0.5 * v).collect());
            assert_same(&mean, &whole);
        }
    }
}

#[test]
fn some_nodes_are_measured_as_they_are_among_all() {
    fn check<B: Basis + Clone>(scene: &Arc<Scene>, basis: B, field: &Field, n_elements: usize) {
        let some: Vec<bool> = (0..field.len()).map(|node| node % 17 == 3).collect();
        let plain = transport(scene, basis, PLAN);
        for source in [Source::Emitters, Source::Field(field)] {
            let all = measure(&plain, source, 0);
            let part = measure(&plain.with_samples(PLAN, &some), source, 0);
            let wanted = || (0..field.len()).filter(|&node| some[node]);
            assert!(wanted().all(|node| part.known[node]));
            assert!(part.known.contains(&false), "all were measured");
            for node in wanted() {
                assert_same(
                    &Field::from_values(vec![part.field.values()[node]]),
                    &Field::from_values(vec![all.field.values()[node]]),
                );
            }
        }
        let cached = CachedTransport::new(plain.with_samples(PLAN, &vec![true; field.len()]), None);
        assert!(cached.elements_towards(&some) < n_elements / 2);
        assert_eq!(cached.elements_towards(&vec![true; field.len()]), n_elements);
        assert_eq!(cached.elements_towards(&vec![false; field.len()]), 0);
    }
    let (scene, basis, field) = room();
    check(&scene, basis.clone(), &field, field.len());
    check(&scene, AreaVertexBasis::new(basis), &field, scene.triangle_count());
}
