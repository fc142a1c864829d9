//! `lumel compare`

use crate::args::CompareArgs;
use crate::console::{self, Console};
use crate::failure::hinted;
use crate::outcome::Outcome;
use crate::report::significant;
use anyhow::Context;
use glam::Vec3;
use lumel::{Difference, LightFile, LightmapSolution, Percentiles};
use serde::Serialize;
use std::fmt::Write;

/// How two files of light differ.
#[derive(Debug, Serialize)]
struct SolutionComparison {
    a: String,
    b: String,
    /// Where light is compared: "vertices" or "lumels".
    places: &'static str,
    /// How many of these there are; under the name that vertices have had from the beginning.
    vertices: usize,
    /// Those that were measured in both.
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
        match [&args.a, &args.b].map(|path| LightmapSolution::is_file(path)) {
            [true, true] => Self::of_lightmaps(args),
            [false, false] => Self::of_vertices(args),
            _ => Err(hinted(
                "one file is light at vertices, the other at lumels",
                "compare two files of the same basis",
            )),
        }
    }

    fn of_lightmaps(args: &CompareArgs) -> anyhow::Result<Self> {
        let (a, b) = (LightmapSolution::load(&args.a)?, LightmapSolution::load(&args.b)?);
        if !a.same_lumels_as(&b) {
            let of = |lightmap: &LightmapSolution| {
                let n_lumels = lightmap.lightmap.atlas.lumel_count();
                format!("scene \"{}\" with {n_lumels} lumels", lightmap.meta.scene)
            };
            let message =
                format!("{} is light on {}, {} on {}", args.a.display(), of(&a), args.b.display(), of(&b));
            return Err(hinted(message, "only light at the same lumels can be compared"));
        }
        let counts: Vec<bool> =
            a.lightmap.valid.iter().zip(&b.lightmap.valid).map(|(a, b)| *a && *b).collect();
        let [of_a, of_b] = [&a, &b].map(LightmapSolution::bounces);
        let [sum_a, sum_b] = [&a, &b].map(|solution| &*solution.lightmap.layers[0].values);
        Self::of(args, "lumels", [sum_a, sum_b], [of_a, of_b], &counts)
    }

    fn of_vertices(args: &CompareArgs) -> anyhow::Result<Self> {
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
        let bounces = [&a, &b].map(|file| file.bounces().iter().map(Vec::as_slice).collect());
        Self::of(args, "vertices", [&a.sum(), &b.sum()], bounces, &counts)
    }

    /// The differences of two sums and their bounces where it counts.
    fn of(
        args: &CompareArgs,
        places: &'static str,
        [a, b]: [&[Vec3]; 2],
        [bounces_a, bounces_b]: [Vec<&[Vec3]>; 2],
        counts: &[bool],
    ) -> anyhow::Result<Self> {
        let bounces = bounces_a.iter().zip(&bounces_b);
        Ok(Self {
            a: args.a.display().to_string(),
            b: args.b.display().to_string(),
            places,
            vertices: counts.len(),
            valid_vertices: counts.iter().filter(|counts| **counts).count(),
            sum: Difference::of(a, b, counts)
                .with_context(|| format!("none of the {places} was measured in both files"))?,
            bounces: bounces.filter_map(|(a, b)| Difference::of(a, b, counts)).collect(),
            bounces_a: bounces_a.len(),
            bounces_b: bounces_b.len(),
        })
    }

    /// What --max-error is about; `None` when B is dark and A is not.
    fn error(&self) -> Option<f64> {
        self.sum.relative_rmse.or((self.sum.rmse == 0.0).then_some(0.0))
    }

    fn text(&self) -> String {
        let mut text = format!(
            "A {}\nB {}\n{} of {} {} were measured in both\n\n",
            self.a, self.b, self.valid_vertices, self.vertices, self.places
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
