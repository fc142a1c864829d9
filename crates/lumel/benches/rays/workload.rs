//! A fixed piece of work that is counted by callgrind: `cargo x bench instructions`.

use crate::embree::{Build, Coherence, Embree, Lanes};
use crate::work::{self, Rays};
use crate::{gather, scenes, shadow};
use lumel::Bvh;
use std::hint::black_box;

/// What can be counted: ray by ray and in bundles, Embree's ways for comparison, and building the tree.
const NAMES: [&str; 9] = [
    "gather-single",
    "gather-one-origin",
    "gather-transposed",
    "shadow-single",
    "shadow-one-origin",
    "build",
    "embree-gather-single",
    "embree-gather-transposed",
    "embree-shadow-one-origin",
];

/// Tiles of 256 receivers.
const TILES: usize = 4;

/// Does a piece of work and prints the number of rays, or triangles when building; the names of all without one.
///
/// With the best instructions that the machine has, or claims to have.
pub(crate) fn run(name: &str, embree: Option<&Embree>) -> Result<(), String> {
    if !NAMES.contains(&name) {
        let all = NAMES.iter().filter(|name| embree.is_some() || !name.starts_with("embree"));
        all.for_each(|name| println!("{name}"));
        return Ok(());
    }
    let test = scenes::open("cornell-box")?;
    let scene = &test.scene;
    // On this thread, the one that is counted.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let pool = pool.map_err(|e| e.to_string())?;
    let build = || pool.install(|| Bvh::build(scene));
    let bvh = build();
    let tiles = work::tiles(scene, TILES, test.pitch, |_, _| true);
    let rays = if name.contains("shadow") {
        Rays::shadows(&tiles, crate::SHADOW, &test.lights[0].1)
    } else {
        Rays::hemispheres(&tiles, crate::GATHER)
    };
    let transposed = Lanes::pack(&rays.transposed);
    let packets = Lanes::pack(&rays.rays);
    let tree = embree.map(|e| e.build(scene, Build::High));
    let n_rays = rays.rays.len();
    let (mut distances, mut occluded) = (vec![0.0; n_rays], vec![false; n_rays]);
    let mut work: Box<dyn FnMut() + '_> = match (name, &tree) {
        ("gather-single", _) => Box::new(|| gather::single(&bvh, &rays, &mut distances)),
        ("gather-one-origin", _) => Box::new(|| gather::one_origin(&bvh, &rays, &mut distances)),
        ("gather-transposed", _) => Box::new(|| gather::transposed(&bvh, &rays, &mut distances)),
        ("shadow-single", _) => Box::new(|| shadow::single(&bvh, &rays, &mut occluded)),
        ("shadow-one-origin", _) => Box::new(|| shadow::one_origin(&bvh, &rays, &mut occluded)),
        ("embree-gather-single", Some(tree)) => Box::new(|| tree.distances(&rays.rays, &mut distances)),
        ("embree-gather-transposed", Some(tree)) => {
            Box::new(|| tree.by_16(Coherence::Coherent).distances(&transposed, &mut distances))
        }
        ("embree-shadow-one-origin", Some(tree)) => {
            Box::new(|| tree.by_16(Coherence::Coherent).occlusions(&packets, &mut occluded))
        }
        ("build", _) => Box::new(|| drop(black_box(build()))),
        _ => return Err("Embree is not there".to_owned()),
    };
    counted(&mut *work);
    let n = if name == "build" { scene.traced_count() } else { n_rays };
    println!("{name} {n} {}", bvh.instructions());
    Ok(())
}

/// Callgrind counts between the start and the end of this function, which it finds by name.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}
