//! From chunks to a field.

use crate::job::{Cancelled, ChunkSink, ChunkSums, Control, Job, Transport};
use glam::{DVec3, Vec3};
use lumel_basis::Field;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A measured field.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Irradiance per node; zero where nothing was measured.
    pub field: Field,
    /// Whether a node was measured.
    pub known: Vec<bool>,
}

/// A look at a measurement that is still under way.
pub trait PartialField: Sync {
    /// Called after each chunk with the chunks so far; `None` for those that are missing.
    fn chunk_done(&self, chunks: &[Option<ChunkSums>]);
}

/// Applies the operator once and merges the chunks in their order.
///
/// The bits of the result depend on the job alone, not on threads or on the order in which chunks arrive.
///
/// # Errors
/// When `control` asks to stop.
pub fn accumulate(
    transport: &dyn Transport,
    job: &Job<'_>,
    control: &Control,
    progress: Option<&dyn PartialField>,
) -> Result<Measured, Cancelled> {
    let shape = transport.shape();
    let slots = Slots { chunks: Mutex::new((0..shape.chunks).map(|_| None).collect()), progress };
    transport.measure(job, 0..shape.chunks, control, &slots)?;
    let chunks = slots.lock();
    Ok(Measured::from_chunks(shape.nodes, &chunks))
}

struct Slots<'a> {
    chunks: Mutex<Vec<Option<ChunkSums>>>,
    progress: Option<&'a dyn PartialField>,
}

impl Slots<'_> {
    fn lock(&self) -> MutexGuard<'_, Vec<Option<ChunkSums>>> {
        // Slots are written whole, so a panic elsewhere leaves nothing half-done.
        self.chunks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ChunkSink for Slots<'_> {
    fn accept(&self, chunk: u32, sums: ChunkSums) {
        let mut chunks = self.lock();
        chunks[chunk as usize] = Some(sums);
        if let Some(progress) = self.progress {
            progress.chunk_done(&chunks);
        }
    }
}

impl Measured {
    /// Merges the chunks that are there, in order.
    pub fn from_chunks(nodes: usize, chunks: &[Option<ChunkSums>]) -> Self {
        let mut sums = vec![(0.0f64, DVec3::ZERO); nodes];
        for sum in chunks.iter().flatten().flat_map(|chunk| &chunk.sums) {
            let (weight, value) = &mut sums[sum.node.index()];
            *weight += sum.weight;
            *value += sum.value;
        }
        let mean = |&(weight, value): &(f64, DVec3)| {
            if weight > 0.0 { (value / weight).as_vec3() } else { Vec3::ZERO }
        };
        Self {
            field: Field::from_values(sums.iter().map(mean).collect()),
            known: sums.iter().map(|(weight, _)| *weight > 0.0).collect(),
        }
    }
}
