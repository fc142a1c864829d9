//! Direct light at the vertices, where points carry the bounces.

use crate::settings::{Settings, TargetError};
use crate::surfaces::{Ordered, Surfaces};
use lumel_basis::{Basis, Receivers, Sampling};
use lumel_scene::Scene;
use lumel_transport::{Plan, Transport};
use std::sync::Arc;

/// Makes operators that measure direct light at the vertices, as the projection says.
pub(crate) struct DirectAtVertices {
    scene: Arc<Scene>,
    surfaces: Surfaces,
    sampling: Sampling,
}

/// What measures direct light at the vertices.
pub(crate) struct AtVertices {
    pub(crate) transport: Box<dyn Transport>,
    /// Whether it takes hemisphere rays, too.
    pub(crate) needs_hemisphere: bool,
}

impl DirectAtVertices {
    /// `None` where nothing needs it: without points, and with a target error where bounces do not reflect it. What is read is
    /// then that of the points, whose errors are known.
    pub(crate) fn new(scene: &Arc<Scene>, surfaces: &Surfaces, settings: &Settings) -> Option<Self> {
        let is_read = surfaces.basis.points().is_some() && settings.target_error == TargetError::Off;
        (is_read || surfaces.basis.direct().is_some()).then(|| Self {
            scene: Arc::clone(scene),
            surfaces: surfaces.clone(),
            sampling: settings.projection.sampling(),
        })
    }

    /// The operator with these samples.
    pub(crate) fn operator(&self, plan: Plan) -> AtVertices {
        match self.sampling {
            Sampling::Point => self.traced(self.surfaces.at_vertices(), plan),
            Sampling::Area => self.traced(self.surfaces.over_areas(), plan),
        }
    }

    fn traced<R: Receivers + 'static>(&self, measured: &Ordered<R>, plan: Plan) -> AtVertices {
        let operator = self.surfaces.traced(&self.scene, measured, plan);
        AtVertices { needs_hemisphere: operator.needs_hemisphere(), transport: Box::new(operator) }
    }
}
