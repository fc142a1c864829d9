//! Edges of a smooth surface that have two places in an atlas.

use glam::DVec2;
use lumel_scene::{Edge, Edges, Scene, TriId, Weld};
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

/// All edges whose two triangles are neighbours on a smooth surface, but not in the atlas.
///
/// Neighbours have the ends of the edge in the same places, bit by bit, run along it in opposite directions, and have
/// nearly the same normals there. They may be of different objects.
pub(crate) fn seams(scene: &Scene, atlas: &Atlas) -> Vec<Seam> {
    let mut weld = Weld::default();
    let numbers: Vec<u32> = scene.positions().iter().map(|&position| weld.number(position)).collect();
    let places = scene.triangles().iter().map(|triangle| triangle.map(|vertex| numbers[vertex as usize]));
    let edges = Edges::new(places);
    let is_an_edge = |sides: &&[Edge]| sides[0].ends[0] != sides[0].ends[1] && sides.len() <= MOST_AT_AN_EDGE;
    let mut found = Vec::new();
    for edge in edges.each().filter(is_an_edge) {
        for (i, a) in edge.iter().enumerate() {
            found.extend(edge[i + 1..].iter().filter_map(|b| seam(scene, atlas, a, b)));
        }
    }
    found
}

fn seam(scene: &Scene, atlas: &Atlas, a: &Edge, b: &Edge) -> Option<Seam> {
    let tri = |edge: &Edge| TriId(edge.tri);
    let normals =
        |edge: &Edge| edge.corners().map(|k| scene.normals()[scene.triangle(tri(edge))[k] as usize]);
    let is_smooth = normals(a).iter().zip(normals(b)).all(|(a, b)| a.dot(b) > SMOOTH);
    if a.forward == b.forward || !is_smooth {
        return None;
    }
    let side = |edge: &Edge| {
        let corners = atlas.corners(tri(edge));
        Side { tri: tri(edge), ends: edge.corners().map(|corner| corners[corner].as_dvec2()) }
    };
    let sides = [side(a), side(b)];
    let is_apart = (0..2).any(|end| sides[0].ends[end].distance(sides[1].ends[end]) > ONE_PLACE);
    (atlas.page(tri(a)) != atlas.page(tri(b)) || is_apart).then_some(Seam { sides })
}
