//! Units, meshes, materials, lights and the immutable [`Scene`] of the lumel baker.
//!
//! Importers and generators fill a [`SceneBuilder`]; [`SceneBuilder::build`] checks it, splits vertices where lighting is discontinuous and returns a [`Scene`] that never changes again.
//! Metres, right-handed, +Y up, linear Rec. 709.

mod address;
mod builder;
mod camera;
mod corners;
mod hash;
mod light;
mod material;
mod normals;
mod offset;
mod scene;
mod tessellate;
mod texture;
mod units;
mod warning;

pub use address::{Barycentrics, MaterialId, ObjectId, SurfacePoint, TextureId, TriId};
pub use builder::{Face, MAX_TRIANGLES, ObjectMesh, SceneBuilder, SceneError, Smoothing};
pub use camera::Camera;
pub use hash::SceneHash;
pub use light::{DirectionalLight, Light, PointLight, RectLight, SpotLight};
pub use material::{MAX_ALBEDO, Material, Sides, TextureRef, UvTransform};
pub use offset::offset_along;
pub use scene::{Bounds, FaceSide, Scene};
pub use texture::{Encoding, Texture, Wrap};
pub use units::{Albedo, Irradiance, Radiance, Radiosity, luminance};
pub use warning::{Warning, Warnings};
