//! The bits of bakes, recorded: a change that is to leave results alone leaves these hashes alone.
//!
//! The table is for Linux on x86-64 with the C library's mathematics; the same bits are promised for any number of
//! threads and any instruction set of a machine, not across C libraries. Where results are meant to change, print the
//! new table with `LUMEL_TEST_RECORD=1 cargo test -p lumel --test bits -- --nocapture` and say in CHANGELOG.md which
//! bits changed and why.

#![cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Control, Memory, Method, Projection, SamplerKind, Settings, Share, Silent, Solution,
    SolveState, SolverKind, Tail, TargetError,
};
use std::fmt::Write as _;
use std::sync::Arc;

const SCENES: [&str; 4] = ["cornell-box", "atrium", "sphere", "furnace"];
const PROJECTIONS: [Projection; 2] = [Projection::Point, Projection::Area];

/// Few samples: what is checked is the arithmetic, not the light.
fn settings() -> Settings {
    Settings {
        bounces: BounceLimit::Count(2),
        tail: Tail::Geometric,
        direct_samples: 4,
        indirect_samples: 16,
        seed: 7,
        ..Settings::default()
    }
}

/// Memory for rays that is too small for all of them, so that a final gather follows.
fn memory_for_a_final_gather(scene: &lumel::Scene) -> Memory {
    // Triangles are about twice as many as vertices: 64 rays per vertex take 256 bytes per triangle or more, 16 take
    // 112 bytes or somewhat more.
    Memory(200 * scene.triangle_count() as u64)
}

/// All variants of a bake in a scene, by name.
fn variants(scene: &lumel::Scene) -> Vec<(String, Settings)> {
    let mut variants = Vec::new();
    for projection in PROJECTIONS {
        let base = Settings { projection, ..settings() };
        for sampler in SamplerKind::ALL {
            for solver in [SolverKind::Cached, SolverKind::Neumann] {
                let settings = Settings { sampler, solver, ..base.clone() };
                variants.push((format!("{projection:?} {sampler} {solver:?}"), settings));
            }
        }
        let memory = memory_for_a_final_gather(scene);
        let gather = Settings { memory, indirect_samples: 64, ..base.clone() };
        variants.push((format!("{projection:?} final gather"), gather));
        let target_error = TargetError::At(Share::new(0.4).unwrap());
        let target = Settings { target_error, indirect_samples: 128, ..base };
        variants.push((format!("{projection:?} target error"), target));
    }
    variants
}

fn hash(solution: &Solution) -> String {
    let mut hasher = Hasher::default();
    hasher.vectors(&solution.irradiance);
    solution.bounces.iter().for_each(|bounce| hasher.vectors(bounce));
    solution.tail.iter().for_each(|tail| hasher.vectors(tail));
    solution.standard_error.iter().for_each(|error| hasher.vectors(error));
    solution.valid.iter().for_each(|&valid| hasher.add(valid.into()));
    hasher.finish()
}

/// FNV-1a with 64 bits, after Fowler, Noll and Vo, on words.
struct Hasher(u64);

impl Default for Hasher {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher {
    fn add(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn vectors(&mut self, vectors: &[Vec3]) {
        self.add(vectors.len() as u32);
        vectors.iter().flat_map(|v| v.to_array()).for_each(|x| self.add(x.to_bits()));
    }

    fn finish(self) -> String {
        format!("{:016x}", self.0)
    }
}

fn scene(name: &str) -> Arc<lumel::Scene> {
    let opened = lumel::open(name, &lumel::OpenOptions::default()).unwrap();
    Arc::new(opened.builder.build().unwrap().0)
}

fn baked(baker: &Baker, mut state: SolveState) -> Solution {
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    baker.solution(&state)
}

#[test]
fn bakes_have_the_recorded_bits() {
    let (mut found, recorded) = (String::new(), include_str!("bits.txt"));
    for name in SCENES {
        let scene = scene(name);
        let mut first: Option<Baker> = None;
        for (variant, settings) in variants(&scene) {
            let baker = match &first {
                Some(first) => first.relit(Arc::clone(&scene), settings),
                None => Baker::new(Arc::clone(&scene), settings),
            };
            let solution = baked(&baker, SolveState::new());
            let gathers = matches!(baker.method(), Method::FinalGather { .. });
            assert_eq!(gathers, variant.ends_with("final gather"), "{name} {variant}: {}", baker.method());
            writeln!(found, "{} {name} {variant}", hash(&solution)).unwrap();
            first.get_or_insert(baker);
        }
    }
    if std::env::var_os("LUMEL_TEST_RECORD").is_some() {
        return print!("{found}");
    }
    let differing: Vec<&str> =
        found.lines().filter(|line| !recorded.lines().any(|old| old == *line)).collect();
    assert!(differing.is_empty(), "bits differ:\n{}", differing.join("\n"));
    assert_eq!(found.lines().count(), recorded.lines().count());
}

#[test]
fn a_bake_that_is_stopped_and_resumed_has_the_recorded_bits() {
    for name in ["cornell-box", "sphere"] {
        let scene = scene(name);
        for projection in PROJECTIONS {
            for solver in [SolverKind::Cached, SolverKind::Neumann] {
                let whole = Settings { projection, solver, ..settings() };
                let part = Settings { bounces: BounceLimit::Count(1), ..whole.clone() };
                let part = baked(&Baker::new(Arc::clone(&scene), part), SolveState::new());
                let baker = Baker::new(Arc::clone(&scene), whole);
                let resumed = hash(&baked(&baker, baker.resume_solution(&part).unwrap()));
                let variant =
                    format!("{resumed} {name} {projection:?} {} {solver:?}", SamplerKind::default());
                assert!(
                    include_str!("bits.txt").lines().any(|line| line == variant),
                    "not recorded: {variant}"
                );
            }
        }
    }
}
