//! Parts that several panels are made of.

mod color;
mod rows;
mod toast;

pub use color::{albedo_button, color_button};
pub use rows::{check, choice, heading, number, primary_button, row, slider, value, vector};
pub use toast::Toasts;
