//! Parts that several panels are made of.

mod busy;
mod color;
mod modal;
mod rows;
mod toast;

pub use busy::busy;
pub use color::{albedo_button, color_button, share_button};
pub use modal::modal;
pub use rows::{check, choice, heading, hint, number, place, primary_button, row, slider, value};
pub use toast::Toasts;
