//! How fast rays are traced, against Embree on the same rays: `cargo x bench rays`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at the first surprise")]

mod embree;
mod machine;
mod rounds;
mod work;

use embree::{Build, Coherence, Embree, Lanes, Tree};
use glam::Vec3;
use lumel::{Bvh, OpenOptions, RayTracer, RectLight, Scene};
use lumel_accel::{Bundle, Hit, InstructionSet, Ray};
use lumel_scene::Radiance;
use rounds::{Rounds, thread_seconds};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use work::{GROUP, Rays, Receiver, SHADOW, same_distance, shares, tiles};

const HELP: &str = "\
usage: cargo x bench rays [--quick] [--json FILE]

Traces the same rays with lumel and with Embree on one thread, in turns, and prints ratios of thread CPU time to
Embree's single ray (fast mode, high build quality). Hemispheres: 256 rays from each receiver of 16x16 tiles, one in
each cell of a grid, 4 cm apart. Shadow rays: 64 from each receiver to a rectangle.

Embree is loaded from the file that LUMEL_EMBREE names; `cargo x bench rays` fetches the wheel `embreex` from PyPI when
it is not set. Without it lumel is measured alone.

  --quick       few rays and rounds
  --json FILE   write the results as JSON too
";

/// Metres between receivers.
const PITCH: f32 = 0.04;

struct Options {
    tiles: u32,
    rounds: usize,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut options, mut json_file) = (Options { tiles: 6, rounds: 7 }, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => options = Options { tiles: 2, rounds: 3 },
            "--json" => json_file = Some(arguments.next().expect("--json needs a file")),
            _ => return println!("{HELP}"),
        }
    }
    println!("{}", machine::describe());
    let embree = load_embree();
    let mut results = Vec::new();
    for (name, subdivide) in [("cornell-box", Some(1)), ("atrium", None), (SPONZA, None)] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../").join(name);
        if name == SPONZA && !file.is_file() {
            println!("\nSponza is left out: no {}", file.display());
            continue;
        }
        let opened = if name == SPONZA { file.to_string_lossy().into_owned() } else { name.to_owned() };
        let open = OpenOptions { subdivide, ..OpenOptions::default() };
        let scene = Arc::new(lumel::open(&opened, &open).unwrap().builder.build().unwrap().0);
        results.push(measure(&scene, embree.as_ref(), &options));
    }
    if let Some(file) = json_file {
        let all = json!({"machine": machine::describe(), "scenes": results});
        std::fs::write(file, serde_json::to_string_pretty(&all).unwrap()).unwrap();
    }
}

const SPONZA: &str = "../shared/scenes/sponza-dabrovic/sponza.obj";

fn load_embree() -> Option<Embree> {
    let Some(file) = std::env::var_os("LUMEL_EMBREE").map(PathBuf::from) else {
        println!("no Embree: LUMEL_EMBREE is not set");
        return None;
    };
    match Embree::load(&file) {
        Ok(embree) => {
            println!("Embree {} from {}", embree.version(), file.file_name()?.to_string_lossy());
            Some(embree)
        }
        Err(error) => {
            println!("no Embree: {}: {error}", file.display());
            None
        }
    }
}

fn measure(scene: &Arc<Scene>, embree: Option<&Embree>, options: &Options) -> Value {
    println!("\n{}: {} triangles", scene.name(), scene.traced_count());
    let build = measure_build(scene, embree, options.rounds);
    let trees: Vec<Bvh> = {
        let tree = Bvh::build(scene);
        let sets = InstructionSet::available().into_iter().rev();
        sets.filter_map(|set| tree.clone().with_instructions(set)).collect()
    };
    let receivers = tiles(scene, options.tiles, PITCH);
    let fast = embree.map(|e| e.build(scene, Build::High).unwrap());
    let robust = embree.map(|e| e.build(scene, Build::HighRobust).unwrap());
    let rays = Rays::hemispheres(&receivers, 16);
    let gather = measure_gather(&trees, fast.as_ref(), robust.as_ref(), &rays, options.rounds);
    let shadows: Vec<Value> = [1.0, 4.0]
        .into_iter()
        .map(|size| measure_shadows(scene, &trees, fast.as_ref(), (&receivers, size), options.rounds))
        .collect();
    json!({
        "scene": scene.name(), "triangles": scene.traced_count(), "build": build, "gather": gather, "shadows": shadows,
    })
}

/// Seconds to build on one thread, in turns.
fn measure_build(scene: &Arc<Scene>, embree: Option<&Embree>, rounds: usize) -> Value {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        ours.push(pool.install(|| thread_seconds(|| drop(Bvh::build(scene)))));
        if let Some(embree) = embree {
            theirs.push(thread_seconds(|| drop(embree.build(scene, Build::Medium).unwrap())));
        }
    }
    let memory = Bvh::build(scene).memory() as f64 / 1e6;
    let seconds = rounds::median(&mut ours);
    if theirs.is_empty() {
        println!("  build {:.1} ms, {memory:.1} MB", seconds * 1e3);
        return json!({"seconds": seconds, "megabytes": memory});
    }
    let of_embree = rounds::median(&mut theirs);
    let held = embree.map_or(0.0, |e| e.build(scene, Build::Medium).unwrap().memory as f64 / 1e6);
    println!(
        "  build {:.1} ms, {memory:.1} MB; Embree medium {:.1} ms, {held:.1} MB: {:.2} times as long",
        seconds * 1e3,
        of_embree * 1e3,
        seconds / of_embree
    );
    json!({
        "seconds": seconds, "megabytes": memory, "embree_medium_seconds": of_embree, "embree_megabytes": held,
        "times_embree": seconds / of_embree,
    })
}

fn measure_gather(
    trees: &[Bvh],
    fast: Option<&Tree<'_>>,
    robust: Option<&Tree<'_>>,
    rays: &Rays,
    n_rounds: usize,
) -> Value {
    let n = rays.rays.len();
    let mut rounds = Rounds::new("hemispheres, 256 rays per receiver", n);
    let (sorted, across) = (Lanes::<16>::pack(&rays.rays), Lanes::<16>::pack(&rays.transposed));
    let mut distances = vec![0.0; n];
    let mut hits: Vec<Option<Hit>> = vec![None; n];
    let mut expected = vec![0.0; n];
    for _ in 0..n_rounds {
        if let Some(tree) = fast {
            rounds.time("Embree 1", || tree.distances(&rays.rays, &mut distances));
            for (coherence, name) in
                [(Coherence::Unknown, "Embree 16"), (Coherence::Coherent, "Embree 16 coherent")]
            {
                rounds.time(&format!("{name}, together"), || {
                    tree.distances_of(&sorted, coherence, &mut distances)
                });
                rounds.time(&format!("{name}, apart"), || {
                    tree.distances_of(&across, coherence, &mut distances)
                });
            }
        }
        if let Some(tree) = robust {
            rounds.time("Embree 1 robust", || tree.distances(&rays.rays, &mut expected));
        }
        for tree in trees.iter().filter(|tree| tree.instructions() != InstructionSet::Portable) {
            let set = tree.instructions();
            rounds.time(&format!("lumel {set}, alone"), || {
                for (ray, hit) in rays.rays.iter().zip(&mut hits) {
                    *hit = tree.closest_hit(ray);
                }
            });
            rounds.time(&format!("lumel {set}, together"), || {
                bundles(rays, |bundle, range| tree.closest_hits(&bundle, &mut hits[range]));
            });
            check(&hits, &expected, robust.is_some());
            rounds.time(&format!("lumel {set}, apart"), || {
                for (rays, hits) in rays.transposed.chunks(GROUP * 16).zip(hits.chunks_mut(GROUP * 16)) {
                    tree.closest_hits_of(rays, hits);
                }
            });
            check(&rays.in_order(&hits), &expected, robust.is_some());
        }
    }
    rounds.print()
}

/// Hands out the rays of each receiver as one bundle.
fn bundles(rays: &Rays, mut trace: impl FnMut(Bundle<'_>, std::ops::Range<usize>)) {
    for first in (0..rays.rays.len()).step_by(rays.per_receiver) {
        let range = first..first + rays.per_receiver;
        let Ray { origin, t_max, skip, .. } = rays.rays[first];
        trace(Bundle { origin, directions: &rays.directions[range.clone()], t_max, skip }, range);
    }
}

/// Embree's robust mode and we must see the same surfaces, but for rays that one of us lets through an edge.
fn check(hits: &[Option<Hit>], expected: &[f32], known: bool) {
    let differs = |(hit, t): (&Option<Hit>, &f32)| !same_distance(hit.map_or(f32::INFINITY, |hit| hit.t), *t);
    let different = hits.iter().zip(expected).filter(|pair| differs(*pair)).count();
    let share = different as f64 / hits.len() as f64;
    assert!(!known || share < 1e-4, "{different} of {} distances differ from Embree's", hits.len());
}

fn measure_shadows(
    scene: &Scene,
    trees: &[Bvh],
    fast: Option<&Tree<'_>>,
    (receivers, size): (&[Receiver], f32),
    n_rounds: usize,
) -> Value {
    let bounds = scene.bounds();
    let (center, extent) = (0.5 * (bounds.min + bounds.max), bounds.max - bounds.min);
    let half = 0.02 * size * extent.max_element();
    let light = RectLight {
        center: center + Vec3::Y * 0.3 * extent.y,
        u: Vec3::X * half,
        v: Vec3::Z * half,
        radiance: Radiance::splat(1.0),
        texture: None,
    };
    let rays = Rays::shadows(receivers, 8, &light);
    let n = rays.rays.len();
    let mut occluded = vec![false; n];
    if let Some(tree) = trees.first() {
        bundles(&rays, |bundle, range| {
            tree.occlusions(&Bundle { t_max: SHADOW, ..bundle }, &mut occluded[range])
        });
    }
    let expected = occluded.clone();
    let (blocked, mixed) = shares(&occluded, rays.per_receiver);
    let title = format!(
        "shadow rays, 64 per receiver, light of {:.2} m: {:.0} % blocked, {:.0} % of the receivers in half-shadow",
        2.0 * half,
        100.0 * blocked,
        100.0 * mixed
    );
    let mut rounds = Rounds::new(&title, n);
    let (sorted, across) = (Lanes::<16>::pack(&rays.rays), Lanes::<16>::pack(&rays.transposed));
    for _ in 0..n_rounds {
        if let Some(tree) = fast {
            rounds.time("Embree 1", || tree.occlusions(&rays.rays, &mut occluded));
            for (coherence, name) in
                [(Coherence::Unknown, "Embree 16"), (Coherence::Coherent, "Embree 16 coherent")]
            {
                rounds.time(&format!("{name}, together"), || {
                    tree.occlusions_of(&sorted, coherence, &mut occluded)
                });
                rounds.time(&format!("{name}, apart"), || {
                    tree.occlusions_of(&across, coherence, &mut occluded)
                });
            }
        }
        for tree in trees.iter().filter(|tree| tree.instructions() != InstructionSet::Portable) {
            let set = tree.instructions();
            rounds.time(&format!("lumel {set}, alone"), || {
                for (ray, blocked) in rays.rays.iter().zip(&mut occluded) {
                    *blocked = tree.occluded(ray);
                }
            });
            assert_eq!(occluded, expected);
            rounds.time(&format!("lumel {set}, together"), || {
                bundles(&rays, |bundle, range| tree.occlusions(&bundle, &mut occluded[range]));
            });
            assert_eq!(occluded, expected);
        }
    }
    rounds.print()
}
