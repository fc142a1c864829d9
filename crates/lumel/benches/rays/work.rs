//! The rays that are traced: from neighbouring receivers, in the orders that tracers may want.

use glam::{Vec2, Vec3};
use lumel::{RectLight, SamplerKind, Scene};
use lumel_accel::Ray;
use lumel_basis::{ElementId, PointReceivers, Receivers, VertexBasis};
use lumel_sample::{CellOrder, Dim, Frame, Sampler, StreamKey, cosine_hemisphere, uniform_triangle};
use lumel_scene::{SurfacePoint, TriId};
use std::sync::Arc;

/// Receivers along the edge of a tile.
const TILE: u32 = 16;
/// Receivers of a tile, and of a run of vertices.
const RUN: usize = (TILE * TILE) as usize;
/// Neighbours that are traced together when rays are transposed.
pub(crate) const GROUP: usize = 16;
/// Places that are tried for tiles.
const TRIES: u32 = 100_000;
/// How far the receivers of a tile start above it, as a share of their distance.
const LIFT: f32 = 0.025;

/// A point that rays start from, and the hemisphere above it.
#[derive(Clone, Copy)]
pub(crate) struct Receiver {
    origin: Vec3,
    frame: Frame,
}

/// Square tiles of 16x16 receivers `pitch` metres apart, around random points of the surfaces: every area is as likely
/// as every other. A tile is flat, as the surface is at its centre; its receivers follow each other in Morton order.
///
/// Only where a centre and its normal are `wanted`.
pub(crate) fn tiles(
    scene: &Scene,
    count: usize,
    pitch: f32,
    wanted: impl Fn(Vec3, Vec3) -> bool,
) -> Vec<Receiver> {
    let mut sums = Vec::new();
    let mut sum = 0.0;
    for tri in 0..scene.traced_count() as u32 {
        sum += f64::from(scene.area(TriId(tri)));
        sums.push(sum);
    }
    let place = |number: u32| {
        let [choice, s, t, _] = Sampler::Random.sample_4d(StreamKey::new(7).element(number), 0, Dim::Area);
        let tri = TriId(sums.partition_point(|below| *below < f64::from(choice) * sum) as u32);
        let center = scene.position(SurfacePoint { tri, bary: uniform_triangle([s, t]).into() });
        (center, scene.geometric_normal(tri))
    };
    let tile = |(center, normal): (Vec3, Vec3)| {
        let frame = Frame::from_normal(normal);
        (0..TILE * TILE).map(move |i| {
            let place = Vec2::from(morton(i).map(|k| k as f32 - 0.5 * (TILE - 1) as f32));
            Receiver { origin: center + frame.to_world(place.extend(LIFT)) * pitch, frame }
        })
    };
    let places = (0..TRIES).map(place).filter(|(center, normal)| wanted(*center, *normal));
    places.take(count).flat_map(tile).collect()
}

/// Cell `i` of a square grid, in Morton order.
fn morton(i: u32) -> [u32; 2] {
    let even_bits = |i: u32| (0..16).map(|bit| (i >> (2 * bit) & 1) << bit).sum();
    [even_bits(i), even_bits(i >> 1)]
}

/// Runs of 256 vertices that follow each other in the order of a bake: by the axis they face, then along a Morton
/// curve through space.
pub(crate) fn vertices(scene: &Arc<Scene>, runs: usize) -> Vec<Receiver> {
    let receivers = PointReceivers::at_vertices(&Arc::new(VertexBasis::new(Arc::clone(scene))));
    let bounds = scene.bounds();
    let site = |e: u32| receivers.central_site(ElementId(e));
    let mut sorted: Vec<(u64, Receiver)> = (0..receivers.element_count() as u32)
        .map(|e| {
            let Receiver { origin, frame } = Receiver { origin: site(e).origin, frame: site(e).frame };
            let axis = frame.normal.abs().max_position();
            let facing = 2 * axis + usize::from(frame.normal[axis] < 0.0);
            let cell = (origin - bounds.min) / bounds.diagonal() * 65535.0;
            let code =
                |axis: usize| (0..16).map(move |bit| (cell[axis] as u64 >> bit & 1) << (3 * bit + axis));
            let place: u64 = (0..3).flat_map(code).sum();
            ((facing as u64) << 48 | place, Receiver { origin, frame })
        })
        .collect();
    sorted.sort_by_key(|(place, _)| *place);
    let last = sorted.len().saturating_sub(RUN);
    let start = |run: usize| last * run / runs.max(2).saturating_sub(1);
    (0..runs).flat_map(|run| sorted[start(run)..].iter().take(RUN).map(|(_, r)| *r)).collect()
}

/// Rays of all receivers: `per_receiver` from each, in the order of the cells of their samples.
pub(crate) struct Rays {
    /// As the receivers follow each other.
    pub(crate) rays: Vec<Ray>,
    /// In groups of 16 receivers: the first ray of each, the second of each and so on.
    pub(crate) transposed: Vec<Ray>,
    /// Directions of `rays`.
    pub(crate) directions: Vec<Vec3>,
    /// How many rays each receiver has.
    pub(crate) per_receiver: usize,
}

impl Rays {
    /// Cosine-distributed rays over the hemisphere.
    pub(crate) fn hemispheres(receivers: &[Receiver], per_receiver: u32) -> Self {
        Self::new(receivers, per_receiver, |receiver, u| {
            Ray::new(receiver.origin, receiver.frame.to_world(cosine_hemisphere(u)))
        })
    }

    /// Shadow rays to points of a rectangle.
    pub(crate) fn shadows(receivers: &[Receiver], per_receiver: u32, light: &RectLight) -> Self {
        Self::new(receivers, per_receiver, |receiver, u| Ray::between(receiver.origin, light.point(u)))
    }

    fn new(receivers: &[Receiver], n: u32, ray: impl Fn(&Receiver, [f32; 2]) -> Ray) -> Self {
        let mut cells = CellOrder::default();
        let mut rays = Vec::with_capacity(receivers.len() * n as usize);
        for (i, receiver) in receivers.iter().enumerate() {
            let key = StreamKey::new(1).element(i as u32);
            let stream = SamplerKind::Sobol.for_count(n).stream(key, Dim::Hemisphere);
            rays.extend(cells.points(&stream, n).iter().map(|&u| ray(receiver, u)));
        }
        let per_receiver = n as usize;
        let transposed = (0..rays.len()).map(|i| rays[untransposed(i, per_receiver)]).collect();
        let directions = rays.iter().map(|ray| ray.direction).collect();
        Self { rays, transposed, directions, per_receiver }
    }

    /// Puts answers in transposed order into the order of receivers.
    pub(crate) fn in_order<T: Copy>(&self, transposed: &[T]) -> Vec<T> {
        let mut ordered = transposed.to_vec();
        for (i, answer) in transposed.iter().enumerate() {
            ordered[untransposed(i, self.per_receiver)] = *answer;
        }
        ordered
    }
}

/// Where ray `i` of the transposed order is in the order of receivers.
fn untransposed(i: usize, per_receiver: usize) -> usize {
    let (group, rest) = (i / (GROUP * per_receiver), i % (GROUP * per_receiver));
    let (cell, member) = (rest / GROUP, rest % GROUP);
    (group * GROUP + member) * per_receiver + cell
}
