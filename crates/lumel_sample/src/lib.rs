//! Sample sequences, and warps from the unit square to the domains that light is integrated over.
//!
//! - [`StreamKey`] and [`Dim`] name a set of sample points: seed, element, bounce, pass, purpose.
//! - [`Sampler`] turns a key and an index into a point of the unit square or of the 4-D unit cube.
//! - The warps ([`uniform_triangle`], [`cosine_hemisphere`], [`SphericalRectangle`] …) carry such a point to a
//!   triangle, a hemisphere or a light. Each has its density and its inverse.
//!
//! Nothing here holds state: a point is a pure function of its key and its index, so results depend neither on
//! the number of threads nor on the order of the work.
//!
//! ```
//! use lumel_sample::{Dim, SamplerKind, StreamKey, cosine_hemisphere};
//!
//! let n_rays = 256;
//! let sampler = SamplerKind::Sobol.for_count(n_rays);
//! let stream = sampler.stream(StreamKey::new(1).element(42).bounce(1), Dim::Hemisphere);
//! let mean_height = (0..n_rays).map(|i| cosine_hemisphere(stream.sample_2d(i)).z).sum::<f32>() / n_rays as f32;
//! assert!((mean_height - 2.0 / 3.0).abs() < 1e-3);
//! ```

mod bits;
mod cells;
mod frame;
mod halton;
mod key;
mod piecewise;
mod sampler;
mod sobol;
mod stratified;
mod warp;

pub use bits::unit_hash;
pub use cells::{CellOrder, numbers_by_cell};
pub use frame::Frame;
pub use key::{Dim, StreamKey};
pub use piecewise::{PiecewiseConstant1D, PiecewiseConstant2D};
pub use sampler::{Sampler, SamplerKind, Stream, UnknownSampler};
pub use warp::{
    Equirectangular, SphericalCap, SphericalRectangle, SphericalTriangle, concentric_disk,
    concentric_disk_inverse, cosine_hemisphere, cosine_hemisphere_inverse, cosine_hemisphere_pdf,
    mixed_hemisphere, mixed_hemisphere_inverse, mixed_hemisphere_pdf, uniform_hemisphere,
    uniform_hemisphere_inverse, uniform_hemisphere_pdf, uniform_sphere, uniform_sphere_inverse,
    uniform_sphere_pdf, uniform_triangle, uniform_triangle_inverse,
};
