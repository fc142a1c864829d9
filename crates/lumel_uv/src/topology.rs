//! Which triangles of an object continue each other's surface.

use glam::Vec3;
use lumel_scene::{Edges, ObjectId, Scene, TriId};
use std::ops::Range;

/// No neighbour.
pub(crate) const NONE: u32 = u32::MAX;

/// Normals of vertices in one place that turn by less than this are one normal: light changes by no more than noise
/// between them, and files round normals. The cosine of 3°.
const SAME_NORMAL_COS: f32 = 0.9986;

/// The triangles of one object that rays meet, and their neighbours.
pub(crate) struct Topology {
    pub(crate) object: ObjectId,
    /// The scene's triangles.
    pub(crate) triangles: Range<u32>,
    /// Places of vertices; those at a crease have several.
    pub(crate) positions: Vec<Vec3>,
    /// Indices into the positions, for each triangle.
    pub(crate) corners: Vec<[u32; 3]>,
    /// The triangle, counted from the first of the object, across each edge, from corner k to the next; [`NONE`] where
    /// the surface ends, creases, or meets more than one other.
    pub(crate) across: Vec<[u32; 3]>,
}

/// The ranges of triangles that belong to one object, backs excepted.
pub(crate) fn objects(scene: &Scene) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for tri in 0..scene.traced_count() as u32 {
        match ranges.last_mut() {
            Some(range) if scene.object_id(TriId(range.start)) == scene.object_id(TriId(tri)) => {
                range.end = tri + 1;
            }
            _ => ranges.push(tri..tri + 1),
        }
    }
    ranges
}

impl Topology {
    pub(crate) fn new(scene: &Scene, triangles: Range<u32>) -> Self {
        let object = scene.object_id(TriId(triangles.start));
        let faces = &scene.triangles()[triangles.start as usize..triangles.end as usize];
        let (positions, corners) = weld(scene, faces);
        let across = neighbours(&corners);
        Self { object, triangles, positions, corners, across }
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// The scene's triangle.
    pub(crate) fn tri(&self, face: u32) -> TriId {
        TriId(self.triangles.start + face)
    }

    /// The parts of the surface that no edge connects, each in ascending order, by their first triangle.
    pub(crate) fn parts(&self) -> Vec<Vec<u32>> {
        let all: Vec<u32> = (0..self.len() as u32).collect();
        self.parts_of(&all, &mut vec![false; self.len()])
    }

    /// The connected parts of a set of triangles. `marks` are all false, before and after.
    pub(crate) fn parts_of(&self, faces: &[u32], marks: &mut [bool]) -> Vec<Vec<u32>> {
        faces.iter().for_each(|&face| marks[face as usize] = true);
        let mut parts = Vec::new();
        for &seed in faces {
            if !std::mem::take(&mut marks[seed as usize]) {
                continue;
            }
            let mut part = vec![seed];
            let mut next = 0;
            while let Some(&face) = part.get(next) {
                next += 1;
                for other in self.across[face as usize] {
                    if other != NONE && std::mem::take(&mut marks[other as usize]) {
                        part.push(other);
                    }
                }
            }
            part.sort_unstable();
            parts.push(part);
        }
        parts
    }
}

/// One index for all vertices in one place with one normal.
fn weld(scene: &Scene, faces: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices: Vec<u32> = faces.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    // Adding zero turns -0 into 0.
    let place = |vertex: u32| (scene.positions()[vertex as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut by_place: Vec<u32> = (0..vertices.len() as u32).collect();
    by_place.sort_by_key(|&local| place(vertices[local as usize]));
    let mut stands_for: Vec<u32> = (0..vertices.len() as u32).collect();
    for group in by_place.chunk_by(|&a, &b| place(vertices[a as usize]) == place(vertices[b as usize])) {
        for (i, &local) in group.iter().enumerate() {
            let normal = |local: u32| scene.normals()[vertices[local as usize] as usize];
            let same = |&&first: &&u32| normal(first).dot(normal(local)) > SAME_NORMAL_COS;
            if let Some(&first) = group[..i].iter().find(same) {
                stands_for[local as usize] = stands_for[first as usize];
            }
        }
    }
    let positions = vertices.iter().map(|&vertex| scene.positions()[vertex as usize]).collect();
    let local = |vertex: u32| {
        let found = vertices.binary_search(&vertex).unwrap_or_default();
        stands_for[found]
    };
    (positions, faces.iter().map(|face| face.map(local)).collect())
}

fn neighbours(corners: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut across = vec![[NONE; 3]; corners.len()];
    for edge in Edges::new(corners.iter().copied()).each() {
        let [a, b] = edge else { continue };
        if a.forward != b.forward && a.tri != b.tri {
            across[a.tri as usize][a.side as usize] = b.tri;
            across[b.tri as usize][b.side as usize] = a.tri;
        }
    }
    across
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{cube, doubled, fan, scene_of};
    use lumel_testkit::mesh::{Facing, sphere};

    #[test]
    fn a_cube_has_six_parts_and_a_sphere_one() {
        let cube = scene_of(vec![cube()]);
        assert_eq!(Topology::new(&cube, 0..cube.triangle_count() as u32).parts().len(), 6);
        let ball = scene_of(vec![sphere(Vec3::ZERO, 1.0, 3, Facing::Outward, 0)]);
        assert_eq!(Topology::new(&ball, 0..ball.triangle_count() as u32).parts().len(), 1);
    }

    #[test]
    fn an_edge_of_three_triangles_connects_none() {
        let scene = scene_of(vec![fan(3)]);
        let topology = Topology::new(&scene, 0..3);
        assert!(topology.across.iter().flatten().all(|&other| other == NONE));
    }

    #[test]
    fn the_two_sides_of_a_doubled_face_are_apart() {
        let scene = scene_of(vec![doubled()]);
        assert_eq!(Topology::new(&scene, 0..scene.traced_count() as u32).parts().len(), 2);
    }
}
