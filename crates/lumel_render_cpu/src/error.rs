//! Why a picture cannot be drawn.

use crate::limits::{MAX_PIXELS, MAX_SAMPLES};

/// Why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// No pixels, or more than are allowed.
    #[error("a picture of {width} x {height} pixels cannot be drawn; the limit is {MAX_PIXELS} pixels")]
    Size {
        /// The requested size.
        width: u64,
        /// The requested size.
        height: u64,
    },
    /// No samples, or more than are allowed.
    #[error("{0} samples per pixel cannot be drawn; there must be 1 to {MAX_SAMPLES}")]
    Samples(u32),
    /// A number of pixels that does not match the size.
    #[error("a picture of {width} x {height} pixels was given {count} pixels")]
    PixelCount {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Pixels given.
        count: usize,
    },
    /// A camera that has no view.
    #[error("camera \"{name}\": {problem}")]
    Camera {
        /// The camera's name.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A display setting out of range.
    #[error("{what} must be {expected}, not {value}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// The accepted values.
        expected: &'static str,
        /// The value.
        value: String,
    },
    /// An empty list of pictures to join.
    #[error("there are no pictures to place side by side")]
    NoPictures,
    /// The cancel flag was set.
    #[error("drawing was cancelled")]
    Cancelled,
}
