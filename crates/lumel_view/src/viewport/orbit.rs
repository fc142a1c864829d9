//! What the camera turns around and looks at: orbits, views along axes, frames.

use crate::camera::ViewSide;
use crate::document::Document;
use crate::pick::{self, Pick};
use crate::session::Session;
use glam::{Vec2, Vec3};
use lumel_scene::Bounds;

/// The field of view that stands for a parallel projection, degrees.
const PARALLEL_DEG: f32 = crate::camera::FOV_DEG[0];

/// The field of view to come back to where the scene opens with a narrow one, degrees.
const USUAL_DEG: f32 = 50.0;

/// What the camera turns around: the spot that was picked, else the surface at a point of the picture, else the middle of the
/// scene.
pub(super) fn pivot(session: &Session, pick: Option<&Pick>, aspect: f32, at: Vec2) -> Option<Vec3> {
    let document = session.document.as_ref()?;
    let seen = || pick::spot(&document.scene, &*document.tracer, &session.camera.camera(), aspect, at);
    let spot = pick.map(|pick| pick.spot.position).or_else(|| Some(seen()?.position));
    Some(spot.unwrap_or_else(|| document.scene.bounds().center()))
}

/// The picked spot, or the middle of the picture.
pub(crate) fn focus(session: &Session, pick: Option<&Pick>, aspect: f32) -> Option<Vec3> {
    pivot(session, pick, aspect, Vec2::splat(0.5))
}

/// Looks at what is in the middle of the picture, or picked, from a side and as far away as before.
pub(crate) fn view_from(session: &mut Session, pick: Option<&Pick>, aspect: f32, side: ViewSide) {
    if let Some(focus) = focus(session, pick, aspect) {
        session.camera.look_from(focus, side.direction());
    }
}

/// Switches between the scene's field of view and one so narrow that parallels nearly stay parallel; what is in the middle of
/// the picture keeps its size.
pub(crate) fn toggle_parallel(session: &mut Session, pick: Option<&Pick>, aspect: f32) {
    let (Some(focus), Some(document)) = (focus(session, pick, aspect), &session.document) else { return };
    let usual = document.home.fov_deg;
    let usual = if usual > 2.0 * PARALLEL_DEG { usual } else { USUAL_DEG };
    let is_parallel = session.camera.fov_deg <= PARALLEL_DEG;
    session.camera.zoom_about(focus, if is_parallel { usual } else { PARALLEL_DEG });
}

/// Moves the camera until the object of the picked spot fits the picture, or everything where none is picked.
pub(crate) fn frame(session: &mut Session, pick: Option<&Pick>, aspect: f32) {
    let Some(document) = &session.document else { return };
    let bounds = pick.and_then(|pick| object_bounds(document, pick)).unwrap_or(document.scene.bounds());
    session.camera.frame(bounds.center(), 0.5 * bounds.diagonal(), aspect);
}

fn object_bounds(document: &Document, pick: &Pick) -> Option<Bounds> {
    let scene = &document.scene;
    let object = scene.object_id(pick.spot.triangle());
    let triangles = (0..).map(lumel_scene::TriId).zip(scene.triangles());
    let own = triangles.filter(|(tri, _)| scene.object_id(*tri) == object).flat_map(|(_, corners)| *corners);
    let bounds = Bounds::around(own.map(|vertex| scene.positions()[vertex as usize]));
    (bounds.diagonal() > 0.0).then_some(bounds)
}
