//! The parts of triangles after some edges were split.

use crate::face_list::FaceList;
use crate::triangle::longest;
use crate::{Barycentrics, SurfacePoint, TriId};
use glam::Vec3;
use std::collections::HashMap;

/// A part of a triangle of the scene that is refined: one side of it, if it has two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The triangle.
    pub tri: TriId,
    /// Its vertices: those of the scene, and then those in the middle of split edges.
    pub vertices: [u32; 3],
    /// Where they lie on the triangle.
    pub corners: [Barycentrics; 3],
}

impl Part {
    /// The surface point with these weights of the part's corners.
    pub fn at(&self, [a, b, c]: [f32; 3]) -> SurfacePoint {
        let [p, q, r] = self.corners;
        let bary = Barycentrics { u: a * p.u + b * q.u + c * r.u, v: a * p.v + b * q.v + c * r.v };
        SurfacePoint { tri: self.tri, bary }
    }
}

/// A part of a triangle that rays meet, with both of its sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub(super) front: Part,
    /// Its other side, corner by corner in the order of the front.
    pub(super) back: Option<Part>,
    /// Tells it from the other parts of its triangle: 1, and a bit for each split that it comes from.
    pub(super) path: u64,
}

impl Leaf {
    /// A whole triangle.
    pub(super) fn whole(faces: &FaceList, tri: TriId) -> Self {
        let other = faces.other_side[tri.index()];
        let [a, b, c] = faces.triangles[other.index()];
        let [p, q, r] = Barycentrics::CORNERS;
        let back = Part { tri: other, vertices: [b, a, c], corners: [q, p, r] };
        let front = Part { tri, vertices: faces.triangles[tri.index()], corners: Barycentrics::CORNERS };
        Self { front, back: (other != tri).then_some(back), path: 1 }
    }

    /// Both halves of the edge that begins at corner `edge`, the half at that corner last.
    pub(super) fn halves(
        &self,
        edge: usize,
        mut middle: impl FnMut([u32; 2]) -> Option<u32>,
    ) -> Option<[Self; 2]> {
        let mut of_side = |part: &Part| {
            let (a, b) = (edge, (edge + 1) % 3);
            let vertex = middle([part.vertices[a], part.vertices[b]])?;
            let [p, q] = [part.corners[a], part.corners[b]];
            let corner = Barycentrics { u: 0.5 * (p.u + q.u), v: 0.5 * (p.v + q.v) };
            let with = |k: usize| {
                let mut half = *part;
                (half.vertices[k], half.corners[k]) = (vertex, corner);
                half
            };
            Some([with(a), with(b)])
        };
        let [front, front_last] = of_side(&self.front)?;
        let (back, back_last) = match &self.back {
            None => (None, None),
            Some(back) => of_side(back).map(|[first, last]| (Some(first), Some(last)))?,
        };
        let path = self.path << 1;
        Some([Self { front, back, path }, Self { front: front_last, back: back_last, path: path | 1 }])
    }

    /// The same part beginning with another corner.
    pub(super) fn turned(mut self, turns: usize) -> Self {
        for part in [Some(&mut self.front), self.back.as_mut()].into_iter().flatten() {
            part.vertices.rotate_left(turns);
            part.corners.rotate_left(turns);
        }
        self
    }

    pub(super) fn sides(&self) -> impl Iterator<Item = &Part> {
        [&self.front].into_iter().chain(&self.back)
    }
}

/// The longest edge of a triangle: where it is split.
pub(super) fn base(corners: [Vec3; 3]) -> usize {
    longest(corners, 0..3).unwrap_or(0)
}

/// The vertices in the middle of split edges.
#[derive(Clone, Debug, Default)]
pub(super) struct Middles(HashMap<[u32; 2], u32>);

impl Middles {
    /// Those of edges between two vertices each, numbered from `first` on.
    pub(super) fn new(splits: &[[u32; 2]], first: u32) -> Self {
        Self((first..).zip(splits).map(|(middle, &ends)| (sorted(ends), middle)).collect())
    }

    pub(super) fn get(&self, ends: [u32; 2]) -> Option<u32> {
        self.0.get(&sorted(ends)).copied()
    }

    pub(super) fn insert(&mut self, ends: [u32; 2], middle: u32) {
        self.0.insert(sorted(ends), middle);
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

/// Two numbers, the smaller first.
pub(super) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
