//! Same seed and settings: same bits, however the work was done.

use crate::{go_on, solved_by};
use glam::Vec3;
use lumel_sample::SamplerKind;
use lumel_scene::{Light, SceneBuilder};
use lumel_solve::{SolveState, Stop};
use lumel_testkit::mesh::{Facing, cuboid};
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_testkit::{Method, Operator, Stage};
use lumel_transport::Plan;

/// A room with a light and a box that stands over vertices of the floor, so that some are hidden.
pub(crate) fn furnished() -> SceneBuilder {
    let mut objects = cuboid(Vec3::ZERO, Vec3::ONE, 6, Facing::Inward, [0; 6]);
    let (min, max) = (Vec3::new(0.25, 0.3, -0.1), Vec3::new(0.6, 0.7, 0.4));
    objects.extend(cuboid(min, max, 2, Facing::Outward, [0; 6]));
    let light = Light::Rect(ceiling_light(Vec3::new(0.5, 0.5, 0.95), 0.4, 0.4, 5.0));
    scene(objects, vec![grey(0.6, 0.0)], vec![light])
}

fn operator(stage: &Stage, method: Method, sampler: SamplerKind) -> Operator {
    stage.operator(method, Plan { sampler, direct_samples: 16, indirect_samples: 32, ..Plan::default() })
}

fn with_threads<T: Send>(n: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start").install(work)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        for sampler in SamplerKind::ALL {
            let operator = operator(&stage, method, sampler);
            let run = |n| with_threads(n, || solved_by(&operator, &stage, Stop::Bounces(3)));
            let one = run(1);
            if method == Method::VERTEX {
                assert!(one.valid.contains(&false), "some vertices are hidden");
            }
            for n in [2, 7] {
                assert!(run(n) == one, "{method}, {sampler}: {n} threads");
            }
        }
    }
}

#[test]
fn a_solve_resumed_after_any_bounce_has_the_same_bits() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        let operator = operator(&stage, method, SamplerKind::Sobol);
        let whole = solved_by(&operator, &stage, Stop::Bounces(4));
        for stopped in 0..4 {
            let mut state: SolveState = solved_by(&operator, &stage, Stop::Bounces(stopped)).clone();
            assert_eq!(state.bounces.len(), stopped as usize + 1);
            go_on(&operator, &stage, Stop::Bounces(4), &mut state);
            assert!(state == whole, "{method}, resumed after bounce {stopped}");
        }
    }
}

#[test]
fn another_seed_gives_other_bits() {
    let stage = Stage::new(furnished());
    for method in Method::ALL {
        let run = |seed| {
            let operator = stage.operator(method, Plan { seed, indirect_samples: 8, ..Plan::default() });
            solved_by(&operator, &stage, Stop::Bounces(1)).total()
        };
        assert!(run(1) != run(2) && run(1) == run(1), "{method}");
    }
}
