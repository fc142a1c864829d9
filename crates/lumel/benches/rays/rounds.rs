//! Timing several methods in turns.

use cpu_time::ThreadTime;
use serde_json::{Value, json};
use std::hint::black_box;

/// Seconds of this thread's processor time.
pub(crate) fn thread_seconds(work: impl FnOnce()) -> f64 {
    let start = ThreadTime::now();
    work();
    black_box(());
    start.elapsed().as_secs_f64()
}

pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The seconds of each method, round by round. The first method is what the others are compared with.
pub(crate) struct Rounds {
    title: String,
    n_rays: usize,
    methods: Vec<(String, Vec<f64>)>,
}

impl Rounds {
    pub(crate) fn new(title: &str, n_rays: usize) -> Self {
        Self { title: title.to_owned(), n_rays, methods: Vec::new() }
    }

    /// Times a method once more.
    pub(crate) fn time(&mut self, name: &str, work: impl FnOnce()) {
        let seconds = thread_seconds(work);
        match self.methods.iter_mut().find(|(known, _)| known == name) {
            Some((_, times)) => times.push(seconds),
            None => self.methods.push((name.to_owned(), vec![seconds])),
        }
    }

    /// Prints the table, fastest packet mode of Embree included, and returns it.
    pub(crate) fn print(mut self) -> Value {
        println!("  {}", self.title);
        let rate = |seconds: f64| self.n_rays as f64 / seconds / 1e6;
        let medians: Vec<(String, f64)> =
            self.methods.iter_mut().map(|(name, times)| (name.clone(), median(times))).collect();
        let single = medians[0].1;
        let packets = medians.iter().filter(|(name, _)| name.starts_with("Embree 16"));
        let best = packets.map(|(_, seconds)| *seconds).fold(single, f64::min);
        println!("    {:32} {:>8} {:>12} {:>14}", "", "Mrays/s", "to the first", "to Embree's best");
        let mut rows = Vec::new();
        for (name, seconds) in &medians {
            let (to_single, to_best) = (single / seconds, best / seconds);
            println!("    {name:32} {:>8.2} {to_single:>12.2} {to_best:>14.2}", rate(*seconds));
            rows.push(json!({
                "method": name, "mrays_per_second": rate(*seconds), "to_first": to_single, "to_best": to_best,
            }));
        }
        json!({"title": self.title, "rays": self.n_rays, "methods": rows})
    }
}
