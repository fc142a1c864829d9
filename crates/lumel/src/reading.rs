//! Time and counters of a solve.

use lumel_transport::Control;

/// Time and counters at some moment of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Seconds since any fixed moment; libraries have no clock.
    pub seconds: f64,
    /// Elements measured so far, see [`Control::elements`].
    pub elements: u64,
    /// Rays traced so far, see [`Control::rays`].
    pub rays: u64,
}

impl Reading {
    /// The counters of a control, at a time in seconds.
    pub fn new(control: &Control, seconds: f64) -> Self {
        Self { seconds, elements: control.elements(), rays: control.rays() }
    }

    /// What has come since an earlier reading.
    pub(crate) fn since(self, start: Self) -> Self {
        Self {
            seconds: self.seconds - start.seconds,
            elements: self.elements.saturating_sub(start.elements),
            rays: self.rays.saturating_sub(start.rays),
        }
    }
}
