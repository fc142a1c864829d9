//! Edges of a smooth surface that have two places in an atlas.

use glam::DVec2;
use lumel_scene::{Scene, TriId, Weld};
use lumel_uv::Atlas;

/// Light does not jump where normals turn by less than this cosine, 8°: Iwanicki, *Lighting Technology of The Last of Us*,
/// SIGGRAPH 2013.
const SMOOTH: f32 = 0.99;

/// Places that differ by less are one, lumels: rounding does.
const ONE_PLACE: f64 = 1e-3;

/// Where more triangles meet in an edge, no surface is smooth.
const MOST_AT_AN_EDGE: usize = 8;

/// An edge with two places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seam {
    pub(crate) sides: [Side; 2],
}

/// An edge on the page of one of its triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub(crate) tri: TriId,
    /// Lumels; both sides begin at the same end.
    pub(crate) ends: [DVec2; 2],
}

impl Side {
    /// Lumels.
    pub(crate) fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// A triangle at an edge: its corners at the ends with the smaller and the larger number of all places.
struct Use {
    places: [u32; 2],
    tri: TriId,
    corners: [usize; 2],
}

/// All edges whose two triangles are neighbours on a smooth surface, but not in the atlas.
///
/// Neighbours have the ends of the edge in the same places, bit by bit, run along it in opposite directions, and have
/// nearly the same normals there. They may be of different objects.
pub(crate) fn seams(scene: &Scene, atlas: &Atlas) -> Vec<Seam> {
    let mut weld = Weld::default();
    let numbers: Vec<u32> = scene.positions().iter().map(|&position| weld.number(position)).collect();
    let mut uses = Vec::with_capacity(3 * scene.triangle_count());
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        let places = scene.triangle(tri).map(|vertex| numbers[vertex as usize]);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let corners = if places[from] < places[to] { [from, to] } else { [to, from] };
            let places = corners.map(|corner| places[corner]);
            if places[0] != places[1] {
                uses.push(Use { places, tri, corners });
            }
        }
    }
    uses.sort_unstable_by_key(|one| (one.places, one.tri));
    let mut found = Vec::new();
    for edge in uses.chunk_by(|a, b| a.places == b.places).filter(|edge| edge.len() <= MOST_AT_AN_EDGE) {
        for (i, a) in edge.iter().enumerate() {
            found.extend(edge[i + 1..].iter().filter_map(|b| seam(scene, atlas, a, b)));
        }
    }
    found
}

fn seam(scene: &Scene, atlas: &Atlas, a: &Use, b: &Use) -> Option<Seam> {
    let forward = |one: &Use| (one.corners[0] + 1) % 3 == one.corners[1];
    let normal = |one: &Use, end: usize| scene.normals()[scene.triangle(one.tri)[one.corners[end]] as usize];
    let is_smooth = (0..2).all(|end| normal(a, end).dot(normal(b, end)) > SMOOTH);
    if forward(a) == forward(b) || !is_smooth {
        return None;
    }
    let side = |one: &Use| {
        let corners = atlas.corners(one.tri);
        Side { tri: one.tri, ends: one.corners.map(|corner| corners[corner].as_dvec2()) }
    };
    let sides = [side(a), side(b)];
    let is_apart = (0..2).any(|end| sides[0].ends[end].distance(sides[1].ends[end]) > ONE_PLACE);
    (atlas.page(a.tri) != atlas.page(b.tri) || is_apart).then_some(Seam { sides })
}
