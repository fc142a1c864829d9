//! The sky behind the picture.

use lumel::Sky;
use lumel_render_gpu::{Backdrop, RenderError, Renderer};

/// The sky on the device.
#[derive(Default)]
pub(super) struct ShownSky {
    sky: Sky,
    backdrop: Option<Backdrop>,
}

impl ShownSky {
    /// Uploads the sky if it has changed. One that does not fit is told about once, and its mean is shown.
    pub(super) fn fill(&mut self, renderer: &Renderer, sky: &Sky) -> Result<(), RenderError> {
        if self.sky == *sky {
            return Ok(());
        }
        self.sky = sky.clone();
        self.backdrop = renderer.backdrop(sky, self.backdrop.take())?;
        Ok(())
    }

    /// What is drawn of it, where it is not the same everywhere.
    pub(super) fn backdrop(&self) -> Option<&Backdrop> {
        self.backdrop.as_ref()
    }
}
