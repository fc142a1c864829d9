//! Triangles and vertices as the scene stores them.

use crate::coincident::FaceRef;
use crate::mesh::ObjectMesh;
use crate::runs::Runs;
use crate::shells::Shells;
use crate::transparency::{Look, Looks};
use crate::{Material, MaterialId, ObjectId, Sides, TriId};
use glam::{Vec2, Vec3, Vec4};
use std::collections::BTreeMap;

/// Triangles and vertices of all objects in one list.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaceList {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    /// Empty where no object has any, else zero for vertices that have none.
    pub(crate) tangents: Vec<Vec4>,
    /// Empty where no object has any, else no number for vertices that have none.
    pub(crate) lightmap_uvs: Vec<Vec2>,
    pub(crate) tints: Vec<Vec3>,
    /// Empty where no object has any.
    pub(crate) alphas: Vec<f32>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) materials: Vec<MaterialId>,
    pub(crate) objects: Vec<ObjectId>,
    /// Triangles up to here are met by rays, but for those that are the back of another one before them.
    pub(crate) traced: usize,
    /// The triangle on the other side, or itself if there is none.
    pub(crate) other_side: Vec<TriId>,
    /// Whether light passes through each triangle; empty where it passes through none.
    pub(crate) transparent: Vec<bool>,
    /// By how many corners triangles begin later than they were given.
    pub(crate) turns: BTreeMap<TriId, u8>,
    pub(crate) object_names: Vec<String>,
    /// By object.
    pub(crate) density_factors: Vec<f32>,
    /// Where each object comes from.
    pub(crate) origins: Vec<Origin>,
}

impl FaceList {
    /// Adds an object without the vertices that no face uses.
    pub(crate) fn append(&mut self, mesh: ObjectMesh, given: Given) {
        let id = ObjectId(self.object_names.len() as u32);
        self.object_names.push(mesh.name);
        self.density_factors.push(mesh.density_factor.unwrap_or(1.0));
        let mut origin = Origin {
            first_vertex: self.positions.len() as u32,
            vertices: Runs::default(),
            vertex_count: given.vertex_count,
            first_triangle: self.triangles.len() as u32,
            faces: given.faces,
            face_count: given.face_count,
        };
        let mut used = vec![false; mesh.positions.len()];
        for vertex in mesh.faces.iter().flat_map(|f| f.vertices) {
            used[vertex as usize] = true;
        }
        let mut new_index = vec![u32::MAX; used.len()];
        for old in (0..used.len()).filter(|&v| used[v]) {
            new_index[old] = self.positions.len() as u32;
            origin.vertices.extend([given.vertices[old]]);
            self.positions.push(mesh.positions[old]);
            self.normals.push(mesh.normals[old]);
            self.uvs.push(mesh.uvs.get(old).copied().unwrap_or_default());
            self.tints.push(mesh.tints.get(old).copied().unwrap_or(Vec3::ONE));
            let tangent = mesh.tangents.get(old).copied();
            push_if_any(&mut self.tangents, tangent, Vec4::ZERO, self.positions.len());
            push_if_any(
                &mut self.lightmap_uvs,
                mesh.lightmap_uvs.get(old).copied(),
                Vec2::NAN,
                self.positions.len(),
            );
            push_if_any(&mut self.alphas, mesh.alphas.get(old).copied(), 1.0, self.positions.len());
        }
        for face in mesh.faces {
            self.triangles.push(face.vertices.map(|v| new_index[v as usize]));
            self.materials.push(face.material);
            self.objects.push(id);
        }
        self.origins.push(origin);
    }

    /// Makes pairs of triangles in one place the two sides of one surface, and gives every other triangle with two
    /// [sides](Sides) a partner for its back.
    pub(crate) fn add_back_sides(&mut self, materials: &[Material], pairs: &[[FaceRef; 2]]) {
        self.traced = self.triangles.len();
        self.other_side = (0..self.traced as u32).map(TriId).collect();
        for pair in pairs {
            let [front, back] = pair.map(|at| self.origins[at.object].first_triangle as usize + at.face);
            self.pair(front, back);
        }
        let by_shape = materials.iter().any(|material| material.sides == Sides::Shape);
        let shells = by_shape.then(|| Shells::of_faces(self));
        let mut back_vertex = vec![u32::MAX; self.positions.len()];
        for tri in 0..self.traced {
            let material = &materials[self.materials[tri].index()];
            let has_back = match material.sides {
                Sides::Front => false,
                Sides::Both => true,
                Sides::Shape => {
                    !material.emits() && shells.as_ref().is_some_and(|shells| !shells.has_inside(tri))
                }
            };
            if !has_back || self.other_side[tri].index() != tri {
                continue;
            }
            let [a, b, c] = self.triangles[tri].map(|front| {
                if back_vertex[front as usize] == u32::MAX {
                    back_vertex[front as usize] = self.positions.len() as u32;
                    self.copy_vertex_for_back(front as usize);
                }
                back_vertex[front as usize]
            });
            self.other_side[tri] = TriId(self.triangles.len() as u32);
            self.other_side.push(TriId(tri as u32));
            self.triangles.push([b, a, c]);
            self.materials.push(self.materials[tri]);
            self.objects.push(self.objects[tri]);
        }
    }

    /// The alphas at the corners of a triangle.
    #[inline]
    pub(crate) fn corner_alphas(&self, tri: usize) -> [f32; 3] {
        self.triangles[tri].map(|v| self.alphas.get(v as usize).copied().unwrap_or(1.0))
    }

    /// Notes which triangles are transparent.
    pub(crate) fn note_transparent(&mut self, looks: &Looks) {
        let is_transparent =
            |tri: usize| looks.of(self.materials[tri].index(), self.corner_alphas(tri)) == Look::Transparent;
        let transparent: Vec<bool> = (0..self.triangles.len()).map(is_transparent).collect();
        self.transparent = if transparent.contains(&true) { transparent } else { Vec::new() };
    }

    /// Makes two triangles with the same corners and opposite windings the sides of one surface.
    fn pair(&mut self, front: usize, back: usize) {
        self.other_side[front] = TriId(back as u32);
        self.other_side[back] = TriId(front as u32);
        // As a back has them: barycentrics on the one side are those on the other with the first two exchanged.
        let last = self.positions[self.triangles[front][2] as usize];
        while self.positions[self.triangles[back][2] as usize] != last {
            self.triangles[back].rotate_left(1);
            *self.turns.entry(TriId(back as u32)).or_default() += 1;
        }
    }

    fn copy_vertex_for_back(&mut self, front: usize) {
        self.positions.push(self.positions[front]);
        self.normals.push(-self.normals[front]);
        self.uvs.push(self.uvs[front]);
        self.tints.push(self.tints[front]);
        // What bulges on the front is hollow on the back: there, the whole frame is reversed.
        let tangent = self.tangents.get(front).map(|tangent| -*tangent);
        push_if_any(&mut self.tangents, tangent, Vec4::ZERO, self.positions.len());
        let lightmap_uv = self.lightmap_uvs.get(front).copied();
        push_if_any(&mut self.lightmap_uvs, lightmap_uv, Vec2::NAN, self.positions.len());
        let alpha = self.alphas.get(front).copied();
        push_if_any(&mut self.alphas, alpha, 1.0, self.positions.len());
    }
}

/// Adds the value of the last of `n` vertices to a list that is empty as long as no vertex has any.
fn push_if_any<T: Copy>(list: &mut Vec<T>, value: Option<T>, absent: T, n: usize) {
    if value.is_some() || !list.is_empty() {
        list.resize(n - 1, absent);
        list.push(value.unwrap_or(absent));
    }
}

/// The vertices and faces of an object as they were given, and what became of them.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// How many vertices were given.
    pub(crate) vertex_count: u32,
    /// The given vertex that each vertex of the mesh is, or is a copy of.
    pub(crate) vertices: Vec<u32>,
    /// How many faces were given.
    pub(crate) face_count: u32,
    /// The given face that each face of the mesh is.
    pub(crate) faces: Runs,
}

/// Where the vertices and triangles of an object come from; back sides excepted, which follow from
/// [`FaceList::other_side`].
///
/// A few bytes for each gap in the order that was given: a dropped face, an unused vertex, a vertex split at a crease.
#[derive(Clone, Debug)]
pub(crate) struct Origin {
    pub(crate) first_vertex: u32,
    /// The given vertices that the vertices from `first_vertex` on stand for.
    pub(crate) vertices: Runs,
    /// How many vertices were given.
    pub(crate) vertex_count: u32,
    pub(crate) first_triangle: u32,
    /// The given faces that the triangles from `first_triangle` on are; ascending.
    pub(crate) faces: Runs,
    /// How many faces were given.
    pub(crate) face_count: u32,
}
