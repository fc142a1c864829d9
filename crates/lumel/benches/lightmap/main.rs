//! How far light at lumels is from the truth over all surfaces, beside light at vertices, and at what price:
//! `cargo x bench lightmap`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Control, Light, Lighting, Lightmap, Lumels, MaxEdge, OpenOptions, Preset, Scene,
    Settings, Silent, SolveState, Tail, VertexLighting,
};
use lumel_basis::{Basis, Field, PointReceivers};
use lumel_scene::{DirectionalLight, Radiance, Sides, Sky, SunLight};
use lumel_testkit::{Reference, shared};
use lumel_transport::{CpuTransport, Plan, Transport};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use std::sync::Arc;

mod denoising;
#[path = "../common/sponza.rs"]
mod sponza;

const HELP: &str = "\
usage: cargo x bench lightmap [--quick | --denoising | --cycles] [SCENE]...

Bakes files as they are given, at vertices and at lumels, with the defaults of the presets draft and medium and two bounces, and
compares the light with many samples at random points, uniform by area over all surfaces.

  CPU           seconds of all threads, from the opened scene to light that can be read
  error         root mean square of the difference, without the worst 2 % of the points, and what 95 % stay below, relative to
                the root mean square of the light; bias is the relative difference of means

Scenes: cornell-box (44 triangles), bevy-cornell, cornell-built-in, atrium, sponza, house; files are read from LUMEL_TEST_SHARED.

  --quick       few points, and the preset draft alone
  --cycles      the time to equal error, beside Blender Cycles on the same lumels; see bench/peers/run_lightmaps.py
  --denoising   what the denoiser makes of 16,384 lumels with the samples of each preset, and of 16 times those of medium
";

struct Case {
    name: &'static str,
    file: Option<&'static str>,
}

const CASES: [Case; 6] = [
    Case { name: "cornell-box", file: Some("scenes/cornell-variants/CornellBox-Original.obj") },
    Case { name: "bevy-cornell", file: Some("scenes/gltf-samples/bevy-CornellBox.glb") },
    Case { name: "cornell-built-in", file: None },
    Case { name: "atrium", file: None },
    Case { name: "sponza", file: None },
    Case { name: "house", file: Some("scenes/house-lightmap-uv/house.glb") },
];

const OPTIONS: [&str; 2] = ["--quick", "--denoising"];

/// Bounces after direct light.
const BOUNCES: u32 = 2;

/// Independent measurements of the reference.
const PASSES: u32 = 4;

fn main() {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let names: Vec<&str> = arguments.iter().map(String::as_str).filter(|a| !OPTIONS.contains(a)).collect();
    if names.iter().any(|name| CASES.iter().all(|case| case.name != *name)) {
        return println!("{HELP}");
    }
    let [quick, denoising] = OPTIONS.map(|option| arguments.iter().any(|argument| argument == option));
    let presets: &[Preset] = if quick { &[Preset::Draft] } else { &[Preset::Draft, Preset::Medium] };
    println!("lumel {} on {} threads", env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
    for case in CASES.iter().filter(|case| names.is_empty() || names.contains(&case.name)) {
        println!("\n{}", case.name);
        let measured = match denoising {
            true => denoising::measure(case),
            false => case.measure(presets, if quick { 500 } else { 4000 }),
        };
        if let Err(reason) = measured {
            println!("  {reason}");
        }
    }
}

impl Case {
    fn open(&self, max_edge: MaxEdge, preset: Preset) -> Result<Arc<Scene>, String> {
        let path = match (self.file, self.name) {
            (Some(file), _) => shared::path(file)
                .ok_or_else(|| format!("{file} is read from the folder that {} names", shared::VARIABLE))?,
            (None, "sponza") => sponza::file()?,
            (None, "cornell-built-in") => "cornell-box".into(),
            (None, name) => name.into(),
        };
        let options = OpenOptions {
            max_edge: Some(max_edge),
            vertex_budget: Some(preset.vertex_budget()),
            ..OpenOptions::default()
        };
        let mut builder = lumel::open(&path, &options).map_err(|e| e.to_string())?.builder;
        if self.name == "sponza" {
            builder.materials.iter_mut().for_each(|material| material.sides = Sides::Both);
            builder.lights = vec![Light::Rect(sponza::light())];
        }
        if self.name == "house" {
            let direction = Vec3::new(-0.48, -0.8, -0.36);
            let parallel = DirectionalLight { direction, irradiance: Vec3::splat(5.0) };
            builder.lights = vec![Light::Sun(SunLight { parallel, sin_half_angle: 0.005 })];
            builder.sky = Sky::Uniform(Radiance(Vec3::new(0.5, 0.6, 1.0)));
        }
        builder.build().map(|(scene, _)| Arc::new(scene)).map_err(|e| e.to_string())
    }

    fn measure(&self, presets: &[Preset], n_points: u32) -> Result<(), String> {
        let whole = self.open(MaxEdge::Off, Preset::Medium)?;
        let truth = Truth::new(self.open(MaxEdge::Auto, Preset::Production)?, n_points);
        let of_whole = truth.at_points_of(&whole);
        println!("  reference: {} points, noise {:.2} %", of_whole.points().len(), 100.0 * of_whole.noise());
        for &preset in presets {
            let fine = self.open(MaxEdge::Auto, preset)?;
            let settings = crate::settings(preset);
            let begun = ProcessTime::now();
            let (baker, state) = solved(&fine, &settings);
            let light = baker.light_at_vertices(&state);
            let seconds = begun.elapsed().as_secs_f64();
            let of_fine = truth.at_points_of(&fine);
            let name = format!("{preset:?} vertices, {}", fine.vertex_count());
            row(&name, seconds, &of_fine, &VertexLighting::new(&fine, &light).unwrap());
            let begun = ProcessTime::now();
            let (baker, state) = solved(&fine, &settings);
            let lumels = lumels_of(&whole, Density::Budget(preset.lumel_budget()));
            let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
            let Lumels { scene, atlas, coverage } = &lumels;
            let raw = Lightmap::finished(scene, atlas, coverage, &light, None, None);
            let seconds = begun.elapsed().as_secs_f64();
            let begun = ProcessTime::now();
            let known = baker.solved_at_lumels(&state, &lumels);
            let denoised = Lightmap::finished(scene, atlas, coverage, &light, Some(&known), None);
            let more = begun.elapsed().as_secs_f64();
            let n_lumels = coverage.len();
            row(&format!("{preset:?} lumels, {n_lumels}"), seconds, &of_whole, &raw.lighting(0));
            row(&format!("{preset:?} lumels, denoised"), seconds + more, &of_whole, &denoised.lighting(0));
        }
        Ok(())
    }
}

/// What light is compared with: many samples at each point, of bounces that a finer mesh carries.
struct Truth {
    baker: Baker,
    carried: Field,
    n_points: u32,
}

impl Truth {
    fn new(scene: Arc<Scene>, n_points: u32) -> Self {
        let (baker, state) = solved(&scene, &settings(Preset::Production));
        let carried = Field::sum(baker.basis().node_count(), &state.bounces[..BOUNCES as usize]);
        Self { baker, carried, n_points }
    }

    fn at_points_of<'a>(&self, scene: &'a Scene) -> Reference<'a> {
        let baker = &self.baker;
        let plan = Plan { direct_samples: 256, indirect_samples: 1024, ..baker.settings().plan() };
        let towards = |points: PointReceivers| -> Box<dyn Transport> {
            let (scene, tracer) = (Arc::clone(baker.scene()), Arc::clone(baker.tracer()));
            Box::new(CpuTransport::new(scene, tracer, Arc::clone(baker.basis()), Arc::new(points), plan))
        };
        Reference::measured(scene, self.n_points, 7, towards, Some(&self.carried), PASSES)
    }
}

fn settings(preset: Preset) -> Settings {
    Settings { bounces: BounceLimit::Count(BOUNCES), tail: Tail::Off, ..preset.settings() }
}

fn solved(scene: &Arc<Scene>, settings: &Settings) -> (Baker, SolveState) {
    let (baker, mut state) = (Baker::new(Arc::clone(scene), settings.clone()), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    (baker, state)
}

fn lumels_of(scene: &Arc<Scene>, density: Density) -> Lumels {
    let settings = UnwrapSettings { density, ..UnwrapSettings::default() };
    Lumels::new(Arc::clone(scene), unwrap(scene, &settings, &|| Pace::Go).unwrap().atlas)
}

fn row(name: &str, seconds: f64, reference: &Reference<'_>, light: &dyn Lighting) {
    let error = reference.error_of(light);
    let [trimmed, most, bias] = [error.trimmed, error.percentile_95, error.bias].map(|share| 100.0 * share);
    println!(
        "  {name:<28} {seconds:7.1} s CPU, error {trimmed:5.2} %, 95 % below {most:5.2} %, bias {bias:+.2} %"
    );
}
