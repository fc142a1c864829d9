//! One application of the light transport operator: measure the light that arrives at receivers.
//!
//! Two kernels do all the work. The area form integrates over lights, the hemisphere form over directions; both are
//! measured by a [`CpuTransport`] in chunks of elements and merged by [`accumulate`] in the order of the chunks, so
//! that the bits of the result do not depend on who computed what.
//! Nothing here knows about bounces: the same operator serves all of them.

mod accumulate;
mod cached;
mod cpu;
mod direct;
mod gather;
mod hemisphere;
mod job;
mod light_cone;
mod light_points;
mod light_tree;
mod light_view;
mod lights;
mod order;
mod paint;
mod plan;
mod polygon;
mod rows;
mod scatter;
mod shadow_rays;

pub use accumulate::{Measured, PartialField, accumulate};
pub use cached::{CachedTransport, Stored};
pub use cpu::CpuTransport;
pub use hemisphere::direction as hemisphere_direction;
pub use job::{Cancelled, ChunkSink, ChunkSums, Control, Job, NodeSum, Shape, Source, Transport};
pub use order::Order;
pub use plan::{EmitterSampling, LightSampling, Plan};
pub use rows::Rows;
