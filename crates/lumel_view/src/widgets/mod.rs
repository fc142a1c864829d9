//! Parts that several panels are made of.

mod rows;
mod toast;

pub use rows::{check, choice, heading, number, primary_button, row, slider, value, vector};
pub use toast::Toasts;
