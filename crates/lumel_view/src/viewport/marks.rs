//! Dots and lines over the picture: sample points, the brightest shooters, and the rays of a picked vertex.

use super::ground;
use crate::pick::Pick;
use crate::prefs::ViewPrefs;
use crate::session::Session;
use crate::solver::Solved;
use crate::stage::Marks;
use lumel_render_gpu::{Hidden, Mark};

/// Rays of a vertex beyond these are left out: they would cover the picture.
const MAX_RAYS: usize = 512;

/// At most this many dots for sample points: more cannot be told apart.
const MAX_POINTS: usize = 200_000;

/// The colour of what shoots next.
const SHOOTER: [u8; 4] = [255, 120, 220, 255];

/// What the marks depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MarksKey {
    document: u64,
    mesh: u64,
    light: u64,
    points: bool,
    /// The generation of the light that is still to be reflected.
    unshot: Option<u64>,
    rays_of: Option<usize>,
    spot: Option<[f32; 3]>,
    ground: bool,
}

/// The marks with what they were made for.
#[derive(Default)]
pub(super) struct CurrentMarks {
    key: Option<MarksKey>,
    marks: Marks,
}

impl CurrentMarks {
    /// Brings the marks up to date; `None` when there are none.
    pub(super) fn update(
        &mut self,
        session: &Session,
        view: &ViewPrefs,
        pick: Option<&Pick>,
    ) -> Option<&Marks> {
        // Points and rays belong to a finished solve: a running one does not change them.
        let solved = session.computed().and_then(|c| c.solved.as_ref());
        let key = MarksKey {
            document: session.document_generation,
            mesh: session.mesh_generation,
            light: if solved.is_some() { session.light_generation } else { 0 },
            points: view.sample_points,
            unshot: view.shooters.then_some(session.light_generation),
            rays_of: pick.filter(|_| view.rays).map(|pick| pick.spot.vertex),
            spot: pick.map(|pick| pick.spot.position.to_array()),
            ground: view.ground && session.document.as_ref().is_some_and(|document| document.is_outdoors),
        };
        if self.key != Some(key) {
            self.key = Some(key);
            self.marks = key.marks(session, solved.map(|solved| &**solved), self.marks.generation + 1);
        }
        let is_empty = self.marks.points.is_empty() && self.marks.lines.is_empty();
        (!is_empty).then_some(&self.marks)
    }
}

impl MarksKey {
    fn marks(&self, session: &Session, solved: Option<&Solved>, generation: u64) -> Marks {
        let mut marks = Marks { generation, ..Marks::default() };
        if let (true, Some(solved)) = (self.points, solved) {
            marks.points = sample_points(solved);
        }
        if let (Some(_), Some(unshot)) = (self.unshot, session.unshot()) {
            let mark = |&position: &_| Mark { position, color: SHOOTER };
            marks.points.extend(unshot.brightest.iter().map(mark));
        }
        if let (Some(vertex), Some(solved), Some(document)) = (self.rays_of, solved, &session.document) {
            let rays = solved.baker.rays_of_vertex(vertex, 1, 0.2 * document.diagonal());
            let step = rays.len().div_ceil(MAX_RAYS).max(1);
            let end = |position, alpha| Mark { position, color: [255, 205, 110, alpha] };
            marks.lines = rays.into_iter().step_by(step).map(|[a, b]| [end(a, 150), end(b, 60)]).collect();
        }
        if let Some(spot) = self.spot {
            marks.points.push(Mark { position: spot.into(), color: [255, 255, 255, 255] });
        }
        // The ground is covered by what stands on it; other marks are to be seen through surfaces.
        let has_others = !marks.points.is_empty() || !marks.lines.is_empty();
        marks.hidden = if has_others { Hidden::Faint } else { Hidden::Invisible };
        if let (true, Some(document)) = (self.ground, &session.document) {
            marks.lines.extend(ground::grid(&document.scene));
        }
        marks
    }
}

/// Dots where light is measured.
fn sample_points(solved: &Solved) -> Vec<Mark> {
    let points = solved.baker.sample_points(&solved.state.valid, MAX_POINTS);
    let color = |valid: bool| if valid { [90, 210, 140, 255] } else { [235, 70, 60, 255] };
    points.into_iter().map(|(position, valid)| Mark { position, color: color(valid) }).collect()
}
