//! Triangles in parts of a given size, and what is integrated over them.

use crate::{Basis, NodeId, NodeWeights};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use rayon::prelude::*;

/// Parts that are looked at together.
const BATCH: usize = 1 << 16;

/// Calls back with each node that has a weight in the middle of each part of all surfaces, parts that are no longer than the
/// [resolution](Basis::resolution) of the basis.
///
/// Weights are found on the threads of the caller's rayon pool; the order in which they are told does not depend on these.
pub(crate) fn for_each_weight(
    scene: &Scene,
    basis: &(impl Basis + ?Sized),
    mut each: impl FnMut(&Part, NodeId, f32),
) {
    let mut parts = parts(scene, 0..scene.triangle_count() as u32, basis.resolution());
    loop {
        let batch: Vec<Part> = parts.by_ref().take(BATCH).collect();
        if batch.is_empty() {
            return;
        }
        let weights_at = |part: &Part| {
            let mut weights = NodeWeights::default();
            basis.weights_at(part.middle, &mut weights);
            weights
        };
        let weights: Vec<NodeWeights> = batch.par_iter().map(weights_at).collect();
        for (part, weights) in batch.iter().zip(&weights) {
            weights.iter().for_each(|(node, weight)| each(part, node, weight));
        }
    }
}

/// Halvings of a triangle at most: of longer ones parts are larger than was asked for.
const MAX_HALVINGS: u32 = 40;

/// A part of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Its middle.
    pub(crate) middle: SurfacePoint,
    /// Its area, m².
    pub(crate) area: f64,
}

/// The parts of triangles, each halved at its longest edge until none is longer than `size` metres.
///
/// However thin a triangle is, it has about as many parts as it is long or wide. No place of a part is further than ⅔ `size` from
/// its middle.
pub(crate) fn parts(scene: &Scene, tris: std::ops::Range<u32>, size: f32) -> impl Iterator<Item = Part> + '_ {
    let mut stack: Vec<Piece> = Vec::new();
    let mut tris = tris.map(TriId);
    std::iter::from_fn(move || {
        if stack.is_empty() {
            let tri = tris.next()?;
            let corners = scene.triangle_positions(tri).map(|p| p.as_dvec3());
            let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
            stack.push(Piece { tri, corners: CORNERS, area, halvings: 0 });
        }
        while let Some(piece) = stack.pop() {
            match piece.halved(scene, size) {
                Some(halves) => stack.extend(halves),
                None => return Some(Part { middle: piece.middle(), area: piece.area }),
            }
        }
        None
    })
}

/// The weights of all three corners, at corners 0, 1 and 2.
const CORNERS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

struct Piece {
    tri: TriId,
    corners: [[f64; 3]; 3],
    area: f64,
    halvings: u32,
}

impl Piece {
    /// Its halves; `None` if it is small enough.
    fn halved(&self, scene: &Scene, size: f32) -> Option<[Self; 2]> {
        let of_tri = scene.triangle_positions(self.tri).map(|p| p.as_dvec3());
        let at = self.corners.map(|[a, b, c]| of_tri[0] * a + of_tri[1] * b + of_tri[2] * c);
        let squared = |i: usize| at[i].distance_squared(at[(i + 1) % 3]);
        let longest = (1..3).fold(0, |longest, i| if squared(i) > squared(longest) { i } else { longest });
        if squared(longest) <= f64::from(size).powi(2) || self.halvings == MAX_HALVINGS {
            return None;
        }
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(longest + k) % 3]);
        let middle = [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
        let half = |corners| Self { corners, area: 0.5 * self.area, halvings: self.halvings + 1, ..*self };
        Some([half([middle, b, c]), half([a, middle, c])])
    }

    fn middle(&self) -> SurfacePoint {
        let [u, v] = [0, 1].map(|k| (self.corners.iter().map(|corner| corner[k]).sum::<f64>() / 3.0) as f32);
        SurfacePoint { tri: self.tri, bary: Barycentrics { u, v } }
    }
}
