//! Draws lit scenes on the CPU, with our own ray tracer: no GPU, no display, the same bytes everywhere.
//!
//! [`draw`] looks at a [`View`] (scene, tracer, light) through a camera and returns a [`Picture`]. What is shown is
//! chosen by [`Show`], how it is shown by [`Display`]. From linear light to bytes it is, in this order:
//!
//! 1. the mean of the samples of a pixel, linear Rec. 709, unclamped;
//! 2. exposure: times `2^stops` ([`Exposure`], read by [`meter`] unless given);
//! 3. [`ToneMapper::map`] to 0..=1;
//! 4. [`srgb_encode`], times 255, rounded to nearest ([`srgb_byte`]).
//!
//! Any other renderer that follows the formulas given there shows the same scene within one step of 255.

mod canvas;
mod display;
mod draw;
mod error;
mod exposure;
mod false_color;
mod font;
mod lamp;
mod legend;
mod lens;
mod limits;
mod names;
mod normal_map;
mod picture;
mod resolution;
mod show;
mod srgb;
mod stats;
mod tone;
mod view;
mod viewpoint;

pub use display::Display;
pub use draw::draw;
pub use error::PictureError;
pub use exposure::{BadExposure, Exposure, meter};
pub use false_color::{FalseColor, Legend, Scale, false_color, false_color_map};
pub use legend::{Tick, ticks};
pub use lens::Lens;
pub use limits::{MAX_PIXELS, MAX_SAMPLES};
pub use names::UnknownName;
pub use picture::Picture;
pub use resolution::Resolution;
pub use show::Show;
pub use srgb::{srgb_byte, srgb_decode, srgb_encode, srgb_from_byte};
pub use tone::ToneMapper;
pub use view::{Backfaces, Lighting, VertexLight, View};
pub use viewpoint::camera_for;
