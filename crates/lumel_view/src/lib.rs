//! The interactive program: fly through a scene and watch light arrive in it.
//!
//! A [`Session`](session::Session) is all that is open and going on, without a window; the [`App`](app::App) shows it and
//! takes what is done with keys and mouse; the [`Stage`](stage::Stage) draws the scene with `lumel_render_gpu`. Solves run
//! on threads of their own ([`solver`]) and publish what they know; nothing that draws ever waits for them.

pub mod actions;
pub mod app;
pub mod atlas_view;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod dialogs;
pub mod dock;
pub mod document;
pub mod emissive;
pub mod event_loop;
pub mod gauges;
pub mod gizmo;
mod heap;
pub mod history;
pub mod input;
pub mod inputs;
pub mod instance;
pub mod layout;
mod light_shape;
pub mod lights;
pub mod lumel_light;
pub mod lumel_values;
pub mod mesh;
pub mod notice;
mod panels;
pub mod pick;
pub mod point_light;
pub mod prefs;
pub mod recovery;
pub mod relief;
mod rhythm;
pub mod screenshot;
pub mod selection;
pub mod session;
mod sky;
pub mod slots;
pub mod solver;
pub mod stage;
pub mod task;
pub mod theme;
pub mod unshot;
pub mod values;
pub mod viewport;
pub mod wake;
pub mod widgets;
