//! An operator whose samples come in several passes.

use crate::Sums;
use crate::accumulate::accumulate;
use crate::job::{ChunkSink, Control, Job, Shape, Source, Transport, TransportError};
use std::ops::Range;
use std::sync::Arc;

/// Some more samples, for some of the nodes.
pub struct Pass {
    operator: Box<dyn Transport>,
    /// The nodes that it measures; of others it may have measured a part, which does not count.
    nodes: Arc<[bool]>,
    /// What its measurements weigh beside those of other passes.
    samples: f64,
}

impl Pass {
    /// The samples of an operator, which measures `nodes` completely.
    pub fn new(operator: Box<dyn Transport>, nodes: Arc<[bool]>, samples: f64) -> Self {
        Self { operator, nodes, samples }
    }

    /// The mean of each of its nodes, weighted by the samples of the pass.
    ///
    /// # Errors
    /// Those of the operator.
    pub fn measure(&self, job: &Job<'_>, control: &Control) -> Result<Sums, TransportError> {
        let measured = accumulate(&*self.operator, job, control, None)?;
        let mut sums = Sums::default();
        for node in (0..measured.field.node_count() as u32).map(lumel_basis::NodeId) {
            if measured.known[node.index()] && self.nodes[node.index()] {
                sums.nodes.push(node);
                sums.weights.push(self.samples);
                let means = measured.field.coefficients(node).iter();
                sums.values.extend(means.map(|mean| mean.as_dvec3() * self.samples));
                if matches!(job.source, Source::Nothing) {
                    sums.hidden.push(f64::from(measured.hidden[node.index()]) * self.samples);
                }
            }
        }
        Ok(sums)
    }
}

/// Passes over the same nodes, as one operator: the mean of all, by their samples.
///
/// Each pass is a chunk, whose sums are those of its own chunks merged and divided, so that the bits of the whole do not
/// depend on how a pass is split. More passes can be added at any time: the rounds of a target error, new elements of a
/// refined basis, the parts of several devices.
#[derive(Default)]
pub struct Passes(Vec<Pass>);

impl Passes {
    /// Adds a pass.
    ///
    /// # Panics
    /// If it is of other nodes or channels than the passes before.
    pub fn push(&mut self, pass: Pass) {
        let sizes = |pass: &Pass| (pass.operator.shape().nodes, pass.operator.shape().channels);
        assert!(self.0.first().is_none_or(|first| sizes(first) == sizes(&pass)), "passes over other nodes");
        self.0.push(pass);
    }

    /// The passes.
    pub fn as_slice(&self) -> &[Pass] {
        &self.0
    }
}

impl Transport for Passes {
    /// Without passes, that of nothing.
    fn shape(&self) -> Shape {
        let shapes = || self.0.iter().map(|pass| pass.operator.shape());
        let elements = shapes().map(|shape| shape.elements).sum();
        let none =
            Shape { nodes: 0, channels: 1, elements: 0, chunks: 0, sampling: lumel_basis::Sampling::Point };
        Shape { elements, chunks: self.0.len() as u32, ..shapes().next().unwrap_or(none) }
    }

    /// One pass after the other, each on all threads.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError> {
        for chunk in chunks {
            sink.accept(chunk, self.0[chunk as usize].measure(job, control)?);
        }
        Ok(())
    }
}
