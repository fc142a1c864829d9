//! What is wrong with an atlas.

use crate::Atlas;
use crate::chart::signed_area;
use crate::mask::{INSET, reach_of};
use crate::overlap::overlapping;
use crate::raster::touched;
use glam::DVec2;
use lumel_scene::{ObjectId, Scene, TriId};
use std::collections::BTreeSet;
use std::fmt;

/// Triangles may lie on each other by this many lumels: rounding on large pages and in charts of curved surfaces leaves
/// less, and no light comes from the wrong place by more than this.
const OVERLAP: f64 = 0.05;

/// A triangle that is upside down by less than this many lumels is a line.
const LINE: f64 = 1e-2;

/// No chart.
const NOBODY: u32 = u32::MAX;

/// Something wrong with the place of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The atlas has another number of triangles than the scene.
    OtherScene,
    /// Its place is no number.
    NotFinite(TriId),
    /// It is not on its page.
    OutsidePage(TriId),
    /// Its corners run the other way round than those of its chart.
    Mirrored(TriId),
    /// It lies on another triangle.
    Overlap {
        /// The one.
        tri: TriId,
        /// The other.
        other: TriId,
    },
    /// Its chart comes so near to another one that a lumel belongs to both: its centre is nearer to either than half of the
    /// gutter. Charts that are as far apart as the gutter have none in common.
    Gutter {
        /// A triangle of the one chart.
        tri: TriId,
        /// A triangle of the other.
        other: TriId,
        /// Column, row and page of a lumel of the first.
        lumel: [u32; 3],
    },
}

impl Fault {
    /// The triangle that is wrong.
    pub fn triangle(&self) -> Option<TriId> {
        match *self {
            Self::OtherScene => None,
            Self::NotFinite(tri) | Self::OutsidePage(tri) | Self::Mirrored(tri) => Some(tri),
            Self::Overlap { tri, .. } | Self::Gutter { tri, .. } => Some(tri),
        }
    }

    /// The object of the triangle that is wrong.
    pub fn object(&self, scene: &Scene) -> Option<ObjectId> {
        self.triangle().filter(|tri| tri.index() < scene.triangle_count()).map(|tri| scene.object_id(tri))
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherScene => write!(f, "the atlas has another number of triangles than the scene"),
            Self::NotFinite(TriId(tri)) => write!(f, "triangle {tri} has a corner that is no number"),
            Self::OutsidePage(TriId(tri)) => write!(f, "triangle {tri} is not on its page"),
            Self::Mirrored(TriId(tri)) => write!(f, "triangle {tri} is mirrored"),
            Self::Overlap { tri, other } => write!(f, "triangles {} and {} overlap", tri.0, other.0),
            Self::Gutter { tri, other, lumel: [x, y, page] } => write!(
                f,
                "the charts of triangles {} and {} are too near at lumel ({x}, {y}) of page {page}",
                tri.0, other.0
            ),
        }
    }
}

/// Finds mirrored and overlapping triangles, charts that are nearer to each other than the gutter, and places that are
/// not on a page. Empty for an atlas that can be used.
pub fn check(atlas: &Atlas, scene: &Scene) -> Vec<Fault> {
    if atlas.triangle_count() != scene.triangle_count() {
        return vec![Fault::OtherScene];
    }
    let sides = sides(atlas);
    let mut faults = Vec::new();
    let mut by_page: Vec<Vec<TriId>> = vec![Vec::new(); atlas.pages().len()];
    for tri in (0..atlas.triangle_count() as u32).map(TriId) {
        match fault_of(atlas, tri, sides[atlas.chart(tri)]) {
            Some(fault) => faults.push(fault),
            None => by_page[atlas.page(tri)].push(tri),
        }
    }
    for (page, triangles) in by_page.iter().enumerate() {
        let corners: Vec<[DVec2; 3]> =
            triangles.iter().map(|&tri| atlas.corners(tri).map(|c| c.as_dvec2())).collect();
        let pairs = overlapping(&corners, OVERLAP).into_iter();
        faults.extend(pairs.map(|[a, b]| Fault::Overlap { tri: triangles[b], other: triangles[a] }));
        faults.extend(too_near(atlas, page, triangles));
    }
    faults
}

/// 1 or -1 for each chart: the side from which it is seen, as most of it is.
fn sides(atlas: &Atlas) -> Vec<f64> {
    let mut areas = vec![0.0; atlas.charts().len()];
    for tri in (0..atlas.triangle_count() as u32).map(TriId) {
        areas[atlas.chart(tri)] += signed_area(atlas.corners(tri).map(|c| c.as_dvec2()));
    }
    areas.into_iter().map(f64::signum).collect()
}

/// What is wrong with the place of a triangle by itself, on a chart seen from this side.
fn fault_of(atlas: &Atlas, tri: TriId, side: f64) -> Option<Fault> {
    let corners = atlas.corners(tri).map(|c| c.as_dvec2());
    let [width, height] = atlas.pages()[atlas.page(tri)].map(f64::from);
    let inside = |c: &DVec2| (0.0..=width).contains(&c.x) && (0.0..=height).contains(&c.y);
    let longest = (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
    if !corners.iter().all(|c| c.is_finite()) {
        Some(Fault::NotFinite(tri))
    } else if !corners.iter().all(inside) {
        Some(Fault::OutsidePage(tri))
    } else if 2.0 * side * signed_area(corners) < -LINE * longest {
        Some(Fault::Mirrored(tri))
    } else {
        None
    }
}

/// One fault for each two charts that have a lumel in common: one whose centre is nearer to both than half of the
/// gutter, or that both touch.
fn too_near(atlas: &Atlas, page: usize, triangles: &[TriId]) -> Vec<Fault> {
    let [width, height] = atlas.pages()[page].map(|side| side as usize);
    let reach = reach_of(atlas.gutter());
    // For each lumel, a triangle that comes near.
    let mut owner = vec![NOBODY; width * height];
    let mut faults = Vec::new();
    let mut told = BTreeSet::new();
    for &tri in triangles {
        touched(atlas.corners(tri).map(|c| c.as_dvec2()), reach - 2.0 * INSET, |y, first, end| {
            let Ok(y) = usize::try_from(y) else { return };
            for x in first.max(0) as usize..(end.max(0) as usize).min(width) {
                let Some(lumel) = owner.get_mut(y * width + x) else { continue };
                let other = TriId(std::mem::replace(lumel, tri.0));
                if other.0 == NOBODY || atlas.chart(other) == atlas.chart(tri) {
                    continue;
                }
                if told.insert([atlas.chart(tri), atlas.chart(other)]) {
                    faults.push(Fault::Gutter { tri, other, lumel: [x as u32, y as u32, page as u32] });
                }
            }
        });
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene_of;
    use crate::{Density, Pace, UnwrapSettings, unwrap};
    use glam::{Vec2, Vec3};
    use lumel_testkit::mesh::quad;

    /// Two squares of ten lumels.
    fn squares() -> (Scene, Atlas) {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let scene = scene_of(vec![quad(corners, [1, 1], 0), quad(corners.map(|c| c + Vec3::Z), [1, 1], 0)]);
        let settings = UnwrapSettings { density: Density::PerMetre(10.0), ..UnwrapSettings::default() };
        let atlas = unwrap(&scene, &settings, &|| Pace::Go).unwrap().atlas;
        (scene, atlas)
    }

    /// What is found when the places of some triangles change.
    fn changed(tris: &[usize], change: impl Fn([Vec2; 3]) -> [Vec2; 3]) -> Vec<Fault> {
        let (scene, mut atlas) = squares();
        assert_eq!(check(&atlas, &scene), []);
        tris.iter().for_each(|&tri| atlas.corners[tri] = change(atlas.corners[tri]));
        check(&atlas, &scene)
    }

    #[test]
    fn every_fault_is_found() {
        assert_eq!(changed(&[1], |[a, _, c]| [a, Vec2::NAN, c]), [Fault::NotFinite(TriId(1))]);
        assert_eq!(changed(&[1], |t| t.map(|c| c + 1000.0)), [Fault::OutsidePage(TriId(1))]);
        assert_eq!(changed(&[1], |[a, b, c]| [b, a, c]), [Fault::Mirrored(TriId(1))]);
        let enlarged = |[a, b, c]: [Vec2; 3]| [a, b, c].map(|p| p + (p - (a + b + c) / 3.0) * 0.1);
        let found = changed(&[1], enlarged);
        assert_eq!(found[0], Fault::Overlap { tri: TriId(1), other: TriId(0) }, "triangles of one chart");
    }

    #[test]
    fn charts_that_come_too_near_are_found_on_all_sides_and_those_in_each_other_too() {
        let (_, atlas) = squares();
        let [a, b] = [0, 2].map(|tri| atlas.charts()[atlas.chart(TriId(tri))]);
        let mut n_near = 0;
        for (dx, dy) in (-14..=14).flat_map(|dx| (-14..=14).map(move |dy| (dx, dy))) {
            let place = |k: usize, d: i32| a.min[k] as f32 + d as f32 - b.min[k] as f32;
            let shift = Vec2::new(place(0, dx), place(1, dy));
            let mut moved = atlas.clone();
            // Room for all of it.
            moved.pages[0] = [64, 64];
            moved.corners.iter_mut().flatten().for_each(|corner| *corner += 20.0);
            moved.corners[2..].iter_mut().flatten().for_each(|corner| *corner += shift);
            let triangles: Vec<TriId> = (0..4).map(TriId).collect();
            let is_near = (-11..=11).contains(&dx) && (-11..=11).contains(&dy);
            assert_eq!(!too_near(&moved, 0, &triangles).is_empty(), is_near, "{dx} {dy}");
            n_near += usize::from(is_near);
        }
        assert_eq!(n_near, 23 * 23);
    }

    #[test]
    fn faults_say_what_and_where() {
        let fault = Fault::Gutter { tri: TriId(3), other: TriId(7), lumel: [5, 6, 0] };
        assert_eq!(
            fault.to_string(),
            "the charts of triangles 3 and 7 are too near at lumel (5, 6) of page 0"
        );
        assert_eq!(Fault::Mirrored(TriId(3)).to_string(), "triangle 3 is mirrored");
        let (scene, _) = squares();
        assert_eq!(fault.object(&scene), Some(ObjectId(1)));
    }
}
