//! Units, meshes, materials, lights and the immutable [`Scene`] of the lumel baker.
//!
//! Importers and generators fill a [`SceneBuilder`]; [`SceneBuilder::build`] checks it, splits vertices where lighting
//! is discontinuous and returns a [`Scene`] that never changes again. [`Scene::input_mesh`] leads back to the vertices
//! that were given. Metres, right-handed, +Y up, linear Rec. 709.

mod address;
mod assemble;
mod bounds;
mod build;
mod builder;
mod camera;
mod check;
mod coincident;
mod corners;
mod creases;
mod edge_length;
mod edges;
mod error;
mod face_list;
mod gloss;
mod hash;
mod input_mesh;
mod light;
mod light_names;
mod material;
mod mesh;
mod normal_map;
mod normals;
mod offset;
mod origin;
mod refine;
mod resolution;
mod runs;
mod sanitize;
mod scene;
mod shells;
mod sky;
mod tangents;
mod tessellate;
#[cfg(test)]
mod testing;
mod texture;
mod transparency;
mod triangle;
mod units;
mod vertex_map;
mod warning;
mod weld;

pub use address::{Barycentrics, FaceSide, MaterialId, ObjectId, SurfacePoint, TextureId, TriId};
pub use bounds::Bounds;
pub use builder::SceneBuilder;
pub use camera::Camera;
pub use edges::{Edge, Edges, Forest};
pub use error::{MAX_TRIANGLES, SceneError};
pub use gloss::{EncodedImage, Gloss, GlossTexture};
pub use hash::SceneHash;
pub use input_mesh::InputMesh;
pub use light::{
    DirectionalLight, DiskLight, Light, PointLight, RectLight, SphereLight, SpotLight, SunLight,
};
pub use material::{MAX_ALBEDO, Material, Sides, TextureRef, UvTransform};
pub use mesh::{Face, ObjectMesh, Smoothing};
pub use normal_map::NormalMap;
pub use offset::{Margins, RayOrigins, lift_from, offset_from};
pub use origin::{origin_for, rounding_of};
pub use refine::{Bisection, Part, Refinement};
pub use scene::Scene;
pub use sky::{Sky, SkyGradient, SkyImage};
pub use texture::{Encoding, Filter, Texture, Wrap};
pub use transparency::{AlphaMode, Transparency};
pub use units::{Albedo, Irradiance, Radiance, Radiosity, luminance};
pub use vertex_map::{Share, VertexMap};
pub use warning::{Warning, Warnings};
pub use weld::Weld;
