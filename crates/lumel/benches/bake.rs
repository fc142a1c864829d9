//! How fast rays are traced and scenes solved, and with what error: `cargo x bench`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use glam::{DVec3, Vec3};
use lumel::{
    Baker, BounceLimit, Bvh, Control, Light, Observer, RayTracer, Scene, Settings, Silent, SolveState, Step,
};
use lumel_accel::{Bundle, SHADOW_END};
use lumel_basis::{ElementId, Field, PointReceivers, Receivers, Site, VertexBasis, VertexLighting};
use lumel_sample::{CellOrder, Dim, SamplerKind, StreamKey, cosine_hemisphere};
use lumel_testkit::Reference;
use lumel_transport::{CpuTransport, Plan};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};
use std::time::Instant;

const HELP: &str = "\
usage: cargo x bench [--quick] [--json FILE]

Traces hemisphere gathers (256 rays from one origin) and shadow rays (64 to one light) on one core, and bakes the
Cornell box (4 bounces) and the atrium (2 bounces) with 64, 256 and 1024 hemisphere rays on all cores. The error is
the noise of one bake, relative to the root mean square of the light: the difference of two seeds over the root of 2.
The error over surfaces is that of the interpolated light of one bake at random points of all surfaces, against a
measurement of many samples there: its root mean square and the difference that 95 % of the points stay below, relative
to the root mean square of the light, and the relative difference of the means, with standard errors.
Then a light is moved, and all is solved again on the rays that are stored.

  --quick       64 rays only
  --json FILE   write the results as JSON too
";

/// Receivers that rays are traced from.
const RECEIVERS: usize = 512;
/// Random points of all surfaces at which light is compared with a reference.
const SURFACE_POINTS: u32 = 4000;
/// Hemisphere rays per vertex of the solve that the reference gathers, and per point and pass of the reference.
const REFERENCE_RAYS: u32 = 1024;
/// Independent measurements of the reference.
const REFERENCE_PASSES: u32 = 4;
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
    let tracer: Arc<dyn RayTracer> = Arc::new(bvh);
    let reference = reference(&scene, &tracer, bounces);
    println!("  reference: {} points, noise {:.3} %", reference.points().len(), reference.noise() * 100.0);
    println!(
        "  bounces   rays per vertex    solve s   Mrays/s   error %   error² · s   over surfaces %          bias %          95 % below"
    );
    let solves: Vec<Value> =
        samples.iter().map(|&n| solve_row(&scene, &tracer, bounces, n, &reference)).collect();
    let relight = relight_row(&scene, &tracer);
    json!({
        "scene": name, "vertices": scene.vertex_count(), "triangles": scene.triangle_count(),
        "build_seconds": build_seconds, "gather_mrays_per_core": gather, "shadow_mrays_per_core": shadow,
        "reference_noise": reference.noise(), "solves": solves, "relight": relight,
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
    let receivers = PointReceivers::at_vertices(&Arc::new(VertexBasis::new(Arc::clone(scene))));
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

fn baked(scene: &Arc<Scene>, tracer: &Arc<dyn RayTracer>, settings: Settings) -> Baked {
    let baker = Baker::with_tracer(Arc::clone(scene), Arc::clone(tracer), settings);
    let (mut state, control) = (SolveState::new(), Control::default());
    let ((), seconds) = timed(|| baker.run(&mut state, &control, &Silent).unwrap());
    Baked { baker, state, seconds, rays: control.rays() }
}

/// A bake with what it took.
struct Baked {
    baker: Baker,
    state: SolveState,
    seconds: f64,
    rays: u64,
}

/// Light at random points of all surfaces: direct light, and a gather of all but the last bounce of a long solve.
///
/// The gathered bounces are interpolated on the same mesh, whose error there is in the reference as well, smoothed.
fn reference<'a>(scene: &'a Arc<Scene>, tracer: &Arc<dyn RayTracer>, bounces: u32) -> Reference<'a> {
    let settings = Settings {
        bounces: BounceLimit::Count(bounces - 1),
        direct_samples: 256,
        indirect_samples: REFERENCE_RAYS,
        seed: 100,
        ..Settings::default()
    };
    let plan = Plan { seed: 200, ..settings.plan() };
    let Baked { baker, state, .. } = baked(scene, tracer, settings);
    let towards = |receivers| -> Box<dyn lumel_transport::Transport> {
        let (scene, basis) = (Arc::clone(scene), Arc::clone(baker.basis()));
        Box::new(CpuTransport::new(scene, Arc::clone(tracer), basis, Arc::new(receivers), plan))
    };
    let field: Field = state.total();
    Reference::measured(scene, SURFACE_POINTS, 1, towards, Some(&field), REFERENCE_PASSES)
}

fn solve_row(
    scene: &Arc<Scene>,
    tracer: &Arc<dyn RayTracer>,
    bounces: u32,
    samples: u32,
    reference: &Reference<'_>,
) -> Value {
    let bake = |seed| {
        let settings = Settings {
            bounces: BounceLimit::Count(bounces),
            indirect_samples: samples,
            seed,
            ..Settings::default()
        };
        baked(scene, tracer, settings)
    };
    let (first, second) = (bake(1), bake(2));
    let [a, b] = [&first, &second].map(|baked| baked.baker.solution(&baked.state));
    let over_surfaces = reference.error_of(&VertexLighting::new(scene, &a.irradiance).unwrap());
    let (seconds, rays) = (0.5 * (first.seconds + second.seconds), first.rays);
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
        "  {bounces:>7}   {samples:>15}   {seconds:>8.2}   {mrays:>7.2}   {:>7.3}   {:>10.3e}   {:>6.2} ± {:<6.2}   {:>6.2} ± {:<6.2}   {:>7.2}",
        error * 100.0,
        error * error * seconds,
        over_surfaces.rms * 100.0,
        over_surfaces.rms_error * 100.0,
        over_surfaces.bias * 100.0,
        over_surfaces.bias_error * 100.0,
        over_surfaces.percentile_95 * 100.0,
    );
    json!({
        "bounces": bounces, "samples": samples, "seconds": seconds, "mrays_per_second": mrays,
        "relative_error": error, "surface_error": over_surfaces.rms, "surface_error_error": over_surfaces.rms_error,
        "surface_bias": over_surfaces.bias, "surface_bias_error": over_surfaces.bias_error,
        "surface_percentile_95": over_surfaces.percentile_95,
    })
}
