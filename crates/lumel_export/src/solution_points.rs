//! Light at scattered points, beside what is read of it at vertices.

use crate::members::{
    read_flags, read_numbers, read_optional, read_positions, read_stacked, read_vectors, read_whole_numbers,
    stacked,
};
use crate::{Array, ArrayData, NpzReader, NpzWriter, SolutionError};
use glam::{DVec3, Vec3};
use std::io;

/// The points that carried light from bounce to bounce, with what they carried.
///
/// In a file: `points`, `point_normals` (points, 3), `point_radius`, `point_level`, `point_valid` (points), `point_bounces`
/// (bounces, points, 3) and `point_tail` (points, 3). Around every point, light is the mean of the points within their radii, weighted by
/// `(1 - 3t² + 2t³) max(0, n·nᵢ)` with the distance t over the radius and the normals there; points whose normal is more than 84°
/// from that of the place do not count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolutionPoints {
    /// Their places in world space, metres.
    pub positions: Vec<DVec3>,
    /// Their unit normals, on the lit side.
    pub normals: Vec<Vec3>,
    /// How far each reaches, metres.
    pub radii: Vec<f32>,
    /// The level of each: 0 is the coarsest.
    pub levels: Vec<u32>,
    /// Whether each was measured itself. Others, such as those inside a wall, were filled in from neighbours.
    pub valid: Vec<bool>,
    /// `bounces[k][point]`: light that arrived after `k` reflections, W·m⁻²; `bounces[0]` is direct light.
    pub bounces: Vec<Vec<Vec3>>,
    /// What no bounce contains, as in a [`Solution`](crate::Solution).
    pub tail: Option<Vec<Vec3>>,
}

const POINTS: &str = "points";
const NORMALS: &str = "point_normals";
const RADII: &str = "point_radius";
const LEVELS: &str = "point_level";
const VALID: &str = "point_valid";
const BOUNCES: &str = "point_bounces";
const TAIL: &str = "point_tail";

impl SolutionPoints {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Checks that all arrays cover the same points with finite numbers.
    pub(crate) fn validate(&self) -> Result<(), SolutionError> {
        let not_finite = |array: &str, at: Option<usize>| match at {
            Some(vertex) => Err(SolutionError::NotFinite { array: array.to_owned(), vertex }),
            None => Ok(()),
        };
        not_finite(POINTS, self.positions.iter().position(|position| !position.is_finite()))?;
        not_finite(RADII, self.radii.iter().position(|radius| !radius.is_finite()))?;
        for (array, count) in
            [(RADII, self.radii.len()), (LEVELS, self.levels.len()), (VALID, self.valid.len())]
        {
            self.check_length(array, count)?;
        }
        let bounces = self.bounces.iter().map(|bounce| (BOUNCES, bounce));
        let vectors =
            bounces.chain(self.tail.iter().map(|tail| (TAIL, tail))).chain([(NORMALS, &self.normals)]);
        for (array, values) in vectors {
            self.check_length(array, values.len())?;
            not_finite(array, values.iter().position(|value| !value.is_finite()))?;
        }
        Ok(())
    }

    fn check_length(&self, array: &str, count: usize) -> Result<(), SolutionError> {
        let vertices = self.len();
        if count == vertices {
            return Ok(());
        }
        Err(SolutionError::Length { array: array.to_owned(), count, vertices })
    }

    pub(crate) fn write(&self, npz: &mut NpzWriter<'_>) -> io::Result<()> {
        npz.array(POINTS, &Array::from_positions(&self.positions))?;
        npz.array(NORMALS, &Array::from_vectors(&self.normals))?;
        npz.array(RADII, &Array::list(ArrayData::F32(self.radii.clone())))?;
        npz.array(LEVELS, &Array::list(ArrayData::U32(self.levels.clone())))?;
        npz.array(VALID, &Array::list(ArrayData::Bool(self.valid.clone())))?;
        npz.array(BOUNCES, &stacked(&self.bounces, self.len()))?;
        self.tail.as_ref().map_or(Ok(()), |tail| npz.array(TAIL, &Array::from_vectors(tail)))
    }

    /// Reads the points of a solution, if it has any.
    pub(crate) fn read(npz: &mut NpzReader) -> Result<Option<Self>, SolutionError> {
        if !npz.has_array(POINTS) {
            return Ok(None);
        }
        let positions = read_positions(npz, POINTS)?;
        let points = Self {
            normals: read_vectors(npz, NORMALS)?,
            radii: read_numbers(npz, RADII)?,
            levels: read_whole_numbers(npz, LEVELS)?,
            valid: read_flags(npz, VALID)?,
            bounces: read_stacked(npz, BOUNCES, positions.len())?,
            tail: read_optional(npz, TAIL)?,
            positions,
        };
        points.validate()?;
        Ok(Some(points))
    }

    /// What each array holds.
    pub(crate) fn descriptions(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let tail = self.tail.is_some().then_some((TAIL, "(point, rgb) what no bounce contains, as tail"));
        [
            (POINTS, "(point, xyz) position of the points that carried light, in world space, metres, +Y up"),
            (NORMALS, "(point, xyz) unit normal on the lit side"),
            (RADII, "(point) how far the point reaches, metres"),
            (LEVELS, "(point) the level of the point, 0 for the coarsest"),
            (VALID, "(point) true where light was measured, false where it was filled in from neighbours"),
            (
                BOUNCES,
                "(bounce, point, rgb) light that arrived at the point after 0, 1, 2.. reflections, W/m^2",
            ),
        ]
        .into_iter()
        .chain(tail)
    }
}
