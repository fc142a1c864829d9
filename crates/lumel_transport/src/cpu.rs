//! The operator on all cores of this machine.

use crate::direct::{Direct, Tally};
use crate::gather::{GROUP, Gather};
use crate::hemisphere::{self, Seen};
use crate::job::{Cancelled, ChunkSink, ChunkSums, Control, Job, NodeSum, Shape, Source, Transport};
use crate::light_points::LightPoints;
use crate::lights::LightSet;
use crate::order::Order;
use crate::plan::Plan;
use crate::rows::End;
use crate::scatter::scattered;
use glam::DVec3;
use lumel_accel::RayTracer;
use lumel_basis::{Basis, ElementId, Measure, NodeWeights, Receivers, Site};
use lumel_sample::{CellOrder, Dim, Sampler, Stream, StreamKey};
use lumel_scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Elements per chunk: few enough to spread over cores and to stop quickly, and neighbours that trace rays together.
pub(crate) const CHUNK: usize = GROUP;

/// Rays that decide whether an element lies inside geometry.
pub(crate) const OPENNESS_RAYS: u32 = 64;

/// Rays that decide whether an origin on an area lies inside geometry, and how many must meet the back of a surface:
/// three quarters, which an origin that sees backs in a third of its hemisphere reaches once in fifty times.
const INSIDE_RAYS: u32 = 8;
const INSIDE_BACKS: usize = 6;

/// Measures the elements of `R` under light that is stored in the basis `B`, usually the same.
///
/// Runs on the threads of the caller's rayon pool.
pub struct CpuTransport<B, R = B> {
    pub(crate) scene: Arc<Scene>,
    tracer: Arc<dyn RayTracer>,
    pub(crate) source: Arc<B>,
    pub(crate) receivers: Arc<R>,
    pub(crate) lights: Arc<LightSet>,
    pub(crate) plan: Plan,
    /// The elements in the order of chunks.
    order: Order,
    /// Whether these are all elements.
    pub(crate) is_whole: bool,
}

impl<B: Basis, R: Receivers> CpuTransport<B, R> {
    /// The operator of a scene.
    pub fn new(
        scene: Arc<Scene>,
        tracer: Arc<dyn RayTracer>,
        source: Arc<B>,
        receivers: Arc<R>,
        plan: Plan,
    ) -> Self {
        let order = Order::new(&*receivers);
        Self::in_order(scene, tracer, source, (receivers, order), plan)
    }

    /// The operator of a scene, measuring receivers whose order there is already.
    pub fn in_order(
        scene: Arc<Scene>,
        tracer: Arc<dyn RayTracer>,
        source: Arc<B>,
        (receivers, order): (Arc<R>, Order),
        plan: Plan,
    ) -> Self {
        let lights = Arc::new(LightSet::new(&scene, plan.emitters));
        Self { scene, tracer, source, receivers, lights, plan, order, is_whole: true }
    }

    /// The same operator with other samples, for the elements alone that count towards one of certain nodes.
    ///
    /// All else is shared, and so `plan.emitters` has no effect. Nodes beside those asked for may be measured in part.
    pub fn with_samples(&self, plan: Plan, nodes: &[bool]) -> Self {
        let order: Order = self.elements_towards(nodes).collect();
        Self {
            scene: Arc::clone(&self.scene),
            tracer: Arc::clone(&self.tracer),
            source: Arc::clone(&self.source),
            receivers: Arc::clone(&self.receivers),
            lights: Arc::clone(&self.lights),
            plan,
            is_whole: self.is_whole && order.elements().len() == self.order.elements().len(),
            order,
        }
    }

    /// The elements that count towards one of certain nodes.
    pub(crate) fn elements_towards(&self, nodes: &[bool]) -> impl Iterator<Item = ElementId> {
        let mut towards = NodeWeights::default();
        self.order.elements().iter().copied().filter(move |&element| {
            towards.clear();
            self.receivers.receiver(element, [0.5, 0.5], &mut towards);
            towards.iter().any(|(node, _)| nodes[node.index()])
        })
    }

    /// The elements of a chunk.
    pub(crate) fn elements(&self, chunk: u32) -> &[ElementId] {
        let first = chunk as usize * CHUNK;
        let order = self.order.elements();
        &order[first..order.len().min(first + CHUNK)]
    }

    pub(crate) fn tracer(&self) -> &dyn RayTracer {
        &*self.tracer
    }

    /// Origins and directions of so many of an area's hemisphere rays.
    pub(crate) fn area_stream(&self, samples: u32, key: StreamKey) -> Stream {
        self.plan.stream(samples, key, Dim::Area)
    }

    /// What a site sees in one direction.
    #[inline]
    fn see(&self, site: &Site, u: [f32; 2]) -> Seen {
        let hit = self.tracer.closest_hit(&hemisphere::ray(site, hemisphere::direction(site, u)));
        Seen::new(&self.scene, hit)
    }

    /// Whether a site of which one ray has met the back of a surface lies inside geometry; traces [`INSIDE_RAYS`].
    ///
    /// Inside a closed solid all rays do. One ray alone must not decide: in front of a one-sided wall that shows its
    /// back, leaving out what is dark would make the rest too bright.
    fn is_inside(&self, site: &Site, key: StreamKey) -> bool {
        let stream = Sampler::Sobol.stream(key, Dim::Validity);
        let met_back = |i: &u32| matches!(self.see(site, stream.sample_2d(*i)), Seen::Back);
        (0..INSIDE_RAYS).filter(met_back).count() >= INSIDE_BACKS
    }

    /// Traces the hemisphere rays of an area.
    pub(crate) fn trace_area(
        &self,
        element: ElementId,
        key: StreamKey,
        ends: &mut [End],
        control: &Control,
    ) -> Result<(), Cancelled> {
        let stream = self.area_stream(ends.len() as u32, key);
        let (mut towards, mut n_rays) = (NodeWeights::default(), 0);
        for (i, end) in (0u32..).zip(ends) {
            control.check_at(i)?;
            let [s, t, away @ ..] = stream.sample_4d(i);
            towards.clear();
            let site = self.receivers.receiver(element, [s, t], &mut towards);
            let seen = self.see(&site, away);
            n_rays += 1;
            *end = End::new(&seen);
            if matches!(seen, Seen::Back) {
                n_rays += u64::from(INSIDE_RAYS);
                if self.is_inside(&site, key.pass(i)) {
                    *end = End::INSIDE;
                }
            }
        }
        control.count(0, n_rays);
        Ok(())
    }

    /// Where some elements are measured.
    pub(crate) fn group(&self, elements: &[ElementId]) -> Group {
        let mut towards = NodeWeights::default();
        let mut ends = Vec::with_capacity(elements.len());
        let mut site = |&element: &ElementId| {
            let site = self.receivers.receiver(element, [0.5, 0.5], &mut towards);
            ends.push(towards.iter().count());
            site
        };
        let sites = elements.iter().map(&mut site).collect();
        Group { elements: elements.to_vec(), sites, towards, ends }
    }

    /// What lights send to the sites of a group, and the rays it took; hemisphere rays are not among them.
    pub(crate) fn direct_at(
        &self,
        job: &Job<'_>,
        group: &Group,
        control: &Control,
    ) -> Result<(Vec<DVec3>, u64), Cancelled> {
        let mut values = vec![DVec3::ZERO; group.sites.len()];
        let mut meter = Meter::new(self, job, control);
        meter.add_direct(group, &mut values)?;
        Ok((values, meter.n_rays))
    }

    /// The hemisphere rays of a group.
    pub(crate) fn rays(
        &self,
        group: &Group,
        (samples, dim): (u32, Dim),
        key: impl Fn(ElementId) -> StreamKey,
        control: &Control,
    ) -> Result<Gather, Cancelled> {
        let (mut gather, mut cells) = (Gather::default(), CellOrder::default());
        for (&element, site) in group.elements.iter().zip(&group.sites) {
            control.check()?;
            let points = cells.points(&self.plan.stream(samples, key(element), dim), samples);
            gather.add(site, points);
        }
        Ok(gather)
    }

    fn measure_chunk(&self, job: &Job<'_>, chunk: u32, control: &Control) -> Result<ChunkSums, Cancelled> {
        let elements = self.elements(chunk);
        let mut meter = Meter::new(self, job, control);
        let active: Vec<ElementId> = elements.iter().copied().filter(|&e| job.measures(e)).collect();
        control.check()?;
        let sums = match self.receivers.measure() {
            Measure::AtPoint => meter.at_points(&active)?,
            Measure::OverArea => {
                let mut sums = ChunkSums::default();
                for element in active {
                    control.check()?;
                    meter.over_area(element, &mut sums)?;
                }
                sums
            }
        };
        control.count(elements.len() as u64, meter.n_rays);
        Ok(sums)
    }
}

impl<B: Basis, R: Receivers> Transport for CpuTransport<B, R> {
    fn shape(&self) -> Shape {
        let elements = self.order.elements().len();
        Shape {
            nodes: self.receivers.node_count(),
            elements,
            chunks: elements.div_ceil(CHUNK) as u32,
            measure: self.receivers.measure(),
        }
    }

    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), Cancelled> {
        // Scattered, so that what is known of a measurement under way is known everywhere.
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            sink.accept(chunk, self.measure_chunk(job, chunk, control)?);
            Ok(())
        })
    }
}

/// Elements that are measured at points, side by side.
pub(crate) struct Group {
    pub(crate) elements: Vec<ElementId>,
    pub(crate) sites: Vec<Site>,
    /// The nodes that each measurement counts towards, one after the other, and where those of each end.
    towards: NodeWeights,
    ends: Vec<usize>,
}

impl Group {
    /// The sums of the group, from the value at each site.
    pub(crate) fn sums(&self, values: &[DVec3]) -> ChunkSums {
        let mut sums = Vec::with_capacity(values.len());
        let mut towards = self.towards.iter();
        let mut begin = 0;
        for (&value, &end) in values.iter().zip(&self.ends) {
            for (node, weight) in towards.by_ref().take(end - begin) {
                let weight = f64::from(weight);
                sums.push(NodeSum { node, weight, value: value * weight });
            }
            begin = end;
        }
        ChunkSums { sums }
    }
}

/// Measures elements one after the other.
struct Meter<'a, B, R> {
    transport: &'a CpuTransport<B, R>,
    job: &'a Job<'a>,
    control: &'a Control,
    /// Nodes that the current measurement counts towards.
    towards: NodeWeights,
    /// Scratch space for reading the field back.
    weights: NodeWeights,
    n_rays: u64,
}

impl<'a, B: Basis, R: Receivers> Meter<'a, B, R> {
    fn new(transport: &'a CpuTransport<B, R>, job: &'a Job<'a>, control: &'a Control) -> Self {
        let (towards, weights) = (NodeWeights::default(), NodeWeights::default());
        Self { transport, job, control, towards, weights, n_rays: 0 }
    }

    fn key(&self, element: ElementId) -> StreamKey {
        // Openness is no bounce; it must not share the points of one.
        let bounce = if matches!(self.job.source, Source::Openness) { u32::MAX } else { self.job.bounce };
        StreamKey::new(self.transport.plan.seed).element(element.0).bounce(bounce).pass(self.job.pass)
    }

    /// All rays of an element from one origin; the value is their mean.
    fn at_points(&mut self, elements: &[ElementId]) -> Result<ChunkSums, Cancelled> {
        let group = self.transport.group(elements);
        let mut values = vec![DVec3::ZERO; elements.len()];
        if matches!(self.job.source, Source::Emitters) {
            self.add_direct(&group, &mut values)?;
        }
        if self.needs_hemisphere() {
            self.add_hemispheres(&group, &mut values)?;
        }
        Ok(group.sums(&values))
    }

    /// Adds to each value what lights send there.
    fn add_direct(&mut self, group: &Group, values: &mut [DVec3]) -> Result<(), Cancelled> {
        let mut points = LightPoints::default();
        for ((&element, site), value) in group.elements.iter().zip(&group.sites).zip(values) {
            self.control.check()?;
            let mut tally = Tally::default();
            self.direct().at_point(site, self.key(element), &mut points, &mut tally)?;
            *value += tally.sum;
            self.n_rays += tally.n_rays;
        }
        Ok(())
    }

    fn needs_hemisphere(&self) -> bool {
        !matches!(self.job.source, Source::Emitters) || self.transport.lights.needs_hemisphere()
    }

    /// Adds to each value the mean over the hemisphere there.
    fn add_hemispheres(&mut self, group: &Group, values: &mut [DVec3]) -> Result<(), Cancelled> {
        let plan = &self.transport.plan;
        let (requested, dim) = match self.job.source {
            Source::Openness => (OPENNESS_RAYS, Dim::Validity),
            Source::Emitters | Source::Field(_) => (plan.indirect_samples, Dim::Hemisphere),
        };
        let samples = plan.samples(requested, Measure::AtPoint);
        let mut means = vec![DVec3::ZERO; values.len()];
        let transport = self.transport;
        let mut gather = transport.rays(group, (samples, dim), |e| self.key(e), self.control)?;
        gather.trace(&*transport.tracer, &group.sites, samples as usize, self.control, |i, hit| {
            means[i] += self.measured(&Seen::new(&transport.scene, hit));
        })?;
        self.n_rays += u64::from(samples) * group.sites.len() as u64;
        for (value, sum) in values.iter_mut().zip(means) {
            *value += sum / f64::from(samples);
        }
        Ok(())
    }

    /// What a hemisphere ray measures where it ends.
    #[inline]
    fn measured(&mut self, seen: &Seen) -> DVec3 {
        let t = self.transport;
        match self.job.source {
            Source::Field(field) => {
                hemisphere::reflected(&t.scene, &*t.source, field, seen, &mut self.weights).0.as_dvec3()
            }
            Source::Emitters => hemisphere::emitted(&t.scene, t.lights.emission_by_rays, seen).0.as_dvec3(),
            Source::Openness => hemisphere::openness(seen),
        }
    }

    /// A ray from each of many origins; a node's value is their mean by weight.
    ///
    /// Position and direction are one 4-D point, and so are position and point on a light: what lights, sky and
    /// surfaces send adds up under one integral, so all of them share the point. Points of another stream would not
    /// be stratified together with the position. Origins inside geometry are left out, so that what is hidden does
    /// not darken what is not.
    fn over_area(&mut self, element: ElementId, sums: &mut ChunkSums) -> Result<(), Cancelled> {
        let transport = self.transport;
        let direct = matches!(self.job.source, Source::Emitters);
        let plan = &transport.plan;
        let samples =
            plan.samples(if direct { plan.direct_samples } else { plan.indirect_samples }, Measure::OverArea);
        let key = self.key(element);
        let stream = transport.area_stream(samples, key);
        let mut nodes: Vec<NodeSum> = Vec::with_capacity(3);
        for i in 0..samples {
            self.control.check_at(i)?;
            let [s, t, away @ ..] = stream.sample_4d(i);
            self.towards.clear();
            let site = self.transport.receivers.receiver(element, [s, t], &mut self.towards);
            let seen = transport.see(&site, away);
            self.n_rays += 1;
            if matches!(seen, Seen::Back) {
                self.n_rays += u64::from(INSIDE_RAYS);
                if transport.is_inside(&site, key.pass(i)) {
                    continue;
                }
            }
            let mut value = self.measured(&seen);
            if direct {
                let mut tally = Tally::default();
                self.direct().one_sample(&site, key, i, away, &mut tally);
                value += tally.sum;
                self.n_rays += tally.n_rays;
            }
            for (node, weight) in self.towards.iter() {
                add(&mut nodes, NodeSum { node, weight: weight.into(), value: value * f64::from(weight) });
            }
        }
        sums.sums.append(&mut nodes);
        Ok(())
    }

    fn direct(&self) -> Direct<'_> {
        let t = self.transport;
        let control = self.control;
        Direct { scene: &t.scene, tracer: &*t.tracer, lights: &t.lights, plan: &t.plan, control }
    }
}

pub(crate) fn add(nodes: &mut Vec<NodeSum>, new: NodeSum) {
    match nodes.iter_mut().find(|sum| sum.node == new.node) {
        Some(sum) => {
            sum.weight += new.weight;
            sum.value += new.value;
        }
        None => nodes.push(new),
    }
}
