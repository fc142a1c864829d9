//! How fast rays are traced, against Embree 4: `cargo x bench rays`.
//!
//! All methods trace the same rays in one process, in turn, on one thread; times are processor time of that thread.
//! Rays lie ready in memory: Embree's single rays and ours as a list of rays, Embree's packets as arrays of their
//! coordinates. The timed part copies them into Embree's structs, or hands them to our tracer's interface, and writes
//! all distances or answers into one list.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(clippy::expect_used, reason = "a benchmark may stop at the first surprise")]

mod embree;
mod gather;
mod machine;
mod race;
mod scaling;
mod scenes;
mod shadow;
mod trees;
mod work;
mod workload;

use embree::Embree;
use glam::Vec3;
use serde_json::{Value, json};
use std::path::Path;
use trees::Trees;
use work::Rays;

const HELP: &str = "\
usage: cargo x bench rays [--quick] [--scene NAME]... [--rounds N] [--json FILE]

Traces hemisphere rays (256 from each of 4096 receivers) and shadow rays (64 to an area light that they face) with Embree 4 and with
lumel's tracer, single and in bundles, and prints rays per second, the ratio to Embree's single rays (median, lowest
and highest of the rounds) and the share of answers that differ from Embree's robust mode; then times to build a tree,
its memory, and how a solve gains from threads. \"one origin\" bundles the rays of a receiver, \"transposed\" the rays
of 16 neighbours through one cell of their hemispheres. Embree comes from the file that LUMEL_EMBREE names; without it
lumel is measured alone.

  --quick        a quarter of the receivers, 3 rounds
  --scene NAME   only cornell-box, atrium or sponza
  --rounds N     rounds of each race, 7 if not given
  --json FILE    write the results as JSON too
";

/// Rays of a hemisphere.
const GATHER: u32 = 256;
/// Rays to a light.
const SHADOW: u32 = 64;

struct Options {
    scenes: Vec<&'static str>,
    tiles: usize,
    rounds: usize,
    json: Option<String>,
}

fn main() {
    if let Some(name) = workload() {
        let embree = std::env::var_os("LUMEL_EMBREE").and_then(|file| Embree::load(Path::new(&file)).ok());
        return workload::run(&name, embree.as_ref()).expect("the scene is built in");
    }
    let Some(options) = options() else { return println!("{HELP}") };
    let machine = machine::describe();
    println!("{}", machine::line(&machine));
    let embree = load_embree();
    let mut results = Vec::new();
    for name in &options.scenes {
        match measure(name, embree.as_ref(), &options) {
            Ok(result) => results.push(result),
            Err(reason) => println!("\n{name}: left out, {reason}"),
        }
    }
    if let Some(file) = options.json {
        let embree = embree.as_ref().map(Embree::version);
        let all = json!({"machine": machine, "embree": embree, "scenes": results});
        let text = serde_json::to_string_pretty(&all).expect("numbers and names can be written");
        std::fs::write(&file, text).expect("the file can be written");
    }
}

/// The piece of work after `--workload`, which is not measured here.
fn workload() -> Option<String> {
    std::env::args().skip_while(|argument| argument != "--workload").nth(1)
}

fn options() -> Option<Options> {
    let mut options = Options { scenes: scenes::NAMES.to_vec(), tiles: 16, rounds: 7, json: None };
    // Cargo adds --bench.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let mut chosen = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => (options.tiles, options.rounds) = (4, 3),
            "--scene" => {
                let name = arguments.next()?;
                chosen.push(scenes::NAMES.into_iter().find(|known| *known == name)?);
            }
            "--rounds" => options.rounds = arguments.next()?.parse().ok().filter(|n| *n > 0)?,
            "--json" => options.json = Some(arguments.next()?),
            _ => return None,
        }
    }
    if !chosen.is_empty() {
        options.scenes = chosen;
    }
    Some(options)
}

fn load_embree() -> Option<Embree> {
    let Some(file) = std::env::var_os("LUMEL_EMBREE") else {
        println!("without Embree: LUMEL_EMBREE names no library; `cargo x bench rays` sets it");
        return None;
    };
    match Embree::load(Path::new(&file)) {
        Ok(embree) => {
            println!("Embree {}", embree.version());
            Some(embree)
        }
        Err(error) => {
            println!("without Embree: {error}");
            None
        }
    }
}

fn measure(name: &'static str, embree: Option<&Embree>, options: &Options) -> Result<Value, String> {
    let test = scenes::open(name)?;
    let (scene, rounds) = (&test.scene, options.rounds);
    println!("\n{}: {} vertices, {} triangles", test.name, scene.vertex_count(), scene.traced_count());
    let trees = Trees::build(scene, embree);
    let tiles = work::tiles(scene, options.tiles, test.pitch, |_, _| true);
    let vertices = work::vertices(scene, options.tiles);
    let rays = Rays::hemispheres(&tiles, GATHER);
    let in_tiles = gather::measure("hemispheres of receivers in tiles", &trees, &rays, rounds);
    let rays = Rays::hemispheres(&vertices, GATHER);
    let of_vertices = gather::measure("hemispheres of vertices", &trees, &rays, rounds);
    let shadows = test.lights.iter().map(|(name, light)| {
        // A bake asks only where surface and light face each other.
        let facing = light.u.cross(light.v);
        let lit = |center: Vec3, normal: Vec3| {
            let to_light = light.center - center;
            normal.dot(to_light) > 0.0 && facing.dot(to_light) < 0.0
        };
        let tiles = work::tiles(scene, options.tiles, test.pitch, lit);
        let rays = Rays::shadows(&tiles, SHADOW, light);
        let result = shadow::measure(&format!("shadows of {name}"), &trees, &rays, rounds);
        ((*name).to_owned(), result)
    });
    let shadows: serde_json::Map<String, Value> = shadows.collect();
    Ok(json!({
        "scene": test.name, "vertices": scene.vertex_count(), "triangles": scene.traced_count(),
        "gather_tiles": in_tiles, "gather_vertices": of_vertices, "shadows": shadows,
        "build": trees::measure(scene, embree, rounds),
        "scaling": scaling::measure(scene, rounds.min(5)),
    }))
}
