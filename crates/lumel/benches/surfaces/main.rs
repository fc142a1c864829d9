//! Which projection is closest to the truth over all surfaces, and at what price: `cargo x bench surfaces`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

mod paths;
mod place;
mod rows;
mod scenes;
mod solves;

use lumel::{BounceLimit, Preset, Projection, Settings};
use lumel_basis::Field;
use lumel_testkit::Reference;
use lumel_transport::Plan;
use paths::{BOUNCES, Paths};
use place::Place;
use rows::Row;
use scenes::{CASES, Case};
use serde_json::{Value, json};
use solves::{Solved, Way};

const HELP: &str = "\
usage: cargo x bench surfaces [--quick] [--draft] [--times] [--rounds N] [--json FILE] [SCENE]...

Solves each scene with each projection at equal samples, four bounces, and compares the light over all surfaces.

  time          median of runs in alternation, with the time to read light at the vertices; the ratio is that of
                processor time, the median over the rounds
  power         of direct light as it is stored, of bounces 1 to 4 as a fresh gather reads them from what is carried
                (and as they are stored, in JSON), and of all light as it is stored; each over that of exact transport
                along paths from random points, with standard errors of the ratio from the same paths
  error         of direct and of all light at random points, against many samples there: root mean square and what 95 %
                and 99 % stay below, relative to the root mean square of the light, and the relative difference of means
  negative      power of the negative part of direct light as it is stored, over that of direct light

Scenes: coarse-box, cornell-box, atrium, sponza-2m, sponza-0.5m, bathroom; those that are not built in are read from
LUMEL_TEST_SHARED.

  --quick       few paths, points and samples, one run
  --draft       samples of the preset draft instead of medium
  --times       only times, of the three projections
  --rounds N    runs of each projection, 3 unless given
  --json FILE   write the results as JSON too
";

/// How much is measured.
struct Effort {
    preset: Preset,
    /// Runs of each projection.
    rounds: usize,
    paths: u32,
    /// Points of the reference, and light samples and rays of each of its passes.
    points: u32,
    samples: u32,
}

const FULL: Effort =
    Effort { preset: Preset::Medium, rounds: 3, paths: 1 << 20, points: 20_000, samples: 256 };
const QUICK: Effort = Effort { preset: Preset::Draft, rounds: 1, paths: 1 << 17, points: 2000, samples: 128 };

/// What is measured in each scene.
struct Bench {
    settings: Settings,
    effort: Effort,
}

/// Independent measurements of the reference.
const PASSES: u32 = 4;

fn main() {
    // Cargo adds --bench.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut quick, mut times, mut preset, mut rounds, mut json_file) = (false, false, None, None, None);
    let mut names = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => quick = true,
            "--times" => times = true,
            "--draft" => preset = Some(Preset::Draft),
            "--rounds" => {
                let number = arguments.next().and_then(|n| n.parse().ok()).filter(|n| *n > 0);
                rounds = Some(number.expect("--rounds needs a number"));
            }
            "--json" => json_file = Some(arguments.next().expect("--json needs a file")),
            name if CASES.iter().any(|case| case.name == name) => names.push(argument),
            _ => return println!("{HELP}"),
        }
    }
    let effort = if quick { QUICK } else { FULL };
    let preset = preset.unwrap_or(effort.preset);
    let bench = Bench {
        settings: Settings { bounces: BounceLimit::Count(BOUNCES as u32), ..preset.settings() },
        effort: Effort { rounds: rounds.unwrap_or(effort.rounds), ..effort },
    };
    let threads = rayon::current_num_threads();
    println!("lumel {} on {threads} threads", env!("CARGO_PKG_VERSION"));
    let wanted = |case: &&Case| names.is_empty() || names.iter().any(|name| name == case.name);
    let measured = |case| if times { bench.time(case) } else { bench.measure(case) };
    let results: Vec<Value> = CASES.iter().filter(wanted).filter_map(measured).collect();
    if let Some(file) = json_file {
        let all = json!({"version": env!("CARGO_PKG_VERSION"), "threads": threads, "scenes": results});
        std::fs::write(file, serde_json::to_string_pretty(&all).unwrap()).unwrap();
    }
}

impl Bench {
    /// Opens a scene and announces it.
    fn open(&self, case: &Case) -> Option<Place> {
        let place = case.open().map_err(|reason| println!("\n{}: {reason}", case.name)).ok()?;
        let (vertices, triangles) = (place.scene.vertex_count(), place.scene.triangle_count());
        let Settings { direct_samples, indirect_samples, .. } = self.settings;
        println!(
            "\n{}: {vertices} vertices, {triangles} triangles; samples {direct_samples}, {indirect_samples}",
            case.name
        );
        Some(place)
    }

    fn time(&self, case: &Case) -> Option<Value> {
        let place = self.open(case)?;
        let runs = self.alternate(&place, &Way::ALL[..3]);
        let mut rows = Vec::new();
        for i in 0..runs[0].len() {
            let name = Way::ALL[i].name();
            let [seconds, ratio] = times(&runs, i);
            let rays = runs[0][i].rays as f64 * 1e-6;
            println!("  {name:<14} {seconds:8.3} s, {ratio:.3} of point; {rays:.1} million rays");
            rows.push(
                json!({"projection": name, "seconds": seconds, "ratio": ratio, "rays": runs[0][i].rays}),
            );
        }
        Some(json!({"scene": case.name, "rounds": runs.len(), "projections": rows}))
    }

    fn measure(&self, case: &Case) -> Option<Value> {
        let effort = &self.effort;
        let place = self.open(case)?;
        let paths = Paths::trace(&place, effort.paths);
        let [direct, all] = self.references(case, &place);
        println!(
            "  exact light of {} paths; references of {} points, noise {:.2} % (direct), {:.2} %",
            paths.count(),
            all.points().len(),
            direct.noise() * 100.0,
            all.noise() * 100.0
        );
        let runs = self.alternate(&place, &Way::ALL);
        let rows: Vec<Row> = Way::ALL
            .iter()
            .enumerate()
            .map(|(i, way)| {
                Row::new(way.name(), times(&runs, i), &place, &runs[0][i], &paths, [&direct, &all])
            })
            .collect();
        rows::print(&rows);
        Some(json!({
            "scene": case.name, "vertices": place.scene.vertex_count(), "triangles": place.scene.triangle_count(), "rounds": effort.rounds,
            "direct_samples": self.settings.direct_samples, "indirect_samples": self.settings.indirect_samples, "paths": paths.count(),
            "reference_points": all.points().len(), "reference_noise": [direct.noise(), all.noise()],
            "projections": rows.iter().map(Row::json).collect::<Vec<_>>(),
        }))
    }

    /// Some ways in turn, several times.
    fn alternate(&self, place: &Place, ways: &[Way]) -> Vec<Vec<Solved>> {
        let settings = |round: usize| Settings { seed: round as u64 + 1, ..self.settings.clone() };
        let round = |round| ways.iter().map(|way| way.solve(place, &settings(round))).collect();
        (0..self.effort.rounds).map(round).collect()
    }

    /// Direct light, and all light, at random points of the surfaces.
    ///
    /// Bounces come from a solve with least squares, on a finer mesh where the case has one, which the points gather.
    fn references<'a>(&self, case: &Case, place: &'a Place) -> [Reference<'a>; 2] {
        let effort = &self.effort;
        let finer = case.open_reference().unwrap();
        let fine = finer.as_ref().unwrap_or(place);
        let settings = Settings {
            projection: Projection::LeastSquares,
            bounces: BounceLimit::Count(BOUNCES as u32 - 1),
            seed: 1000,
            ..self.settings.clone()
        };
        let bounces = Way::Projection(Projection::LeastSquares).solve(fine, &settings).carried;
        let reflecting = Field::sum(bounces[0].node_count(), &bounces);
        let plan = Plan {
            direct_samples: effort.samples,
            indirect_samples: effort.samples,
            seed: 2000,
            ..Plan::default()
        };
        [None, Some(&reflecting)].map(|field| {
            let towards =
                |points| -> Box<dyn lumel_transport::Transport> { Box::new(fine.towards(points, plan)) };
            Reference::measured(&place.scene, effort.points, 3, towards, field, PASSES)
        })
    }
}

/// Median seconds of a way, and its processor time over that of the first.
fn times(runs: &[Vec<Solved>], way: usize) -> [f64; 2] {
    [
        median(runs.iter().map(|round| round[way].seconds).collect()),
        median(runs.iter().map(|round| round[way].cpu_seconds / round[0].cpu_seconds).collect()),
    ]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
