//! Light on the lumels of an atlas, from what was measured to what can be read.
//!
//! A [`Lightmap`] holds the irradiance of every lumel. What was measured is finished in this order:
//!
//! 1. [`Lightmap::denoise`] takes out noise whose size is known, if that is wanted.
//! 2. [`Seams`] make light equal on both sides of a smooth edge that the atlas cuts.
//! 3. [`Dilation`] gives light to lumels that could not be measured, and to those between charts.
//!
//! [`Lightmap::finish`] does the last two for all layers. All results are the same bits on any number of threads.

mod charts;
mod denoise;
mod dilate;
mod edges;
mod lightmap;
mod nearest;
mod seams;
mod taps;

pub use dilate::Dilation;
pub use lightmap::{Lightmap, LightmapLayer};
pub use seams::Seams;
