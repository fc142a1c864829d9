//! Fields of light and the bases they are stored in.
//!
//! A basis says where light is measured ([`Receivers`]) and how a field is read back anywhere on the surfaces
//! ([`Basis::weights_at`]). It traces no rays: that is the transport's part.

mod area_vertex;
mod basis;
mod field;
mod points;
mod vertex;

pub use area_vertex::AreaVertexBasis;
pub use basis::{Basis, ElementId, Measure, NodeId, NodeWeights, Receivers, Site};
pub use field::Field;
pub use points::PointReceivers;
pub use vertex::VertexBasis;
