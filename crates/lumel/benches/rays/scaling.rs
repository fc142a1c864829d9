//! How much more threads help.

use crate::race::median;
use lumel::{Baker, BounceLimit, Control, Scene, Settings, Silent, SolveState};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;

/// Hemisphere rays of a vertex.
const SAMPLES: u32 = 256;

/// Measures a solve of 4 bounces with 1, 2, 4 … threads; building the tree is not part of it.
///
/// Time passes for all, so nothing else may run on the machine.
pub(crate) fn measure(scene: &Arc<Scene>, rounds: usize) -> Value {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counts: Vec<usize> = (0..).map(|k| 1 << k).take_while(|n| *n < cores).collect();
    counts.push(cores);
    let settings =
        Settings { bounces: BounceLimit::Count(4), indirect_samples: SAMPLES, ..Settings::default() };
    let baker = Baker::new(Arc::clone(scene), settings);
    let mut seconds = vec![Vec::new(); counts.len()];
    for _ in 0..rounds {
        for (n, seconds) in counts.iter().zip(&mut seconds) {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(*n).build().expect("threads can be started");
            let start = Instant::now();
            pool.install(|| baker.run(&mut SolveState::new(), &Control::default(), &Silent))
                .expect("nothing cancels it");
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    println!("\n  {:<44}       s efficiency", format!("solve, 4 bounces, {SAMPLES} rays, threads"));
    let one = seconds[0].clone();
    let row = |(n, seconds): (usize, Vec<f64>)| {
        let of = |(one, mine): (&f64, &f64)| one / mine / n as f64;
        let efficiency = median(one.iter().zip(&seconds).map(of).collect());
        let seconds = median(seconds);
        println!("    {n:<42} {seconds:>7.2} {efficiency:>10.2}");
        json!({"threads": n, "seconds": seconds, "efficiency": efficiency})
    };
    counts.into_iter().zip(seconds).map(row).collect()
}
