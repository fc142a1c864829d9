//! One application of the light transport operator: measure the light that arrives at receivers.
//!
//! Every measurement is *trace, read, project*: rays go out from the sites of some receivers, what arrives along them is
//! read from a [`Source`], and the mean counts towards nodes. Two kernels estimate it: the area form integrates over
//! lights, the hemisphere form over directions. A [`CpuTransport`] traces for every job; a [`CachedTransport`] keeps
//! where rays end. Both measure in chunks of elements, which [`accumulate`] merges in their order, so that the bits of the
//! result do not depend on who computed what.
//!
//! Nothing here knows about bounces: the same operator serves all of them. [`Transport`] can be implemented elsewhere, for
//! another device or other machines; `examples/own_transport.rs` of the crate `lumel` does it.

mod accumulate;
mod ambient;
mod area_pattern;
mod arrivals;
mod balance;
mod cached;
mod cached_area;
mod cached_shots;
mod cap;
mod carried;
mod columns;
mod cpu;
mod direct;
mod direct_area;
mod direct_moments;
mod directional;
mod emissive;
mod emissive_rects;
mod emitters;
mod ends;
mod gather;
mod group;
mod hemisphere;
mod hidden;
mod job;
mod light_cone;
mod light_points;
mod light_tree;
mod light_view;
mod lights;
mod measure;
mod moments;
mod operator;
mod order;
mod passes;
mod plan;
mod polygon;
mod reflectance;
mod rows;
mod scatter;
mod shadow_batch;
mod shadow_rays;
mod shots;
mod sky_light;
mod sky_rays;
mod sums;
mod supports;
mod surface_rays;
mod surface_walks;
mod texel_density;
mod texel_sums;
mod trace;

pub use accumulate::{Measured, PartialField, accumulate};
pub use ambient::AmbientOcclusion;
pub use cached::{CachedTransport, DIRECTIONAL_PASS, Stored};
pub use directional::DirectionalTransport;
pub use emitters::{Emitter, EmitterMask};
pub use hemisphere::direction as hemisphere_direction;
pub use job::{ChunkSink, Control, Job, Shape, Source, Transport, TransportError};
pub use operator::CpuTransport;
pub use order::Order;
pub use passes::{Pass, Passes};
pub use plan::{EmitterSampling, LightSampling, Plan};
pub use rows::Rows;
pub use sums::Sums;
pub use surface_walks::SurfaceWalks;
