//! Trees over a scene: ours for every instruction set, and Embree's.

use crate::embree::{Build, Embree, Tree};
use crate::race::median;
use cpu_time::ProcessTime;
use lumel::{Bvh, Scene};
use lumel_accel::InstructionSet;
use serde_json::{Value, json};

/// All trees over one scene.
pub(crate) struct Trees<'a> {
    /// Ours for each instruction set of the machine, the fastest first.
    pub(crate) lumel: Vec<(InstructionSet, Bvh)>,
    /// Embree's, if it could be loaded.
    pub(crate) embree: Option<EmbreeTrees<'a>>,
}

/// Embree's trees over one scene.
pub(crate) struct EmbreeTrees<'a> {
    /// With the fast triangle test.
    pub(crate) high: Tree<'a>,
    /// With the robust one.
    pub(crate) robust: Tree<'a>,
}

impl<'a> Trees<'a> {
    /// Builds all of them. The portable instructions are for reference only and are left out where there are others.
    pub(crate) fn build(scene: &Scene, embree: Option<&'a Embree>) -> Self {
        let bvh = Bvh::build(scene);
        let mut sets = InstructionSet::available();
        sets.reverse();
        if sets.len() > 1 {
            sets.retain(|set| *set != InstructionSet::Portable);
        }
        let with = |set: InstructionSet| Some((set, bvh.clone().with_instructions(set)?));
        let of_embree = |embree: &'a Embree| EmbreeTrees {
            high: embree.build(scene, Build::High),
            robust: embree.build(scene, Build::Robust),
        };
        Self { lumel: sets.into_iter().filter_map(with).collect(), embree: embree.map(of_embree) }
    }

    /// Ours for the fastest instruction set.
    pub(crate) fn best(&self) -> &Bvh {
        &self.lumel[0].1
    }
}

/// Measures how long building takes on one thread, and how much memory a tree holds.
///
/// Times are those of the whole process, in which nothing else runs.
pub(crate) fn measure(scene: &Scene, embree: Option<&Embree>, rounds: usize) -> Value {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    let mut rows: Vec<(&str, Vec<f64>, f64)> = Vec::new();
    let mut round = |name: &'static str, build: &mut dyn FnMut() -> f64| {
        let start = ProcessTime::now();
        let bytes = build();
        let seconds = start.elapsed().as_secs_f64();
        match rows.iter_mut().find(|row| row.0 == name) {
            Some(row) => row.1.push(seconds),
            None => rows.push((name, vec![seconds], bytes)),
        }
    };
    for _ in 0..rounds {
        if let Some(embree) = embree {
            round("Embree medium", &mut || embree.build(scene, Build::Medium).memory as f64);
            round("Embree high", &mut || embree.build(scene, Build::High).memory as f64);
        }
        round("lumel", &mut || one_thread.install(|| Bvh::build(scene).memory() as f64));
    }
    println!("\n  {:<44}      ms   ratio       MB", "build, one thread");
    let first = rows[0].1.clone();
    let json = rows.into_iter().map(|(name, seconds, bytes)| {
        let ratio = median(first.iter().zip(&seconds).map(|(first, mine)| first / mine).collect());
        let seconds = median(seconds);
        println!("    {name:<42} {:>7.1} {ratio:>7.2} {:>8.1}", seconds * 1e3, bytes / 1e6);
        json!({"method": name, "seconds": seconds, "ratio": ratio, "bytes": bytes})
    });
    json.collect()
}
