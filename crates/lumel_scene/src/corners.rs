//! Which corners around a vertex belong together.

use crate::Forest;
use crate::mesh::{Face, ObjectMesh};
use crate::weld::{Weld, sorted_by_number};
use std::collections::HashMap;

/// The corners of a mesh, three per face, gathered into points; two corners may only be joined at one point.
pub(crate) struct Corners {
    /// The point of each vertex.
    point_of: Vec<u32>,
    /// Corners (`3 * face + corner`) sorted by point.
    sorted: Vec<u32>,
}

impl Corners {
    /// Every vertex is a point of its own.
    pub(crate) fn by_vertex(mesh: &ObjectMesh) -> Self {
        Self::new(mesh, (0..mesh.positions.len() as u32).collect())
    }

    /// Vertices at the same position are one point.
    pub(crate) fn by_position(mesh: &ObjectMesh) -> Self {
        let mut weld = Weld::default();
        Self::new(mesh, mesh.positions.iter().map(|p| weld.number(*p)).collect())
    }

    fn new(mesh: &ObjectMesh, point_of: Vec<u32>) -> Self {
        let corners: Vec<u32> = (0..3 * mesh.faces.len() as u32).collect();
        let point = |corner: &u32| point_of[vertex_of(&mesh.faces, *corner) as usize];
        let sorted = sorted_by_number(&corners, mesh.positions.len(), point);
        Self { point_of, sorted }
    }

    fn point(&self, faces: &[Face], corner: u32) -> u32 {
        self.point_of[vertex_of(faces, corner) as usize]
    }

    /// A group for each corner: corners at one point whose faces are chained by common edges across which
    /// `joined(face, face)` holds. Edges of more than two faces join nothing.
    ///
    /// A group's number is its first corner in face order.
    pub(crate) fn groups(&self, faces: &[Face], joined: impl Fn(usize, usize) -> bool) -> Vec<u32> {
        let mut groups = Forest::new(self.sorted.len());
        let mut spokes: Vec<(u32, u32)> = Vec::new();
        for run in self.sorted.chunk_by(|&a, &b| self.point(faces, a) == self.point(faces, b)) {
            spokes.clear();
            for &corner in run {
                let (face, k) = (corner / 3 * 3, corner % 3);
                for other in [face + (k + 1) % 3, face + (k + 2) % 3] {
                    spokes.push((self.point(faces, other), corner));
                }
            }
            spokes.sort_unstable();
            for edge in spokes.chunk_by(|a, b| a.0 == b.0) {
                if let [(_, a), (_, b)] = *edge
                    && joined(a as usize / 3, b as usize / 3)
                {
                    groups.join(a, b);
                }
            }
        }
        (0..self.sorted.len() as u32).map(|corner| groups.of(corner)).collect()
    }
}

fn vertex_of(faces: &[Face], corner: u32) -> u32 {
    faces[corner as usize / 3].vertices[corner as usize % 3]
}

/// Gives every group of corners at a vertex a vertex of its own.
///
/// The first group keeps the vertex, the others get copies at the end, so that the order of the file is kept. Returns
/// which vertex each copy is one of.
pub(crate) fn split_vertices(mesh: &mut ObjectMesh, groups: &[u32]) -> Vec<u32> {
    let mut group_at: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    let mut copy_of: HashMap<(u32, u32), u32> = HashMap::new();
    let mut copied = Vec::new();
    for (corner, &group) in groups.iter().enumerate() {
        let vertex = mesh.faces[corner / 3].vertices[corner % 3];
        if *group_at[vertex as usize].get_or_insert(group) == group {
            continue;
        }
        let copy = *copy_of.entry((vertex, group)).or_insert_with(|| {
            copied.push(vertex);
            copy_vertex(mesh, vertex)
        });
        mesh.faces[corner / 3].vertices[corner % 3] = copy;
    }
    copied
}

fn copy_vertex(mesh: &mut ObjectMesh, vertex: u32) -> u32 {
    fn again<T: Copy>(list: &mut Vec<T>, index: u32) {
        if let Some(&value) = list.get(index as usize) {
            list.push(value);
        }
    }
    again(&mut mesh.positions, vertex);
    again(&mut mesh.normals, vertex);
    again(&mut mesh.uvs, vertex);
    again(&mut mesh.tangents, vertex);
    again(&mut mesh.lightmap_uvs, vertex);
    again(&mut mesh.tints, vertex);
    again(&mut mesh.alphas, vertex);
    mesh.positions.len() as u32 - 1
}
