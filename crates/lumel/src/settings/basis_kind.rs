//! Which basis stores the light.

use serde::{Deserialize, Serialize};

/// Where light is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BasisKind {
    /// At the vertices.
    #[default]
    Vertex,
    /// At the vertices, measured over the triangles around each.
    VertexArea,
}
