//! Shots on stored rows: the columns of the same operator.

use crate::Sums;
use crate::area_pattern::WholePatterns;
use crate::cached::CachedTransport;
use crate::columns::{AreaRays, Block, Columns};
use crate::job::{ChunkSink, Control, Job, TransportError};
use crate::reflectance::{ShotTriangle, unpacked};
use crate::scatter::scattered;
use glam::DVec3;
use lumel_basis::{Basis, CENTER, ElementId, Field, NodeId, NodeWeights, Receivers};
use rayon::prelude::*;
use std::ops::Range;

/// Triangles between two looks at the cancel flag.
const TRIANGLES_PER_CHECK: u32 = 1024;

/// A ray of a column takes about as long as so many of a row, which follow each other in memory.
const COST_OF_COLUMNS: usize = 4;

/// What arrives at each element of a block; of areas what counts towards each corner, of points in the first place alone.
type Arrived = Vec<[DVec3; 3]>;

/// What some nodes send, by triangles.
pub(crate) struct ColumnShot<'a> {
    columns: &'a Columns,
    patterns: Option<&'a WholePatterns>,
    triangles: Vec<ShotTriangle>,
}

impl ColumnShot<'_> {
    /// Whether few enough rays end on these triangles that it takes less time to read them here and there than all rows in
    /// their order.
    pub(crate) fn is_small(&self) -> bool {
        let blocks = || self.columns.blocks.iter();
        let reached: usize =
            blocks().map(|block| self.triangles.iter().map(|t| block.count_to(t.tri)).sum::<usize>()).sum();
        COST_OF_COLUMNS * reached < blocks().map(Block::ray_count).sum()
    }
}

impl<B: Basis, R: Receivers + 'static> CachedTransport<B, R> {
    /// Whether there are columns: the basis is linear over triangles, and receivers are points or triangles.
    pub(crate) fn can_shoot(&self) -> bool {
        let first = self.inner.order.elements().first();
        let has_corners = first.is_some_and(|&element| self.inner.receivers.corners(element).is_some());
        self.reflectance.triangle_count() > 0 && (self.areas.is_none() || has_corners)
    }

    /// What some nodes send, and the columns that say where it arrives.
    pub(crate) fn shot_of(
        &self,
        (field, nodes): (&Field, &[NodeId]),
        control: &Control,
    ) -> Result<ColumnShot<'_>, TransportError> {
        let patterns = self.areas.as_ref().map(|areas| areas.whole.get_or_init(|| areas.rays.whole()));
        let columns = self.columns(patterns, control)?;
        let triangles = self.reflectance.of_shot(&*self.inner.basis, field, nodes);
        Ok(ColumnShot { columns, patterns, triangles })
    }

    /// Measures what some nodes send: the rays alone are read that end on triangles around them.
    pub(crate) fn shoot(
        &self,
        job: &Job<'_>,
        shot: &ColumnShot<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        let within = |block: &&Block| block.chunks.start < chunks.end && chunks.start < block.chunks.end;
        shot.columns.blocks.par_iter().filter(within).try_for_each(|block| {
            let arrived = self.arrived(block, shot, control)?;
            for chunk in block.chunks.clone().filter(|chunk| chunks.contains(chunk)) {
                let first = block.first_elements[(chunk - block.chunks.start) as usize] as usize;
                let sums = match shot.patterns {
                    None => self.sums_at_points(job, chunk, &arrived[first..]),
                    Some(patterns) => self.sums_over_areas(job, chunk, (block, first), &arrived, patterns),
                };
                control.count(self.inner.elements(chunk).len() as u64, 0);
                sink.accept(chunk, sums);
            }
            Ok(())
        })
    }

    /// The rows by where they end, once all are traced.
    fn columns(
        &self,
        patterns: Option<&WholePatterns>,
        control: &Control,
    ) -> Result<&Columns, TransportError> {
        if let Some(columns) = self.rows.columns.get() {
            return Ok(columns);
        }
        let order = &self.inner.order;
        scattered(0..order.chunk_count())
            .into_par_iter()
            .try_for_each(|chunk| self.chunk_rows(chunk, control).map(|_| ()))?;
        let triangles = self.reflectance.triangle_count();
        let key = |element: ElementId| self.row_key(element);
        let block = |chunks: Range<u32>| {
            // All of them are there.
            let rows = |chunk| self.rows_there(chunk);
            Block::new(
                chunks,
                triangles,
                rows,
                patterns.map(|patterns| AreaRays { patterns, order, key: &key }),
            )
        };
        let divided = Columns::divided(order, order.rays(&self.inner.plan), triangles);
        let blocks = divided.into_par_iter().map(block).collect();
        Ok(self.rows.columns.get_or_init(|| Columns { blocks }))
    }

    /// What arrives at the elements of a block from the triangles that shoot, in their order.
    fn arrived(
        &self,
        block: &Block,
        shot: &ColumnShot<'_>,
        control: &Control,
    ) -> Result<Arrived, TransportError> {
        let inner = &self.inner;
        let mut arrived = vec![[DVec3::ZERO; 3]; block.element_count()];
        let rows: Vec<_> = block.chunks.clone().map(|chunk| self.rows_there(chunk)).collect();
        let of_chunk = |chunk| Some(shot.patterns?.of_chunk(&inner.order, chunk));
        let patterns: Vec<_> = block.chunks.clone().map(of_chunk).collect();
        for (i, triangle) in (0..).zip(&shot.triangles) {
            if i % TRIANGLES_PER_CHECK == 0 {
                control.check()?;
            }
            for ray in block.rays_to(triangle.tri) {
                let row = &rows[ray.chunk];
                let (lanes, end) = (row.elements.len(), row.ends[ray.at]);
                let mut value = triangle.at(end);
                if triangle.varies {
                    let chunk = block.chunks.start + ray.chunk as u32;
                    let albedos = self.reflectance.albedos(&inner.scene, chunk, row.ends);
                    value *= albedos.map_or(glam::Vec4::ONE, |albedos| unpacked(albedos[ray.at]));
                }
                let element = block.first_elements[ray.chunk] as usize + ray.at % lanes;
                let value = value.truncate().as_dvec3();
                match patterns[ray.chunk] {
                    None => arrived[element][0] += value,
                    Some(patterns) => {
                        let stratum = (ray.at / lanes) as u32;
                        let weights = block.areas[element].corner_weights(patterns, stratum);
                        (0..3).for_each(|k| arrived[element][k] += value * f64::from(weights[k]));
                    }
                }
            }
        }
        Ok(arrived)
    }

    fn sums_at_points(&self, job: &Job<'_>, chunk: u32, arrived: &[[DVec3; 3]]) -> Sums {
        let rows = self.rows_there(chunk);
        let (mut sums, mut towards) = (Sums::with_capacity(rows.elements.len()), NodeWeights::default());
        for (&element, [sum, ..]) in rows.elements.iter().zip(arrived) {
            if job.measures(element) {
                towards.clear();
                self.inner.receivers.towards(element, CENTER, &mut towards);
                let mean = *sum / rows.per_element() as f64;
                towards.iter().for_each(|(node, weight)| sums.push(node, f64::from(weight), mean));
            }
        }
        sums
    }

    fn sums_over_areas(
        &self,
        job: &Job<'_>,
        chunk: u32,
        (block, first): (&Block, usize),
        arrived: &[[DVec3; 3]],
        patterns: &WholePatterns,
    ) -> Sums {
        let (elements, share) = (self.inner.elements(chunk), patterns.share(&self.inner.order, chunk));
        let mut sums = Sums::with_capacity(3 * elements.len());
        for (place, &element) in (first..).zip(elements).filter(|(_, element)| job.measures(**element)) {
            let Some((nodes, area)) = self.inner.receivers.corners(element) else { continue };
            let share = share * f64::from(area);
            let of_corners = nodes.into_iter().zip(block.areas[place].weights).zip(arrived[place]);
            for ((node, weight), value) in of_corners.filter(|((_, weight), _)| *weight > 0.0) {
                sums.nodes.push(node);
                sums.weights.push(share * weight);
                sums.values.push(value * share);
            }
        }
        sums
    }
}
