//! What is wrong with an atlas.

use crate::Atlas;
use crate::chart::signed_area;
use crate::mask::INSET;
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
    /// Its corners run the other way round.
    Mirrored(TriId),
    /// It lies on another triangle.
    Overlap {
        /// The one.
        tri: TriId,
        /// The other.
        other: TriId,
    },
    /// Its chart comes nearer to another one than the gutter.
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
    let mut faults = Vec::new();
    let mut by_page: Vec<Vec<TriId>> = vec![Vec::new(); atlas.pages().len()];
    for tri in (0..atlas.triangle_count() as u32).map(TriId) {
        match fault_of(atlas, tri) {
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

fn fault_of(atlas: &Atlas, tri: TriId) -> Option<Fault> {
    let corners = atlas.corners(tri).map(|c| c.as_dvec2());
    let [width, height] = atlas.pages()[atlas.page(tri)].map(f64::from);
    let inside = |c: &DVec2| (0.0..=width).contains(&c.x) && (0.0..=height).contains(&c.y);
    let longest = (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
    if !corners.iter().all(|c| c.is_finite()) {
        Some(Fault::NotFinite(tri))
    } else if !corners.iter().all(inside) {
        Some(Fault::OutsidePage(tri))
    } else if 2.0 * signed_area(corners) < -LINE * longest {
        Some(Fault::Mirrored(tri))
    } else {
        None
    }
}

/// One fault for each chart that shares a lumel with another one, or has less than the gutter between.
fn too_near(atlas: &Atlas, page: usize, triangles: &[TriId]) -> Vec<Fault> {
    let [width, height] = atlas.pages()[page].map(|side| side as usize);
    // For each lumel, a triangle that touches it.
    let mut owner = vec![NOBODY; width * height];
    let mut faults = Vec::new();
    let mut told = BTreeSet::new();
    let mut tell = |tri: TriId, other: TriId, [x, y]: [usize; 2]| {
        if told.insert(atlas.chart(tri)) {
            faults.push(Fault::Gutter { tri, other, lumel: [x as u32, y as u32, page as u32] });
        }
    };
    for &tri in triangles {
        touched(atlas.corners(tri).map(|c| c.as_dvec2()), -2.0 * INSET, |y, first, end| {
            let Ok(y) = usize::try_from(y) else { return };
            for x in first.max(0) as usize..(end.max(0) as usize).min(width) {
                let Some(lumel) = owner.get_mut(y * width + x) else { continue };
                if *lumel != NOBODY && atlas.chart(TriId(*lumel)) != atlas.chart(tri) {
                    tell(tri, TriId(*lumel), [x, y]);
                }
                *lumel = tri.0;
            }
        });
    }
    let gutter = atlas.gutter() as usize;
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let tri = owner[y * width + x];
        // The far side of a chart of one lumel is looked at from there.
        let inner = |at: usize| owner.get(at).is_some_and(|&other| other == tri);
        if tri == NOBODY || inner(y * width + x + 1) && inner((y + 1) * width + x) && x + 1 < width {
            continue;
        }
        for row in y..(y + gutter + 1).min(height) {
            for column in x.saturating_sub(gutter)..(x + gutter + 1).min(width) {
                let other = owner[row * width + column];
                if other != NOBODY && atlas.chart(TriId(other)) != atlas.chart(TriId(tri)) {
                    tell(TriId(tri), TriId(other), [x, y]);
                }
            }
        }
    }
    faults
}
