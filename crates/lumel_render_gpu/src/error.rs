//! Why something cannot be drawn.

use lumel_basis::VertexCountError;
use lumel_render_cpu::PictureError;

/// Why something cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// A part of a scene is larger than the device allows.
    #[error(
        "scene \"{scene}\" does not fit the graphics device: its {what} take {bytes} bytes; the limit is {limit}"
    )]
    TooLarge {
        /// The scene's name.
        scene: String,
        /// The part.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// More or larger pages of a lightmap than the device allows.
    #[error(
        "a lightmap of {pages} pages cannot be shown; the graphics device allows {limit} of {side} x {side} lumels"
    )]
    Atlas {
        /// Number of pages.
        pages: usize,
        /// How many there may be.
        limit: usize,
        /// The longest side of a page.
        side: u32,
    },
    /// More scattered points, or more levels of them, than the device allows.
    #[error(
        "{points} points on {levels} levels cannot be shown; the graphics device allows {limit} on {most_levels} levels"
    )]
    Points {
        /// Number of points.
        points: usize,
        /// Number of their levels.
        levels: usize,
        /// How many points there may be.
        limit: u64,
        /// How many levels there may be.
        most_levels: usize,
    },
    /// The device has no memory left.
    #[error("the graphics device has no memory left for {what}")]
    OutOfMemory {
        /// What was to be created.
        what: String,
    },
    /// No pixels, or more than the device allows.
    #[error("a picture of {width} x {height} pixels cannot be drawn; both must be 1 to {limit}")]
    Size {
        /// The requested size.
        width: u32,
        /// The requested size.
        height: u32,
        /// The largest width or height.
        limit: u32,
    },
    /// Light of a different scene.
    #[error(transparent)]
    Light(#[from] VertexCountError),
    /// Pixels that do not form a picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The device did not return the pixels.
    #[error("the graphics device did not return the picture: {0}")]
    Read(String),
}
