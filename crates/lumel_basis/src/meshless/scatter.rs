//! Points scattered over surfaces, none too near to another, none missing.

use super::cells::{BYTES_PER_CELL, CellTable, Grid};
use super::clearance::{Clearance, Obstacles};
use super::nodes::RADIUS;
use crate::RandomPlaces;
use crate::parts::parts;
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint};
use rayon::prelude::*;

/// Random points that are tried per square of the spacing, before the gaps between those taken are filled.
const CANDIDATES: f64 = 20.0;

/// Points are apart, however near they are, if their normals differ by more than this cosine (60°): so the two sides of a thin wall,
/// and the walls of a corner, are covered each by itself.
const SAME_FACING: f32 = 0.5;

/// Points that are taken per square of the spacing: less at large spacings, where surfaces have more border than inside.
const DENSITY: f64 = 0.66;

/// Candidates that are looked at together.
const BATCH: std::ops::RangeInclusive<usize> = 1024..=65_536;

/// Triangles whose gaps are looked at together.
const TRIANGLES_PER_BATCH: u32 = 4096;

/// A place of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// Its address.
    pub at: SurfacePoint,
    /// Where it is in the coordinates of the scene, metres.
    pub position: Vec3,
    /// Which way the surface faces: the interpolated normal, unless the triangle turns away from it.
    pub normal: Vec3,
}

impl SurfaceSample {
    pub(crate) fn new(scene: &Scene, at: SurfacePoint) -> Self {
        let (shading, geometric) = (scene.shading_normal(at), scene.geometric_normal(at.tri));
        let normal = if shading.dot(geometric) > 0.0 { shading } else { geometric };
        Self { at, position: scene.position(at), normal }
    }
}

/// What is lower than this share of the spacing is no obstacle: light has no detail as small as that.
pub(crate) const LIFT: f32 = 0.1;

/// A point that was taken, and what stands around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattered {
    pub(crate) sample: SurfaceSample,
    pub(crate) clearance: Option<Clearance>,
}

/// The spacing at which about so many points cover an area, m².
pub(crate) fn spacing_for(count: u64, area: f64) -> f32 {
    (DENSITY * area / count.max(1) as f64).sqrt() as f32
}

/// How many points an area has at a spacing, about; surfaces of many small pieces have up to one more for each.
pub(crate) fn count_for(spacing: f32, area: f64) -> u64 {
    (DENSITY * area / f64::from(spacing).powi(2)).ceil() as u64
}

/// The memory that scattering takes beyond its result, for so many points on so many triangles.
pub(crate) fn bytes_to_scatter(points: u64, triangles: u64) -> u64 {
    points * (BYTES_PER_CELL + 4) + triangles * size_of::<f64>() as u64
}

/// Points on the surfaces of a scene that are as even as random ones can be, `spacing` metres apart or more where they face the same
/// way.
///
/// Random points, uniform by area, are taken in turn if they keep their distance from those taken before (dart throwing), and then the
/// middles of all parts of the triangles. So every place is within 1⅔ spacings of a point that faces about the same way, and where
/// triangles lie has no influence but on the few that fill gaps. Points from which an obstacle hides a place are not near it: both sides
/// of a wall that stands on a floor are covered each by itself. The same on any number of threads.
pub(crate) fn scattered(scene: &Scene, spacing: f32, obstacles: &dyn Obstacles) -> Vec<Scattered> {
    let mut taken = Taken::new(scene, spacing, obstacles);
    let places = RandomPlaces::new(scene);
    let count =
        (CANDIDATES * places.area() / f64::from(spacing).powi(2)).ceil().min(u32::MAX.into()) as usize;
    let mut first = 0;
    while first < count {
        let batch = taken.points.len().clamp(*BATCH.start(), *BATCH.end()).min(count - first);
        let candidate = |i: usize| taken.if_free(SurfaceSample::new(scene, places.place(i as u32)));
        let free: Vec<Scattered> = (first..first + batch).into_par_iter().filter_map(candidate).collect();
        free.into_iter().for_each(|point| taken.take(point));
        first += batch;
    }
    let n_triangles = scene.triangle_count() as u32;
    for first in (0..n_triangles).step_by(TRIANGLES_PER_BATCH as usize) {
        let tris = first..n_triangles.min(first + TRIANGLES_PER_BATCH);
        let free = |tri: u32| {
            let middles =
                parts(scene, tri..tri + 1, spacing).map(|part| SurfaceSample::new(scene, part.middle));
            middles.filter_map(|sample| taken.if_free(sample)).collect::<Vec<_>>()
        };
        let free: Vec<Vec<Scattered>> = tris.into_par_iter().map(free).collect();
        free.into_iter().flatten().for_each(|point| taken.take(point));
    }
    taken.points
}

/// The points that are taken already.
struct Taken<'a> {
    spacing: f32,
    obstacles: &'a dyn Obstacles,
    grid: Grid,
    /// The last point taken in each cell.
    last: CellTable,
    /// The point taken before each in its cell; itself for the first.
    before: Vec<u32>,
    points: Vec<Scattered>,
}

impl<'a> Taken<'a> {
    fn new(scene: &Scene, spacing: f32, obstacles: &'a dyn Obstacles) -> Self {
        let grid = Grid::new(scene.bounds().min, spacing);
        let (last, before, points) = (CellTable::default(), Vec::new(), Vec::new());
        Self { spacing, obstacles, grid, last, before, points }
    }

    /// The sample and what stands around it, if it keeps its distance from all points.
    fn if_free(&self, sample: SurfaceSample) -> Option<Scattered> {
        let clearance =
            |sample| Clearance::around(sample, LIFT * self.spacing, RADIUS * self.spacing, self.obstacles);
        self.is_free(&sample).then(|| Scattered { sample, clearance: clearance(&sample) })
    }

    fn is_free(&self, sample: &SurfaceSample) -> bool {
        let is_near = |Scattered { sample: other, clearance }: &Scattered| {
            let offset = sample.position - other.position;
            offset.length_squared() < self.spacing * self.spacing
                && other.normal.dot(sample.normal) > SAME_FACING
                && clearance.is_none_or(|clearance| clearance.behind(other.normal, offset) <= 1.0)
        };
        let mut around = self.grid.around(sample.position).into_iter().filter_map(|cell| self.last.get(cell));
        let is_taken = around.any(|last| {
            let mut point = last as usize;
            loop {
                if is_near(&self.points[point]) {
                    return true;
                }
                let before = self.before[point] as usize;
                if before == point {
                    return false;
                }
                point = before;
            }
        });
        !is_taken
    }

    /// Takes a point unless it is too near to one.
    fn take(&mut self, point: Scattered) {
        if !self.is_free(&point.sample) {
            return;
        }
        let number = self.points.len() as u32;
        let before = self.last.insert(self.grid.cell(point.sample.position), number);
        self.before.push(before.unwrap_or(number));
        self.points.push(point);
    }
}
