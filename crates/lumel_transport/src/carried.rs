//! Rows of a coarser mesh for a finer one: triangles that were not split keep their rays.

use crate::cached::Stored;
use crate::ends::{RayEnd, StoredEnd};
use crate::operator::CpuTransport;
use crate::rows::Rows;
use lumel_basis::{Basis, ElementId, Receivers};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// The rows of some elements of a chunk.
#[derive(Debug)]
pub(crate) struct Carried {
    /// Which, by their place in the chunk.
    lanes: Vec<bool>,
    /// As [rows](crate::cached::ChunkRows) are stored; those of other elements say nothing.
    pub(crate) ends: Box<[StoredEnd]>,
}

impl Carried {
    pub(crate) fn has(&self, lane: usize) -> bool {
        self.lanes[lane]
    }

    /// Adds the rows of elements at these places of the chunk, which lie side by side among themselves.
    pub(crate) fn fill(&mut self, places: &[usize], ends: &[StoredEnd]) {
        for (row, new) in self.ends.chunks_exact_mut(self.lanes.len()).zip(ends.chunks_exact(places.len())) {
            places.iter().zip(new).for_each(|(&place, &end)| row[place] = end);
        }
        places.iter().for_each(|&place| self.lanes[place] = true);
    }
}

impl Rows {
    /// These rows with what is stored of the same elements of another mesh: the original triangles of both are the same, and
    /// so are sites, samples and where rays end, which are told by the triangles of the new mesh.
    ///
    /// What was carried has the bits of what is traced: ends are rounded on the original triangles.
    pub(crate) fn carried_from<B: Basis, R: Receivers>(
        mut self,
        stored: &Stored,
        new: &CpuTransport<B, R>,
    ) -> Self {
        let is_same = self.key.is_like(&stored.rows.key) && stored.scene.has_originals_of(&new.scene);
        if !is_same {
            return self;
        }
        let mut places: HashMap<u32, (u32, usize)> = HashMap::new();
        for chunk in (0..stored.order.chunk_count())
            .filter(|&chunk| stored.rows.chunks[chunk as usize].get().is_some())
        {
            for (lane, &element) in stored.order.chunk(chunk).iter().enumerate() {
                places.insert(stored.receivers.stream(element), (chunk, lane));
            }
        }
        let whole = kept_triangles(&stored.scene, &new.scene);
        let refined = |end: StoredEnd| match whole.get(end.tri as usize) {
            Some(&Some(TriId(tri))) => StoredEnd { tri, ..end },
            _ => match end.end() {
                Some(RayEnd::Surface(at)) => {
                    StoredEnd::new(&RayEnd::Surface(point_on(&stored.scene, &new.scene, at)))
                }
                _ => end,
            },
        };
        let found = |chunk: u32, element: ElementId| {
            let &(from, lane) = places.get(&new.receivers.stream(element))?;
            let old = stored.order.chunk(from);
            let [here, there] =
                [new.receivers.central_site(element), stored.receivers.central_site(old[lane])];
            let is_same = here.origin == there.origin
                && here.frame.normal == there.frame.normal
                && new.order.doublings_of(chunk) == stored.order.doublings_of(from);
            let ends = stored.rows.chunks[from as usize].get()?;
            is_same.then(|| {
                ends.iter().skip(lane).step_by(old.len()).map(|&end| refined(end)).collect::<Vec<_>>()
            })
        };
        let of_chunk = |chunk: u32| {
            let elements = new.elements(chunk);
            let mut carried: Option<Carried> = None;
            for (lane, &element) in elements.iter().enumerate() {
                let Some(row) = found(chunk, element) else { continue };
                let carried = carried.get_or_insert_with(|| Carried {
                    lanes: vec![false; elements.len()],
                    ends: vec![StoredEnd::SKY; elements.len() * row.len()].into(),
                });
                carried.fill(&[lane], &row);
            }
            Mutex::new(carried)
        };
        self.carried = (0..new.order.chunk_count()).into_par_iter().map(of_chunk).collect();
        self
    }

    /// What was carried over of a chunk, once.
    pub(crate) fn take_carried(&self, chunk: u32) -> Option<Carried> {
        self.carried.get(chunk as usize)?.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The point of another mesh with the same original triangles.
fn point_on(old: &Scene, new: &Scene, at: SurfacePoint) -> SurfacePoint {
    new.refined_point(old.refinement().map_or(at, |refinement| refinement.original(at)))
}

/// For each triangle of a mesh, the one of another mesh with the same original triangles that has the same corners in the same
/// order, if there is one: what is stored of the one is true of the other.
fn kept_triangles(old: &Scene, new: &Scene) -> Vec<Option<TriId>> {
    let middle = Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 };
    let (Some(of_old), Some(of_new)) = (old.refinement(), new.refinement()) else { return Vec::new() };
    let kept = |tri: u32| {
        let found = point_on(old, new, SurfacePoint { tri: TriId(tri), bary: middle }).tri;
        let [here, there] = [of_old.part(TriId(tri)), of_new.part(found)];
        ((here.tri, here.corners) == (there.tri, there.corners)).then_some(found)
    };
    (0..old.triangle_count() as u32).into_par_iter().map(kept).collect()
}
