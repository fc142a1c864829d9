//! Stored rows by where their rays end: what light from a few triangles needs, which few of all rays meet.
//!
//! Rows and columns are the same rays. A bounce reads every ray of every row; a shot adds what a few triangles send to the
//! rows whose rays end there, and so costs what it reaches. Elements are dealt with in blocks, each by one thread and
//! always in the same order, so that the bits of a shot do not depend on the number of threads.

use crate::area_pattern::{AreaPattern, PART, WholePatterns, part_key};
use crate::cached::ChunkRows;
use crate::ends::StoredEnd;
use crate::order::Order;
use glam::Vec4;
use lumel_basis::ElementId;
use lumel_sample::StreamKey;
use smallvec::SmallVec;
use std::ops::Range;

/// Blocks at most: enough for the threads of most machines.
const MAX_BLOCKS: u64 = 32;

/// A block has at least this many times as many rays as there are triangles, so that what it knows of each triangle costs a
/// byte per ray at most.
const RAYS_PER_TRIANGLE: u64 = 4;

/// A block has fewer rays than this, so that they can be numbered.
const MAX_RAYS: u64 = 1 << 31;

/// All stored rays, by the triangles that they end on.
#[derive(Debug)]
pub(crate) struct Columns {
    pub(crate) blocks: Vec<Block>,
}

/// The rays of some successive chunks.
#[derive(Debug)]
pub(crate) struct Block {
    pub(crate) chunks: Range<u32>,
    /// Where the rays of each chunk begin, and the last ones end, when all are numbered.
    firsts: Box<[u32]>,
    /// Where the elements of each chunk begin.
    pub(crate) first_elements: Box<[u32]>,
    /// Where those that end on each triangle begin among `rays`, and the last ones end.
    starts: Box<[u32]>,
    /// The numbers of those that end on a surface, triangle by triangle, in ascending order.
    rays: Box<[u32]>,
    /// Over areas.
    pub(crate) areas: Vec<AreaElement>,
}

/// How the stored rays of areas were sampled.
pub(crate) struct AreaRays<'a> {
    pub(crate) patterns: &'a WholePatterns,
    pub(crate) order: &'a Order,
    /// What names the streams of an element.
    pub(crate) key: &'a dyn Fn(ElementId) -> StreamKey,
}

/// What is the same of an area in every shot.
#[derive(Clone, Debug)]
pub(crate) struct AreaElement {
    /// What all samples outside geometry count towards each corner of a triangle of unit area.
    pub(crate) weights: [f64; 3],
    /// How each part of the pattern is turned.
    pub(crate) turns: SmallVec<[u32; 2]>,
}

/// A ray of a block.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    /// The chunk, counted from the first of the block.
    pub(crate) chunk: usize,
    /// Where it stands in the [rows](ChunkRows) of the chunk.
    pub(crate) at: usize,
}

impl Columns {
    /// Bytes per ray, about.
    pub(crate) const BYTES_PER_RAY: u64 = 6;

    /// How the chunks of an order are divided into blocks, of so many rays that end on so many triangles.
    pub(crate) fn divided(order: &Order, rays: u64, triangles: usize) -> Vec<Range<u32>> {
        let by_size = rays / (RAYS_PER_TRIANGLE * triangles.max(1) as u64);
        let blocks = by_size.clamp(1, MAX_BLOCKS).max(rays.div_ceil(MAX_RAYS));
        let chunks = u64::from(order.chunk_count());
        let end = |block: u64| (chunks * block / blocks) as u32;
        (0..blocks).map(|block| end(block)..end(block + 1)).filter(|chunks| !chunks.is_empty()).collect()
    }
}

impl Block {
    /// The rays of some chunks, whose `rows` are stored.
    pub(crate) fn new<'a>(
        chunks: Range<u32>,
        triangles: usize,
        rows: impl Fn(u32) -> ChunkRows<'a>,
        areas: Option<AreaRays<'_>>,
    ) -> Self {
        let (mut firsts, mut first_elements) = (vec![0], vec![0]);
        let mut starts = vec![0u32; triangles + 1];
        let surface = |end: &StoredEnd| Some(end.tri as usize).filter(|&tri| tri < triangles);
        for chunk in chunks.clone() {
            let ChunkRows { ends, elements } = rows(chunk);
            firsts.push(firsts.last().copied().unwrap_or(0) + ends.len() as u32);
            first_elements.push(first_elements.last().copied().unwrap_or(0) + elements.len() as u32);
            ends.iter().filter_map(surface).for_each(|tri| starts[tri] += 1);
        }
        // From how many there are to where they end; filling them in from the last leaves where they begin.
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut rays = vec![0u32; sum as usize];
        for (chunk, &first) in chunks.clone().zip(&firsts).rev() {
            for (at, end) in rows(chunk).ends.iter().enumerate().rev() {
                let Some(tri) = surface(end) else { continue };
                starts[tri] -= 1;
                rays[starts[tri] as usize] = first + at as u32;
            }
        }
        let elements = chunks.clone().flat_map(|chunk| {
            let of = |AreaRays { patterns, order, key }: &AreaRays<'_>| {
                AreaElement::of_chunk(patterns.of_chunk(order, chunk), rows(chunk), key)
            };
            areas.as_ref().map(of).unwrap_or_default()
        });
        Self {
            firsts: firsts.into(),
            first_elements: first_elements.into(),
            starts: starts.into(),
            rays: rays.into(),
            areas: elements.collect(),
            chunks,
        }
    }

    /// The rays that end on a triangle, in the order of chunks.
    pub(crate) fn rays_to(&self, tri: u32) -> impl Iterator<Item = Ray> {
        let column = self.starts[tri as usize] as usize..self.starts[tri as usize + 1] as usize;
        let mut chunk = 0;
        self.rays[column].iter().map(move |&ray| {
            if ray >= self.firsts[chunk + 1] {
                chunk += self.firsts[chunk + 1..].partition_point(|&first| first <= ray);
            }
            Ray { chunk, at: (ray - self.firsts[chunk]) as usize }
        })
    }

    /// How many rays end on a triangle.
    pub(crate) fn count_to(&self, tri: u32) -> usize {
        (self.starts[tri as usize + 1] - self.starts[tri as usize]) as usize
    }

    /// How many rays it has.
    pub(crate) fn ray_count(&self) -> usize {
        self.firsts.last().copied().unwrap_or(0) as usize
    }

    /// How many elements it has.
    pub(crate) fn element_count(&self) -> usize {
        self.first_elements.last().copied().unwrap_or(0) as usize
    }
}

impl AreaElement {
    fn of_chunk(
        patterns: &[AreaPattern],
        rows: ChunkRows<'_>,
        key: &dyn Fn(ElementId) -> StreamKey,
    ) -> Vec<Self> {
        let element = |(lane, &element): (usize, &ElementId)| {
            let key = key(element);
            let turns =
                (0..).zip(patterns).map(|(part, pattern)| pattern.turn(part_key(key, part))).collect();
            let mut found = Self { weights: [0.0; 3], turns };
            for stratum in 0..(rows.ends.len() / rows.elements.len()) as u32 {
                if rows.ends[rows.at(stratum, lane)] != StoredEnd::INSIDE {
                    let weights = found.corner_weights(patterns, stratum);
                    (0..3).for_each(|k| found.weights[k] += f64::from(weights[k]));
                }
            }
            found
        };
        rows.elements.iter().enumerate().map(element).collect()
    }

    /// What the sample of a stratum counts towards each corner of a triangle of unit area.
    #[inline]
    pub(crate) fn corner_weights(&self, patterns: &[AreaPattern], stratum: u32) -> Vec4 {
        let (part, slot) = (stratum / PART, stratum % PART);
        patterns[part as usize].corner_weights(slot, self.turns[part as usize])
    }
}
