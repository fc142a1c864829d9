//! Draws lit scenes on the CPU, with lumel's ray tracer: no GPU, no display, the same bytes on every machine.
//!
//! [`draw`] looks at a [`View`] (scene, tracer, light) through a camera and returns a [`Picture`]. [`Show`]
//! selects the quantity, [`Display`] how it is shown. Linear light becomes bytes in this order:
//!
//! 1. the mean of the samples of a pixel, linear Rec. 709, unclamped;
//! 2. exposure: multiplication by `2^stops` ([`Exposure`], chosen by [`meter`] unless given);
//! 3. [`ToneMapper::map`] to 0..=1;
//! 4. [`srgb_encode`], times 255, rounded to nearest ([`srgb_byte`]).
//!
//! A renderer that follows these formulas produces the same picture within one step of 255.

mod canvas;
mod display;
mod draw;
mod error;
mod exposure;
mod false_color;
mod font;
mod framing;
mod legend;
mod lens;
mod limits;
mod names;
mod picture;
mod rect_light;
mod relief;
mod resolution;
mod ripple;
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
pub use relief::{NormalMaps, Relief};
pub use resolution::Resolution;
pub use ripple::{Ripple, Rippled};
pub use show::Show;
pub use srgb::{srgb_byte, srgb_decode, srgb_encode, srgb_from_byte};
pub use tone::ToneMapper;
pub use view::{Backfaces, View};
pub use viewpoint::{camera_chosen_for, camera_for};
