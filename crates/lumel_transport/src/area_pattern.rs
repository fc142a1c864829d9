//! The samples of areas: places and the directions that go with them.

use crate::order::Order;
use crate::plan::Plan;
use glam::Vec4;
use lumel_basis::{ElementId, Sampling};
use lumel_sample::{Dim, SamplerKind, StreamKey, numbers_by_cell, uniform_triangle};
use std::borrow::Cow;

/// A weight below this would leave a sample out; the rule is then one of a lower degree.
const MIN_WEIGHT: f64 = 0.2;

/// How a number of samples is spread over an area, and over the hemisphere or a light at the same time.
///
/// A sample is a place and a direction, together a point in four dimensions. The places are the same in all elements; the
/// directions are each element's own, one in each cell, so that neighbours can send theirs through one cell together.
/// Which place goes with which cell is a 4-D low-discrepancy set, *turned* for each element: neighbours do not look
/// through a cell from the same corner, and means over them do not keep what one pattern misses.
///
/// Weights make the places a quadrature rule: polynomials up to the second degree are integrated over a triangle exactly (of
/// fewer than eight samples, up to a lower one). So the sums of weights are the integrals of basis functions themselves:
/// constants are reproduced, and power is lost nowhere between samples and nodes.
#[derive(Clone, Debug)]
pub(crate) struct AreaPattern {
    /// Coordinates in the unit square, by the number of the sample.
    places: Vec<[f32; 2]>,
    weights: Vec<f32>,
    /// The barycentrics of the place in each slot times its weight, before turning.
    corner_weights: Vec<Vec4>,
    /// The number of the sample in each slot, before turning; slots are in the order of the cells of directions.
    numbers: Vec<u32>,
    /// The inverse of that.
    slots: Vec<u32>,
}

impl AreaPattern {
    /// The pattern of so many samples; `key` names no element.
    pub(crate) fn new(plan: &Plan, samples: u32, key: StreamKey) -> Self {
        let stream = plan.stream(samples, key, Dim::Area);
        let points: Vec<[f32; 4]> = (0..samples).map(|number| stream.sample_4d(number)).collect();
        let numbers = numbers_by_cell(&points.iter().map(|&[x, y, ..]| [x, y]).collect::<Vec<_>>());
        let mut slots = vec![0; numbers.len()];
        for (slot, &number) in (0..).zip(&numbers) {
            slots[number as usize] = slot;
        }
        let places: Vec<[f32; 2]> = points.iter().map(|&[.., s, t]| [s, t]).collect();
        let weights = quadrature_weights(&places);
        let of_corners = |&number: &u32| {
            let [a, b] = uniform_triangle(places[number as usize]);
            Vec4::new(a, b, 1.0 - a - b, 0.0) * weights[number as usize]
        };
        let corner_weights = numbers.iter().map(of_corners).collect();
        Self { places, weights, corner_weights, numbers, slots }
    }

    pub(crate) fn len(&self) -> u32 {
        self.numbers.len() as u32
    }

    /// How the pattern is turned for an element.
    pub(crate) fn turn(&self, key: StreamKey) -> u32 {
        let [x, _] = lumel_sample::Sampler::Random.sample_2d(key, 0, Dim::Area);
        ((x * self.len() as f32) as u32).min(self.len() - 1)
    }

    /// The number of the sample in a slot. Bits are flipped, which leaves squares of cells what they are; only where
    /// the count is no power of two are slots shifted.
    #[inline]
    pub(crate) fn number(&self, slot: u32, turn: u32) -> u32 {
        self.numbers[self.turned(slot, turn)]
    }

    /// What the sample in a slot counts towards each corner of a triangle of unit area.
    #[inline]
    pub(crate) fn corner_weights(&self, slot: u32, turn: u32) -> Vec4 {
        self.corner_weights[self.turned(slot, turn)]
    }

    #[inline]
    fn turned(&self, slot: u32, turn: u32) -> usize {
        let n = self.len();
        (if n.is_power_of_two() { slot ^ turn } else { (slot + turn) % n }) as usize
    }

    /// The slot of a sample: the inverse of [`number`](Self::number).
    #[inline]
    pub(crate) fn slot(&self, number: u32, turn: u32) -> u32 {
        let (n, slot) = (self.len(), self.slots[number as usize]);
        if n.is_power_of_two() { slot ^ turn } else { (slot + n - turn) % n }
    }

    /// The places of all samples, by number.
    pub(crate) fn places(&self) -> &[[f32; 2]] {
        &self.places
    }

    /// The place of a sample and its weight, 1 on average.
    #[inline]
    pub(crate) fn place(&self, number: u32) -> ([f32; 2], f32) {
        (self.places[number as usize], self.weights[number as usize])
    }
}

/// More samples than this come in parts, each with a pattern of its own.
pub(crate) const PART: u32 = 1024;

/// The patterns of one measurement: one for each number of samples that elements get.
#[derive(Debug)]
pub(crate) struct AreaPatterns {
    plan: Plan,
    key: StreamKey,
    /// By doublings, in ascending order.
    kinds: Vec<Kind>,
}

/// Elements with the same number of samples.
#[derive(Debug)]
struct Kind {
    doublings: i8,
    samples: u32,
    /// Kept where there is one part: many parts take long to measure anyway, and much memory.
    pattern: Option<AreaPattern>,
}

impl AreaPatterns {
    /// The patterns for an order's elements, of each of which `requested` samples are asked for.
    pub(crate) fn new(plan: &Plan, order: &Order, requested: u32, key: StreamKey) -> Self {
        let mut new = Self { plan: *plan, key, kinds: Vec::new() };
        for doublings in order.doublings() {
            let samples = plan.samples(requested, Sampling::Area, doublings);
            let pattern = (samples <= PART).then(|| new.made(0, samples));
            new.kinds.push(Kind { doublings, samples, pattern });
        }
        new
    }

    fn made(&self, part: u32, samples: u32) -> AreaPattern {
        AreaPattern::new(&self.plan, samples, part_key(self.key, part))
    }

    fn kind(&self, order: &Order, chunk: u32) -> &Kind {
        let wanted = order.doublings_of(chunk);
        let place = self.kinds.binary_search_by_key(&wanted, |kind| kind.doublings);
        &self.kinds[place.unwrap_or_default()]
    }

    /// How many samples each element of a chunk gets, in all parts.
    pub(crate) fn samples(&self, order: &Order, chunk: u32) -> usize {
        self.kind(order, chunk).samples as usize
    }

    /// The parts in which the elements of a chunk are measured.
    pub(crate) fn parts(&self, order: &Order, chunk: u32) -> impl Iterator<Item = AreaPart<'_>> {
        self.parts_of(self.kind(order, chunk))
    }

    fn parts_of<'a>(&'a self, kind: &'a Kind) -> impl Iterator<Item = AreaPart<'a>> {
        (0..kind.samples.div_ceil(PART)).map(move |part| {
            let made = || {
                // A stratified sampler rounds up to a square again.
                let samples = self.plan.sampler.sample_count(PART.min(kind.samples - part * PART));
                Cow::Owned(self.made(part, samples))
            };
            let pattern = kind.pattern.as_ref().map_or_else(made, Cow::Borrowed);
            AreaPart { part, pattern, samples: kind.samples }
        })
    }

    /// All parts of all patterns, for who reads samples here and there.
    pub(crate) fn whole(&self) -> WholePatterns {
        let parts = |kind| self.parts_of(kind).map(|part| part.pattern.into_owned()).collect();
        let kinds: Vec<Vec<AreaPattern>> = self.kinds.iter().map(parts).collect();
        let samples = self.kinds.iter().map(|kind| kind.samples).collect();
        WholePatterns { doublings: self.kinds.iter().map(|kind| kind.doublings).collect(), samples, kinds }
    }

    /// Whether the places of these are among those of others, under the same numbers.
    ///
    /// They are where the same sequence is continued; stratified samples are another set for each count.
    pub(crate) fn are_within(&self, others: &Self) -> bool {
        let mut pairs = self.kinds.iter().zip(&others.kinds);
        let continued = self.plan.sampler != SamplerKind::Stratified && self.plan.portion == 0;
        continued && pairs.all(|(few, many)| few.samples <= many.samples)
    }
}

/// The patterns of one measurement with all their parts.
#[derive(Debug)]
pub(crate) struct WholePatterns {
    doublings: Vec<i8>,
    samples: Vec<u32>,
    /// By doublings, then by part.
    kinds: Vec<Vec<AreaPattern>>,
}

impl WholePatterns {
    fn kind_of(&self, order: &Order, chunk: u32) -> usize {
        self.doublings.binary_search(&order.doublings_of(chunk)).unwrap_or_default()
    }

    /// The parts in which the elements of a chunk are measured.
    pub(crate) fn of_chunk(&self, order: &Order, chunk: u32) -> &[AreaPattern] {
        &self.kinds[self.kind_of(order, chunk)]
    }

    /// What each sample of the elements of a chunk counts.
    pub(crate) fn share(&self, order: &Order, chunk: u32) -> f64 {
        1.0 / f64::from(self.samples[self.kind_of(order, chunk)])
    }
}

/// Names the streams of a part of the samples that `key` names.
pub(crate) fn part_key(key: StreamKey, part: u32) -> StreamKey {
    if part == 0 { key } else { key.pass(part) }
}

/// A part of the samples of some elements.
#[derive(Debug)]
pub(crate) struct AreaPart<'a> {
    /// Its number, from 0.
    part: u32,
    pattern: Cow<'a, AreaPattern>,
    /// The samples of all parts.
    samples: u32,
}

/// The elements of a chunk that are measured, with a part of their samples.
pub(crate) struct AreaChunk<'a> {
    pub(crate) elements: &'a [ElementId],
    pub(crate) pattern: &'a AreaPattern,
    /// Of each element: what names its streams, and how the pattern is turned.
    pub(crate) keys: Vec<(StreamKey, u32)>,
    /// What each sample counts.
    pub(crate) share: f64,
    /// Strata of the parts before.
    pub(crate) first: u32,
}

impl<'a> AreaChunk<'a> {
    pub(crate) fn new(
        elements: &'a [ElementId],
        part: &'a AreaPart<'_>,
        key: impl Fn(ElementId) -> StreamKey,
    ) -> Self {
        let key = |&element: &ElementId| {
            let key = part_key(key(element), part.part);
            (key, part.pattern.turn(key))
        };
        Self {
            elements,
            pattern: &part.pattern,
            keys: elements.iter().map(key).collect(),
            share: 1.0 / f64::from(part.samples),
            first: part.part * PART,
        }
    }
}

impl AreaChunk<'_> {
    /// Where the ray of a sample of an element stands, slot by slot with the elements side by side.
    pub(crate) fn place(&self, element: usize, number: u32) -> usize {
        self.pattern.slot(number, self.keys[element].1) as usize * self.elements.len() + element
    }
}

/// Weights, 1 on average, that make a mean over places of the unit square exact for polynomials over the triangle that the
/// square is mapped to.
///
/// They are `1 + q(place)` with the polynomial `q` of the same degree that corrects all moments: the weights nearest to
/// one. The highest degree up to two is taken that leaves all weights well above zero.
fn quadrature_weights(places: &[[f32; 2]]) -> Vec<f32> {
    let values: Vec<[f64; 6]> = places.iter().map(|&u| monomials(uniform_triangle(u))).collect();
    for n in [6, 3] {
        let Some(factors) = correction(&values, n) else { continue };
        let weight = |values: &[f64; 6]| 1.0 + factors.iter().zip(values).map(|(a, b)| a * b).sum::<f64>();
        let weights: Vec<f64> = values.iter().map(weight).collect();
        if weights.iter().all(|&weight| weight > MIN_WEIGHT) {
            return weights.into_iter().map(|weight| weight as f32).collect();
        }
    }
    vec![1.0; places.len()]
}

/// The polynomials up to the second degree of barycentric coordinates.
fn monomials([a, b]: [f32; 2]) -> [f64; 6] {
    let (a, b) = (f64::from(a), f64::from(b));
    [1.0, a, b, a * a, a * b, b * b]
}

/// Their means over a triangle.
const MEANS: [f64; 6] = [1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, 1.0 / 12.0, 1.0 / 6.0];

/// The factors of the first `n` monomials in `q`; `None` if places are too few to tell.
fn correction(values: &[[f64; 6]], n: usize) -> Option<[f64; 6]> {
    let mean = |f: &dyn Fn(&[f64; 6]) -> f64| values.iter().map(f).sum::<f64>() / values.len() as f64;
    let mut rows: Vec<[f64; 7]> = (0..n)
        .map(|i| {
            let mut row = [0.0; 7];
            (0..n).for_each(|j| row[j] = mean(&|v| v[i] * v[j]));
            row[6] = MEANS[i] - mean(&|v| v[i]);
            row
        })
        .collect();
    // Gaussian elimination with pivots.
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k].abs() < 1e-12 {
            return None;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = rows[i][k] / rows[k][k];
            (0..7).for_each(|j| rows[i][j] -= factor * rows[k][j]);
        }
    }
    let mut factors = [0.0; 6];
    (0..n).for_each(|k| factors[k] = rows[k][6] / rows[k][k]);
    Some(factors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(sampler: SamplerKind) -> Plan {
        Plan { sampler, ..Plan::default() }
    }

    fn pattern(sampler: SamplerKind, requested: u32) -> AreaPattern {
        let samples = sampler.sample_count(requested);
        AreaPattern::new(&plan(sampler), samples, StreamKey::new(3))
    }

    #[test]
    fn every_sample_has_one_slot_however_the_pattern_is_turned() {
        for (sampler, n) in
            [(SamplerKind::Sobol, 32), (SamplerKind::Halton, 24), (SamplerKind::Stratified, 36)]
        {
            let pattern = pattern(sampler, n);
            for turn in [0, 1, 13, n - 1] {
                let mut numbers: Vec<u32> = (0..n).map(|slot| pattern.number(slot, turn)).collect();
                assert!((0..n).all(|slot| pattern.slot(pattern.number(slot, turn), turn) == slot));
                numbers.sort_unstable();
                assert!(numbers.into_iter().eq(0..n), "{sampler} {n} {turn}");
            }
        }
    }

    #[test]
    fn sums_over_places_are_integrals_of_polynomials() {
        for sampler in SamplerKind::ALL {
            for (n, degree) in [(32, 6), (64, 6), (256, 6), (4, 1)] {
                // Random places may lie too badly for the second degree.
                let degree = if sampler == SamplerKind::Random && n == 32 { 3 } else { degree };
                let pattern = pattern(sampler, n);
                let n = pattern.len();
                for (k, expected) in MEANS.iter().enumerate().take(degree) {
                    let value = |number| {
                        let (place, weight) = pattern.place(number);
                        f64::from(weight) * monomials(uniform_triangle(place))[k]
                    };
                    let mean = (0..n).map(value).sum::<f64>() / f64::from(n);
                    assert!((mean - expected).abs() < 1e-7, "{sampler} {n} {k}: {mean}");
                }
            }
        }
    }

    #[test]
    fn places_go_with_all_directions() {
        // The mean over slots of a function of place and direction is near to that over the whole, in every turn.
        let pattern = pattern(SamplerKind::Sobol, 256);
        for turn in [0, 77, 200] {
            let quarter = |slot: u32| {
                let ([s, t], _) = pattern.place(pattern.number(slot, turn));
                slot < 64 && s < 0.5 && t < 0.5
            };
            let n = (0..256).filter(|&slot| quarter(slot)).count();
            assert!((12..=20).contains(&n), "{n} of 16");
        }
    }
}
