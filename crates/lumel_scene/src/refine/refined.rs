//! A scene with split edges.

use super::parts::{Leaf, Middles, base};
use super::refinement::{Node, Refinement};
use crate::face_list::FaceList;
use crate::triangle::{middle, widest_corner};
use crate::{MAX_TRIANGLES, Scene, SceneError, TriId, tangents};
use glam::Vec3;
use std::ops::{Add, Mul};
use std::sync::Arc;

impl Scene {
    /// The same scene with some of its edges split, as [`Bisection::splits`](crate::Bisection::splits) tells them.
    ///
    /// Vertices keep their indices, and those in the middle of edges follow: everything at them is the mean of what is at the
    /// ends. Triangles come in the order of those that they are parts of. All else is shared.
    ///
    /// # Errors
    /// [`SceneError::BadSplits`] for edges that the scene does not have, and [`SceneError::TooLarge`].
    ///
    /// # Panics
    /// If the scene is refined itself.
    pub fn refined(&self, splits: &[[u32; 2]]) -> Result<Self, SceneError> {
        assert!(
            self.refinement().is_none(),
            "a refined scene is refined no further: split the edges of its original"
        );
        let Parts { positions, leaves, roots, nodes } = Parts::new(self, splits)?;
        let triangles = leaves.iter().map(|leaf| leaf.sides().count()).sum::<usize>();
        if positions.len() > MAX_TRIANGLES || triangles > MAX_TRIANGLES {
            return Err(SceneError::TooLarge { scene: self.name().to_owned(), triangles: triangles as u64 });
        }
        let given = self.shared_faces();
        let mut faces = FaceList {
            positions,
            normals: given.normals.clone(),
            uvs: given.uvs.clone(),
            tangents: given.tangents.clone(),
            lightmap_uvs: given.lightmap_uvs.clone(),
            tints: given.tints.clone(),
            alphas: given.alphas.clone(),
            density_factors: given.density_factors.clone(),
            ..FaceList::default()
        };
        for &[a, b] in splits {
            let [i, j] = [a as usize, b as usize];
            let normal = (faces.normals[i] + faces.normals[j]).try_normalize().unwrap_or(faces.normals[i]);
            faces.normals.push(normal);
            push_mean(&mut faces.uvs, [i, j]);
            if !faces.tangents.is_empty() {
                faces.tangents.push(tangents::middle(faces.tangents[i], faces.tangents[j]));
            }
            push_mean(&mut faces.lightmap_uvs, [i, j]);
            push_mean(&mut faces.tints, [i, j]);
            push_mean(&mut faces.alphas, [i, j]);
        }
        let mut refinement = Refinement {
            given: Arc::clone(given),
            splits: splits.to_vec(),
            roots,
            nodes,
            parts: Vec::with_capacity(triangles),
            first_of: Vec::with_capacity(given.triangles.len()),
        };
        refinement.fill(&leaves, &mut faces);
        Ok(self.with_refined(faces, refinement))
    }
}

/// Adds the mean of two of a list's values, unless it is empty.
fn push_mean<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(values: &mut Vec<T>, [i, j]: [usize; 2]) {
    if !values.is_empty() {
        values.push((values[i] + values[j]) * 0.5);
    }
}

/// What splitting edges makes of the triangles of a scene.
pub(super) struct Parts {
    /// Of all vertices.
    pub(super) positions: Vec<Vec3>,
    /// Triangle by triangle.
    pub(super) leaves: Vec<Leaf>,
    /// The node of each triangle that rays meet.
    pub(super) roots: Vec<u32>,
    /// How triangles were split.
    pub(super) nodes: Vec<Node>,
}

impl Parts {
    /// The triangles themselves.
    pub(super) fn whole(scene: &Scene) -> Self {
        let mut parts =
            Self { positions: scene.positions().to_vec(), leaves: vec![], roots: vec![], nodes: vec![] };
        parts.split_all(scene, &Middles::default());
        parts
    }

    pub(super) fn new(scene: &Scene, splits: &[[u32; 2]]) -> Result<Self, SceneError> {
        let bad = || SceneError::BadSplits { scene: scene.name().to_owned(), splits: splits.len() };
        let mut positions = scene.positions().to_vec();
        for &ends in splits {
            let [a, b] = ends.map(|end| positions.get(end as usize).copied());
            positions.push(middle(a.ok_or_else(bad)?, b.ok_or_else(bad)?));
        }
        let middles = Middles::new(splits, scene.vertex_count() as u32);
        let mut parts = Self { positions, leaves: vec![], roots: vec![], nodes: vec![] };
        // Each edge once, and none that no triangle has.
        let is_each_once = middles.len() == splits.len();
        let used = is_each_once.then(|| parts.split_all(scene, &middles)).flatten();
        if used == Some(splits.len()) { Ok(parts) } else { Err(bad()) }
    }

    /// Splits the triangles at these edges; returns how many of them there are, or nothing if only one side has one.
    fn split_all(&mut self, scene: &Scene, middles: &Middles) -> Option<usize> {
        let first = scene.vertex_count() as u32;
        let mut used = vec![false; middles.len()];
        let mut pending = Vec::new();
        for tri in (0..scene.traced_count() as u32).map(TriId) {
            let root = self.nodes.len() as u32;
            self.roots.push(root);
            self.nodes.push(Node::NONE);
            if scene.traced(tri) != tri {
                continue;
            }
            pending.push((root, Leaf::whole(scene.faces(), tri)));
            while let Some((node, leaf)) = pending.pop() {
                let edge = base(leaf.front.vertices.map(|v| self.positions[v as usize]));
                let ends = [leaf.front.vertices[edge], leaf.front.vertices[(edge + 1) % 3]];
                if middles.get(ends).is_none() {
                    self.nodes[node as usize] = Node::leaf(self.leaves.len() as u32);
                    self.leaves.push(leaf);
                    continue;
                }
                let [first_half, last_half] = leaf.halves(edge, |ends| {
                    let middle = middles.get(ends)?;
                    used[(middle - first) as usize] = true;
                    Some(middle)
                })?;
                let halves = self.nodes.len() as u32;
                self.nodes[node as usize] = Node::split(edge, halves);
                self.nodes.extend([Node::NONE; 2]);
                pending.extend([(halves + 1, last_half), (halves, first_half)]);
            }
        }
        Some(used.iter().filter(|used| **used).count())
    }
}

impl Refinement {
    /// Adds the triangles of all parts, in the order of those that they are parts of, and notes where they are.
    fn fill(&mut self, leaves: &[Leaf], faces: &mut FaceList) {
        let given = Arc::clone(&self.given);
        // The first of each triangle's leaves, and where it is among the new triangles.
        let mut first_leaf = Vec::with_capacity(given.traced + 1);
        let mut next = 0;
        for tri in 0..given.traced as u32 {
            first_leaf.push(next);
            next += leaves[next..].iter().take_while(|leaf| leaf.front.tri.0 == tri).count();
        }
        first_leaf.push(next);
        let leaves: Vec<(Leaf, usize)> = leaves
            .iter()
            .map(|leaf| {
                let turns = widest_corner(leaf.front.vertices.map(|v| faces.positions[v as usize]));
                (leaf.turned(turns), turns)
            })
            .collect();
        let of = |tri: TriId| &leaves[first_leaf[tri.index()]..first_leaf[tri.index() + 1]];
        for tri in (0..given.triangles.len() as u32).map(TriId) {
            self.first_of.push(faces.triangles.len() as u32);
            let front = tri.min(given.other_side[tri.index()]);
            for (leaf, _) in of(front) {
                let part = if tri == front { Some(leaf.front) } else { leaf.back };
                let Some(mut part) = part else { continue };
                if tri != front {
                    // Barycentrics on the one side are those on the other with the first two exchanged.
                    part.vertices.swap(0, 1);
                    part.corners.swap(0, 1);
                }
                faces.triangles.push(part.vertices);
                faces.materials.push(given.materials[tri.index()]);
                faces.objects.push(given.objects[tri.index()]);
                if !given.transparent.is_empty() {
                    faces.transparent.push(given.transparent[tri.index()]);
                }
                self.parts.push((part, leaf.path));
            }
            if tri.index() + 1 == given.traced {
                faces.traced = faces.triangles.len();
            }
        }
        for tri in (0..given.triangles.len() as u32).map(TriId) {
            let other = given.other_side[tri.index()];
            let n = of(tri.min(other)).len() as u32;
            faces.other_side.extend((0..n).map(|i| TriId(self.first_of[other.index()] + i)));
        }
        for (node, tri) in self.nodes.iter_mut().filter_map(|node| node.leaf_mut()) {
            let (leaf, turns) = leaves[*tri as usize];
            let front = leaf.front.tri;
            *node = turns as u8;
            *tri = self.first_of[front.index()] + (*tri - first_leaf[front.index()] as u32);
        }
    }
}
