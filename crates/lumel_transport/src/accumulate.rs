//! From chunks to a field.

use crate::Sums;
use crate::job::{ChunkSink, Control, Job, Shape, Transport, TransportError};
use glam::{DVec3, Vec3};
use lumel_basis::Field;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What was measured, by node.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Light; zero where nothing was measured.
    pub field: Field,
    /// Whether a node was measured.
    pub known: Vec<bool>,
    /// Share of the sites that nobody can see, from 0 to 1; zero unless the source was [nothing](crate::Source::Nothing).
    pub hidden: Vec<f32>,
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
/// When `control` asks to stop, or the transport fails.
pub fn accumulate(
    transport: &dyn Transport,
    job: &Job<'_>,
    control: &Control,
    progress: Option<&dyn PartialField>,
) -> Result<Measured, TransportError> {
    let shape = transport.shape();
    let chunks = Mutex::new((0..shape.chunks).map(|_| None).collect());
    let slots = Slots { shape, chunks, progress, looking: Mutex::new(()) };
    transport.measure(job, 0..shape.chunks, control, &slots)?;
    let chunks = lock(&slots.chunks);
    Ok(slots.merged(&chunks))
}

struct Slots<'a> {
    shape: Shape,
    chunks: Mutex<Vec<Option<Arc<Sums>>>>,
    progress: Option<&'a dyn PartialField>,
    /// Held by the thread that looks, so that looks come in order.
    looking: Mutex<()>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Slots are written whole, so a panic elsewhere leaves nothing half-done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ChunkSink for Slots<'_> {
    fn accept(&self, chunk: u32, sums: Sums) {
        lock(&self.chunks)[chunk as usize] = Some(Arc::new(sums));
        if let Some(progress) = self.progress
            && progress.wants_look()
        {
            let _looking = lock(&self.looking);
            // Merging takes long: only the list is copied while nobody else can add to it.
            let chunks = lock(&self.chunks).clone();
            progress.look(self.merged(&chunks));
        }
    }
}

impl Slots<'_> {
    /// The chunks that are there.
    fn merged(&self, chunks: &[Option<Arc<Sums>>]) -> Measured {
        Measured::merge(self.shape.nodes, self.shape.channels, chunks.iter().flatten().map(|sums| &**sums))
    }
}

/// A node of whose sites more than this share is hidden is not measured.
const MAX_HIDDEN: f32 = 0.5;

impl Measured {
    /// Which nodes can be measured, as a measurement of [nothing](crate::Source::Nothing) says: some of their sites are seen.
    pub fn visible(&self) -> impl Iterator<Item = bool> {
        self.hidden.iter().zip(&self.known).map(|(hidden, known)| *known && *hidden <= MAX_HIDDEN)
    }

    /// Merges sums in the order they come in and divides by the weights.
    pub fn merge<'a>(nodes: usize, channels: usize, sums: impl IntoIterator<Item = &'a Sums>) -> Self {
        let mut weights = vec![0.0f64; nodes];
        let mut values = vec![DVec3::ZERO; nodes * channels];
        let mut hidden = vec![0.0f64; nodes];
        for sums in sums {
            let entries = sums.nodes.iter().zip(&sums.weights).zip(sums.values.chunks_exact(channels));
            for ((node, weight), new) in entries {
                weights[node.index()] += weight;
                let sum = &mut values[node.index() * channels..][..channels];
                sum.iter_mut().zip(new).for_each(|(sum, new)| *sum += *new);
            }
            for (node, share) in sums.nodes.iter().zip(&sums.hidden) {
                hidden[node.index()] += share;
            }
        }
        let mean = |(value, weight): (&DVec3, f64)| {
            if weight > 0.0 { (*value / weight).as_vec3() } else { Vec3::ZERO }
        };
        let weight_of = |i: usize| weights[i / channels];
        let values: Vec<Vec3> =
            values.iter().enumerate().map(|(i, value)| mean((value, weight_of(i)))).collect();
        let share = |(sum, weight): (&f64, &f64)| if *weight > 0.0 { (sum / weight) as f32 } else { 0.0 };
        Self {
            field: Field::with_channels(channels, values),
            known: weights.iter().map(|weight| *weight > 0.0).collect(),
            hidden: hidden.iter().zip(&weights).map(share).collect(),
        }
    }
}
