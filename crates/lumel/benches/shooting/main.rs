//! How soon a picture is close to the end, by shooting and by gathering: `cargo x bench shooting`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

mod plot;
#[path = "../common/sponza.rs"]
mod sponza;

use cpu_time::ProcessTime;
use lumel::{
    Baker, BounceLimit, Control, Observer, OpenOptions, Preset, Scene, ScheduleKind, Settings, Silent,
    SolveState, SolverKind, Step,
};
use lumel_basis::Field;
use plot::Curve;
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};

const HELP: &str = "\
usage: cargo x bench shooting [--json FILE] [--plot FILE] [SCENE]...

Solves scenes by shooting and by gathering, with the samples of the preset medium, without stored rays of draft: from the beginning, on stored rays and without them, and once more where all
rays are stored, as after a light has moved. After every bounce and every shot, light is compared with that of a solve
to a hundred-thousandth by the same method: the root mean square of the difference over all surfaces, relative to that of
the light, with and without the ambient term. Prints the CPU seconds of all threads until it is within 20, 10 and 5 %
for good. A bounce that is under way is not looked at.

  --json FILE   write the results as JSON too
  --plot FILE   draw error against time, with the ambient term, as SVG
  SCENE         built-in scenes, scene files, or sponza; by default the atrium
";

/// What pictures are to be within.
const LIMITS: [f64; 3] = [0.2, 0.1, 0.05];

/// The share of all light that the last picture of a solve may lack.
const REMAINDER: f32 = 1e-3;

/// The same without stored rays, where every shot traces new ones.
const TRACED_REMAINDER: f32 = 3e-2;

/// The share of all light that the one it is compared with may lack.
const EXACT: f32 = 1e-5;

/// How light is solved.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Stored,
    Again,
    Traced,
}

impl Way {
    const ALL: [(Self, &'static str); 3] =
        [(Self::Stored, "from the beginning"), (Self::Again, "rays there"), (Self::Traced, "no rays stored")];
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut names, mut json_file, mut plot_file) = (Vec::new(), None, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--help" => return print!("{HELP}"),
            "--json" => json_file = arguments.next(),
            "--plot" => plot_file = arguments.next(),
            _ => names.push(argument),
        }
    }
    if names.is_empty() {
        names.push("atrium".to_owned());
    }
    let (mut results, mut curves) = (Vec::new(), Vec::new());
    for name in &names {
        let scene = match opened(name) {
            Ok(scene) => scene,
            Err(reason) => {
                println!("{name}: skipped, {reason}");
                continue;
            }
        };
        let (result, of_scene) = measure(name, &scene);
        results.push(result);
        curves.push((name.clone(), of_scene));
    }
    if let Some(file) = plot_file {
        std::fs::write(file, plot::svg(&curves, &LIMITS)).unwrap();
    }
    if let Some(file) = json_file {
        std::fs::write(file, serde_json::to_string_pretty(&results).unwrap()).unwrap();
    }
}

fn opened(name: &str) -> Result<Arc<Scene>, String> {
    let is_sponza = name == "sponza";
    let source = if is_sponza { sponza::file()?.to_string_lossy().into_owned() } else { name.to_owned() };
    let mut builder =
        lumel::open(&source, &OpenOptions::default()).map_err(|error| error.to_string())?.builder;
    if is_sponza {
        builder.add_light(sponza::light());
    }
    builder.build().map(|(scene, _)| Arc::new(scene)).map_err(|error| error.to_string())
}

/// Light after a step.
struct Look {
    seconds: f64,
    shown: Field,
    ambient: Field,
}

/// Looks at light after every step, with the time that the solve took without looking.
struct Looks<'a> {
    baker: &'a Baker,
    begun: ProcessTime,
    found: Mutex<(Vec<Look>, f64)>,
}

impl Observer for Looks<'_> {
    fn step_done(&self, step: Step, state: &SolveState) {
        if !matches!(step, Step::Bounce(_) | Step::Shot(_)) {
            return;
        }
        let now = self.begun.elapsed().as_secs_f64();
        let mut found = self.found.lock().unwrap();
        let (shown, ambient) = (state.total(), self.baker.ambient(state));
        let with = shown.values().iter().map(|value| *value + ambient).collect();
        let seconds = now - found.1;
        found.0.push(Look { seconds, shown, ambient: Field::from_values(with) });
        found.1 += self.begun.elapsed().as_secs_f64() - now;
    }
}

fn measure(name: &str, scene: &Arc<Scene>) -> (Value, Vec<Curve>) {
    println!("\n{name}: {} vertices, {} triangles", scene.vertex_count(), scene.triangle_count());
    let (mut rows, mut curves) = (Vec::new(), Vec::new());
    for (way, what) in Way::ALL {
        let solver = if way == Way::Traced { SolverKind::Neumann } else { SolverKind::Cached };
        let remainder = if way == Way::Traced { TRACED_REMAINDER } else { REMAINDER };
        let preset = if way == Way::Traced { Preset::Draft } else { Preset::Medium };
        let bounces = BounceLimit::All;
        let settings = |schedule| Settings { schedule, bounces, solver, remainder, ..preset.settings() };
        for schedule in [ScheduleKind::Gather, ScheduleKind::Shoot] {
            let baker = Baker::new(Arc::clone(scene), settings(schedule));
            if way == Way::Again {
                baker.run(&mut SolveState::new(), &Control::default(), &Silent).unwrap();
            }
            // What a reference by the same samples is: the traced ones have none, and are compared with stored rays.
            let exact = match way {
                Way::Again => reference(&baker),
                Way::Stored | Way::Traced => reference(&Baker::new(Arc::clone(scene), settings(schedule))),
            };
            let looks = Looks { baker: &baker, begun: ProcessTime::now(), found: Mutex::default() };
            baker.run(&mut SolveState::new(), &Control::default(), &looks).unwrap();
            let (looks, _) = looks.found.into_inner().unwrap();
            let order = if schedule == ScheduleKind::Gather { "gathering" } else { "shooting" };
            let errors = |field: fn(&Look) -> &Field| -> Vec<(f64, f64)> {
                looks.iter().map(|look| (look.seconds, error(&baker, field(look), &exact))).collect()
            };
            let [plain, ambient] = [errors(|look| &look.shown), errors(|look| &look.ambient)];
            let [without, with] =
                [&plain, &ambient].map(|errors| LIMITS.map(|limit| time_within(errors, limit)));
            println!(
                "  {what:<19} {order:<10} {:>4} steps, {:7.2} s in all; within 20, 10, 5 %: {} s; with ambient {} s",
                looks.len(),
                looks.last().map_or(0.0, |look| look.seconds),
                text(without),
                text(with),
            );
            rows.push(json!({"way": what, "order": order, "without": plain, "with_ambient": ambient}));
            curves.push(Curve { way: what, order, errors: ambient });
        }
    }
    (json!({"scene": name, "rows": rows}), curves)
}

/// The light that a solve ends with, if it is never stopped. Without stored rays every bounce has others: the mean light is that
/// of rays that are stored.
fn reference(baker: &Baker) -> Field {
    let settings = Settings {
        schedule: ScheduleKind::Gather,
        solver: SolverKind::Cached,
        remainder: EXACT,
        ..baker.settings().clone()
    };
    // The same rays, if they are there.
    let exact = baker.relit(Arc::clone(baker.scene()), settings);
    let mut state = SolveState::new();
    exact.run(&mut state, &Control::default(), &Silent).unwrap();
    state.total()
}

/// The root mean square over all surfaces of a difference, relative to that of the light.
fn error(baker: &Baker, found: &Field, exact: &Field) -> f64 {
    let difference = found.values().iter().zip(exact.values()).map(|(a, b)| *a - *b).collect();
    baker.root_mean_square(&Field::from_values(difference)) / baker.root_mean_square(exact)
}

/// When the error is below a limit for good; `None` if it never is.
fn time_within(errors: &[(f64, f64)], limit: f64) -> Option<f64> {
    let above = errors.iter().rposition(|(_, error)| *error > limit);
    errors.get(above.map_or(0, |last| last + 1)).map(|(seconds, _)| *seconds)
}

fn text(seconds: [Option<f64>; 3]) -> String {
    seconds.map(|seconds| seconds.map_or("never".to_owned(), |seconds| format!("{seconds:.2}"))).join(", ")
}
