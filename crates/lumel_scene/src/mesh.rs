//! The meshes that a scene is built from.

use crate::{MaterialId, triangle};
use glam::{Vec2, Vec3, Vec4};

/// Which faces share a normal at a vertex that has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Smoothing {
    /// Only faces in one plane.
    Flat,
    /// Faces of the same group.
    Group(u32),
    /// Faces that turn by less than 40° at their common edge.
    #[default]
    Crease,
}

/// A triangle of an [`ObjectMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// Indices into the object's vertices, counter-clockwise seen from the front.
    pub vertices: [u32; 3],
    /// Index into the builder's materials.
    pub material: MaterialId,
    /// How missing normals are made.
    pub smoothing: Smoothing,
}

/// A named mesh in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectMesh {
    /// The name messages use.
    pub name: String,
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Vertex normals: empty, or one per position. Zero stands for "none given"; any length is accepted.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, `v` down: empty, or one per position.
    pub uvs: Vec<Vec2>,
    /// Tangents for normal maps: empty, or one per position. The last number is the sign of `normal × tangent`, along which
    /// images have their top. Zero stands for "none given"; any length is accepted.
    pub tangents: Vec<Vec4>,
    /// The place of each vertex in a lightmap of the object's own, or of one that objects share, `v` down: empty, or one per
    /// position. No number stands for "none given".
    pub lightmap_uvs: Vec<Vec2>,
    /// Linear vertex colours that multiply the albedo: empty, or one per position.
    pub tints: Vec<Vec3>,
    /// Vertex alphas that multiply those of materials: empty, or one per position.
    pub alphas: Vec<f32>,
    /// How much finer its lumels are in a lightmap than those of others; `None` stands for 1.
    pub density_factor: Option<f32>,
    /// The triangles.
    pub faces: Vec<Face>,
    /// By how much a file or program may have rounded the coordinates before they came here, metres; zero if by no more
    /// than `positions` are.
    pub rounding: f64,
}

impl ObjectMesh {
    /// The corners' positions of a face.
    pub fn corners(&self, face: &Face) -> [Vec3; 3] {
        face.vertices.map(|v| self.positions[v as usize])
    }

    /// The alphas at the corners of a face.
    pub(crate) fn corner_alphas(&self, face: &Face) -> [f32; 3] {
        face.vertices.map(|v| self.alphas.get(v as usize).copied().unwrap_or(1.0))
    }

    /// Unit normals of the faces from their winding. Faces must have an area.
    pub(crate) fn face_normals(&self) -> Vec<Vec3> {
        self.faces.iter().map(|face| triangle::normal(self.corners(face))).collect()
    }
}
