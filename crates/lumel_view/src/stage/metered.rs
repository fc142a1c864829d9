//! Automatic exposure.

use super::content::Content;
use super::showing::{Quality, Showing};
use crate::camera::FlyCamera;
use lumel::{RectLight, VertexLighting};
use lumel_render_cpu::{View, meter};
use std::time::{Duration, Instant};

/// While something moves or a solve runs, the exposure is read this often.
const PERIOD: Duration = Duration::from_millis(900);

/// The exposure that was read last.
#[derive(Default)]
pub(super) struct Metered {
    /// In stops.
    pub(super) stops: f32,
    of: Option<Reading>,
    at: Option<Instant>,
}

/// What an exposure depends on.
#[derive(PartialEq)]
struct Reading {
    camera: FlyCamera,
    content: Content,
    lamps: Vec<RectLight>,
}

impl Metered {
    /// Reads the exposure off the scene if what is seen has changed.
    pub(super) fn read(
        &mut self,
        showing: &Showing<'_>,
        content: &Content,
        lamps: &[RectLight],
        size: [u32; 2],
    ) {
        let session = showing.session;
        let of = Reading { camera: session.camera, content: *content, lamps: lamps.to_vec() };
        // Another part of the light is not brighter or darker by a little: it is read at once.
        let same_kind = self.of.as_ref().is_some_and(|old| old.content.shows_the_same_as(content));
        let is_recent = self.at.is_some_and(|at| at.elapsed() < PERIOD);
        let hold = showing.quality == Quality::Live && is_recent && same_kind;
        if self.of.as_ref() == Some(&of) || hold {
            return;
        }
        if let Some(stops) = stops_for(showing, content, size) {
            *self = Self { stops, of: Some(of), at: Some(Instant::now()) };
        }
    }
}

/// What the meter reads for some light from the camera of the session.
pub(super) fn stops_for(showing: &Showing<'_>, content: &Content, size: [u32; 2]) -> Option<f32> {
    let session = showing.session;
    let document = session.document.as_ref()?;
    let scene = document.relit(&session.lights).ok()?;
    let values = content.values(session)?;
    let lighting = VertexLighting::new(&scene, &values).ok()?;
    let view = View::new(&scene, &*document.tracer, &lighting);
    let aspect = size[0] as f32 / size[1].max(1) as f32;
    meter(&view, &session.camera.camera(), aspect).ok()
}
