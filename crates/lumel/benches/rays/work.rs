//! The rays that are traced: from tiles of receivers, in the orders that tracers may want.

use glam::{Vec2, Vec3};
use lumel::{RectLight, Scene};
use lumel_accel::{Ray, SHADOW_END};
use lumel_sample::{Dim, Frame, Sampler, SamplerKind, StreamKey, cosine_hemisphere, uniform_triangle};
use lumel_scene::{Barycentrics, SurfacePoint, TriId};

/// Receivers along the edge of a tile.
const TILE: u32 = 16;
/// Neighbours that are traced together when rays are transposed.
pub(crate) const GROUP: usize = 16;
/// How far receivers start above their plane, metres.
const LIFT: f32 = 1e-3;

/// A point of a tile.
#[derive(Clone, Copy)]
pub(crate) struct Receiver {
    origin: Vec3,
    frame: Frame,
}

/// Square tiles of 16x16 receivers `pitch` metres apart, around random points of the surfaces: every area is as likely
/// as every other. A tile is flat, as the surface is at its centre; receivers follow each other in Morton order.
pub(crate) fn tiles(scene: &Scene, count: u32, pitch: f32) -> Vec<Receiver> {
    let mut sums = Vec::new();
    let mut sum = 0.0;
    for tri in 0..scene.traced_count() as u32 {
        sum += f64::from(scene.area(TriId(tri)));
        sums.push(sum);
    }
    let mut receivers = Vec::new();
    for tile in 0..count {
        let key = StreamKey::new(7).element(tile);
        let [choice, s, t, _] = Sampler::Random.sample_4d(key, 0, Dim::Area);
        let tri = TriId(sums.partition_point(|sum_| *sum_ < f64::from(choice) * sum) as u32);
        let [u, v] = uniform_triangle([s, t]);
        let center = scene.position(SurfacePoint { tri, bary: Barycentrics { u, v } });
        let frame = Frame::from_normal(scene.geometric_normal(tri));
        receivers.extend((0..TILE * TILE).map(|i| {
            let place = Vec2::from(morton(i).map(|k| k as f32 - 0.5 * (TILE - 1) as f32)) * pitch;
            let origin = center + frame.to_world(place.extend(LIFT));
            Receiver { origin, frame }
        }));
    }
    receivers
}

/// Cell `i` of a square grid, in Morton order.
fn morton(i: u32) -> [u32; 2] {
    let even_bits = |i: u32| (0..16).map(|bit| (i >> (2 * bit) & 1) << bit).sum();
    [even_bits(i), even_bits(i >> 1)]
}

/// Rays of all receivers: `per_receiver` from each, one after the other and in Morton order of their sample's cell.
pub(crate) struct Rays {
    /// As the receivers follow each other.
    pub(crate) rays: Vec<Ray>,
    /// In groups of 16 receivers, the same cell of each one after the other.
    pub(crate) transposed: Vec<Ray>,
    /// Directions of `rays`.
    pub(crate) directions: Vec<Vec3>,
    /// How many rays each receiver has.
    pub(crate) per_receiver: usize,
}

impl Rays {
    /// Cosine-distributed rays over the hemisphere, `side²` from each receiver.
    pub(crate) fn hemispheres(receivers: &[Receiver], side: u16) -> Self {
        Self::new(receivers, side, |receiver, u| {
            Ray::new(receiver.origin, receiver.frame.to_world(cosine_hemisphere(u)))
        })
    }

    /// Shadow rays to a rectangle, `side²` from each receiver.
    pub(crate) fn shadows(receivers: &[Receiver], side: u16, light: &RectLight) -> Self {
        Self::new(receivers, side, |receiver, u| Ray::between(receiver.origin, light.point(u)))
    }

    fn new(receivers: &[Receiver], side: u16, ray: impl Fn(&Receiver, [f32; 2]) -> Ray) -> Self {
        let n = u32::from(side) * u32::from(side);
        let per_receiver = n as usize;
        let sampler = SamplerKind::Stratified.for_count(n);
        let of = |(i, receiver): (usize, &Receiver)| {
            let stream = sampler.stream(StreamKey::new(1).element(i as u32), Dim::Hemisphere);
            let point = |k| {
                let [x, y] = morton(k);
                stream.sample_2d(y * u32::from(side) + x)
            };
            (0..n).map(|k| ray(receiver, point(k))).collect::<Vec<_>>()
        };
        let rays: Vec<Ray> = receivers.iter().enumerate().flat_map(of).collect();
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

/// Of answers to shadow rays: the share of blocked rays, and the share of receivers that see a part of the light.
pub(crate) fn shares(occluded: &[bool], per_receiver: usize) -> (f64, f64) {
    let blocked = occluded.iter().filter(|blocked| **blocked).count();
    let receivers = occluded.chunks(per_receiver);
    let n_receivers = receivers.len();
    let mixed = receivers.filter(|of| of.iter().any(|blocked| *blocked != of[0])).count();
    (blocked as f64 / occluded.len() as f64, mixed as f64 / n_receivers as f64)
}

/// How far a tracer's distances may be from another's without being called different.
pub(crate) fn same_distance(a: f32, b: f32) -> bool {
    a == b || (a - b).abs() <= 1e-4 * (1.0 + a.abs())
}

/// A shadow ray ends here.
pub(crate) const SHADOW: f32 = SHADOW_END;
