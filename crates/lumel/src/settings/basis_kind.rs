//! Where light is measured.

use super::value::choices;
use serde::{Deserialize, Serialize};

/// Where light is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BasisKind {
    /// At the vertices.
    #[default]
    Vertex,
    /// Over the triangles around each vertex.
    VertexArea,
}

choices! {
    BasisKind {
        Vertex = "vertex", "At vertices", "at the vertices; those inside geometry take the light of their neighbours";
        VertexArea = "vertex-area", "Over areas",
            "over the triangles around each vertex: for vertices in corners and inside walls";
    }
}
