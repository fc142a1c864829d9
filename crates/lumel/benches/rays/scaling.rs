//! How much more threads help.

use crate::race::median;
use cpu_time::ProcessTime;
use lumel::{Baker, BounceLimit, Bvh, Control, RayTracer, Scene, Settings, Silent, SolveState};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;

/// Hemisphere rays of a vertex.
const SAMPLES: u32 = 256;

/// Measures a solve of 4 bounces with 1, 2, 4 … threads; building the tree is not part of it.
///
/// Efficiency is about the time that passes, so nothing else may run on the machine; the processor time shows what
/// threads cost each other even then.
pub(crate) fn measure(scene: &Arc<Scene>, rounds: usize) -> Value {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counts: Vec<usize> = (0..).map(|k| 1 << k).take_while(|n| *n < cores).collect();
    counts.push(cores);
    let settings =
        Settings { bounces: BounceLimit::Count(4), indirect_samples: SAMPLES, ..Settings::default() };
    let tracer: Arc<dyn RayTracer> = Arc::new(Bvh::build(scene));
    let mut seconds = vec![Vec::new(); counts.len()];
    for _ in 0..rounds {
        for (n, seconds) in counts.iter().zip(&mut seconds) {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(*n).build().expect("threads can be started");
            // A baker keeps the rays of its first solve.
            let baker = Baker::with_tracer(Arc::clone(scene), Arc::clone(&tracer), settings.clone());
            let (start, cpu) = (Instant::now(), ProcessTime::now());
            pool.install(|| baker.run(&mut SolveState::new(), &Control::default(), &Silent))
                .expect("nothing cancels it");
            seconds.push([start.elapsed(), cpu.elapsed()].map(|time| time.as_secs_f64()));
        }
    }
    println!("\n  {:<44}       s efficiency   cpu s", format!("solve, 4 bounces, {SAMPLES} rays, threads"));
    let one = seconds[0].clone();
    let row = |(n, seconds): (usize, Vec<[f64; 2]>)| {
        let of = |(one, mine): (&[f64; 2], &[f64; 2])| one[0] / mine[0] / n as f64;
        let efficiency = median(one.iter().zip(&seconds).map(of).collect());
        let [wall, cpu] = [0, 1].map(|i| median(seconds.iter().map(|s| s[i]).collect()));
        println!("    {n:<42} {wall:>7.2} {efficiency:>10.2} {cpu:>7.2}");
        json!({"threads": n, "seconds": wall, "efficiency": efficiency, "cpu_seconds": cpu})
    };
    counts.into_iter().zip(seconds).map(row).collect()
}
