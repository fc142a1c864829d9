//! The operator that traces rays for every job.

use crate::Sums;
use crate::group::Group;
use crate::job::{ChunkSink, Control, Job, Shape, Source, Transport, TransportError};
use crate::measure::{self, JobPatterns};
use crate::operator::CpuTransport;
use crate::scatter::scattered;
use lumel_basis::{Basis, Receivers, Sampling};
use rayon::prelude::*;
use std::ops::Range;

impl<B: Basis, R: Receivers> Transport for CpuTransport<B, R> {
    fn shape(&self) -> Shape {
        self.sizes()
    }

    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        if let Source::Shot(field, nodes) = job.source
            && self.basis.corner_nodes().is_some()
        {
            return self.shoot(job, (field, nodes), chunks, control, sink);
        }
        let patterns = (self.receivers.sampling() == Sampling::Area).then(|| measure::patterns(self, job));
        // Scattered, so that what is known of a measurement under way is known everywhere.
        scattered(chunks).into_par_iter().try_for_each(|chunk| {
            sink.accept(chunk, measure_chunk(self, job, chunk, patterns.as_ref(), control)?);
            Ok(())
        })
    }
}

fn measure_chunk<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    job: &Job<'_>,
    chunk: u32,
    patterns: Option<&JobPatterns>,
    control: &Control,
) -> Result<Sums, TransportError> {
    control.check()?;
    let active = op.active(job, chunk);
    let sums = match patterns {
        None => measure::at_points(op, job, &Group::new(&*op.receivers, &active), control)?,
        Some(patterns) => measure::over_areas(op, job, (&active, chunk), patterns, control)?,
    };
    control.count(op.elements(chunk).len() as u64, 0);
    Ok(sums)
}
