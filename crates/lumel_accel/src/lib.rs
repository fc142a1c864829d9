//! The ray tracer of the lumel baker: a bounding volume hierarchy over the triangles of a scene.
//!
//! [`RayTracer`] is the seam: everything above asks it for the closest hit or for occlusion and knows nothing of how
//! they are found. [`Bvh`] is the tracer, [`BruteForce`] the reference it is tested against.
//!
//! Among hits at the same distance the lowest triangle wins, in every tracer, so that results do not depend on the
//! order in which triangles are met.

mod brute_force;
mod bvh;
mod bvh_tracer;
mod ray;
mod simd;
mod trace;
mod triangle;

pub use brute_force::BruteForce;
pub use bvh::Bvh;
pub use ray::{Bundle, Hit, Ray, RayTracer, SHADOW_END};
pub use simd::InstructionSet;
