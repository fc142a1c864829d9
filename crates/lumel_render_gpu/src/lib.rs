//! Draws lit scenes with wgpu, offscreen: for the viewer, for tests and for screenshots. It knows no window and no UI.
//!
//! A [`Renderer`] turns a scene into a [`Model`] once, and the light on it into a [`LightBuffer`] whenever there is
//! new light. A [`Frame`] says what to draw, a [`Target`] holds the picture: a texture for a UI to show, which
//! [`Renderer::read`] turns into a [`Picture`](lumel_render_cpu::Picture).
//!
//! The picture is that of [`lumel_render_cpu`], by the same formulas: light is summed up in linear numbers and exposed,
//! then tone mapped, then encoded. Surfaces come first, then lamps, then the tone mapper, then what a user draws on
//! top ([`Overlay`], wireframe), in colours that no exposure changes.

mod attachments;
mod batches;
mod display;
mod draw;
mod error;
mod frame;
mod gpu;
mod lamps;
mod layout;
mod light;
mod memory;
mod mips;
mod model;
mod overlay;
mod pipelines;
mod read;
mod renderer;
mod shaders;
mod target;
mod texture;
mod vertices;

pub use attachments::Samples;
pub use error::RenderError;
pub use frame::{Frame, Lit, Look};
pub use gpu::{Gpu, GpuError};
pub use light::LightBuffer;
pub use model::Model;
pub use overlay::{Hidden, Mark, Overlay};
pub use renderer::Renderer;
pub use target::Target;
