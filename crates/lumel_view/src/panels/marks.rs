//! Dots and lines over the picture: sample points, and the rays of a picked vertex.

use crate::app::App;
use crate::stage::{Marks, sample_marks};
use lumel_render_gpu::Mark;

/// Rays of a vertex beyond these are left out: they would cover the picture.
const MAX_RAYS: usize = 512;

/// What the marks depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MarksKey {
    document: u64,
    light: u64,
    points: bool,
    rays_of: Option<usize>,
    spot: Option<[f32; 3]>,
}

/// Brings the marks up to date; false when there are none.
pub(crate) fn marks(app: &mut App) -> bool {
    let view = &app.prefs.view;
    let rays_of = app.pick.as_ref().filter(|_| view.rays).map(|pick| pick.spot.vertex);
    let spot = app.pick.as_ref().map(|pick| pick.spot.position.to_array());
    // Points and rays are those of a finished solve, so light that is being measured changes nothing.
    let solved = app.session.computed().and_then(|c| c.solved.clone());
    let light = if solved.is_some() { app.session.light_generation } else { 0 };
    let key = MarksKey {
        document: app.session.document_generation,
        light,
        points: view.sample_points,
        rays_of,
        spot,
    };
    if app.viewport.marks_key != Some(key) {
        app.viewport.marks_key = Some(key);
        let mut marks = Marks { generation: app.viewport.marks.generation + 1, ..Marks::default() };
        if key.points {
            marks.points = sample_marks(&app.session);
        }
        if let (Some(vertex), Some(solved), Some(document)) = (rays_of, solved, &app.session.document) {
            let rays = solved.baker.rays_of_vertex(vertex, 1, 0.2 * document.diagonal());
            let step = rays.len().div_ceil(MAX_RAYS).max(1);
            let end = |position, alpha| Mark { position, color: [255, 205, 110, alpha] };
            marks.lines = rays.into_iter().step_by(step).map(|[a, b]| [end(a, 150), end(b, 60)]).collect();
        }
        if let Some(pick) = &app.pick {
            marks.points.push(Mark { position: pick.spot.position, color: [255, 255, 255, 255] });
        }
        app.viewport.marks = marks;
    }
    !(app.viewport.marks.points.is_empty() && app.viewport.marks.lines.is_empty())
}
