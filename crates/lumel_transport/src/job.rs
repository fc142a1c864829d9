//! What a transport is asked to do, and how it answers.

use crate::{AmbientOcclusion, EmitterMask, Sums};
use lumel_basis::{ElementId, Field, NodeId, Sampling};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Rays between two looks at the cancel flag: a millisecond.
const RAYS_PER_CHECK: u32 = 1024;

/// What shines in one application of the operator.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// Lights, sky and emissive surfaces, all of them or those of a mask: direct light.
    Emitters(Option<&'a EmitterMask>),
    /// The surfaces, with this irradiance on them: one bounce.
    Field(&'a Field),
    /// The surfaces, with direct light on them in the [basis that holds it](lumel_basis::Basis::direct), and if there is any, with other
    /// light in the basis that carries bounces.
    Reflecting {
        /// Direct light.
        direct: &'a Field,
        /// All other light.
        carried: Option<&'a Field>,
    },
    /// The same as of a field, where the irradiance is zero at all nodes but these: a part of a bounce.
    ///
    /// Shots of all nodes, each once, add up to the bounce of one linear operator: number of bounce and pass must be the same for
    /// all of them.
    Shot(&'a Field, &'a [NodeId]),
    /// An even sky that brings an irradiance of 1 where nothing near hides it.
    Ambient(AmbientOcclusion),
    /// Nothing: it is only found out what is [hidden](Sums::hidden).
    Nothing,
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
    pub fn measures(&self, element: ElementId) -> bool {
        self.active.is_none_or(|active| active[element.index()])
    }
}

/// The sizes of an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Nodes of the result.
    pub nodes: usize,
    /// Coefficients per node of the result.
    pub channels: usize,
    /// Elements that are measured.
    pub elements: usize,
    /// Portions in which they are measured.
    pub chunks: u32,
    /// How they are sampled.
    pub sampling: Sampling,
}

/// Takes finished chunks.
///
/// A transport calls [`accept`](Self::accept) once for each chunk that it was asked for, in any order, from any thread and
/// from several at once. When it fails, some chunks may have been delivered; none is delivered twice.
pub trait ChunkSink: Sync {
    /// Takes a chunk.
    fn accept(&self, chunk: u32, sums: Sums);
}

/// Why a measurement ended early.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// It was asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// What computes has failed: a device, a worker, a connection.
    #[error("{worker} failed: {cause}")]
    Failed {
        /// What failed, as users know it.
        worker: String,
        /// What it said.
        cause: String,
    },
}

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

    /// For transports: fails once the measurement was asked to stop.
    ///
    /// # Errors
    /// [`TransportError::Cancelled`].
    pub fn check(&self) -> Result<(), TransportError> {
        if self.is_cancelled() { Err(TransportError::Cancelled) } else { Ok(()) }
    }

    /// [`check`](Self::check), once in a thousand samples: `i` numbers the samples of a loop.
    ///
    /// # Errors
    /// [`TransportError::Cancelled`].
    #[inline]
    pub fn check_at(&self, i: u32) -> Result<(), TransportError> {
        if i % RAYS_PER_CHECK == RAYS_PER_CHECK - 1 { self.check() } else { Ok(()) }
    }

    /// For transports: counts what was done.
    pub fn count(&self, elements: u64, rays: u64) {
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
    /// The sums of a chunk are a pure function of the job and the chunk, whichever other chunks are asked for.
    ///
    /// # Errors
    /// When `control` asks to stop, or what computes fails.
    fn measure(
        &self,
        job: &Job<'_>,
        chunks: Range<u32>,
        control: &Control,
        sink: &dyn ChunkSink,
    ) -> Result<(), TransportError>;
}
