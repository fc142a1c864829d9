//! Methods against each other on the same rays.

use cpu_time::ThreadTime;
use serde_json::{Value, json};

/// The order of the rays that a method traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// One receiver after the other.
    Receivers,
    /// See [`Rays::transposed`](crate::work::Rays::transposed).
    Transposed,
}

/// Traces all rays of a race and writes the answers, in the order of the rays.
type TraceAll<'a, T> = Box<dyn Fn(&mut [T]) + 'a>;

/// A way to trace all rays of a race.
pub(crate) struct Method<'a, T> {
    name: String,
    order: Order,
    trace: TraceAll<'a, T>,
}

impl<'a, T> Method<'a, T> {
    pub(crate) fn new(name: impl Into<String>, order: Order, trace: impl Fn(&mut [T]) + 'a) -> Self {
        Self { name: name.into(), order, trace: Box::new(trace) }
    }
}

/// How a method did.
pub(crate) struct Row {
    name: String,
    /// Millions of rays per second.
    mrays: f64,
    /// How much faster than the first method: the median over the rounds, the smallest and the largest.
    ratio: [f64; 3],
    /// The share of answers that differ from those of the reference.
    differing: f64,
}

/// Traces with all methods in turn, `rounds` times; times are those of this thread's processor time.
///
/// `differing` tells what share of a method's answers, given in their order, is not that of the reference.
pub(crate) fn race<T: Copy + Default>(
    methods: &[Method<'_, T>],
    n_rays: usize,
    rounds: usize,
    differing: impl Fn(Order, &[T]) -> f64,
) -> Vec<Row> {
    let mut answers = vec![T::default(); n_rays];
    // Also warms up.
    let differing = methods.iter().map(|method| {
        (method.trace)(&mut answers);
        differing(method.order, &answers)
    });
    let differing: Vec<f64> = differing.collect();
    let mut seconds = vec![Vec::new(); methods.len()];
    for _ in 0..rounds {
        for (method, seconds) in methods.iter().zip(&mut seconds) {
            let start = ThreadTime::now();
            (method.trace)(&mut answers);
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    let row = |((method, mine), differing): ((&Method<'_, T>, &Vec<f64>), f64)| {
        let ratios = sorted(seconds[0].iter().zip(mine).map(|(first, mine)| first / mine).collect());
        Row {
            name: method.name.clone(),
            mrays: n_rays as f64 / median(mine.clone()) / 1e6,
            ratio: [median(ratios.clone()), ratios[0], ratios[rounds - 1]],
            differing,
        }
    };
    methods.iter().zip(&seconds).zip(differing).map(row).collect()
}

/// Prints the rows, and by how much the best of ours is ahead of the best of theirs.
pub(crate) fn print(title: &str, rows: &[Row]) {
    println!("\n  {title:<44} Mrays/s   ratio   lowest  highest   differing");
    for Row { name, mrays, ratio: [ratio, low, high], differing } in rows {
        let differing = format!("{:.4} %", differing * 100.0);
        println!("    {name:<42} {mrays:>7.2} {ratio:>7.2} {low:>8.2} {high:>8.2}  {differing:>10}");
    }
    let best = |ours: bool| {
        let of = rows.iter().filter(|row| row.name.starts_with("lumel") == ours);
        of.max_by(|a, b| a.ratio[0].total_cmp(&b.ratio[0]))
    };
    if let (Some(ours), Some(theirs)) = (best(true), best(false)) {
        let lead = ours.ratio[0] / theirs.ratio[0];
        println!("    {} is {lead:.2} times as fast as {}", ours.name, theirs.name);
    }
}

/// The rows as JSON.
pub(crate) fn to_json(rows: &[Row]) -> Value {
    let row = |row: &Row| {
        let [ratio, low, high] = row.ratio;
        json!({
            "method": row.name, "mrays_per_second": row.mrays, "ratio": ratio, "ratio_lowest": low,
            "ratio_highest": high, "differing": row.differing,
        })
    };
    rows.iter().map(row).collect()
}

/// The value in the middle.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    let values = sorted(values);
    values[values.len() / 2]
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}
