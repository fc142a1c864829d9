//! From chunks to a field.

use crate::job::{Cancelled, ChunkSink, ChunkSums, Control, Job, Transport};
use glam::{DVec3, Vec3};
use lumel_basis::Field;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A measured field.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Irradiance per node; zero where nothing was measured.
    pub field: Field,
    /// Whether a node was measured.
    pub known: Vec<bool>,
}

/// Looks at a measurement that is still under way.
pub trait PartialField: Sync {
    /// Whether to look now; asked after each chunk. A yes is followed by one look.
    fn wants_look(&self) -> bool;

    /// What the chunks so far say. Each look has all chunks of the looks before it.
    ///
    /// Takes no time from the other threads, unless they want a look too.
    fn look(&self, measured: Measured);
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
    let chunks = Mutex::new((0..shape.chunks).map(|_| None).collect());
    let slots = Slots { nodes: shape.nodes, chunks, progress, looking: Mutex::new(()) };
    transport.measure(job, 0..shape.chunks, control, &slots)?;
    let chunks = lock(&slots.chunks);
    Ok(Measured::from_chunks(shape.nodes, &chunks))
}

struct Slots<'a> {
    nodes: usize,
    chunks: Mutex<Vec<Option<Arc<ChunkSums>>>>,
    progress: Option<&'a dyn PartialField>,
    /// Held by the thread that looks, so that looks come in order.
    looking: Mutex<()>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Slots are written whole, so a panic elsewhere leaves nothing half-done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ChunkSink for Slots<'_> {
    fn accept(&self, chunk: u32, sums: ChunkSums) {
        lock(&self.chunks)[chunk as usize] = Some(Arc::new(sums));
        if let Some(progress) = self.progress
            && progress.wants_look()
        {
            let _looking = lock(&self.looking);
            // Merging takes long: only the list is copied while nobody else can add to it.
            let chunks = lock(&self.chunks).clone();
            progress.look(Measured::from_chunks(self.nodes, &chunks));
        }
    }
}

impl Measured {
    /// Merges the chunks that are there, in order.
    fn from_chunks(nodes: usize, chunks: &[Option<Arc<ChunkSums>>]) -> Self {
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
