//! Indirect light on points beside that on vertices, over all surfaces: `cargo x bench points`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

mod scattering;

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{
    Adaptive, Baker, BounceLimit, Control, Light, PointSpacing, Preset, RectLight, Scene, Settings, Share,
    Silent, SolveState, VertexLighting,
};
use lumel_basis::{Basis, Field, FieldLighting, Lighting, PointReceivers};
use lumel_scene::{Irradiance, Radiance, SurfacePoint};
use lumel_testkit::Reference;
use lumel_transport::{CpuTransport, Plan, Transport};
use std::sync::Arc;

#[path = "../common/meshes.rs"]
mod meshes;
#[path = "../common/sponza.rs"]
mod sponza;

use meshes::uniform;

const HELP: &str = "\
usage: cargo x bench points [--quick] [SCENE]...
       cargo x bench points --scatter wall|leaves TRIANGLES...

Bakes scenes with two bounces and 256 rays for each node, on vertices of uniform meshes and of meshes that follow light, on points of
one level and of several, and on levels of which only those points are measured that light needs. Compares the indirect light
with many samples at random points, uniform by area over all surfaces.

  nodes         that are measured
  rays          millions
  CPU           seconds of all threads, from the opened scene to light that can be read
  error         root mean square of the difference, the same without the worst 2 % of the points, relative to the root mean square
                of the light; vertices as they are read in the end
  W             the power of the indirect light, by luminance

Scenes: cornell-box (32 triangles), sponza, country-kitchen; read from LUMEL_TEST_SHARED.

  --quick       few points of the reference
  --scatter     measures instead what it takes to scatter points over walls and leaves of so many triangles
";

/// Bounces after direct light.
const BOUNCES: u32 = 2;

/// Rays of each node.
const RAYS: u32 = 256;

/// Independent measurements of the reference.
const PASSES: u32 = 4;

/// Errors at which ways are compared, without the worst 2 % of the points: those at the rims of lights decide else.
const ERRORS: [f64; 3] = [0.1, 0.05, 0.02];

struct Case {
    name: &'static str,
    /// Longest edges of uniform meshes, as parts of the diameter of the scene.
    uniform: &'static [f64],
    /// Errors of meshes that follow light.
    vertices: &'static [f32],
    /// Points of the finest level.
    points: &'static [u32],
    /// Points of the finest level, how many levels, and the errors of those that follow light.
    levels: (u32, u32),
    errors: &'static [f32],
    /// Longest edges of the mesh that carries the bounces of the reference, in the same way; as it is given for none.
    reference: Option<f64>,
}

const CASES: [Case; 3] = [
    Case {
        name: "cornell-box",
        uniform: &[8.0, 16.0, 32.0, 64.0],
        vertices: &[0.32, 0.16, 0.08],
        points: &[300, 1000, 3000, 10_000],
        levels: (16_000, 5),
        errors: &[0.4, 0.2, 0.1, 0.05],
        reference: Some(64.0),
    },
    Case {
        name: "sponza",
        uniform: &[16.0, 32.0],
        vertices: &[0.64, 0.32, 0.16],
        points: &[1000, 4000, 16_000, 64_000],
        levels: (64_000, 5),
        errors: &[0.8, 0.4],
        reference: Some(32.0),
    },
    Case {
        name: "country-kitchen",
        uniform: &[],
        vertices: &[],
        points: &[1000, 4000, 16_000],
        levels: (64_000, 5),
        errors: &[0.8, 0.4, 0.2],
        reference: None,
    },
];

fn main() {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    println!("lumel {} on {} threads", env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
    if let Some((_, counts)) = arguments.split_first().filter(|(first, _)| *first == "--scatter") {
        return scattering::measure(counts);
    }
    let names: Vec<&str> = arguments.iter().map(String::as_str).filter(|a| *a != "--quick").collect();
    if names.iter().any(|name| CASES.iter().all(|case| case.name != *name)) {
        return println!("{HELP}");
    }
    let points = if arguments.iter().any(|a| a == "--quick") { 1000 } else { 4000 };
    for case in CASES.iter().filter(|case| names.is_empty() || names.contains(&case.name)) {
        match open(case.name) {
            Ok(scene) => measure(case, &Arc::new(scene), points),
            Err(reason) => println!("\n{}: {reason}", case.name),
        }
    }
}

fn open(name: &str) -> Result<Scene, String> {
    let mut builder = meshes::open(match name {
        "sponza" => name,
        "country-kitchen" => "scenes/country-kitchen/country-kitchen.glb",
        _ => "scenes/cornell-variants/CornellBox-Original.obj",
    })?;
    let is_dark =
        builder.lights.is_empty() && builder.materials.iter().all(|m| m.emission == Radiance(Vec3::ZERO));
    let scene = builder.clone().build().map_err(|e| e.to_string())?.0;
    if !is_dark {
        return Ok(scene);
    }
    // A square below the ceiling.
    let (low, high) = (scene.bounds().min, scene.bounds().max);
    let (middle, size) = (0.5 * (low + high), 0.1 * (high - low));
    let light = RectLight {
        center: Vec3::new(middle.x, high.y - 0.1 * (high.y - low.y), middle.z),
        u: Vec3::X * size.x,
        v: Vec3::Z * size.z,
        radiance: Radiance(Vec3::splat(10.0)),
        texture: None,
    };
    builder.lights = vec![Light::Rect(light)];
    builder.build().map(|(scene, _)| scene).map_err(|e| e.to_string())
}

/// Light at places of the scene as it was given.
struct OnMesh<'a> {
    scene: &'a Scene,
    light: &'a dyn Lighting,
}

impl Lighting for OnMesh<'_> {
    fn irradiance(&self, at: SurfacePoint, normal: Vec3) -> Irradiance {
        self.light.irradiance(self.scene.refined_point(at), normal)
    }
}

/// What a way took, and how far off it is.
struct Row {
    nodes: f64,
    rays: f64,
    seconds: f64,
    error: f64,
}

fn measure(case: &Case, scene: &Arc<Scene>, points: u32) {
    let settings = Settings {
        bounces: BounceLimit::Count(BOUNCES),
        direct_samples: 64,
        indirect_samples: RAYS,
        ..Preset::Medium.settings()
    };
    let on_points = |count: u32, levels: u32| Settings {
        point_spacing: PointSpacing::Points(count),
        levels,
        max_vertices: 10_000_000,
        ..settings.clone()
    };
    // What the last bounce reflects is not in the light.
    let carrying = Settings { bounces: BounceLimit::Count(BOUNCES - 1), seed: 1000, ..settings.clone() };
    let mesh = case.reference.map_or_else(|| Arc::clone(scene), |part| uniform(scene, part));
    let fine = Baker::new(mesh, carrying);
    let mut state = SolveState::new();
    fine.run(&mut state, &Control::default(), &Silent).unwrap();
    let reflecting = Field::sum(state.node_count(), &state.bounces);
    let plan = Plan { direct_samples: 256, indirect_samples: RAYS, seed: 2000, ..Plan::default() };
    let towards = |points: PointReceivers| -> Box<dyn Transport> {
        let (scene, tracer) = (Arc::clone(fine.scene()), Arc::clone(fine.tracer()));
        Box::new(CpuTransport::new(scene, tracer, Arc::clone(fine.basis()), Arc::new(points), plan))
    };
    let reference = Reference::reflected(scene, points, 3, towards, &reflecting, PASSES);
    println!(
        "\n{}: {} triangles; reference of {} points, noise {:.2} %, bounces on {} vertices",
        case.name,
        scene.triangle_count(),
        reference.points().len(),
        100.0 * reference.noise(),
        fine.scene().vertex_count()
    );
    let row = |name: String, make: &dyn Fn() -> Baker| {
        let (cpu, control) = (ProcessTime::now(), Control::default());
        let baker = make();
        let mut state = SolveState::new();
        baker.run(&mut state, &control, &Silent).unwrap();
        let seconds = cpu.elapsed().as_secs_f64();
        let basis = baker.basis();
        let field = Field::sum(state.node_count(), &state.bounces[1..]);
        let on_points = FieldLighting { basis: &**basis, field: &field };
        let values = baker.light_reader(&state).at_vertices(&field);
        let on_vertices = VertexLighting::new(baker.scene(), &values).unwrap();
        let light: &dyn Lighting = if basis.points().is_some() { &on_points } else { &on_vertices };
        let error = reference.error_of(&OnMesh { scene: baker.scene(), light });
        let measured = state.valid.iter().filter(|valid| **valid).count();
        let [rms, trimmed] = [error.rms, error.trimmed].map(|error| 100.0 * error);
        println!(
            "  {name:<22} {measured:>7} nodes of {:>7}; {:7.1} M rays; CPU {seconds:7.2} s; error {rms:5.2} %, trimmed {trimmed:5.2} %; {:.4} W",
            basis.node_count(),
            control.rays() as f64 * 1e-6,
            baker.power(&field),
        );
        Row { nodes: measured as f64, rays: control.rays() as f64 * 1e-6, seconds, error: error.trimmed }
    };
    let adaptive = |error: f32| Adaptive::At(Share::new(error).unwrap());
    let bake = |settings: Settings| Baker::new(Arc::clone(scene), settings);
    let single: Vec<Row> =
        case.points.iter().map(|&n| row(format!("points {n}"), &|| bake(on_points(n, 1)))).collect();
    let (finest, levels) = case.levels;
    let hierarchy: Vec<Row> = (1..levels.min(4))
        .rev()
        .map(|k| {
            let count = finest >> (2 * k);
            row(format!("{} levels", levels - k), &|| bake(on_points(count, levels - k)))
        })
        .collect();
    let refined: Vec<Row> = (case.errors.iter())
        .map(|&error| {
            let settings = Settings { adaptive: adaptive(error), ..on_points(finest, levels) };
            row(format!("adaptive {levels} levels {error}"), &|| bake(settings.clone()))
        })
        .collect();
    let uniform_vertices: Vec<Row> = (case.uniform.iter())
        .map(|&part| {
            row(format!("vertices 1/{part}"), &|| Baker::new(uniform(scene, part), settings.clone()))
        })
        .chain(case.uniform.is_empty().then(|| row("vertices as given".into(), &|| bake(settings.clone()))))
        .collect();
    let follow = |error: f32| {
        let given = bake(Settings { adaptive: adaptive(error), max_vertices: 2_000_000, ..settings.clone() });
        given.adapted(&Control::default(), &mut |_| {}).unwrap().unwrap().baker
    };
    let adaptive_vertices: Vec<Row> =
        case.vertices.iter().map(|&e| row(format!("adaptive vertices {e}"), &|| follow(e))).collect();
    for (name, rows) in [
        ("points", single),
        ("levels", hierarchy),
        ("adaptive levels", refined),
        ("vertices", uniform_vertices),
        ("adaptive vertices", adaptive_vertices),
    ] {
        print_at_errors(name, &rows);
    }
}

/// What a way takes for each of the [`ERRORS`], between two of its rows on scales of logarithms.
fn print_at_errors(name: &str, rows: &[Row]) {
    let at = |error: f64| {
        let pair = rows.windows(2).find(|pair| pair[0].error >= error && pair[1].error <= error)?;
        let share = (error / pair[0].error).ln() / (pair[1].error / pair[0].error).ln();
        let between = |of: fn(&Row) -> f64| of(&pair[0]) * (of(&pair[1]) / of(&pair[0])).powf(share);
        Some([between(|row| row.nodes), between(|row| row.rays), between(|row| row.seconds)])
    };
    let text = ERRORS.map(|error| match at(error) {
        Some([nodes, rays, seconds]) => {
            format!("{} %: {nodes:.0} nodes, {rays:.1} M rays, {seconds:.1} s", 100.0 * error)
        }
        None => format!("{} %: -", 100.0 * error),
    });
    println!("  {name:<18} at {}", text.join("; "));
}
