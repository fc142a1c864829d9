//! From the vertices and faces that a scene was built from to those of the scene.

use crate::face_list::{FaceList, Origin};
use crate::vertex_map::{Standing, VertexMap};
use crate::{FaceSide, ObjectId, Scene, TriId, triangle};

/// An object in the order in which [`SceneBuilder::build`](crate::SceneBuilder::build) received it.
///
/// Maps its vertices and faces to those of the scene, although building splits vertices at creases, gives two-sided
/// faces a back and drops triangles without area.
///
/// Indices are those of the [`ObjectMesh`](crate::ObjectMesh) when the scene was built.
/// [`SceneBuilder::tessellate`](crate::SceneBuilder::tessellate) keeps the indices of existing vertices and appends new
/// vertices; where it splits a vertex without a normal at a crease, the index stays with the first part, and the others
/// are among the appended ones. It does not keep the indices of faces.
///
/// A [refined](Scene::refined) scene has the vertices of the one it was made from, under the same indices, so that light is
/// read there; a face that was split is no triangle of it any more.
///
/// The scene stores 8 bytes for each gap in the order: a dropped face, an unused vertex, a vertex split at a crease. A
/// map is computed when it is requested, and nothing of it is kept.
///
/// ```
/// use lumel_scene::{Face, FaceSide, Material, MaterialId, ObjectId, ObjectMesh, SceneBuilder, Smoothing};
/// # use glam::Vec3;
/// let face = |vertices| Face { vertices, material: MaterialId(0), smoothing: Smoothing::Crease };
/// let corner = ObjectMesh {
///     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE],
///     faces: vec![face([0, 1, 2]), face([0, 3, 1])],
///     ..ObjectMesh::default()
/// };
/// let builder =
///     SceneBuilder { objects: vec![corner], materials: vec![Material::default()], ..SceneBuilder::default() };
/// let (scene, _) = builder.build()?;
///
/// let input = scene.input_mesh(ObjectId(0));
/// let map = input.vertex_map(FaceSide::Front);
/// assert_eq!(map.at(0).unwrap().len(), 2, "the two faces do not share a vertex along their edge");
/// assert!(map.at(4).is_none(), "no face uses it");
/// let up = map.mean(|vertex| scene.normals()[vertex as usize]);
/// assert!((up[0].unwrap() - (Vec3::Y + Vec3::Z) / 2.0).length() < 1e-6);
/// # Ok::<(), lumel_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct InputMesh<'a> {
    scene: &'a Scene,
    /// Those of the scene before it was refined.
    faces: &'a FaceList,
    origin: &'a Origin,
}

impl Scene {
    /// The mesh that an object was built from: object `i` is `objects[i]` of the builder.
    ///
    /// # Panics
    /// If the scene has no such object.
    pub fn input_mesh(&self, object: ObjectId) -> InputMesh<'_> {
        let faces = self.refinement().map_or(self.faces(), |refinement| &**refinement.given());
        InputMesh { scene: self, faces, origin: &faces.origins[object.index()] }
    }
}

impl<'a> InputMesh<'a> {
    /// Number of vertices of the mesh, used or not.
    pub fn vertex_count(&self) -> usize {
        self.origin.vertex_count as usize
    }

    /// Number of faces of the mesh, dropped ones included.
    pub fn face_count(&self) -> usize {
        self.origin.face_count as usize
    }

    /// The scene's triangle for one side of a face; `None` if the face was dropped, was split or has no such side.
    pub fn triangle(&self, face: usize, side: FaceSide) -> Option<TriId> {
        let tri = self.side_of(self.front(face)?, side)?;
        self.scene.refinement().map_or(Some(tri), |refinement| refinement.unsplit(tri))
    }

    fn front(&self, face: usize) -> Option<TriId> {
        let position = self.origin.faces.position(u32::try_from(face).ok()?)?;
        Some(TriId(self.origin.first_triangle + position as u32))
    }

    /// The scene's vertices at the corners of a face, in the face's own order on either side. `None` where
    /// [`InputMesh::triangle`] is.
    ///
    /// Exact, without weights: each corner has one vertex.
    pub fn corners(&self, face: usize, side: FaceSide) -> Option<[u32; 3]> {
        let front = self.front(face)?;
        let mut corners = self.vertices_of(self.side_of(front, side)?, side);
        corners.rotate_right(self.faces.turns.get(&front).map_or(0, |&turns| usize::from(turns)));
        Some(corners)
    }

    /// The scene's vertices that stand for each vertex of the mesh on one side of its faces.
    ///
    /// Time and memory are proportional to the size of the object.
    pub fn vertex_map(&self, side: FaceSide) -> VertexMap {
        // Vertices of the back are copies of those of the front, one for one.
        let mut angle = vec![0.0; self.origin.vertices.len()];
        let mut on_side = vec![u32::MAX; angle.len()];
        for front in (0..self.origin.faces.len() as u32).map(|i| TriId(self.origin.first_triangle + i)) {
            let Some(tri) = self.side_of(front, side) else { continue };
            let corners = self.faces.triangles[front.index()].map(|v| self.faces.positions[v as usize]);
            let vertices = self.faces.triangles[front.index()].into_iter().zip(self.vertices_of(tri, side));
            for (k, (vertex, standing)) in vertices.enumerate() {
                let local = (vertex - self.origin.first_vertex) as usize;
                angle[local] += triangle::angle(corners, k);
                on_side[local] = standing;
            }
        }
        let standing = self.origin.vertices.iter().zip(on_side).zip(angle);
        let standing = standing.map(|((given, vertex), angle)| Standing { given, vertex, angle });
        let standing = standing.filter(|s| s.vertex != u32::MAX).collect();
        VertexMap::new(self.vertex_count(), standing)
    }

    fn side_of(&self, front: TriId, side: FaceSide) -> Option<TriId> {
        match side {
            FaceSide::Front => Some(front),
            FaceSide::Back => Some(self.faces.other_side[front.index()]).filter(|&back| back != front),
        }
    }

    /// Vertices of a triangle in the order of its front.
    fn vertices_of(&self, tri: TriId, side: FaceSide) -> [u32; 3] {
        let [a, b, c] = self.faces.triangles[tri.index()];
        match side {
            FaceSide::Front => [a, b, c],
            FaceSide::Back => [b, a, c],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::quad;
    use crate::{Face, Material, MaterialId, ObjectMesh, SceneBuilder, Share, Sides, Smoothing};
    use glam::{Vec2, Vec3};

    fn face(vertices: [u32; 3], material: u32) -> Face {
        Face { vertices, material: MaterialId(material), smoothing: Smoothing::Crease }
    }

    /// A scene of these objects, whose material 1 is two-sided.
    fn scene(objects: Vec<ObjectMesh>) -> Scene {
        let two_sided = Material { sides: Sides::Both, ..Material::default() };
        let materials = vec![Material::default(), two_sided];
        SceneBuilder { objects, materials, ..SceneBuilder::default() }.build().unwrap().0
    }

    fn vertices(map: &VertexMap) -> Vec<Option<Vec<u32>>> {
        let of = |given| map.at(given).map(|shares| shares.iter().map(|s| s.vertex).collect());
        (0..map.len()).map(of).collect()
    }

    fn n_standing(map: &VertexMap) -> Vec<usize> {
        (0..map.len()).map(|given| map.at(given).map_or(0, <[Share]>::len)).collect()
    }

    /// Two walls that meet at a right angle in the edge from vertex 0 to 1, the second of two triangles at vertex 0.
    fn bent() -> ObjectMesh {
        ObjectMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 0.0, 1.0)],
            faces: vec![face([0, 1, 2], 0), face([0, 3, 4], 0), face([0, 4, 1], 0)],
            ..ObjectMesh::default()
        }
    }

    /// What must hold for every corner of every kept face, on both sides.
    fn check_corners(mesh: &ObjectMesh, scene: &Scene, object: u32) {
        let input = scene.input_mesh(ObjectId(object));
        assert_eq!((input.vertex_count(), input.face_count()), (mesh.positions.len(), mesh.faces.len()));
        for side in [FaceSide::Front, FaceSide::Back] {
            let map = input.vertex_map(side);
            assert_eq!(map.len(), mesh.positions.len());
            let mut n_corners = 0;
            for (i, face) in mesh.faces.iter().enumerate() {
                let Some(corners) = input.corners(i, side) else { continue };
                let tri = input.triangle(i, side).unwrap();
                assert_eq!(scene.object_id(tri), ObjectId(object));
                for (given, vertex) in face.vertices.into_iter().zip(corners) {
                    assert_eq!(scene.positions()[vertex as usize], mesh.positions[given as usize]);
                    assert!(map.at(given as usize).unwrap().iter().any(|s| s.vertex == vertex));
                    assert!(scene.triangle(tri).contains(&vertex));
                    n_corners += 1;
                }
            }
            let shares: Vec<&[Share]> = (0..map.len()).filter_map(|given| map.at(given)).collect();
            assert_eq!(shares.is_empty(), n_corners == 0);
            for of_one in shares {
                let sum: f32 = of_one.iter().map(|s| s.weight).sum();
                assert!((sum - 1.0).abs() < 1e-6 && of_one.is_sorted_by_key(|s| s.vertex));
            }
        }
    }

    #[test]
    fn a_mesh_that_nothing_happens_to_maps_to_itself() {
        let (first, mut second) = (quad("first"), quad("second"));
        second.positions.iter_mut().for_each(|position| *position += 1.0);
        let scene = scene(vec![first.clone(), second.clone()]);
        check_corners(&first, &scene, 0);
        check_corners(&second, &scene, 1);
        let map = scene.input_mesh(ObjectId(1)).vertex_map(FaceSide::Front);
        assert_eq!(vertices(&map), [4, 5, 6, 7].map(|v| Some(vec![v])));
        assert!((0..4).all(|given| map.at(given).unwrap()[0].weight == 1.0));
        assert!(
            scene
                .input_mesh(ObjectId(0))
                .vertex_map(FaceSide::Back)
                .mean(|_| 1.0)
                .iter()
                .all(Option::is_none)
        );
    }

    #[test]
    fn a_vertex_on_a_crease_has_a_part_for_each_wall_by_the_angle_it_takes_up() {
        let mut mesh = bent();
        // With normals from the file the split is the one at lighting creases, without them that of the normals.
        for normals in [vec![], vec![Vec3::ONE; 5]] {
            mesh.normals = normals;
            let scene = scene(vec![mesh.clone()]);
            check_corners(&mesh, &scene, 0);
            let map = scene.input_mesh(ObjectId(0)).vertex_map(FaceSide::Front);
            assert_eq!(n_standing(&map), [2, 2, 1, 1, 1]);
            let weights: Vec<f32> = map.at(0).unwrap().iter().map(|s| s.weight).collect();
            assert_eq!(weights, [0.5, 0.5], "90° in one triangle, and in two of 45°");
            let weights: Vec<f32> = map.at(1).unwrap().iter().map(|s| s.weight).collect();
            assert!((weights[0] - 1.0 / 3.0).abs() < 1e-6, "45° against 90°: {weights:?}");
        }
    }

    #[test]
    fn a_vertex_that_is_split_twice_is_still_known_as_the_first() {
        // The normals of group 1 go round the edge between its walls, where light then is discontinuous after all.
        let in_group = |vertices, group| Face { smoothing: Smoothing::Group(group), ..face(vertices, 0) };
        let mesh = ObjectMesh {
            positions: vec![Vec3::X, Vec3::ZERO, Vec3::Y, Vec3::Z],
            faces: vec![in_group([1, 0, 2], 2), in_group([1, 3, 0], 1), in_group([1, 2, 3], 1)],
            ..ObjectMesh::default()
        };
        let scene = scene(vec![mesh.clone()]);
        check_corners(&mesh, &scene, 0);
        assert_eq!(n_standing(&scene.input_mesh(ObjectId(0)).vertex_map(FaceSide::Front)), [2, 3, 2, 2]);
    }

    #[test]
    fn a_corner_keeps_to_its_own_side_of_a_crease() {
        let scene = scene(vec![bent()]);
        let input = scene.input_mesh(ObjectId(0));
        for (face, normal) in [(0, Vec3::Z), (1, Vec3::Y), (2, Vec3::Y)] {
            for vertex in input.corners(face, FaceSide::Front).unwrap() {
                assert!((scene.normals()[vertex as usize] - normal).length() < 1e-6, "{face}");
            }
        }
    }

    #[test]
    fn vertices_that_a_seam_doubles_stay_two() {
        let mut mesh = quad("seam");
        mesh.positions.extend([mesh.positions[0], mesh.positions[2]]);
        mesh.uvs = (0..6).map(|i| Vec2::splat(i as f32)).collect();
        mesh.faces[1].vertices = [4, 5, 3];
        let scene = scene(vec![mesh.clone()]);
        check_corners(&mesh, &scene, 0);
        let map = scene.input_mesh(ObjectId(0)).vertex_map(FaceSide::Front);
        let uv = map.mean(|vertex| scene.uvs()[vertex as usize].x);
        assert_eq!(uv, (0..6).map(|i| Some(i as f32)).collect::<Vec<_>>());
    }

    #[test]
    fn two_sided_faces_have_a_back_in_the_order_that_was_given() {
        let mut mesh = bent();
        mesh.faces[0].material = MaterialId(1);
        let scene = scene(vec![quad("before"), mesh.clone()]);
        check_corners(&mesh, &scene, 1);
        let input = scene.input_mesh(ObjectId(1));
        let back = input.vertex_map(FaceSide::Back);
        let normals = back.mean(|vertex| scene.normals()[vertex as usize]);
        let away = Some(-Vec3::Z);
        assert_eq!(normals, [away, away, away, None, None], "only what the two-sided wall uses");
        assert_eq!(
            input.corners(0, FaceSide::Back).unwrap(),
            [0, 1, 2].map(|i| back.at(i).unwrap()[0].vertex)
        );
        assert_eq!(input.corners(1, FaceSide::Back), None);
    }

    #[test]
    fn dropped_faces_and_vertices_that_only_they_use_map_to_nothing() {
        let mut mesh = bent();
        let far = mesh.positions.len() as u32;
        mesh.positions.splice(0..0, [Vec3::NAN, Vec3::splat(0.5)]);
        mesh.faces.iter_mut().for_each(|f| f.vertices = f.vertices.map(|v| v + 2));
        mesh.positions.push(Vec3::splat(0.25));
        mesh.faces.insert(0, face([0, 2, 3], 0));
        mesh.faces.insert(2, face([1, 1, far + 2], 0));
        let scene = scene(vec![mesh.clone()]);
        check_corners(&mesh, &scene, 0);
        let input = scene.input_mesh(ObjectId(0));
        let kept: Vec<bool> = (0..5).map(|i| input.triangle(i, FaceSide::Front).is_some()).collect();
        assert_eq!(kept, [false, true, false, true, true]);
        assert_eq!(n_standing(&input.vertex_map(FaceSide::Front)), [0, 0, 2, 2, 1, 1, 1, 0]);
    }

    #[test]
    fn an_object_without_a_kept_face_has_vertices_that_map_to_nothing() {
        let nothing = ObjectMesh { positions: vec![Vec3::ZERO; 3], ..ObjectMesh::default() };
        let scene = scene(vec![nothing, quad("quad")]);
        let input = scene.input_mesh(ObjectId(0));
        assert_eq!(vertices(&input.vertex_map(FaceSide::Front)), [const { None }; 3]);
        check_corners(&quad("quad"), &scene, 1);
    }
}
