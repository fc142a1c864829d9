//! How fast rays are traced and scenes solved, and with what error: `cargo x bench`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use glam::{DVec3, Vec3};
use lumel::{
    Baker, BounceLimit, Bvh, Control, Light, Observer, RayTracer, Scene, Settings, Silent, SolveState, Step,
};
use lumel_accel::{Bundle, SHADOW_END};
use lumel_basis::{ElementId, Receivers, Site, VertexBasis, VertexReceivers};
use lumel_sample::{CellOrder, Dim, SamplerKind, StreamKey, cosine_hemisphere};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};
use std::time::Instant;

const HELP: &str = "\
usage: cargo x bench [--quick] [--json FILE]

Traces hemisphere gathers (256 rays from one origin) and shadow rays (64 to one light) on one core, and bakes the
Cornell box (4 bounces) and the atrium (2 bounces) with 64, 256 and 1024 hemisphere rays on all cores. The error is
the noise of one bake, relative to the root mean square of the light: the difference of two seeds over the root of 2.
Then a light is moved, and all is solved again on the rays that are stored.

  --quick       64 rays only
  --json FILE   write the results as JSON too
";

/// Receivers that rays are traced from.
const RECEIVERS: usize = 512;
/// Each timing is the median of this many.
const REPEATS: usize = 5;

fn main() {
    // Cargo adds --bench.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut quick, mut json_file) = (false, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => quick = true,
            "--json" => json_file = Some(arguments.next().expect("--json needs a file")),
            _ => return println!("{HELP}"),
        }
    }
    let threads = rayon::current_num_threads();
    println!("lumel {} on {threads} threads", env!("CARGO_PKG_VERSION"));
    let mut results = Vec::new();
    for (name, bounces) in [("cornell-box", 4), ("atrium", 2)] {
        results.push(measure(name, bounces, if quick { &[64] } else { &[64, 256, 1024] }));
    }
    if let Some(file) = json_file {
        let all = json!({"version": env!("CARGO_PKG_VERSION"), "threads": threads, "scenes": results});
        std::fs::write(file, serde_json::to_string_pretty(&all).unwrap()).unwrap();
    }
}

fn measure(name: &str, bounces: u32, samples: &[u32]) -> Value {
    let opened = lumel::open(name, &lumel::OpenOptions::default()).unwrap();
    let scene = Arc::new(opened.builder.build().unwrap().0);
    let (bvh, build_seconds) = timed(|| Bvh::build(&scene));
    let (gather, shadow) = ray_rates(&scene, &bvh);
    println!("\n{name}: {} vertices, {} triangles", scene.vertex_count(), scene.triangle_count());
    println!("  build                {:>8.1} ms   {:.1} MB", build_seconds * 1e3, bvh.memory() as f64 / 1e6);
    println!("  hemisphere gather    {gather:>8.2} Mrays/s per core");
    println!("  shadow rays          {shadow:>8.2} Mrays/s per core");
    println!("  bounces   rays per vertex    solve s   Mrays/s   error %   error² · s");
    let tracer: Arc<dyn RayTracer> = Arc::new(bvh);
    let solves: Vec<Value> = samples.iter().map(|&n| solve_row(&scene, &tracer, bounces, n)).collect();
    let relight = relight_row(&scene, &tracer);
    json!({
        "scene": name, "vertices": scene.vertex_count(), "triangles": scene.triangle_count(),
        "build_seconds": build_seconds, "gather_mrays_per_core": gather, "shadow_mrays_per_core": shadow,
        "solves": solves, "relight": relight,
    })
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Millions of rays per second on one core: hemisphere gathers and shadow rays to the first rectangle light.
fn ray_rates(scene: &Arc<Scene>, bvh: &Bvh) -> (f64, f64) {
    let receivers = VertexReceivers::new(&VertexBasis::new(Arc::clone(scene)));
    let n = receivers.element_count();
    let step = (n / RECEIVERS).max(1);
    let sites: Vec<(u32, Site)> =
        (0..n as u32).step_by(step).map(|e| (e, receivers.central_site(ElementId(e)))).collect();
    let light = scene
        .lights()
        .iter()
        .find_map(|l| if let Light::Rect(rect) = l { Some(*rect) } else { None })
        .unwrap();
    let gathers: Vec<Vec<Vec3>> =
        directions(&sites, 256, |site, u| site.frame.to_world(cosine_hemisphere(u)));
    let shadows: Vec<Vec<Vec3>> = directions(&sites, 64, |site, u| light.point(u) - site.origin);
    let gather = rate(&gathers, |i, directions| {
        let mut hits = [None; 256];
        bvh.closest_hits(&bundle(&sites[i].1, directions, f32::INFINITY), &mut hits);
        hits.iter().flatten().count()
    });
    let shadow = rate(&shadows, |i, directions| {
        let mut blocked = [false; 64];
        bvh.occlusions(&bundle(&sites[i].1, directions, SHADOW_END), &mut blocked);
        blocked.iter().filter(|b| **b).count()
    });
    (gather, shadow)
}

fn bundle<'a>(site: &Site, directions: &'a [Vec3], t_max: f32) -> Bundle<'a> {
    Bundle { origin: site.origin, directions, t_max, skip: site.skip }
}

fn directions(sites: &[(u32, Site)], n: u32, direction: impl Fn(&Site, [f32; 2]) -> Vec3) -> Vec<Vec<Vec3>> {
    let sampler = SamplerKind::Sobol.for_count(n);
    let mut cells = CellOrder::default();
    let of = |(element, site): &(u32, Site)| {
        let stream = sampler.stream(StreamKey::new(1).element(*element), Dim::Hemisphere);
        cells.points(&stream, n).iter().map(|&u| direction(site, u)).collect()
    };
    sites.iter().map(of).collect()
}

fn rate(bundles: &[Vec<Vec3>], trace: impl Fn(usize, &[Vec3]) -> usize) -> f64 {
    let n_rays: usize = bundles.iter().map(Vec::len).sum();
    let once = || bundles.iter().enumerate().map(|(i, b)| trace(i, b)).sum::<usize>();
    let seconds = median((0..REPEATS).map(|_| timed(|| std::hint::black_box(once())).1).collect());
    n_rays as f64 / seconds / 1e6
}

/// Seconds that each step of a solve takes.
#[derive(Default)]
struct Steps(Mutex<Timings>);

#[derive(Default)]
struct Timings {
    begun: Option<Instant>,
    done: Vec<(Step, f64)>,
}

impl Observer for Steps {
    fn step_started(&self, _: Step) {
        self.0.lock().unwrap().begun = Some(Instant::now());
    }

    fn step_done(&self, step: Step, _: &SolveState) {
        let mut timings = self.0.lock().unwrap();
        let seconds = timings.begun.take().unwrap().elapsed().as_secs_f64();
        timings.done.push((step, seconds));
    }
}

/// Seconds to solve again after a light has moved, until a thousandth of the light is missing: all bounces, and all.
fn relight_row(scene: &Arc<Scene>, tracer: &Arc<dyn RayTracer>) -> Value {
    let settings = Settings { bounces: BounceLimit::All, ..Settings::default() };
    let baker = Baker::with_tracer(Arc::clone(scene), Arc::clone(tracer), settings.clone());
    baker.run(&mut SolveState::new(), &Control::default(), &Silent).unwrap();
    let once = |step: usize| {
        let mut lights = scene.lights().to_vec();
        if let Some(Light::Rect(rect)) = lights.first_mut() {
            rect.center += Vec3::X * (0.01 * step as f32);
        }
        let relit = Arc::new(scene.relit(lights).unwrap());
        let (steps, mut state) = (Steps::default(), SolveState::new());
        let ((), all) = timed(|| {
            let baker = baker.relit(relit, settings.clone());
            baker.run(&mut state, &Control::default(), &steps).unwrap();
        });
        let steps = steps.0.into_inner().unwrap().done;
        let bounces = steps.iter().filter(|(step, _)| matches!(step, Step::Bounce(1..)));
        (bounces.map(|(_, seconds)| seconds).sum::<f64>(), all, state.bounces.len() - 1)
    };
    let runs: Vec<(f64, f64, usize)> = (1..=REPEATS).map(once).collect();
    let bounces = median(runs.iter().map(|r| r.0).collect());
    let all = median(runs.iter().map(|r| r.1).collect());
    println!(
        "  a light moved: {} bounces again {:.1} ms, with direct light {:.1} ms",
        runs[0].2,
        bounces * 1e3,
        all * 1e3
    );
    json!({"n_bounces": runs[0].2, "bounces_seconds": bounces, "seconds": all})
}

fn solve_row(scene: &Arc<Scene>, tracer: &Arc<dyn RayTracer>, bounces: u32, samples: u32) -> Value {
    let bake = |seed| {
        let settings = Settings {
            bounces: BounceLimit::Count(bounces),
            indirect_samples: samples,
            seed,
            ..Settings::default()
        };
        let baker = Baker::with_tracer(Arc::clone(scene), Arc::clone(tracer), settings);
        let (mut state, control) = (SolveState::new(), Control::default());
        let ((), seconds) = timed(|| baker.run(&mut state, &control, &Silent).unwrap());
        (baker.solution(&state), seconds, control.rays())
    };
    let (a, seconds_a, rays) = bake(1);
    let (b, seconds_b, _) = bake(2);
    let seconds = 0.5 * (seconds_a + seconds_b);
    let squared = |values: &mut dyn Iterator<Item = DVec3>| values.map(|v| v.length_squared()).sum::<f64>();
    let valid = || a.valid.iter().zip(&b.valid).map(|(a, b)| *a && *b);
    let pairs = || {
        a.irradiance.iter().zip(&b.irradiance).zip(valid()).filter(|(_, valid)| *valid).map(|(pair, _)| pair)
    };
    let noise = squared(&mut pairs().map(|(a, b)| (*a - *b).as_dvec3())) / 2.0;
    let power = squared(&mut pairs().map(|(a, b)| (*a + *b).as_dvec3() / 2.0));
    let error = (noise / power).sqrt();
    let mrays = rays as f64 / seconds / 1e6;
    println!(
        "  {bounces:>7}   {samples:>15}   {seconds:>8.2}   {mrays:>7.2}   {:>7.3}   {:>10.3e}",
        error * 100.0,
        error * error * seconds
    );
    json!({"bounces": bounces, "samples": samples, "seconds": seconds, "mrays_per_second": mrays, "relative_error": error})
}
