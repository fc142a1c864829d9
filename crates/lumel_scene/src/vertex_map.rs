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
    /// The share of its faces in the angle that all kept faces on this side span at the given vertex, 0..=1.
    ///
    /// Independent of the triangulation of the surface. The weights of a given vertex sum to 1 up to rounding; a single
    /// one is exactly 1.
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

    /// Number of given vertices.
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

    /// A quantity at the given vertices from `value`, the quantity at the scene's vertices: the mean weighted by
    /// [`Share::weight`], and `None` where no vertex stands for the given one.
    ///
    /// Where one vertex does, its value is returned unchanged.
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
