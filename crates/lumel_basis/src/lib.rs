//! Functions on the surfaces of a scene, and where light is measured.
//!
//! A [`Basis`] is a space of functions: it says what the coefficients of a [`Field`] mean anywhere on the surfaces.
//! [`Receivers`] say where light is measured and towards which coefficients a measurement counts. The two are chosen
//! apart: the same functions may be measured at points or over areas, and light may be read from one basis and
//! measured for another. Neither traces rays: that is the part of the transport.

mod adjacency;
mod angular;
mod area_receivers;
mod at_vertices;
mod basis;
mod field;
mod identity;
mod least_squares;
mod lighting;
mod lumel_receivers;
mod meshless;
mod node;
mod parts;
mod points;
mod random_places;
mod readout;
mod receivers;
mod reflecting;
mod vertex;
mod vertex_lighting;
mod vertex_receivers;

pub use adjacency::Adjacency;
pub use angular::{
    Coefficients, Directional, HARMONICS, Harmonics, IncidentRadiance, Moment, Shading, UnknownShading,
    band_of, integrals_of_harmonics, spherical_harmonics,
};
pub use area_receivers::AreaReceivers;
pub use at_vertices::{VertexPoints, incident_at_vertices, irradiance_at_vertices};
pub use basis::{Basis, Hierarchy};
pub use field::Field;
pub use identity::Identity;
pub use least_squares::{LeastSquares, Limits};
pub use lighting::{FieldLighting, Lighting};
pub use lumel_receivers::LumelReceivers;
pub use meshless::{
    Clearance, CloudLighting, CloudPoint, DIRECTIONS, MeshlessBasis, Obstacle, Obstacles, PointCloud,
    SurfaceSample,
};
pub use node::{NodeId, NodeWeights};
pub use points::PointReceivers;
pub use random_places::RandomPlaces;
pub use readout::Readout;
pub use receivers::{CENTER, ElementId, Receivers, Sampling, Site};
pub use reflecting::reflecting_areas;
pub use vertex::VertexBasis;
pub use vertex_lighting::{VertexCountError, VertexLighting};
