//! The rows of the discrete transport operator: where all of its hemisphere rays end.
//!
//! Directions do not depend on the bounce, nor on lights or materials: what is stored here serves every bounce, and a
//! scene under other lights.

use crate::carried::Carried;
use crate::columns::Columns;
use crate::ends::StoredEnd;
use crate::hemisphere::HemisphereDensity;
use lumel_basis::Identity;
use lumel_sample::SamplerKind;
use std::mem::size_of;
use std::sync::{Mutex, OnceLock};

/// The ends of all hemisphere rays of an operator, chunk by chunk, traced when they are first asked for.
#[derive(Debug)]
pub struct Rows {
    pub(crate) key: RowsKey,
    pub(crate) chunks: Vec<OnceLock<Box<[StoredEnd]>>>,
    /// What is known of each chunk before it is traced, if anything is.
    pub(crate) carried: Vec<Mutex<Option<Carried>>>,
    /// The same rays by where they end, made when light is shot for the first time.
    pub(crate) columns: OnceLock<Columns>,
}

/// What the ends of rays depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RowsKey {
    /// Where rays start, which tells the surfaces too.
    pub(crate) elements: Identity,
    /// Rays that were asked for of each element.
    pub(crate) requested: u32,
    pub(crate) sampler: SamplerKind,
    pub(crate) seed: u64,
    pub(crate) portion: u32,
    pub(crate) density: HemisphereDensity,
}

impl RowsKey {
    /// Whether the same rays are stored of elements that both have.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        Self { elements: other.elements, ..*self } == *other
    }
}

impl Rows {
    pub(crate) fn new(key: RowsKey, chunks: u32) -> Self {
        let chunks = (0..chunks).map(|_| OnceLock::new()).collect();
        Self { key, chunks, carried: Vec::new(), columns: OnceLock::new() }
    }

    /// Bytes of rows with so many rays in all, once all are traced.
    ///
    /// `textured` adds the albedo at the end of each ray, which is kept where it changes within triangles.
    pub fn bytes_for(rays: u64, textured: bool) -> u64 {
        let per_ray = size_of::<StoredEnd>() + if textured { size_of::<[u16; 3]>() } else { 0 };
        rays * per_ray as u64
    }

    /// Bytes that shooting takes besides, for so many rays.
    pub fn column_bytes_for(rays: u64) -> u64 {
        rays * Columns::BYTES_PER_RAY
    }

    /// Whether all rays have been traced.
    pub fn is_complete(&self) -> bool {
        self.chunks.iter().all(|chunk| chunk.get().is_some())
    }

    /// Bytes of the rows that are held now, without albedos.
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().filter_map(OnceLock::get).map(|chunk| size_of_val(&**chunk) as u64).sum()
    }
}
