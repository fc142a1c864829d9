//! Shots on stored rows: the columns of the same operator.

use crate::area_pattern::WholePatterns;
use crate::cached::CachedTransport;
use crate::columns::{AreaRays, Block, Columns};
use crate::job::{ChunkSink, Control, Job, TransportError};
use crate::reflectance::{ShotTriangle, unpacked};
use crate::scatter::scattered;
use crate::sums::{ElementSums, Sums};
use glam::DVec3;
use lumel_basis::{Basis, CENTER, ElementId, Field, NodeId, NodeWeights, Receivers};
use rayon::prelude::*;
use std::ops::Range;

/// Triangles between two looks at the cancel flag.
const TRIANGLES_PER_CHECK: u32 = 1024;

/// What arrives at each element of a block; of areas what counts towards each corner, of points in the first place alone.
type Arrived = Vec<[DVec3; 3]>;

impl<B: Basis, R: Receivers + 'static> CachedTransport<B, R> {
    /// Whether there are columns: the basis is linear over triangles, and receivers are points or triangles.
    pub(crate) fn can_shoot(&self) -> bool {
        let first = self.inner.order.elements().first();
        let has_corners = first.is_some_and(|&element| self.inner.receivers.corners(element).is_some());
        self.reflectance.triangle_count() > 0 && (self.areas.is_none() || has_corners)
    }

    /// Measures what some nodes send: the rays alone are read that end on triangles around them.
    pub(crate) fn shoot(
        &self,
        job: &Job<'_>,
        (field, nodes): (&Field, &[NodeId]),
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        let patterns = self.areas.as_ref().map(|areas| areas.whole.get_or_init(|| areas.rays.whole()));
        let columns = self.columns(patterns, control)?;
        let shot = self.reflectance.of_shot(&*self.inner.basis, field, nodes);
        let within = |block: &&Block| block.chunks.start < chunks.end && chunks.start < block.chunks.end;
        columns.blocks.par_iter().filter(within).try_for_each(|block| {
            let arrived = self.arrived(block, &shot, patterns, control)?;
            for chunk in block.chunks.clone().filter(|chunk| chunks.contains(chunk)) {
                let first = block.first_elements[(chunk - block.chunks.start) as usize] as usize;
                let sums = match patterns {
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
        shot: &[ShotTriangle],
        patterns: Option<&WholePatterns>,
        control: &Control,
    ) -> Result<Arrived, TransportError> {
        let inner = &self.inner;
        let mut arrived = vec![[DVec3::ZERO; 3]; block.element_count()];
        let rows: Vec<_> = block.chunks.clone().map(|chunk| self.rows_there(chunk)).collect();
        let of_chunk = |chunk| Some(patterns?.of_chunk(&inner.order, chunk));
        let patterns: Vec<_> = block.chunks.clone().map(of_chunk).collect();
        for (i, triangle) in (0..).zip(shot) {
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
        let mut all = ElementSums::some(elements.len());
        for (place, (&element, sums)) in (first..).zip(elements.iter().zip(&mut all)) {
            let Some((nodes, area)) = self.inner.receivers.corners(element) else { continue };
            let share = share * f64::from(area);
            for k in (0..3).filter(|_| job.measures(element)) {
                let weight = block.areas[place].weights[k];
                if weight > 0.0 {
                    sums.add(k, nodes[k], share * weight, arrived[place][k] / weight);
                }
            }
        }
        Sums::of_elements(&all, false)
    }
}
