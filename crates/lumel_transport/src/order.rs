//! The order in which elements are measured.
//!
//! Rays of neighbours meet the same parts of the tree, and neighbours that face the same way can send theirs together.

use glam::Vec3;
use lumel_basis::{CENTER, ElementId, Identity, NodeWeights, Receivers};
use std::sync::Arc;

/// Elements per chunk: few enough to spread over cores and to stop quickly, and as many neighbours as the tracer's packets
/// have rays, so that they can send theirs together.
pub(crate) const CHUNK: usize = 16;

/// Bits of a Morton code per axis.
const BITS: u32 = 16;

/// Elements of some receivers: those that face the same way along a space-filling curve, one facing after the
/// other. Cheap to clone, for operators of the same receivers.
#[derive(Clone, Debug)]
pub struct Order(Arc<[ElementId]>);

impl Order {
    /// Sorts the elements.
    pub fn new<R: Receivers>(receivers: &R) -> Self {
        Self(spatial(receivers).into())
    }

    pub(crate) fn elements(&self) -> &[ElementId] {
        &self.0
    }

    /// Tells these elements from others of the same receivers.
    pub(crate) fn identity_within(&self, receivers: &Identity) -> Identity {
        let elements: Vec<u8> = self.0.iter().flat_map(|element| element.0.to_le_bytes()).collect();
        Identity::new("some elements", [&receivers.as_bytes()[..], &elements])
    }

    pub(crate) fn chunk_count(&self) -> u32 {
        self.0.len().div_ceil(CHUNK) as u32
    }

    /// The elements of a chunk.
    pub(crate) fn chunk(&self, chunk: u32) -> &[ElementId] {
        let first = chunk as usize * CHUNK;
        &self.0[first..self.0.len().min(first + CHUNK)]
    }
}

impl FromIterator<ElementId> for Order {
    fn from_iter<I: IntoIterator<Item = ElementId>>(elements: I) -> Self {
        Self(elements.into_iter().collect())
    }
}

fn spatial<R: Receivers>(receivers: &R) -> Vec<ElementId> {
    let mut weights = NodeWeights::default();
    let mut place = |e: u32| {
        weights.clear();
        let site = receivers.site(ElementId(e), CENTER, &mut weights);
        (site.origin, site.frame.normal)
    };
    let places: Vec<(Vec3, Vec3)> = (0..receivers.element_count() as u32).map(&mut place).collect();
    let finite = || places.iter().map(|(origin, _)| *origin).filter(|p| p.is_finite());
    let min = finite().fold(Vec3::INFINITY, Vec3::min);
    let max = finite().fold(Vec3::NEG_INFINITY, Vec3::max);
    let scale = ((1 << BITS) - 1) as f32 / (max - min).max_element().max(f32::MIN_POSITIVE);
    let key = |&(origin, normal): &(Vec3, Vec3)| {
        let cell = ((origin - min) * scale).to_array().map(|x| x as u64);
        facing(normal) << (3 * BITS) | morton(cell)
    };
    let mut order: Vec<(u64, ElementId)> =
        places.iter().enumerate().map(|(e, place)| (key(place), ElementId(e as u32))).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, element)| element).collect()
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

    #[test]
    fn every_element_comes_once_beside_one_that_is_near_and_faces_the_same_way() {
        let at = |i: u32| Vec3::new((i * 7 % 64) as f32, (i / 64) as f32, 0.0);
        let normal = |i: u32| if i.is_multiple_of(2) { Vec3::Z } else { Vec3::NEG_Y };
        let points = PointReceivers::new((0..4096).map(|i| (at(i), normal(i)))).unwrap();
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
