//! Writes and reads lighting solutions, lit meshes and pictures.
//!
//! - [`Solution`] is the result of a bake: a NumPy archive that Python opens in one line,
//!   `numpy.load("a.npz")["irradiance"]`.
//! - [`write_glb`], [`write_ply`] and [`write_obj`] write the lit mesh for other programs, [`RadFile`] the course's
//!   format; [`write_unwrapped_glb`] a mesh with its places in an atlas, [`write_lightmap_glb`] with the light of it.
//! - [`write_lightmap_exr`] and [`write_lightmap_png`] write the pages of a lightmap.
//! - [`write_png`] writes pictures, [`write_atlas_png`] those of an atlas.
//!
//! Writers read light through [`Lighting`](lumel_basis::Lighting), at the vertices that these formats have; those of a
//! solution come from [`Solution::lighting`].
//!
//! - [`write_npz`] and [`NpzReader`] are what solutions and checkpoints are made of.
//!
//! Every file appears whole or not at all: see [`write_atomically`]. Equal content gives equal bytes. Reading
//! never trusts a file: sizes are checked before anything is allocated, checksums before anything is used.

mod atlas_png;
mod atomic;
mod checkpoint;
mod display;
mod error;
mod glb;
mod lightmap;
mod lock;
mod lumel_state;
mod members;
mod npy;
mod npz;
mod obj;
mod pixels;
mod ply;
mod png;
mod quiet;
mod rad;
mod refinement_state;
mod solution;
mod solution_points;

pub use atlas_png::{chart_color, write_atlas_png};
pub use atomic::write_atomically;
pub use checkpoint::{Checkpoint, CheckpointMeta, Saved, SavedShots};
pub use display::ColorScale;
pub use error::{ExportError, ReadError, SceneLabel, SolutionError};
pub use glb::{
    GlbOptions, GltfMaterials, LightmapTarget, write_glb, write_lightmap_glb, write_unwrapped_glb,
};
pub use lightmap::{
    LightmapSolution, PngDepth, Precision, path_of_page, write_lightmap_exr, write_lightmap_png, write_pages,
};
pub use lock::{Lock, LockError, remove_strays};
pub use lumel_state::{LumelMeta, LumelState};
pub use npy::{Array, ArrayData};
pub use npz::{NpzReader, NpzWriter, write_npz};
pub use obj::{check_obj, write_obj};
pub use ply::write_ply;
pub use png::write_png;
pub use rad::{RadFile, position_md5};
pub use refinement_state::{NextRefinement, RefinementMeta, RefinementState, SavedProbe};
pub use solution::{Solution, SolutionLayer, SolutionMeta, SolutionSelection};
pub use solution_points::SolutionPoints;
