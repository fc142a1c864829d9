//! What rays that are looked at together have in common.

/// Per axis, the smallest and the largest of a coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

/// Where rays start, as far as errors are concerned.
#[derive(Clone, Copy)]
pub(super) struct Origins {
    pub(super) center: [f32; 3],
    pub(super) spread: f32,
    /// The largest component of their directions.
    pub(super) reach: f32,
}
