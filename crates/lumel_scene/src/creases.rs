//! Edges at which light is discontinuous.

use crate::corners::{Corners, split_vertices};
use crate::mesh::ObjectMesh;

/// Neighbouring faces of one vertex that turn by more than this do not share a lighting vertex, whatever normals
/// the file gives: light changes at such an edge. Coarse but round meshes (an icosahedron turns by 42°) stay smooth.
const LIGHTING_CREASE_COS: f32 = 0.5;

/// Splits vertices at sharp edges. Returns which vertex each added one is a copy of.
pub(crate) fn split_at_creases(mesh: &mut ObjectMesh) -> Vec<u32> {
    let normals = mesh.face_normals();
    let groups =
        Corners::by_vertex(mesh).groups(&mesh.faces, |a, b| normals[a].dot(normals[b]) > LIGHTING_CREASE_COS);
    split_vertices(mesh, &groups)
}
