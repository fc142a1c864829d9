//! Shots by the area form: receivers connect to points of the surfaces that send light.
//!
//! Where rays are not stored, what a node sends is direct light with its basis function as the light. All nodes together
//! are far more lights than rays can be traced to: a receiver connects to a node as often on average as the node is near
//! and large, and what is connected counts that much more.
//! So a shot of all nodes takes about as many shadow rays as a bounce takes hemisphere rays.
//!
//! Which points these are depends on the node, on the receiver and on nothing else: all shots are parts of one linear
//! operator. Of nodes that are near, compared with their size, triangles are sampled by solid angle, so that no receiver meets
//! the singularity of the distance.

use crate::area_pattern::{AreaChunk, AreaPatterns};
use crate::job::{ChunkSink, Control, Job, TransportError};
use crate::light_view::meet_plane;
use crate::operator::CpuTransport;
use crate::order::CHUNK;
use crate::plan::Plan;
use crate::scatter::scattered;
use crate::shadow_batch::Batch;
use crate::sums::ElementSums;
use crate::supports::{Lamp, Side, Supports};
use crate::{Sums, measure, polygon, trace};
use glam::{DVec3, Vec3, Vec4};
use lumel_basis::{Basis, CENTER, ElementId, Field, NodeId, NodeWeights, Receivers, Sampling, Site};
use lumel_sample::{Dim, SphericalTriangle, StreamKey, cosine_hemisphere_pdf, uniform_triangle, unit_hash};
use lumel_scene::{Barycentrics, Scene};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;

/// A node is near within this many radii of both.
const NEAR: f32 = 3.0;

/// Rays of a bounce for each point of a node, and for each sample of one of its triangles where it is near.
const RAYS_PER_POINT: u32 = 16;

/// Of this many samples that a bounce takes over an area, one is a place that shots connect to.
const SAMPLES_PER_PLACE: u32 = 4;

/// Places of an area at least, and at most before large ones get more.
const PLACES: [u32; 2] = [16, 64];

/// Nodes whose shadow rays are traced together.
const BATCH: usize = 64;

/// Successive multiples of the golden ratio, in 32 bits, are spread evenly, whatever some of them are taken of.
const GOLDEN: u32 = 0x9e37_79b9;

/// What shots need to know of an operator, found when it first shoots.
#[derive(Debug, Default)]
pub(crate) struct Shooting {
    supports: OnceLock<Supports>,
    patterns: OnceLock<AreaPatterns>,
    /// Of each chunk of areas, which places lie outside geometry, element by element.
    outside: OnceLock<Vec<OnceLock<Vec<bool>>>>,
}

/// One shot.
struct Shot<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    lamps: Vec<Lamp>,
    /// Samples of each triangle of a node that is near.
    near_samples: u32,
}

/// An element that receives, with its places outside geometry.
struct Receiver {
    center: Vec3,
    /// How far its places are from that, metres.
    radius: f32,
    /// Of each place, where it stands among all of its chunk.
    places: Vec<(usize, Site)>,
    /// Turns what chooses points, nodes and places.
    turn: u32,
}

impl<B: Basis, R: Receivers> CpuTransport<B, R> {
    /// Measures what some nodes send.
    pub(crate) fn shoot(
        &self,
        job: &Job<'_>,
        (field, nodes): (&Field, &[NodeId]),
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        let corner_nodes = self.basis.corner_nodes().unwrap_or_default();
        let new = || Supports::new(corner_nodes, self.basis.node_count());
        let supports = self.shooting.supports.get_or_init(new);
        let samples = (self.plan.indirect_samples / RAYS_PER_POINT).max(1);
        let of = (&*self.scene, &*self.basis, &self.plan);
        let lamps = supports.lamps(of, (field, nodes), self.plan.sampler.sample_count(samples));
        let shot = Shot { scene: &self.scene, plan: &self.plan, lamps, near_samples: samples };
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            control.check()?;
            let active = self.active(job, chunk);
            let sums = match self.receivers.sampling() {
                Sampling::Point => self.shot_at_points(&shot, &active, control)?,
                Sampling::Area => self.shot_over_areas(&shot, (&active, chunk), control)?,
            };
            control.count(self.elements(chunk).len() as u64, 0);
            sink.accept(chunk, sums);
            Ok(())
        })
    }

    fn shot_at_points(
        &self,
        shot: &Shot<'_>,
        elements: &[ElementId],
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let receiver = |(at, &element): (usize, &ElementId)| {
            Receiver::new(self.turn(element), vec![(at, self.receivers.central_site(element))])
        };
        let receivers: Vec<Receiver> = elements.iter().enumerate().map(receiver).collect();
        let mut values = vec![DVec3::ZERO; elements.len()];
        shot.receive(&*self.tracer, &receivers, &mut values, control)?;
        let (mut sums, mut towards) = (Sums::with_capacity(elements.len()), NodeWeights::default());
        for (&element, value) in elements.iter().zip(values) {
            towards.clear();
            self.receivers.towards(element, CENTER, &mut towards);
            towards.iter().for_each(|(node, weight)| sums.push(node, f64::from(weight), value));
        }
        Ok(sums)
    }

    fn shot_over_areas(
        &self,
        shot: &Shot<'_>,
        (elements, chunk): (&[ElementId], u32),
        control: &Control,
    ) -> Result<Sums, TransportError> {
        let patterns = self.shooting.patterns.get_or_init(|| {
            let [least, most] = PLACES;
            let places = (self.plan.indirect_samples / SAMPLES_PER_PLACE).clamp(least, most);
            AreaPatterns::new(&self.plan, &self.order, 2 * places, self.shared_shot_key())
        });
        let mut sums = ElementSums::some(elements.len());
        // Few enough places for one part.
        for part in patterns.parts(&self.order, chunk) {
            let area = AreaChunk::new(elements, &part, |element| self.shot_key(element));
            let (places, mut all) = (area.pattern.len() as usize, Vec::new());
            let outside = self.outside(&area, chunk, control)?;
            let mut receivers = Vec::with_capacity(elements.len());
            for (i, &element) in elements.iter().enumerate() {
                all.clear();
                self.receivers.sites(element, area.pattern.places(), &mut all);
                let numbered = all.drain(..).enumerate().map(|(number, site)| (i * places + number, site));
                let kept: Vec<_> = numbered.filter(|(at, _)| outside[*at]).collect();
                receivers.push(Receiver::new(self.turn(element), kept));
            }
            let mut values = vec![DVec3::ZERO; elements.len() * places];
            shot.receive(&*self.tracer, &receivers, &mut values, control)?;
            for (i, receiver) in receivers.iter().enumerate() {
                // Each place has connected to its share of the nodes alone.
                let times = receiver.places.len() as f64;
                measure::add_samples::<CHUNK, _, _>(self, &area, &[i], &mut sums, |_, slot| {
                    let at = i * places + area.pattern.number(slot, area.keys[i].1) as usize;
                    if outside[at] { (values[at] * times).as_vec3().extend(1.0) } else { Vec4::ZERO }
                });
            }
        }
        Ok(Sums::of_elements(&sums, false))
    }

    /// Which places of the elements of a chunk lie outside geometry.
    fn outside(
        &self,
        area: &AreaChunk<'_>,
        chunk: u32,
        control: &Control,
    ) -> Result<Vec<bool>, TransportError> {
        let (lanes, places) = (area.elements.len(), area.pattern.len());
        let find = || {
            let ends = trace::over_areas(self, area, control)?;
            let end = |i: usize, number: u32| {
                ends[area.pattern.slot(number, area.keys[i].1) as usize * lanes + i].is_some()
            };
            let numbers = (0..lanes).flat_map(|i| (0..places).map(move |number| (i, number)));
            Ok(numbers.map(|(i, number)| end(i, number)).collect())
        };
        if lanes != self.elements(chunk).len() {
            return find();
        }
        let new = || (0..self.order.chunk_count()).map(|_| OnceLock::new()).collect();
        let slot = &self.shooting.outside.get_or_init(new)[chunk as usize];
        match slot.get() {
            Some(outside) => Ok(outside.clone()),
            None => find().map(|outside| slot.get_or_init(|| outside).clone()),
        }
    }

    fn shared_shot_key(&self) -> StreamKey {
        StreamKey::new(self.plan.seed).bounce(1)
    }

    fn shot_key(&self, element: ElementId) -> StreamKey {
        StreamKey::new(self.plan.seed).element(self.receivers.stream(element)).bounce(1)
    }

    fn turn(&self, element: ElementId) -> u32 {
        let [high, low] = [(self.plan.seed >> 32) as u32, self.plan.seed as u32];
        let half = |k: u32| (unit_hash(&[high, low, self.receivers.stream(element), k]) * 65_536.0) as u32;
        (half(0) << 16) | half(1)
    }
}

impl Receiver {
    fn new(turn: u32, places: Vec<(usize, Site)>) -> Self {
        let center = places.iter().map(|(_, site)| site.origin).sum::<Vec3>() / places.len().max(1) as f32;
        let radius = places.iter().map(|(_, site)| site.origin.distance(center)).fold(0.0, f32::max);
        Self { center, radius, places, turn }
    }

    /// The place that connects to a point.
    fn place(&self, number: u32) -> &(usize, Site) {
        let turned = number.wrapping_mul(GOLDEN).wrapping_add(self.turn.rotate_left(16));
        &self.places[((u64::from(turned) * self.places.len() as u64) >> 32) as usize]
    }
}

impl Shot<'_> {
    /// Adds to `values`, by place, what arrives at each of the receivers.
    fn receive(
        &self,
        tracer: &dyn lumel_accel::RayTracer,
        receivers: &[Receiver],
        values: &mut [DVec3],
        control: &Control,
    ) -> Result<(), TransportError> {
        let mut batch = Batch::default();
        let mut n_rays = 0;
        for lamps in self.lamps.chunks(BATCH) {
            control.check()?;
            for receiver in receivers.iter() {
                batch.begin_element();
                if receiver.places.is_empty() {
                    continue;
                }
                for (slot, lamp) in (0..).zip(lamps) {
                    let distance = receiver.center.distance(lamp.center);
                    if distance < NEAR * (lamp.radius + receiver.radius) {
                        self.add_near(&mut batch, receiver, lamp, slot);
                    } else {
                        self.add_far(&mut batch, receiver, (lamp, distance), slot);
                    }
                }
            }
            n_rays += batch.trace(tracer, |_, at, value, passed| values[at] += value * passed.as_dvec3());
        }
        control.count(0, n_rays as u64);
        Ok(())
    }

    /// How often a receiver connects to a node at this distance on average: as often as the rays of a bounce would meet it,
    /// if it were seen straight ahead.
    fn connections(&self, lamp: &Lamp, distance: f32) -> f32 {
        let rays_per_steradian = self.plan.indirect_samples as f32 * cosine_hemisphere_pdf(1.0);
        rays_per_steradian * lamp.area / (distance * distance)
    }

    #[inline]
    fn add_far(&self, batch: &mut Batch, receiver: &Receiver, (lamp, distance): (&Lamp, f32), slot: u32) {
        let times = self.connections(lamp, distance);
        let chance = lamp.node.0.wrapping_mul(GOLDEN).wrapping_add(receiver.turn) as f32 / 4_294_967_296.0;
        let n = (times + chance).floor();
        for k in 0..n as u32 {
            let number = k.wrapping_add(receiver.turn >> 8);
            let (at, site) = receiver.place(lamp.node.0.wrapping_add(k));
            if let Some((target, value)) = lamp.far(number, site.origin, site.frame.normal) {
                batch.add(site, target, (slot, *at), (value / times).as_dvec3());
            }
        }
    }

    fn add_near(&self, batch: &mut Batch, receiver: &Receiver, lamp: &Lamp, slot: u32) {
        let samples = self.near_samples;
        let key = StreamKey::new(self.plan.seed).element(lamp.node.0).bounce(1);
        let turned =
            [receiver.turn, receiver.turn.wrapping_mul(GOLDEN)].map(|turn| turn as f32 / 4_294_967_296.0);
        for (t, side) in (0u32..).zip(&lamp.sides) {
            let stream = self.plan.sampler.for_count(samples).stream(key.pass(t), Dim::Hemisphere);
            for k in 0..samples {
                let (at, site) = receiver.place(lamp.node.0.wrapping_add(t * samples + k));
                let sample = stream.sample_2d(k);
                let u = [0, 1].map(|i| (sample[i] + turned[i]).fract());
                if let Some((target, value)) = self.near(lamp, side, site, u) {
                    batch.add(site, target, (slot, *at), value.as_dvec3() / f64::from(samples));
                }
            }
        }
    }

    /// What arrives from one point of a triangle, which stands for all of the triangle.
    fn near(&self, lamp: &Lamp, side: &Side, site: &Site, u: [f32; 2]) -> Option<(Vec3, Vec3)> {
        let (place, normal) = (site.origin, site.frame.normal);
        if !polygon::is_lit(&side.corners, place, normal) {
            return None;
        }
        let [a, b, c] = side.corners;
        // The projected solid angle that the point stands for, sr.
        let (point, bary, projected) = match SphericalTriangle::new(a, b, c, place) {
            Some(triangle) => {
                let (point, bary) = meet_plane(place, triangle.sample(u), &side.corners)?;
                let cos = normal.dot((point - place).try_normalize()?);
                (point, bary, cos * triangle.solid_angle() as f32)
            }
            None => {
                let bary = Barycentrics::from(uniform_triangle(u));
                let [x, y, z] = bary.weights();
                let point = a * x + b * y + c * z;
                let to_lamp = point - place;
                let cosines = normal.dot(to_lamp) * -side.normal.dot(to_lamp);
                let squared = to_lamp.length_squared().max(f32::MIN_POSITIVE);
                (point, bary, cosines * self.scene.area(side.tri) / (squared * squared))
            }
        };
        let value = lamp.radiance_on(self.scene, side, bary) * projected;
        (projected > 0.0 && value.is_finite()).then(|| (side.target(point), value))
    }
}
