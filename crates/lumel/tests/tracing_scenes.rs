//! Every way to trace a ray against brute force, on whole scenes.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::Vec3;
use lumel::{Bvh, OpenOptions, RayTracer, Scene};
use lumel_accel::{BruteForce, Bundle, Hit, InstructionSet, Ray, SHADOW_END};
use lumel_basis::{ElementId, PointReceivers, Receivers, Site, VertexBasis};
use lumel_sample::{CellOrder, Dim, SamplerKind, StreamKey, cosine_hemisphere};
use lumel_testkit::shared;
use std::sync::Arc;

const RAYS: u32 = 64;

/// Neighbours in the list of vertices, some of which lie in the plane of walls and in corners.
fn sites(receivers: &PointReceivers, first: u32) -> Vec<Site> {
    let n = receivers.element_count() as u32;
    (0..16).map(|i| receivers.central_site(ElementId((first + i) % n))).collect()
}

fn assert_all_ways(scene: &Arc<Scene>, groups: u32) {
    let brute = BruteForce::new(scene);
    let receivers = PointReceivers::at_vertices(&Arc::new(VertexBasis::new(Arc::clone(scene))));
    let tree = Bvh::build(scene);
    let trees: Vec<Bvh> = InstructionSet::available()
        .into_iter()
        .filter_map(|set| tree.clone().with_instructions(set))
        .collect();
    println!("{}: {:?}", scene.name(), InstructionSet::available());
    let mut cells = CellOrder::default();
    let mut n_hits = 0;
    for group in 0..groups {
        let sites = sites(&receivers, group * (receivers.element_count() as u32 / groups));
        let directions: Vec<Vec<Vec3>> = (0u32..)
            .zip(&sites)
            .map(|(i, site)| {
                let stream = SamplerKind::Sobol.for_count(RAYS);
                let stream = stream.stream(StreamKey::new(7).element(16 * group + i), Dim::Hemisphere);
                let points = cells.points(&stream, RAYS);
                points.iter().map(|&u| site.frame.to_world(cosine_hemisphere(u))).collect()
            })
            .collect();
        let ray = |i: usize, k: usize, t_max: f32| Ray {
            origin: sites[i].origin,
            direction: directions[i][k],
            t_max,
            skip: sites[i].skip,
        };
        // All rays of the first site, and the first few of all of them.
        let whole: Vec<Option<Hit>> =
            (0..RAYS as usize).map(|k| brute.closest_hit(&ray(0, k, f32::INFINITY))).collect();
        n_hits += whole.iter().flatten().count();
        let across: Vec<Ray> = (0..2)
            .flat_map(|k| (0..16).map(move |i| (i, k)))
            .map(|(i, k)| ray(i, k, f32::INFINITY))
            .collect();
        let of_across: Vec<Option<Hit>> = across.iter().map(|ray| brute.closest_hit(ray)).collect();
        for tree in &trees {
            let set = tree.instructions();
            let bundle = Bundle {
                origin: sites[0].origin,
                directions: &directions[0],
                t_max: f32::INFINITY,
                skip: sites[0].skip,
            };
            let mut hits = vec![None; RAYS as usize];
            tree.closest_hits(&bundle, &mut hits);
            assert_eq!(hits, whole, "{set}, together");
            let alone: Vec<_> = (0..RAYS as usize).map(|k| tree.closest_hit(&bundle.ray(k))).collect();
            assert_eq!(alone, whole, "{set}, alone");
            let mut hits = vec![None; across.len()];
            tree.closest_hits_of(&across, &mut hits);
            assert_eq!(hits, of_across, "{set}, apart");
            // Shadow rays to where these went, and half as far again.
            let t_max = whole.iter().flatten().map(|hit| hit.t).fold(0.0, f32::max) * 0.7 * SHADOW_END;
            let shadows = Bundle { t_max, ..bundle };
            let mut blocked = vec![false; RAYS as usize];
            tree.occlusions(&shadows, &mut blocked);
            let expected: Vec<bool> = whole.iter().map(|hit| hit.is_some_and(|hit| hit.t < t_max)).collect();
            assert_eq!(blocked, expected, "{set}, shaft");
        }
    }
    assert!(n_hits > 10 * groups as usize, "{n_hits}");
}

fn open(name: &str) -> Arc<Scene> {
    Arc::new(lumel::open(name, &OpenOptions::default()).unwrap().builder.build().unwrap().0)
}

#[test]
fn the_cornell_box_is_met_alike_in_every_way() {
    assert_all_ways(&open("cornell-box"), 24);
}

#[test]
fn the_atrium_is_met_alike_in_every_way() {
    assert_all_ways(&open("atrium"), 12);
}

#[test]
fn sponza_is_met_alike_in_every_way() {
    let Some(file) = shared::path_or_skip("scenes/sponza-dabrovic/sponza.obj") else { return };
    assert_all_ways(&open(&file.to_string_lossy()), 12);
}
