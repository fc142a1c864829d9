//! A part of a surface, laid flat.

use crate::rectangle::long_side;
use glam::{DVec2, Vec2};
use lumel_scene::{FaceSide, ObjectId, Scene, SurfacePoint, TriId};
use std::collections::BTreeMap;

/// Triangles of one object, laid flat without overlap.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) object: ObjectId,
    pub(crate) triangles: Vec<TriId>,
    /// Corners in metres, none negative; every triangle has a positive area, unless a file gives the layout.
    pub(crate) corners: Vec<[Vec2; 3]>,
    /// Width and height, metres.
    pub(crate) size: DVec2,
    /// Area, m².
    pub(crate) area: f64,
    /// Length of the border, metres.
    pub(crate) border: f64,
    /// By triangle, the part that it belongs to, if a file gives the layout: its parts stay where they are to each other.
    /// Empty for a chart of our own, which is one part.
    pub(crate) islands: Vec<u32>,
}

impl Chart {
    /// A chart with its longer side along x, at the origin.
    pub(crate) fn new(object: ObjectId, triangles: Vec<TriId>, corners: &[[DVec2; 3]]) -> Self {
        let along = long_side(corners.iter().flatten().copied());
        let turned: Vec<[DVec2; 3]> =
            corners.iter().map(|t| t.map(|c| DVec2::new(c.dot(along), c.dot(along.perp())))).collect();
        Self::in_place(object, triangles, &turned)
    }

    /// A chart that is not turned, moved to the origin.
    pub(crate) fn in_place(object: ObjectId, triangles: Vec<TriId>, corners: &[[DVec2; 3]]) -> Self {
        let all = || corners.iter().flatten().copied();
        let (min, max) = all().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
        let area = corners.iter().map(|&t| signed_area(t).abs()).sum();
        let corners: Vec<[Vec2; 3]> =
            corners.iter().map(|t| t.map(|c| (c - min).as_vec2().max(Vec2::ZERO))).collect();
        let border = border(&corners);
        Self { object, triangles, corners, size: max - min, area, border, islands: Vec::new() }
    }

    /// Whether a file gives the layout: it is put on a page as it is, and neither turned nor cut.
    pub(crate) fn is_given(&self) -> bool {
        !self.islands.is_empty()
    }

    /// Its triangles for which there is a back, seen from there: mirrored, so that they have a positive area again.
    pub(crate) fn back(&self, scene: &Scene) -> Option<Self> {
        let mirrored = |[a, b, c]: [Vec2; 3]| [b, a, c].map(|p| DVec2::new(-f64::from(p.x), f64::from(p.y)));
        let backs = self.triangles.iter().enumerate();
        let backs: Vec<(usize, TriId)> =
            backs.filter_map(|(i, &tri)| Some((i, generated_back(scene, tri)?))).collect();
        let corners: Vec<[DVec2; 3]> = backs.iter().map(|&(i, _)| mirrored(self.corners[i])).collect();
        let islands = backs.iter().filter_map(|&(i, _)| self.islands.get(i).copied()).collect();
        let triangles: Vec<TriId> = backs.into_iter().map(|(_, tri)| tri).collect();
        (!triangles.is_empty()).then(|| Self { islands, ..Self::in_place(self.object, triangles, &corners) })
    }
}

/// The triangle that building the scene added for the back of this one. Its first two corners are exchanged.
///
/// A back that was given is a triangle like any other.
pub(crate) fn generated_back(scene: &Scene, tri: TriId) -> Option<TriId> {
    let at = SurfacePoint { tri, ..SurfacePoint::default() };
    let back = scene.seen_side(at, FaceSide::Back)?.tri;
    (back.index() >= scene.traced_count()).then_some(back)
}

/// The area of a triangle; negative if it is mirrored.
pub(crate) fn signed_area([a, b, c]: [DVec2; 3]) -> f64 {
    0.5 * (b - a).perp_dot(c - a)
}

/// The length of all edges that only one triangle has.
fn border(corners: &[[Vec2; 3]]) -> f64 {
    let mut edges: BTreeMap<[[u32; 2]; 2], (i32, f32)> = BTreeMap::new();
    for t in corners {
        for k in 0..3 {
            let (from, to) = (t[k], t[(k + 1) % 3]);
            let [a, b] = [from, to].map(|p| p.to_array().map(f32::to_bits));
            edges.entry(if a < b { [a, b] } else { [b, a] }).or_insert((0, from.distance(to))).0 += 1;
        }
    }
    edges.values().filter(|(count, _)| *count == 1).map(|(_, length)| f64::from(*length)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_turned_by_anything_lies_straight() {
        let along = DVec2::from_angle(0.3);
        let at = |x: f64, y: f64| along * x + along.perp() * y + DVec2::splat(7.0);
        let corners =
            [[at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0)], [at(0.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)]];
        let chart = Chart::new(ObjectId(0), vec![TriId(0), TriId(1)], &corners);
        assert!((chart.size - DVec2::new(2.0, 1.0)).length() < 1e-9, "{}", chart.size);
        assert!((chart.area - 2.0).abs() < 1e-9 && (chart.border - 6.0).abs() < 1e-5, "{chart:?}");
    }
}
