//! What the renderer's scattered points hold.

use crate::point_light::PointIllumination;
use crate::prefs::{ViewMode, ViewPrefs};
use crate::selection::Selection;
use crate::session::Session;
use lumel_basis::PointCloud;
use lumel_render_gpu::{PointBuffer, Renderer};
use std::sync::Arc;

/// What is shown of light at points: equal ones need no new picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointContent {
    generation: u64,
    selection: Selection,
    /// The finest level that is shown.
    pub(super) finest: u32,
}

impl PointContent {
    /// What a view shows of the session's light; `None` where it shows vertices.
    pub(super) fn new(session: &Session, view: &ViewPrefs) -> Option<Self> {
        let is_light = matches!(view.mode, ViewMode::Final | ViewMode::Irradiance | ViewMode::FalseColor);
        (is_light && session.light.points.is_some() && session.lumel_light().is_none()).then_some(Self {
            generation: session.light_generation,
            selection: view.selection,
            finest: view.finest_level,
        })
    }
}

/// Points on the device.
pub(super) struct ShownPoints {
    cloud: Arc<PointCloud>,
    /// `None` where the device cannot hold them.
    buffer: Option<PointBuffer>,
    content: Option<(u64, Selection)>,
}

impl ShownPoints {
    /// Uploads what has changed. A device that cannot hold the points is told about once.
    pub(super) fn fill(
        shown: &mut Option<Self>,
        renderer: &Renderer,
        light: &PointIllumination,
        content: &PointContent,
    ) -> Result<(), String> {
        let mut problem = Ok(());
        let mut new = || {
            let buffer = renderer.points(&light.cloud);
            let buffer = buffer.map_err(|error| problem = Err(error.to_string())).ok();
            Self { cloud: Arc::clone(&light.cloud), buffer, content: None }
        };
        let is_same = |shown: &Self| Arc::ptr_eq(&shown.cloud, &light.cloud);
        let shown = match shown {
            Some(same) if is_same(same) => same,
            other => other.insert(new()),
        };
        let content = (content.generation, content.selection);
        if let Some(buffer) = shown.buffer.as_ref().filter(|_| shown.content != Some(content)) {
            renderer.set_points(buffer, &light.select(content.1));
            shown.content = Some(content);
        }
        problem
    }

    pub(super) fn buffer(&self) -> Option<&PointBuffer> {
        self.buffer.as_ref()
    }
}
