//! What a transport is asked to do, and how it answers.

use glam::DVec3;
use lumel_basis::{ElementId, Field, Measure, NodeId};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Rays between two looks at the cancel flag: a millisecond.
const RAYS_PER_CHECK: u32 = 1024;

/// What shines in one application of the operator.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// Lights, sky and emissive surfaces: direct light.
    Emitters,
    /// The surfaces, with this irradiance on them: one bounce.
    Field(&'a Field),
    /// Nothing: measures the share of rays that do not meet the back of a surface, in all channels. Elements that
    /// see much of it lie inside geometry.
    Openness,
}

/// One application of the operator.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// What shines.
    pub source: Source<'a>,
    /// Number of the bounce: each has sample points of its own.
    pub bounce: u32,
    /// Number of the set of samples: each has sample points of its own.
    pub pass: u32,
    /// Elements to measure; `None` for all. The others get no weight.
    pub active: Option<&'a [bool]>,
}

impl Job<'_> {
    /// Whether an element is to be measured.
    pub(crate) fn measures(&self, element: ElementId) -> bool {
        self.active.is_none_or(|active| active[element.index()])
    }
}

/// The sizes of an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Coefficients of the result.
    pub nodes: usize,
    /// Things that are measured.
    pub elements: usize,
    /// Portions in which they are measured.
    pub chunks: u32,
    /// How they are measured.
    pub measure: Measure,
}

/// The weighted sum of some measurements of a node.
#[derive(Clone, Copy, Debug)]
pub struct NodeSum {
    /// The node.
    pub node: NodeId,
    /// Sum of the weights.
    pub weight: f64,
    /// Weighted sum of the measured irradiance.
    pub value: DVec3,
}

/// The measurements of one chunk of elements, in the order of elements.
#[derive(Clone, Debug, Default)]
pub struct ChunkSums {
    /// A sum for each node that an element of the chunk counts towards; nodes may occur more than once.
    pub sums: Vec<NodeSum>,
}

/// Takes finished chunks, in any order, from any thread.
pub trait ChunkSink: Sync {
    /// Takes a chunk.
    fn accept(&self, chunk: u32, sums: ChunkSums);
}

/// The solve was asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// The way in and out of a running measurement.
#[derive(Debug, Default)]
pub struct Control {
    cancel: AtomicBool,
    rays: AtomicU64,
    elements: AtomicU64,
}

impl Control {
    /// Asks the measurement to stop; it does within a few milliseconds.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Rays traced so far, shadow rays included.
    pub fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Elements measured so far, over all applications of the operator.
    pub fn elements(&self) -> u64 {
        self.elements.load(Ordering::Relaxed)
    }

    /// `Err` once it was asked to stop.
    pub(crate) fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// [`check`](Self::check), now and then: `i` numbers the samples of a loop.
    #[inline]
    pub(crate) fn check_at(&self, i: u32) -> Result<(), Cancelled> {
        if i % RAYS_PER_CHECK == RAYS_PER_CHECK - 1 { self.check() } else { Ok(()) }
    }

    pub(crate) fn count(&self, elements: u64, rays: u64) {
        self.elements.fetch_add(elements, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }
}

/// The discrete transport operator, whoever computes it.
pub trait Transport: Send + Sync {
    /// Its sizes.
    fn shape(&self) -> Shape;

    /// Measures some chunks and hands each to `sink` as it is done.
    ///
    /// The sums of a chunk are a pure function of the job and the chunk.
    ///
    /// # Errors
    /// When `control` asks to stop; some chunks may have been delivered then.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), Cancelled>;
}
