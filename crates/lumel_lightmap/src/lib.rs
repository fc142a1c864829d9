//! Light on the lumels of an atlas, from what was measured to what can be read.
//!
//! A [`LumelLight`] is measured round by round. [`Lightmap::finished`] makes a [`Lightmap`] of it, the irradiance of every lumel, in
//! this order:
//!
//! 1. If noise is to be taken off, light is moved towards what the solve knows of it, as far as that helps; what one lumel found by
//!    chance is spread over those around it, and [`Lightmap::denoise`] takes out noise whose size is known.
//! 2. [`Seams`] make light equal on both sides of a smooth edge that the atlas cuts.
//! 3. [`Dilation`] gives light to lumels that could not be measured, and to those between charts.
//!
//! All results are the same bits on any number of threads.

mod by_direction;
mod charts;
mod denoise;
mod dilate;
mod edges;
mod fireflies;
mod light;
mod lighting;
mod lightmap;
mod nearest;
mod seams;
mod shrink;
mod solved;
mod surface;
mod taps;

pub use by_direction::LumelsByDirection;
pub use dilate::Dilation;
pub use light::{DirectionalLight, Half, LumelLight, PartLight};
pub use lighting::LumelLighting;
pub use lightmap::{Lightmap, LightmapLayer};
pub use seams::Seams;
pub use solved::SolvedLight;
pub use taps::Filter;
