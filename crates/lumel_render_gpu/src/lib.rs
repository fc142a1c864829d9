//! Draws lit scenes with wgpu, offscreen, for the viewer, tests and screenshots. Needs neither a window nor a UI.
//!
//! A [`Renderer`] turns a scene into a [`Model`] once, and its light into a [`LightBuffer`] or a [`LumelBuffer`] whenever
//! it changes. A [`Frame`] describes what to draw, a [`Target`] holds the picture: a texture that a UI can show and that
//! [`Renderer::read`] turns into a [`Picture`](lumel_render_cpu::Picture).
//!
//! The picture follows the formulas of [`lumel_render_cpu`]: linear light is summed and exposed, then tone mapped, then
//! encoded. Surfaces are drawn first, then rectangle lights; tone mapping follows, then the [`Overlay`] and the
//! wireframe, whose colours do not depend on the exposure.

mod attachments;
mod backdrop;
mod batches;
mod corners;
mod display;
mod draw;
mod error;
mod frame;
mod gpu;
mod layout;
mod light;
mod lumels;
mod memory;
mod mips;
mod model;
mod overlay;
mod pipelines;
mod places;
mod point_passes;
mod points;
mod read;
mod rect_lights;
mod renderer;
mod shaders;
mod target;
mod texture;
mod vertices;

pub use attachments::Samples;
pub use backdrop::Backdrop;
pub use error::RenderError;
pub use frame::{Frame, Lit, Look, Values};
pub use gpu::{Gpu, GpuError};
pub use light::LightBuffer;
pub use lumels::{LumelBuffer, Tile};
pub use model::Model;
pub use overlay::{Hidden, Mark, Overlay};
pub use points::PointBuffer;
pub use renderer::Renderer;
pub use target::Target;
