//! The ray tracer of the lumel baker: a bounding volume hierarchy over the triangles of a scene.
//!
//! [`RayTracer`] is the seam: everything above asks it for the closest hit or for occlusion and knows nothing of how
//! they are found. [`Bvh`] is the tracer of opaque triangles, [`BruteForce`] the reference it is tested against,
//! [`SeeThrough`] the tracer of scenes in which light passes through some, and [`Refined`] that of scenes whose triangles were
//! split: it traces those that they were. [`tracer_of`] chooses.
//!
//! Among hits at the same distance the lowest triangle wins, in every tracer, so that results do not depend on the
//! order in which triangles are met.

mod brute_force;
mod bvh;
mod bvh_tracer;
mod ray;
mod refined;
mod see_through;
mod simd;
mod trace;
mod triangle;

pub use brute_force::BruteForce;
pub use bvh::Bvh;
pub use ray::{Bundle, Hit, Layer, Ray, RayTracer, SHADOW_END};
pub use refined::Refined;
pub use see_through::{SeeThrough, tracer_of};
pub use simd::InstructionSet;
