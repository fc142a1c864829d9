//! lumel's part in the comparison with other renderers: `cargo x bench peers`, which runs `bench/peers/run.py`.
//!
//! Writes a scene and its receivers for the others to read, an answer that took long, to check the reference with, and
//! what lumel makes of the scene in how much time.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

mod lumels;
mod places;
mod scenes;

use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{Baker, Bvh, Control, RayTracer, RectLight, Scene, Settings, Silent, SolveState, measure_points};
use lumel_accel::Ray;
use lumel_basis::{ElementId, PointReceivers, Receivers};
use lumel_sample::{Dim, Sampler, StreamKey};
use lumel_scene::{Light, TriId};
use places::Places;
use scenes::Detail;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const HELP: &str = "\
usage: peers export SCENE PLACES FOLDER
           write the scene, its receivers and which of them are compared
       peers long SCENE PLACES FOLDER
           write the irradiance of those that are compared, from a long solve on a finer mesh, and its standard error
       peers solve SCENE PLACES FOLDER DIRECT INDIRECT SEED
           write lumel's irradiance of all receivers and print the time it took
       peers export-lumels SCENE FOLDER
           write the scene as it is given, its lightmap coordinates, and random points of its surfaces with their light
       peers bake-lumels SCENE FOLDER DIRECT INDIRECT SEED
           write the light at these points from lumel's lightmap, noisy and denoised, and print the time it took
       peers read-lumels SCENE FOLDER PAGE ANSWER
           write the light at these points from a page of irradiance, row by row
Scenes: cornell-box, sponza. Places: nodes (all nodes are receivers, some are compared) or surfaces (random points of
the surfaces, all of which are compared). Arrays are of little-endian numbers of four bytes without a header.
";

/// Reflections after the direct light.
const BOUNCES: u32 = 4;
/// What is nearer to a light than this share of the scene's diagonal is right behind it.
const CLOSE: f32 = 0.01;
/// Receivers that are compared.
const SAMPLE: usize = 2000;

fn main() {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["export", scene, places, folder] => export(scene, Places::named(places), Path::new(folder)),
        ["long", scene, places, folder] => long(scene, Places::named(places), Path::new(folder)),
        ["solve", scene, places, folder, direct, indirect, seed] => {
            let places = Places::named(places);
            solve(scene, places, Path::new(folder), settings(places, [direct, indirect, seed]));
        }
        ["export-lumels", scene, folder] => lumels::export(scene, Path::new(folder)),
        ["bake-lumels", scene, folder, direct, indirect, seed] => {
            lumels::bake(scene, Path::new(folder), settings(Places::Surfaces, [direct, indirect, seed]));
        }
        ["read-lumels", scene, folder, page, answer] => lumels::read(scene, Path::new(folder), page, answer),
        _ => println!("{HELP}"),
    }
}

fn settings(places: Places, [direct, indirect, seed]: [&str; 3]) -> Settings {
    Settings {
        direct_samples: direct.parse().unwrap(),
        indirect_samples: indirect.parse().unwrap(),
        seed: seed.parse().unwrap(),
        ..places.settings()
    }
}

fn export(name: &str, places: Places, folder: &Path) {
    let scene = Arc::new(scenes::open(name, places, Detail::Usual));
    let [Light::Rect(light)] = scene.lights() else { panic!("{name} has other lights than one rectangle") };
    let gap = CLOSE * scene.bounds().diagonal();
    let receivers = sites(&places.receivers(&scene));
    let valid = valid_nodes(&scene);
    let to_compare = match places {
        Places::Nodes => valid.clone(),
        Places::Surfaces => (0..receivers.len() as u32).collect(),
    };
    let seen = |i: &u32| !is_behind(light, receivers[*i as usize][0], gap);
    let sample = sample(to_compare.into_iter().filter(seen).collect());
    std::fs::create_dir_all(folder).unwrap();
    let numbers = receivers.iter().flatten().flat_map(|v| v.to_array());
    write(folder, "receivers.f32", numbers.map(f32::to_le_bytes));
    write(folder, "valid.u32", valid.iter().map(|i| i.to_le_bytes()));
    write(folder, "sample.u32", sample.iter().map(|i| i.to_le_bytes()));
    let description = json!({ "valid": valid.len(), "sample": sample.len() });
    describe(name, &scene, description, folder);
}

/// Writes geometry, materials and light, and a description of the scene to which more is added; prints the latter.
fn describe(name: &str, scene: &Scene, mut more: Value, folder: &Path) {
    let [Light::Rect(light)] = scene.lights() else { panic!("{name} has other lights than one rectangle") };
    let triangles = &scene.triangles()[..scene.traced_count()];
    let materials = (0..triangles.len() as u32).map(|tri| scene.material_id(TriId(tri)).0);
    let albedos: Vec<[f32; 3]> =
        scene.materials().iter().map(|material| material.albedo.to_array()).collect();
    write(folder, "positions.f32", scene.positions().iter().flat_map(|p| p.to_array()).map(f32::to_le_bytes));
    write(folder, "triangles.u32", triangles.iter().flatten().map(|i| i.to_le_bytes()));
    write(folder, "materials.u32", materials.map(u32::to_le_bytes));
    let mut description = json!({
        "scene": name, "vertices": scene.vertex_count(), "triangles": triangles.len(), "bounces": BOUNCES,
        "albedos": albedos,
        "light": {
            "center": light.center, "u": light.u, "v": light.v, "radiance": light.radiance.0,
            "normal": light.normal(), "backing": backing(scene, light),
        },
    });
    if let (Some(all), Some(more)) = (description.as_object_mut(), more.as_object_mut()) {
        all.append(more);
    }
    std::fs::write(folder.join("scene.json"), description.to_string()).unwrap();
    println!("{description}");
}

/// The albedo of what lies closely behind a light.
fn backing(scene: &Scene, light: &RectLight) -> Option<[f32; 3]> {
    let hit = Bvh::build(scene).closest_hit(&Ray::new(light.center, -light.normal()?))?;
    (hit.t < CLOSE * scene.bounds().diagonal()).then(|| scene.material(hit.at.tri).albedo.to_array())
}

/// Whether a point is in the gap behind a light. Light passes through a light of lumel, but not through those of others.
fn is_behind(light: &RectLight, point: Vec3, gap: f32) -> bool {
    let from_center = point - light.center;
    let along = |axis: Vec3| (from_center.dot(axis) / axis.length_squared()).abs();
    let height = light.normal().map_or(0.0, |normal| from_center.dot(normal));
    along(light.u) < 1.0 && along(light.v) < 1.0 && (-gap..=0.0).contains(&height)
}

/// Random ones, all different, in random order.
fn sample(mut from: Vec<u32>) -> Vec<u32> {
    let count = SAMPLE.min(from.len()) as u32;
    let choose = |k: u32| {
        let [choice, _] = Sampler::Random.sample_2d(StreamKey::new(11), k, Dim::Area);
        let at = (choice * from.len() as f32) as usize;
        from.swap_remove(at.min(from.len() - 1))
    };
    (0..count).map(choose).collect()
}

/// Nodes of the vertex basis that can be measured at their points.
fn valid_nodes(scene: &Arc<Scene>) -> Vec<u32> {
    let settings = Settings { direct_samples: 1, indirect_samples: 64, ..Places::Nodes.settings() };
    let baker = Baker::new(Arc::clone(scene), settings);
    let valid = solved(&baker).valid;
    (0..valid.len() as u32).filter(|i| valid[*i as usize]).collect()
}

/// Origins and normals.
fn sites(receivers: &PointReceivers) -> Vec<[Vec3; 2]> {
    let site = |e| receivers.central_site(ElementId(e));
    (0..receivers.element_count() as u32).map(site).map(|site| [site.origin, site.frame.normal]).collect()
}

fn solved(baker: &Baker) -> SolveState {
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    state
}

/// All light at the receivers that are compared, gathered with many rays from a long solve on a finer mesh.
fn long(name: &str, places: Places, folder: &Path) {
    let scene = Arc::new(scenes::open(name, places, Detail::Usual));
    let all = sites(&places.receivers(&scene));
    let sample = std::fs::read(folder.join("sample.u32")).unwrap();
    let sample = sample.chunks(4).map(|bytes| u32::from_le_bytes(bytes.try_into().unwrap()));
    let points = PointReceivers::new(&scene, sample.map(|i| all[i as usize].into())).unwrap();
    let fine = Arc::new(scenes::open(name, places, Detail::Fine));
    println!("long solve on {} vertices", fine.vertex_count());
    let long = Settings { direct_samples: 256, indirect_samples: 256, ..places.settings() };
    let baker = Baker::new(Arc::clone(&fine), long.clone());
    let state = solved(&baker);
    let many = Settings { direct_samples: 1 << 14, indirect_samples: 1 << 14, ..long };
    let baker = Baker::with_tracer(fine, Arc::clone(baker.tracer()), many);
    let measured = measure_points(&baker, &state, &points, &Control::default()).unwrap();
    let flat = |values: &[Vec3]| values.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>();
    write(folder, "long.f32", flat(&measured.irradiance).into_iter().map(f32::to_le_bytes));
    write(folder, "long_error.f32", flat(&measured.standard_error).into_iter().map(f32::to_le_bytes));
}

/// Writes the light at all receivers; prints processor time of all threads for the tree, and for the solve.
fn solve(name: &str, places: Places, folder: &Path, settings: Settings) {
    let scene = Arc::new(scenes::open(name, places, Detail::Usual));
    let (direct, indirect) = (settings.direct_samples, settings.indirect_samples);
    let start = ProcessTime::now();
    let tracer: Arc<dyn RayTracer> = Arc::new(Bvh::build(&scene));
    let tree_seconds = start.elapsed().as_secs_f64();
    let start = ProcessTime::now();
    let baker = Baker::with_tracer(Arc::clone(&scene), tracer, settings);
    let values = places.values(&baker, &solved(&baker));
    let seconds = start.elapsed().as_secs_f64();
    let vertices = values.len();
    let numbers = places.read(&scene, values).into_iter().flat_map(|v| v.to_array());
    write(folder, "lumel.f32", numbers.map(f32::to_le_bytes));
    println!(
        "{}",
        json!({
            "direct_samples": direct, "indirect_samples": indirect, "cpu_seconds": seconds,
            "tree_cpu_seconds": tree_seconds, "vertices": vertices,
        })
    );
}

fn write(folder: &Path, name: &str, numbers: impl Iterator<Item = [u8; 4]>) {
    let file: PathBuf = folder.join(name);
    std::fs::write(file, numbers.flatten().collect::<Vec<u8>>()).unwrap();
}
