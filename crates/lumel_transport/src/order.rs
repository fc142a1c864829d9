//! The order in which elements are measured.
//!
//! Rays of neighbours meet the same parts of the tree, and neighbours that face the same way can send theirs together.

use crate::plan::Plan;
use glam::Vec3;
use lumel_basis::{ElementId, Identity, Receivers, Sampling};
use std::sync::Arc;

/// Elements per chunk: few enough to spread over cores and to stop quickly, and as many neighbours as the tracer's packets
/// have rays, so that they can send theirs together.
pub(crate) const CHUNK: usize = 16;

/// Bits of a Morton code per axis.
const BITS: u32 = 16;

/// Elements of some receivers in chunks: those with the same number of samples, that face the same way, along a
/// space-filling curve. Cheap to clone, for operators of the same receivers.
#[derive(Clone, Debug)]
pub struct Order {
    elements: Arc<[ElementId]>,
    chunks: Arc<[Chunk]>,
    sampling: Sampling,
}

/// Neighbours with the same number of samples.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    /// The place after its last element.
    end: u32,
    doublings: i8,
}

impl Order {
    /// Sorts the elements.
    pub fn new<R: Receivers>(receivers: &R) -> Self {
        Self::of(receivers, spatial(receivers))
    }

    /// Some elements, in an order of their own in which those with the same number of samples follow each other.
    fn of<R: Receivers>(receivers: &R, elements: Vec<ElementId>) -> Self {
        let (mut chunks, mut end) = (Vec::with_capacity(elements.len() / CHUNK + 1), 0);
        for same in elements.chunk_by(|&a, &b| receivers.doublings(a) == receivers.doublings(b)) {
            for chunk in same.chunks(CHUNK) {
                end += chunk.len() as u32;
                chunks.push(Chunk { end, doublings: receivers.doublings(chunk[0]) });
            }
        }
        Self { elements: elements.into(), chunks: chunks.into(), sampling: receivers.sampling() }
    }

    /// The elements that count towards one of certain nodes.
    pub(crate) fn towards<R: Receivers>(&self, receivers: &R, nodes: &[bool]) -> Self {
        let mut towards = Vec::new();
        let elements = self.elements.iter().copied().filter(|&element| {
            towards.clear();
            receivers.nodes_of(element, &mut towards);
            towards.iter().any(|node| nodes[node.index()])
        });
        Self::of(receivers, elements.collect())
    }

    pub(crate) fn elements(&self) -> &[ElementId] {
        &self.elements
    }

    /// Tells these elements from others of the same receivers.
    pub(crate) fn identity_within(&self, receivers: &Identity) -> Identity {
        let elements: Vec<u8> = self.elements.iter().flat_map(|element| element.0.to_le_bytes()).collect();
        Identity::new("some elements", [&receivers.as_bytes()[..], &elements])
    }

    pub(crate) fn chunk_count(&self) -> u32 {
        self.chunks.len() as u32
    }

    /// The elements of a chunk.
    pub(crate) fn chunk(&self, chunk: u32) -> &[ElementId] {
        let begin = if chunk == 0 { 0 } else { self.chunks[chunk as usize - 1].end };
        &self.elements[begin as usize..self.chunks[chunk as usize].end as usize]
    }

    /// How many doublings of their samples the elements of a chunk get.
    pub(crate) fn doublings_of(&self, chunk: u32) -> i8 {
        self.chunks[chunk as usize].doublings
    }

    /// All doublings that there are, in ascending order.
    pub(crate) fn doublings(&self) -> Vec<i8> {
        let mut all: Vec<i8> = self.chunks.iter().map(|chunk| chunk.doublings).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Hemisphere rays of all elements in one application of an operator.
    pub fn rays(&self, plan: &Plan) -> u64 {
        let of = |chunk: u32| {
            let samples = plan.samples(plan.indirect_samples, self.sampling, self.doublings_of(chunk));
            self.chunk(chunk).len() as u64 * u64::from(samples)
        };
        (0..self.chunk_count()).map(of).sum()
    }
}

fn spatial<R: Receivers>(receivers: &R) -> Vec<ElementId> {
    let place = |e: u32| {
        let site = receivers.central_site(ElementId(e));
        (site.origin, site.frame.normal)
    };
    let places: Vec<(Vec3, Vec3)> = (0..receivers.element_count() as u32).map(place).collect();
    let finite = || places.iter().map(|(origin, _)| *origin).filter(|p| p.is_finite());
    let min = finite().fold(Vec3::INFINITY, Vec3::min);
    let max = finite().fold(Vec3::NEG_INFINITY, Vec3::max);
    let scale = ((1 << BITS) - 1) as f32 / (max - min).max_element().max(f32::MIN_POSITIVE);
    let key = |&(origin, normal): &(Vec3, Vec3)| {
        let cell = ((origin - min) * scale).to_array().map(|x| x as u64);
        facing(normal) << (3 * BITS) | morton(cell)
    };
    let entry = |(e, place)| {
        let element = ElementId(e as u32);
        (receivers.doublings(element), key(place), element)
    };
    let mut order: Vec<(i8, u64, ElementId)> = places.iter().enumerate().map(entry).collect();
    order.sort_unstable();
    order.into_iter().map(|(.., element)| element).collect()
}

/// Twelve classes of normals: the nearest axis, and the sign of z, where frames jump.
fn facing(normal: Vec3) -> u64 {
    let axis = normal.abs().max_position();
    (4 * axis + 2 * usize::from(normal[axis] < 0.0) + usize::from(normal.z < 0.0)) as u64
}

/// Interleaves the bits of three coordinates.
fn morton(cell: [u64; 3]) -> u64 {
    let spread = |x: u64| (0..BITS).fold(0, |code, bit| code | (x >> bit & 1) << (3 * bit));
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_basis::PointReceivers;
    use lumel_scene::{Material, SceneBuilder};

    #[test]
    fn every_element_comes_once_beside_one_that_is_near_and_faces_the_same_way() {
        let at = |i: u32| Vec3::new((i * 7 % 64) as f32, (i / 64) as f32, 0.0);
        let normal = |i: u32| if i.is_multiple_of(2) { Vec3::Z } else { Vec3::NEG_Y };
        let mut builder = SceneBuilder::new("test");
        let grey = builder.add_material(Material::default());
        builder.add_mesh("a", [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]], grey);
        let scene = builder.build().unwrap().0;
        let points = PointReceivers::new(&scene, (0..4096).map(|i| (at(i), normal(i)))).unwrap();
        let order = spatial(&points);
        let mut seen = order.clone();
        seen.sort_unstable();
        assert!(seen.iter().map(|e| e.0).eq(0..4096));
        let turns = order.windows(2).filter(|pair| normal(pair[0].0) != normal(pair[1].0)).count();
        assert_eq!(turns, 1);
        let step = |pair: &[ElementId]| at(pair[0].0).distance(at(pair[1].0));
        let mean = order.windows(2).map(step).sum::<f32>() / 4095.0;
        assert!(mean < 3.0, "neighbours in the order are {mean} apart, in the list 15");
    }
}
