//! The closest hits of hemisphere rays.

use crate::embree::{Coherence, Lanes, Tree};
use crate::race::{self, Method, Order};
use crate::trees::Trees;
use crate::work::{GROUP, Rays};
use lumel::{Bvh, RayTracer};
use lumel_accel::{Bundle, Hit};
use serde_json::Value;

/// Strata of a group that are traced at once, as in a bake.
const BLOCK: usize = 256;

/// Rays as Embree's packets want them, in both orders.
struct Packets<const N: usize> {
    of_receivers: Vec<Lanes<N>>,
    transposed: Vec<Lanes<N>>,
}

impl<const N: usize> Packets<N> {
    fn of(rays: &Rays) -> Self {
        Self { of_receivers: Lanes::pack(&rays.rays), transposed: Lanes::pack(&rays.transposed) }
    }
}

/// Measures all methods and prints them.
pub(crate) fn measure(title: &str, trees: &Trees<'_>, rays: &Rays, rounds: usize) -> Value {
    let (by_8, by_16) = (Packets::<8>::of(rays), Packets::<16>::of(rays));
    let mut methods = Vec::new();
    if let Some(embree) = &trees.embree {
        methods.push(Method::new("Embree 1", Order::Receivers, |d| embree.high.distances(&rays.rays, d)));
        methods.push(Method::new("Embree 1 robust", Order::Receivers, |d| {
            embree.robust.distances(&rays.rays, d);
        }));
        add_packets(&mut methods, "", &embree.high, (&by_8, &by_16));
        add_packets(&mut methods, " robust", &embree.robust, (&by_8, &by_16));
    }
    for (instructions, bvh) in &trees.lumel {
        let name = |how: &str| format!("lumel {instructions}, {how}");
        methods.push(Method::new(name("single rays"), Order::Receivers, |d| single(bvh, rays, d)));
        methods.push(Method::new(name("one origin"), Order::Receivers, |d| one_origin(bvh, rays, d)));
        methods.push(Method::new(name("transposed"), Order::Transposed, |d| transposed(bvh, rays, d)));
    }
    let mut reference = vec![0.0; rays.rays.len()];
    match &trees.embree {
        Some(embree) => embree.robust.distances(&rays.rays, &mut reference),
        None => single(trees.best(), rays, &mut reference),
    }
    let differing = |order, distances: &[f32]| match order {
        Order::Receivers => share_of_different(distances, &reference),
        Order::Transposed => share_of_different(&rays.in_order(distances), &reference),
    };
    let rows = race::race(&methods, rays.rays.len(), rounds, differing);
    race::print(title, &rows);
    race::to_json(&rows)
}

fn add_packets<'a>(
    methods: &mut Vec<Method<'a, f32>>,
    kind: &str,
    tree: &'a Tree<'a>,
    (by_8, by_16): (&'a Packets<8>, &'a Packets<16>),
) {
    for (coherence, told) in [(Coherence::Unknown, ""), (Coherence::Coherent, " coherent")] {
        let name = |lanes: u32, order: &str| format!("Embree {lanes}{kind}{told}, {order}");
        let (tracer_8, tracer_16) = (tree.by_8(coherence), tree.by_16(coherence));
        methods.push(Method::new(name(16, "one origin"), Order::Receivers, move |d| {
            tracer_16.distances(&by_16.of_receivers, d);
        }));
        let tracer_16 = tree.by_16(coherence);
        methods.push(Method::new(name(16, "transposed"), Order::Transposed, move |d| {
            tracer_16.distances(&by_16.transposed, d);
        }));
        methods.push(Method::new(name(8, "transposed"), Order::Transposed, move |d| {
            tracer_8.distances(&by_8.transposed, d);
        }));
    }
}

/// Ray by ray.
pub(crate) fn single(bvh: &Bvh, rays: &Rays, distances: &mut [f32]) {
    for (ray, distance) in rays.rays.iter().zip(distances) {
        *distance = distance_of(&bvh.closest_hit(ray));
    }
}

/// All rays of a receiver at once.
pub(crate) fn one_origin(bvh: &Bvh, rays: &Rays, distances: &mut [f32]) {
    let n = rays.per_receiver;
    let mut hits = vec![None; n];
    for (i, (directions, distances)) in rays.directions.chunks(n).zip(distances.chunks_mut(n)).enumerate() {
        let origin = rays.rays[i * n].origin;
        bvh.closest_hits(&Bundle { origin, directions, t_max: f32::INFINITY, skip: None }, &mut hits);
        distances.iter_mut().zip(&hits).for_each(|(distance, hit)| *distance = distance_of(hit));
    }
}

/// A cell of the hemispheres of 16 neighbours after the other.
pub(crate) fn transposed(bvh: &Bvh, rays: &Rays, distances: &mut [f32]) {
    let n = GROUP * rays.per_receiver.min(BLOCK);
    let mut hits = vec![None; n];
    for (rays, distances) in rays.transposed.chunks(n).zip(distances.chunks_mut(n)) {
        let hits = &mut hits[..rays.len()];
        bvh.closest_hits_of(rays, hits);
        distances.iter_mut().zip(hits).for_each(|(distance, hit)| *distance = distance_of(hit));
    }
}

fn distance_of(hit: &Option<Hit>) -> f32 {
    hit.as_ref().map_or(f32::INFINITY, |hit| hit.t)
}

fn share_of_different(distances: &[f32], reference: &[f32]) -> f64 {
    let same = |(a, b): (&f32, &f32)| a == b || (a - b).abs() <= 1e-4 * (1.0 + a.abs());
    let different = distances.iter().zip(reference).filter(|pair| !same(*pair)).count();
    different as f64 / distances.len() as f64
}
