//! The occlusion of shadow rays to a rectangle light.

use crate::embree::{Coherence, Lanes};
use crate::race::{self, Method, Order};
use crate::trees::Trees;
use crate::work::Rays;
use lumel::{Bvh, RayTracer};
use lumel_accel::{Bundle, SHADOW_END};
use serde_json::{Value, json};

/// Measures all methods and prints them.
pub(crate) fn measure(title: &str, trees: &Trees<'_>, rays: &Rays, rounds: usize) -> Value {
    let packets: Vec<Lanes<16>> = Lanes::pack(&rays.rays);
    let transposed: Vec<Lanes<16>> = Lanes::pack(&rays.transposed);
    let (packets, transposed) = (&packets, &transposed);
    let mut methods = Vec::new();
    if let Some(embree) = &trees.embree {
        methods.push(Method::new("Embree 1", Order::Receivers, |o| embree.high.occlusions(&rays.rays, o)));
        methods.push(Method::new("Embree 1 robust", Order::Receivers, |o| {
            embree.robust.occlusions(&rays.rays, o);
        }));
        for (coherence, told) in [(Coherence::Unknown, ""), (Coherence::Coherent, " coherent")] {
            let tracer = embree.high.by_16(coherence);
            let name = format!("Embree 16{told}, one origin");
            methods.push(Method::new(name, Order::Receivers, move |o: &mut [bool]| {
                tracer.occlusions(packets, o)
            }));
            let tracer = embree.high.by_16(coherence);
            let name = format!("Embree 16{told}, transposed");
            methods.push(Method::new(name, Order::Transposed, move |o| tracer.occlusions(transposed, o)));
        }
    }
    for (instructions, bvh) in &trees.lumel {
        let name = |how: &str| format!("lumel {instructions}, {how}");
        methods.push(Method::new(name("single rays"), Order::Receivers, |o| single(bvh, rays, o)));
        methods.push(Method::new(name("one origin"), Order::Receivers, |o| one_origin(bvh, rays, o)));
        methods.push(Method::new(name("transposed"), Order::Transposed, |o| {
            bvh.occlusions_of(&rays.transposed, o);
        }));
    }
    let mut reference = vec![false; rays.rays.len()];
    match &trees.embree {
        Some(embree) => embree.robust.occlusions(&rays.rays, &mut reference),
        None => single(trees.best(), rays, &mut reference),
    }
    let share = |a: &[bool]| a.iter().zip(&reference).filter(|(a, b)| a != b).count() as f64 / a.len() as f64;
    let differing = |order, answers: &[bool]| match order {
        Order::Receivers => share(answers),
        Order::Transposed => share(&rays.in_order(answers)),
    };
    let rows = race::race(&methods, rays.rays.len(), rounds, differing);
    let (blocked, mixed) = shares(&reference, rays.per_receiver);
    let percent = |share: f64| share * 100.0;
    let light = format!("{:.0} % blocked, {:.0} % partly lit", percent(blocked), percent(mixed));
    race::print(&format!("{title} ({light})"), &rows);
    json!({"blocked": blocked, "partly_lit": mixed, "methods": race::to_json(&rows)})
}

/// Ray by ray.
pub(crate) fn single(bvh: &Bvh, rays: &Rays, occluded: &mut [bool]) {
    for (ray, occluded) in rays.rays.iter().zip(occluded) {
        *occluded = bvh.occluded(ray);
    }
}

/// All rays of a receiver at once.
pub(crate) fn one_origin(bvh: &Bvh, rays: &Rays, occluded: &mut [bool]) {
    let n = rays.per_receiver;
    for (i, (directions, occluded)) in rays.directions.chunks(n).zip(occluded.chunks_mut(n)).enumerate() {
        let origin = rays.rays[i * n].origin;
        bvh.occlusions(&Bundle { origin, directions, t_max: SHADOW_END, skip: None }, occluded);
    }
}

/// The share of blocked rays, and the share of receivers that see a part of the light but not all.
fn shares(occluded: &[bool], per_receiver: usize) -> (f64, f64) {
    let blocked = occluded.iter().filter(|blocked| **blocked).count();
    let receivers = occluded.chunks(per_receiver);
    let n_receivers = receivers.len();
    let mixed = receivers.filter(|of| of.iter().any(|blocked| *blocked != of[0])).count();
    (blocked as f64 / occluded.len() as f64, mixed as f64 / n_receivers as f64)
}
