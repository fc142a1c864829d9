//! `lumel compare`

use crate::args::CompareArgs;
use crate::console::{self, Console};
use crate::failure::hinted;
use crate::outcome::Outcome;
use crate::report::significant;
use anyhow::Context;
use lumel::{Difference, LightFile, Percentiles};
use serde::Serialize;
use std::fmt::Write;

/// How two files of light differ.
#[derive(Debug, Serialize)]
struct SolutionComparison {
    a: String,
    b: String,
    vertices: usize,
    /// Vertices that were measured in both.
    valid_vertices: usize,
    sum: Difference,
    /// Bounces that both have.
    bounces: Vec<Difference>,
    bounces_a: usize,
    bounces_b: usize,
}

/// Compares.
pub(crate) fn run(args: &CompareArgs, console: &Console) -> anyhow::Result<Outcome> {
    let comparison = SolutionComparison::new(args)?;
    console::print(&if args.json { serde_json::to_string(&comparison)? + "\n" } else { comparison.text() })?;
    let Some(limit) = args.max_error else { return Ok(Outcome::Done) };
    match comparison.error() {
        Some(error) if error <= limit => Ok(Outcome::Done),
        error => {
            let error = error.map_or_else(|| "infinite".to_owned(), significant);
            console.note(&format!("the relative RMSE of the sum is {error}, above the limit {limit}"));
            Ok(Outcome::Objected)
        }
    }
}

impl SolutionComparison {
    fn new(args: &CompareArgs) -> anyhow::Result<Self> {
        let (a, b) = (LightFile::read(&args.a)?, LightFile::read(&args.b)?);
        if !a.same_vertices_as(&b) {
            let message = format!(
                "{} is light on {}, {} on {}",
                args.a.display(),
                a.scene_label(),
                args.b.display(),
                b.scene_label()
            );
            return Err(hinted(message, "only light on the same vertices can be compared"));
        }
        let counts: Vec<bool> = (0..a.vertex_count()).map(|v| a.is_valid(v) && b.is_valid(v)).collect();
        let none = "no vertex was measured in both files";
        let bounces = a.bounces().iter().zip(b.bounces());
        Ok(Self {
            a: args.a.display().to_string(),
            b: args.b.display().to_string(),
            vertices: counts.len(),
            valid_vertices: counts.iter().filter(|counts| **counts).count(),
            sum: Difference::of(&a.sum(), &b.sum(), &counts).context(none)?,
            bounces: bounces.filter_map(|(a, b)| Difference::of(a, b, &counts)).collect(),
            bounces_a: a.bounces().len(),
            bounces_b: b.bounces().len(),
        })
    }

    /// What --max-error is about; `None` when B is dark and A is not.
    fn error(&self) -> Option<f64> {
        self.sum.relative_rmse.or((self.sum.rmse == 0.0).then_some(0.0))
    }

    fn text(&self) -> String {
        let mut text = format!(
            "A {}\nB {}\n{} of {} vertices were measured in both\n\n",
            self.a, self.b, self.valid_vertices, self.vertices
        );
        let percents = Percentiles::PERCENTS.map(|p| format!("{:>9}", format!("{p} %"))).concat();
        text += &format!(
            "{:9} {:>10} {:>10} {:>9} {:>9} {percents}\n",
            "", "RMSE", "relative", "ratio", "correl."
        );
        for (k, bounce) in self.bounces.iter().enumerate() {
            let name = if k == 0 { "direct".to_owned() } else { format!("bounce {k}") };
            text += &row(&name, bounce);
        }
        text += &row("sum", &self.sum);
        for (name, [r, g, b]) in [("A", self.sum.mean_a), ("B", self.sum.mean_b)] {
            let [r, g, b] = [r, g, b].map(significant);
            // Writing to a string cannot fail.
            let _ = write!(text, "\nmean of {name} {r} {g} {b} W/m²");
        }
        text.push('\n');
        let (n, m) = (self.bounces_a, self.bounces_b);
        if n != m {
            text +=
                &format!("A has {} and B has {} of the bounces, direct light included\n", count(n), count(m));
        }
        text
    }
}

fn count(bounces: usize) -> String {
    if bounces == 0 { "none".to_owned() } else { bounces.to_string() }
}

fn row(name: &str, difference: &Difference) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"));
    let percentiles = difference.percentiles.map_or([None; 4], |p| p.to_array().map(Some));
    format!(
        "{name:9} {:>10} {:>10} {:>9} {:>9} {}\n",
        significant(difference.rmse),
        number(difference.relative_rmse),
        number(difference.mean_ratio),
        number(difference.correlation),
        percentiles.map(|p| format!("{:>9}", number(p))).concat()
    )
}
