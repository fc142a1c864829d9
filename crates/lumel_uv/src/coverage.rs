//! Which parts of which triangles lie in each lumel.

use crate::Atlas;
use crate::chart::signed_area;
use crate::clip::{Polygon, clip_to_square};
use crate::raster::touched;
use glam::DVec2;
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use rayon::prelude::*;

/// Less of a lumel than this is not covered: rounding leaves as much.
const LEAST_AREA: f64 = 1e-6;

/// Triangles that are looked at together.
const AT_ONCE: usize = 1024;

/// For each lumel that a reader between lumels may read, the triangles in it.
///
/// A lumel that triangles cover has a share for each of them. One that only lies beside a triangle, so near that reading
/// the triangle's light bilinearly reads it, has one share of area 0: the nearest triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Indices of lumels, ascending: by page, row and column.
    lumels: Vec<u32>,
    /// The first share of each, and the end of all.
    first: Vec<u32>,
    shares: Vec<Share>,
}

/// What a triangle covers of a lumel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The triangle.
    pub tri: TriId,
    /// Area in the lumel, in parts of the lumel; 0 if it only comes near.
    pub area: f32,
}

/// The part of a triangle in a lumel: a convex polygon, or the nearest point.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    tri: TriId,
    corners: [DVec2; 3],
    /// Lumels; empty if there is only a point.
    polygon: Polygon,
    nearest: Barycentrics,
}

impl Coverage {
    /// The coverage of all pages.
    pub fn new(atlas: &Atlas) -> Self {
        let first_lumels: Vec<usize> = (0..atlas.pages().len()).map(|page| atlas.first_lumel(page)).collect();
        let tris: Vec<TriId> = (0..atlas.triangle_count() as u32).map(TriId).collect();
        let index = |tri: TriId, x: i64, y: i64| {
            let page = atlas.page(tri);
            let [width, height] = atlas.pages()[page].map(i64::from);
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            inside.then(|| (first_lumels[page] + (y * width + x) as usize) as u32)
        };
        let mut covering: Vec<(u32, Share)> = tris
            .par_chunks(AT_ONCE)
            .flat_map_iter(|tris| {
                let mut found = Vec::new();
                for &tri in tris {
                    let corners = atlas.corners(tri).map(|c| c.as_dvec2());
                    each_square(corners, 0.0, |x, y| {
                        let area = area_in_square(corners, DVec2::new(x as f64, y as f64));
                        if let Some(lumel) = index(tri, x, y).filter(|_| area > LEAST_AREA) {
                            found.push((lumel, Share { tri, area: area as f32 }));
                        }
                    });
                }
                found
            })
            .collect();
        covering.par_sort_unstable_by_key(|(lumel, share)| (*lumel, share.tri));
        let is_covered = |lumel: u32| covering.binary_search_by_key(&lumel, |(lumel, _)| *lumel).is_ok();
        let mut near: Vec<(u32, u32, TriId)> = tris
            .par_chunks(AT_ONCE)
            .flat_map_iter(|tris| {
                let mut found = Vec::new();
                for &tri in tris {
                    let corners = atlas.corners(tri).map(|c| c.as_dvec2());
                    each_square(corners, 0.5, |x, y| {
                        // Most of a large triangle is covered.
                        let min = DVec2::new(x as f64, y as f64);
                        if contains_square(corners, min) {
                            return;
                        }
                        if let Some(lumel) = index(tri, x, y).filter(|&lumel| !is_covered(lumel)) {
                            let (_, distance) = nearest(corners, min + 0.5);
                            // Not negative: its bits are in its order.
                            found.push((lumel, (distance as f32).to_bits(), tri));
                        }
                    });
                }
                found
            })
            .collect();
        near.par_sort_unstable();
        near.dedup_by_key(|(lumel, ..)| *lumel);
        covering.extend(near.into_iter().map(|(lumel, _, tri)| (lumel, Share { tri, area: 0.0 })));
        covering.par_sort_unstable_by_key(|(lumel, share)| (*lumel, share.tri));
        let mut coverage =
            Self { lumels: Vec::new(), first: vec![0], shares: Vec::with_capacity(covering.len()) };
        for (lumel, share) in covering {
            if coverage.lumels.last() != Some(&lumel) {
                coverage.lumels.push(lumel);
                coverage.first.push(coverage.shares.len() as u32);
            }
            coverage.shares.push(share);
            if let Some(end) = coverage.first.last_mut() {
                *end = coverage.shares.len() as u32;
            }
        }
        coverage
    }

    /// Number of lumels that are read.
    pub fn len(&self) -> usize {
        self.lumels.len()
    }

    /// Whether no lumel is read.
    pub fn is_empty(&self) -> bool {
        self.lumels.is_empty()
    }

    /// The indices of the lumels, ascending: see [`Atlas::first_lumel`].
    pub fn lumels(&self) -> &[u32] {
        &self.lumels
    }

    /// The triangles in the lumel at a place in [`lumels`](Self::lumels); at least one.
    pub fn shares(&self, place: usize) -> &[Share] {
        &self.shares[self.first[place] as usize..self.first[place + 1] as usize]
    }
}

impl Piece {
    /// The part of a triangle in the lumel whose column and row are given; `None` if it does not come near.
    pub fn new(atlas: &Atlas, tri: TriId, [x, y]: [u32; 2]) -> Option<Self> {
        let corners = atlas.corners(tri).map(|c| c.as_dvec2());
        let min = DVec2::new(f64::from(x), f64::from(y));
        let mut polygon = clip_to_square(corners, min, 1.0);
        if polygon.area() <= LEAST_AREA {
            polygon = Polygon::default();
            clip_to_square(corners, min - 0.5, 2.0).corners().first()?;
        }
        Some(Self { tri, corners, polygon, nearest: nearest(corners, min + 0.5).0 })
    }

    /// The triangle.
    pub fn tri(&self) -> TriId {
        self.tri
    }

    /// Area in parts of the lumel; 0 if the triangle only comes near.
    pub fn area(&self) -> f32 {
        self.polygon.area() as f32
    }

    /// The corners of the polygon on the triangle; none if it only comes near.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = SurfacePoint> + '_ {
        self.polygon.corners().iter().map(|&at| self.surface_point(at))
    }

    /// A point of the piece, uniform by area for uniform `u` in 0..1; the nearest point if it only comes near.
    pub fn point(&self, u: [f32; 2]) -> SurfacePoint {
        let Some((&first, rest)) = self.polygon.corners().split_first() else {
            return SurfacePoint { tri: self.tri, bary: self.nearest };
        };
        let area = |pair: &[DVec2]| 0.5 * (pair[0] - first).perp_dot(pair[1] - first).abs();
        let fan = || rest.windows(2).map(|pair| (pair, area(pair)));
        let mut left = f64::from(u[0]) * self.polygon.area();
        for (i, (pair, area)) in fan().enumerate() {
            if left <= area || i + 2 == rest.len() {
                // What is left of the first number is uniform in this triangle of the fan.
                let along = (left / area).clamp(0.0, 1.0).sqrt();
                let across = f64::from(u[1]);
                let at = first + along * ((pair[0] - first) * (1.0 - across) + (pair[1] - first) * across);
                return self.surface_point(at);
            }
            left -= area;
        }
        SurfacePoint { tri: self.tri, bary: self.nearest }
    }

    /// The point of the triangle at a place on its page, or near it; and the least of the barycentrics there, which is
    /// negative outside.
    pub fn at(&self, place: DVec2) -> (SurfacePoint, f64) {
        let [a, b, c] = self.corners;
        let whole = (b - a).perp_dot(c - a);
        let [u, v] =
            [(b - place).perp_dot(c - place), (c - place).perp_dot(a - place)].map(|area| area / whole);
        (self.surface_point(place), u.min(v).min(1.0 - u - v))
    }

    fn surface_point(&self, at: DVec2) -> SurfacePoint {
        let [a, b, c] = self.corners;
        let whole = (b - a).perp_dot(c - a);
        if whole == 0.0 {
            return SurfacePoint { tri: self.tri, bary: self.nearest };
        }
        let u = ((b - at).perp_dot(c - at) / whole).clamp(0.0, 1.0);
        let v = ((c - at).perp_dot(a - at) / whole).clamp(0.0, 1.0 - u);
        SurfacePoint { tri: self.tri, bary: Barycentrics { u: u as f32, v: v as f32 } }
    }
}

pub(crate) fn each_square(corners: [DVec2; 3], reach: f64, mut square: impl FnMut(i64, i64)) {
    touched(corners, reach, |y, first, end| (first..end).for_each(|x| square(x, y)));
}

/// Whether all of a square of one lumel lies in a triangle.
fn contains_square(corners: [DVec2; 3], min: DVec2) -> bool {
    let side = signed_area(corners).signum();
    (0..3).all(|k| {
        let (from, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        let squares = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        squares.into_iter().all(|corner| side * edge.perp_dot(min + corner - from) >= 0.0)
    })
}

fn area_in_square(corners: [DVec2; 3], min: DVec2) -> f64 {
    if contains_square(corners, min) { 1.0 } else { clip_to_square(corners, min, 1.0).area() }
}

/// The point of a triangle nearest to another one, and their distance.
pub(crate) fn nearest(corners: [DVec2; 3], to: DVec2) -> (Barycentrics, f64) {
    let whole = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
    let opposite = |k: usize| (corners[(k + 1) % 3] - to).perp_dot(corners[(k + 2) % 3] - to);
    if whole != 0.0 && (0..3).all(|k| opposite(k) * whole >= 0.0) {
        let [u, v] = [0, 1].map(|k| (opposite(k) / whole) as f32);
        return (Barycentrics { u, v }, 0.0);
    }
    let mut best = (Barycentrics::CORNERS[0], f64::INFINITY);
    for k in 0..3 {
        let (from, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        let length_squared = edge.length_squared();
        let along =
            if length_squared > 0.0 { ((to - from).dot(edge) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (from + edge * along).distance(to);
        if distance < best.1 {
            let mut weights = [0.0; 3];
            (weights[k], weights[(k + 1) % 3]) = (1.0 - along as f32, along as f32);
            best = (Barycentrics { u: weights[0], v: weights[1] }, distance);
        }
    }
    best
}
