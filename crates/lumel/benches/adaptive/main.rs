//! Meshes that follow light beside uniform ones, at the light of all surfaces: `cargo x bench adaptive`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{
    Adaptive, Baker, BounceLimit, Control, Lighting, Preset, Scene, Settings, Share, Silent, SolveState,
    VertexLighting,
};
use lumel_basis::{Field, PointReceivers};
use lumel_scene::SurfacePoint;
use lumel_testkit::Reference;
use lumel_transport::{CpuTransport, Plan, Transport};
use std::sync::Arc;

#[path = "../common/meshes.rs"]
mod meshes;
#[path = "../common/sponza.rs"]
mod sponza;

use meshes::{open, uniform};

const HELP: &str = "\
usage: cargo x bench adaptive [--quick] [SCENE]...

Bakes scenes with three bounces and the samples of the preset medium, on meshes whose edges are split uniformly and on meshes
that follow light, and compares the light with many samples at random points, uniform by area over all surfaces.

  CPU           seconds of all threads, from the opened scene to light that can be read: for the mesh, and for all
  error         root mean square of the difference, the same without the worst 2 % of the points, and what 99 % stay below,
                relative to the root mean square of the light

Scenes: cornell-box (32 triangles), sponza; read from LUMEL_TEST_SHARED.

  --quick       few points
";

/// Bounces after direct light.
const BOUNCES: u32 = 3;

/// Independent measurements of the reference.
const PASSES: u32 = 4;

struct Case {
    name: &'static str,
    /// Longest edges, as parts of the diameter of the scene.
    uniform: &'static [f64],
    /// Errors of meshes that follow light.
    adaptive: &'static [f32],
    /// Edges of the mesh that carries the bounces of the reference.
    reference: f64,
}

const CASES: [Case; 2] = [
    Case {
        name: "cornell-box",
        uniform: &[32.0, 64.0, 100.0],
        adaptive: &[0.08, 0.04, 0.02, 0.01],
        reference: 150.0,
    },
    Case { name: "sponza", uniform: &[16.0, 32.0, 48.0], adaptive: &[0.32, 0.16, 0.08], reference: 64.0 },
];

fn main() {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let names: Vec<&str> = arguments.iter().map(String::as_str).filter(|a| *a != "--quick").collect();
    if names.iter().any(|name| CASES.iter().all(|case| case.name != *name)) {
        return println!("{HELP}");
    }
    let points = if arguments.iter().any(|a| a == "--quick") { 1000 } else { 5000 };
    println!("lumel {} on {} threads", env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
    for case in CASES.iter().filter(|case| names.is_empty() || names.contains(&case.name)) {
        let file =
            if case.name == "sponza" { case.name } else { "scenes/cornell-variants/CornellBox-Original.obj" };
        let opened = open(file).and_then(|builder| builder.build().map_err(|e| e.to_string()));
        match opened {
            Ok((scene, _)) => measure(case, &Arc::new(scene), points),
            Err(reason) => println!("\n{}: {reason}", case.name),
        }
    }
}

fn solved(baker: &Baker) -> SolveState {
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

fn measure(case: &Case, scene: &Arc<Scene>, points: u32) {
    let settings = Settings { bounces: BounceLimit::Count(BOUNCES), ..Preset::Medium.settings() };
    // What the last bounce reflects is not in the light.
    let carrying = Settings { bounces: BounceLimit::Count(BOUNCES - 1), seed: 1000, ..settings.clone() };
    let fine = Baker::new(uniform(scene, case.reference), carrying);
    let state = solved(&fine);
    let reflecting = Field::sum(state.node_count(), &state.bounces);
    let plan = Plan { direct_samples: 256, indirect_samples: 512, seed: 2000, ..Plan::default() };
    let towards = |points: PointReceivers| -> Box<dyn Transport> {
        let (scene, tracer) = (Arc::clone(fine.scene()), Arc::clone(fine.tracer()));
        Box::new(CpuTransport::new(scene, tracer, Arc::clone(fine.basis()), Arc::new(points), plan))
    };
    let reference = Reference::measured(scene, points, 3, towards, Some(&reflecting), PASSES);
    println!(
        "\n{}: {} triangles; reference of {} points, noise {:.2} %, bounces on {} vertices",
        case.name,
        scene.triangle_count(),
        reference.points().len(),
        100.0 * reference.noise(),
        fine.scene().vertex_count()
    );
    let row = |name: String, mesh: &dyn Fn() -> Baker| {
        let cpu = ProcessTime::now();
        let baker = mesh();
        let mesh_seconds = cpu.elapsed().as_secs_f64();
        let values = baker.light_at_vertices(&solved(&baker));
        let seconds = cpu.elapsed().as_secs_f64();
        let scene = baker.scene();
        let lighting = VertexLighting::new(scene, &values).unwrap();
        let error = reference
            .error_of(&|at: SurfacePoint, normal: Vec3| lighting.irradiance(scene.refined_point(at), normal));
        let [rms, trimmed, p99] = [error.rms, error.trimmed, error.percentile_99].map(|error| 100.0 * error);
        println!(
            "  {name:<16} {:>7} vertices; CPU {mesh_seconds:6.2} of {seconds:6.2} s; error {rms:.2} %, trimmed {trimmed:.2} %, \
             99 % below {p99:.2} %",
            scene.vertex_count(),
        );
    };
    for &part in case.uniform {
        row(format!("uniform 1/{part}"), &|| Baker::new(uniform(scene, part), settings.clone()));
    }
    for &error in case.adaptive {
        let adaptive = Adaptive::At(Share::new(error).unwrap());
        let given =
            Baker::new(Arc::clone(scene), Settings { adaptive, max_vertices: 2_000_000, ..settings.clone() });
        row(format!("adaptive {} %", 100.0 * error), &|| {
            given.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap().baker
        });
    }
}
