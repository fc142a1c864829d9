//! Which vertices of a scene stand for the vertices of a mesh that was given.

use std::iter::Sum;
use std::ops::Mul;

/// The scene's vertices that stand for each given vertex, on one side of the faces.
///
/// A given vertex has several where light is discontinuous: neighbouring faces that turn sharply have vertices with
/// different normals. It has none where all faces that use it were dropped, where no face uses it, and on the back of
/// one-sided faces.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexMap {
    /// Where the shares of each given vertex end.
    ends: Vec<u32>,
    shares: Vec<Share>,
}

/// A vertex of the scene and its part of a vertex that was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The scene's vertex.
    pub vertex: u32,
    /// Its part of the angle that the kept faces of this side take up around the given vertex, 0..=1. Does not depend
    /// on how the surface is triangulated; sums to 1 over a given vertex, up to rounding, and is 1 for a single one.
    pub weight: f32,
}

impl VertexMap {
    /// The map of `vertex_count` given vertices from what stands for them, in any order.
    pub(crate) fn new(vertex_count: usize, mut standing: Vec<Standing>) -> Self {
        standing.sort_by_key(|s| (s.given, s.vertex));
        let mut map =
            Self { ends: Vec::with_capacity(vertex_count), shares: Vec::with_capacity(standing.len()) };
        for of_one in standing.chunk_by(|a, b| a.given == b.given) {
            // Nothing stands for the vertices before this one.
            map.ends.resize(of_one[0].given as usize, map.shares.len() as u32);
            let whole: f64 = of_one.iter().map(|s| s.angle).sum();
            map.shares
                .extend(of_one.iter().map(|s| Share { vertex: s.vertex, weight: (s.angle / whole) as f32 }));
            map.ends.push(map.shares.len() as u32);
        }
        map.ends.resize(vertex_count, map.shares.len() as u32);
        map
    }

    /// How many vertices were given.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether no vertices were given.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The vertices that stand for a given one, in ascending order; `None` if there are none.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn at(&self, given: usize) -> Option<&[Share]> {
        let start = given.checked_sub(1).map_or(0, |before| self.ends[before]);
        let shares = &self.shares[start as usize..self.ends[given] as usize];
        (!shares.is_empty()).then_some(shares)
    }

    /// What the given vertices have of a quantity that the scene's vertices have: the mean by [`Share::weight`].
    ///
    /// Exact where one vertex stands for the given one.
    pub fn mean<T: Mul<f32, Output = T> + Sum>(&self, value: impl Fn(u32) -> T) -> Vec<Option<T>> {
        let mean = |shares: &[Share]| shares.iter().map(|share| value(share.vertex) * share.weight).sum();
        (0..self.len()).map(|given| self.at(given).map(mean)).collect()
    }
}

/// A scene's vertex that stands for a given one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    pub(crate) given: u32,
    pub(crate) vertex: u32,
    /// The angle that the faces of this vertex take up around it, radians; more than zero.
    pub(crate) angle: f64,
}
