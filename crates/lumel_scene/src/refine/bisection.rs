//! A mesh that is being refined.

use super::parts::{Leaf, Middles, Part, base, sorted};
use super::refined::Parts;
use crate::edge_length::{EdgeLength, PER_DIAMETER};
use crate::triangle::{length_squared, middle};
use crate::{Scene, SceneError, Weld};
use glam::Vec3;
use std::collections::HashSet;
use std::sync::Arc;

/// The triangles of a scene, some of them split.
///
/// A triangle is split in the middle of its longest edge, and so is every other one at that edge: across creases, materials
/// and objects, whose vertices are their own, and on both sides of two-sided surfaces. No vertex hangs in an edge, so that what
/// was closed stays closed. Angles stay at least half as wide as they were (Rivara 1984; Rosenberg, Stenger 1975). The scene
/// itself does not change.
///
/// ```
/// # use lumel_scene::{Bisection, Material, SceneBuilder};
/// # use std::sync::Arc;
/// let mut builder = SceneBuilder::new("square");
/// let white = builder.add_material(Material::default());
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// builder.add_mesh("square", corners, [[0, 1, 2], [0, 2, 3]], white);
/// let scene = Arc::new(builder.build()?.0);
///
/// let mut mesh = Bisection::new(Arc::clone(&scene));
/// // The edge from 0 to 1 is not the longest of its triangle: the diagonal is split first, which the other one shares.
/// assert!(mesh.split([[0, 1]], usize::MAX));
/// assert_eq!(mesh.splits(), [[0, 2], [0, 1]]);
/// assert_eq!(scene.refined(mesh.splits())?.triangle_count(), 5);
/// # Ok::<(), lumel_scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bisection {
    scene: Arc<Scene>,
    lengths: Option<EdgeLength>,
    /// Of vertices in the middle of edges, after those of the scene.
    positions: Vec<Vec3>,
    splits: Vec<[u32; 2]>,
    middles: Middles,
    leaves: Vec<Leaf>,
    places: Weld,
    /// The place of each vertex.
    place_of: Vec<u32>,
    /// Edges between places that are split, wherever they occur.
    divided: HashSet<[u32; 2]>,
}

impl Bisection {
    /// The triangles of a scene as they are.
    ///
    /// # Panics
    /// If the scene is refined itself.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self::of_parts(&scene, &[], Parts::whole(&scene))
    }

    /// The triangles of a scene with some edges split, as [`splits`](Self::splits) tells them.
    ///
    /// # Errors
    /// [`SceneError::BadSplits`] for edges that the scene does not have.
    ///
    /// # Panics
    /// If the scene is refined itself.
    pub fn with_splits(scene: Arc<Scene>, splits: &[[u32; 2]]) -> Result<Self, SceneError> {
        Ok(Self::of_parts(&scene, splits, Parts::new(&scene, splits)?))
    }

    fn of_parts(scene: &Arc<Scene>, splits: &[[u32; 2]], parts: Parts) -> Self {
        assert!(
            scene.refinement().is_none(),
            "a refined scene is refined no further: split the edges of its original"
        );
        let mut places = Weld::default();
        let place_of = parts.positions.iter().map(|&position| places.number(position)).collect();
        let mut mesh = Self {
            scene: Arc::clone(scene),
            lengths: EdgeLength::for_built(scene),
            positions: parts.positions,
            splits: splits.to_vec(),
            middles: Middles::new(splits, scene.vertex_count() as u32),
            leaves: parts.leaves,
            places,
            place_of,
            divided: HashSet::new(),
        };
        mesh.divided = splits.iter().map(|&ends| mesh.edge_at(ends)).collect();
        mesh
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Number of vertices, those of the scene included.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The position of a vertex, relative to the origin of the scene, metres.
    pub fn position(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    /// The parts that triangles consist of, back sides included.
    pub fn parts(&self) -> impl Iterator<Item = &Part> {
        self.leaves.iter().flat_map(Leaf::sides)
    }

    /// The vertices at the ends of each split edge, in the order of the vertices in their middle.
    pub fn splits(&self) -> &[[u32; 2]] {
        &self.splits
    }

    /// The places at the ends of an edge between two vertices, the same for all edges that are split together.
    pub fn edge_at(&self, ends: [u32; 2]) -> [u32; 2] {
        sorted(ends.map(|vertex| self.place_of[vertex as usize]))
    }

    /// How long an edge is, as a share of the diameter of the [core](crate::SceneBuilder::tessellate_to_suit) of the scene,
    /// or of a longer one away from there.
    pub fn relative_length(&self, ends: [u32; 2]) -> f64 {
        let [a, b] = ends.map(|vertex| self.position(vertex));
        let usual = self.lengths.map_or(f64::INFINITY, |lengths| lengths.at(middle(a, b).as_dvec3()));
        length_squared(a, b).sqrt() / (PER_DIAMETER * usual)
    }

    /// Splits edges, each given by the vertices at its ends, with all that has to be split with them, unless more than
    /// `max_vertices` vertices would result.
    ///
    /// Edges that are too short for a point between their ends stay. Returns whether it did.
    pub fn split(&mut self, edges: impl IntoIterator<Item = [u32; 2]>, max_vertices: usize) -> bool {
        let mut finer = self.clone();
        for ends in edges {
            let [a, b] = ends.map(|vertex| self.position(vertex));
            let between = middle(a, b);
            if between != a && between != b {
                finer.divided.insert(self.edge_at(ends));
            }
        }
        let fits = finer.close(max_vertices);
        if fits {
            *self = finer;
        }
        fits
    }

    /// Splits every triangle at an edge that is to be split, its longest edge first, until no such edge is left.
    fn close(&mut self, max_vertices: usize) -> bool {
        loop {
            let before = self.divided.len();
            let mut pending = std::mem::take(&mut self.leaves);
            // Last in, first out: parts of a triangle stay together and in their order.
            pending.reverse();
            while let Some(leaf) = pending.pop() {
                let edges = [0, 1, 2]
                    .map(|k| self.edge_at([leaf.front.vertices[k], leaf.front.vertices[(k + 1) % 3]]));
                if !edges.iter().any(|edge| self.divided.contains(edge)) {
                    self.leaves.push(leaf);
                    continue;
                }
                let longest = base(leaf.front.vertices.map(|vertex| self.position(vertex)));
                self.divided.insert(edges[longest]);
                let Some([first, last]) = leaf.halves(longest, |ends| Some(self.middle(ends))) else {
                    continue;
                };
                if self.vertex_count() > max_vertices {
                    return false;
                }
                pending.extend([last, first]);
            }
            if self.divided.len() == before {
                return true;
            }
        }
    }

    /// The vertex in the middle of an edge; a new one, unless there is one.
    fn middle(&mut self, ends: [u32; 2]) -> u32 {
        if let Some(vertex) = self.middles.get(ends) {
            return vertex;
        }
        let vertex = self.positions.len() as u32;
        let [a, b] = ends.map(|vertex| self.position(vertex));
        let position = middle(a, b);
        self.positions.push(position);
        self.place_of.push(self.places.number(position));
        self.middles.insert(ends, vertex);
        self.splits.push(sorted(ends));
        vertex
    }
}
