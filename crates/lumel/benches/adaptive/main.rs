//! Meshes that follow light beside uniform ones: `cargo x bench adaptive`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Control, Lighting, MaxEdge, OpenOptions, Preset, Projection, Scene, Settings, Silent,
    SolveState, VertexLighting,
};
use lumel_basis::{Basis, Field, PointReceivers};
use lumel_scene::{Bisection, SurfacePoint};
use lumel_testkit::{Reference, shared};
use lumel_transport::{CpuTransport, Plan, Transport};
use std::sync::Arc;

fn uniform(scene: &Arc<Scene>, length: f64) -> Arc<Scene> {
    let mut mesh = Bisection::new(Arc::clone(scene));
    loop {
        let long: Vec<[u32; 2]> = mesh
            .parts()
            .flat_map(|p| [0, 1, 2].map(|k| [p.vertices[k], p.vertices[(k + 1) % 3]]))
            .filter(|&e| mesh.relative_length(e) > length)
            .collect();
        if long.is_empty() {
            break;
        }
        mesh.split(long, usize::MAX);
    }
    Arc::new(scene.refined(mesh.splits()).unwrap())
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let path = shared::path(&args[0]).unwrap();
    let options = OpenOptions { max_edge: Some(MaxEdge::Off), ..OpenOptions::default() };
    let opened = lumel::open(&path.to_string_lossy(), &options).unwrap();
    let scene = Arc::new(opened.builder.build().unwrap().0);
    let bounces = 3;
    let settings = Settings {
        bounces: BounceLimit::Count(bounces),
        projection: Projection::LeastSquares,
        ..Preset::Medium.settings()
    };
    // reference
    let fine = uniform(&scene, 1.0 / 150.0);
    println!("{} triangles; reference bounces on {} vertices", scene.triangle_count(), fine.vertex_count());
    let baker = Baker::new(
        Arc::clone(&fine),
        Settings { bounces: BounceLimit::Count(bounces - 1), seed: 77, ..settings.clone() },
    );
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let reflecting = Field::sum(state.bounces[0].node_count(), &state.bounces);
    let plan = Plan { direct_samples: 256, indirect_samples: 512, seed: 2000, ..Plan::default() };
    let reference = |field: Option<&Field>| {
        let towards = |points: PointReceivers| -> Box<dyn Transport> {
            Box::new(CpuTransport::new(
                Arc::clone(&fine),
                Arc::clone(baker.tracer()),
                Arc::clone(baker.basis()),
                Arc::new(points),
                plan,
            ))
        };
        Reference::measured(&scene, 5000, 3, towards, field, 4)
    };
    let direct = reference(None);
    let all = reference(Some(&reflecting));
    println!("noise {:.4} {:.4}", direct.noise(), all.noise());
    let measure = |name: String, make: &dyn Fn() -> Baker| {
        let cpu = ProcessTime::now();
        let baker = make();
        let t_mesh = cpu.elapsed().as_secs_f64();
        let mut state = SolveState::new();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let light = baker.light_at_vertices(&state);
        let t = cpu.elapsed().as_secs_f64();
        let d = baker.light_reader(&state).at_vertices(&state.bounces[0]);
        let scene = baker.scene();
        let error = |values: &[Vec3], reference: &Reference| {
            let lighting = VertexLighting::new(scene, values).unwrap();
            let light = |at: SurfacePoint, n: Vec3| lighting.irradiance(scene.refined_point(at), n);
            reference.error_of(&light)
        };
        let (ed, ea) = (error(&d, &direct), error(&light, &all));
        println!(
            "{name:<18} {:>7} vertices {:6.2}+{:6.2} s; direct rms {:.4} trimmed {:.4} p95 {:.4} p99 {:.4}; all rms {:.4} trimmed {:.4} p95 {:.4} p99 {:.4}",
            scene.vertex_count(),
            t_mesh,
            t - t_mesh,
            ed.rms,
            ed.trimmed,
            ed.percentile_95,
            ed.percentile_99,
            ea.rms,
            ea.trimmed,
            ea.percentile_95,
            ea.percentile_99
        );
    };
    let _ = baker.basis().node_count();
    let coarse = Baker::new(Arc::clone(&scene), settings.clone());
    for text in &args[1..] {
        if let Some(e) = text.strip_prefix('a') {
            let e: f64 = e.parse().unwrap();
            measure(text.clone(), &|| {
                let s = Settings {
                    adaptive: lumel::Adaptive::At(lumel::Share::new(e as f32).unwrap()),
                    ..settings.clone()
                };
                coarse
                    .relit(Arc::clone(&scene), s)
                    .adapted(&Control::default(), &mut |_| {})
                    .unwrap()
                    .unwrap()
                    .baker
            });
        } else {
            let n: f64 = text[1..].parse().unwrap();
            measure(text.clone(), &|| {
                let scene = uniform(&scene, 0.999 / n);
                Baker::new(scene, settings.clone())
            });
        }
    }
}
