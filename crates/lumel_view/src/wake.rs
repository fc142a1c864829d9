//! How background threads wake the window.

use std::sync::Arc;

/// Called from any thread when there is something new to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How the window is told of a solve.
#[derive(Clone)]
pub struct Wakes {
    /// Something has happened.
    pub event: Wake,
    /// A little more is known of the bounce under way; may be drawn when it suits.
    pub glimpse: Wake,
}
