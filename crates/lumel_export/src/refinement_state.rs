//! A refinement that is under way: a part of a checkpoint.

use crate::members::{check_members, read_edges, read_vectors, read_whole_numbers, write_edges, wrong_shape};
use crate::{Array, ArrayData, NpzReader, NpzWriter, SolutionError};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::io;

/// How far the refinement of a mesh is: all that its next step reads.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementState {
    /// What comes next.
    pub next: NextRefinement,
    /// The edges that are split, as `lumel_scene::Bisection::splits` tells them.
    pub splits: Vec<[u32; 2]>,
    /// Darker light is taken for as bright, once that is known, W·m⁻².
    pub floor: Option<f64>,
    /// Direct light that was measured, while more of it is to be.
    pub probes: Vec<SavedProbe>,
}

/// What a refinement does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NextRefinement {
    /// Direct light is looked at.
    Direct,
    /// All light after so many bounces is looked at.
    Bounce(u32),
    /// Nothing: light is linear enough everywhere, or edges are as short as they may be.
    Reached,
    /// Nothing: more vertices are not allowed.
    Vertices,
}

/// What was measured at a vertex, in the middle of an edge or within a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SavedProbe {
    /// The vertices of the triangle, or of an edge or one vertex, whose last one is repeated.
    pub corners: [u32; 3],
    /// Irradiance, luminance, W·m⁻².
    pub light: f64,
    /// The square of its standard error.
    pub variance: f64,
    /// Which lights are seen, a bit each.
    pub visible: u32,
    /// Irradiance, W·m⁻².
    pub irradiance: Vec3,
}

/// The part of `meta.json` that arrays do not tell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefinementMeta {
    /// See [`RefinementState::next`].
    pub next: NextRefinement,
}

const SPLITS: &str = "refinement_splits";
/// One number or none: text might not keep all its digits.
const FLOOR: &str = "refinement_floor";
const CORNERS: &str = "probe_corners";
const LIGHT: &str = "probe_light";
const VISIBLE: &str = "probe_visible";
const IRRADIANCE: &str = "probe_irradiance";

impl RefinementState {
    pub(crate) fn meta(&self) -> RefinementMeta {
        RefinementMeta { next: self.next }
    }

    pub(crate) fn write(&self, npz: &mut NpzWriter<'_>) -> io::Result<()> {
        let n = self.probes.len();
        let corners = self.probes.iter().flat_map(|probe| probe.corners).collect();
        let light = self.probes.iter().flat_map(|probe| [probe.light, probe.variance]).collect();
        let visible = self.probes.iter().map(|probe| probe.visible).collect();
        let irradiance: Vec<Vec3> = self.probes.iter().map(|probe| probe.irradiance).collect();
        write_edges(npz, SPLITS, &self.splits)?;
        npz.array(FLOOR, &Array::list(ArrayData::F64(self.floor.into_iter().collect())))?;
        npz.array(CORNERS, &Array { shape: vec![n, 3], data: ArrayData::U32(corners) })?;
        npz.array(LIGHT, &Array { shape: vec![n, 2], data: ArrayData::F64(light) })?;
        npz.array(VISIBLE, &Array::list(ArrayData::U32(visible)))?;
        npz.array(IRRADIANCE, &Array::from_vectors(&irradiance))
    }
}

impl RefinementMeta {
    pub(crate) fn read(&self, npz: &mut NpzReader) -> Result<RefinementState, SolutionError> {
        check_members(npz, &[SPLITS, FLOOR, CORNERS, LIGHT, VISIBLE, IRRADIANCE].map(str::to_owned))?;
        let corners = read_whole_numbers(npz, CORNERS)?;
        let visible = read_whole_numbers(npz, VISIBLE)?;
        let irradiance = read_vectors(npz, IRRADIANCE)?;
        let floor = match npz.array(FLOOR)?.data {
            ArrayData::F64(floor) => floor.first().copied(),
            _ => None,
        };
        let array = npz.array(LIGHT)?;
        let light = match (array.shape.as_slice(), &array.data) {
            ([_, 2], ArrayData::F64(light)) => light,
            _ => return Err(wrong_shape(npz, LIGHT, "(n, 2) of <f8", &array)),
        };
        let n = irradiance.len();
        if corners.len() != 3 * n || light.len() != 2 * n || visible.len() != n {
            return Err(wrong_shape(npz, LIGHT, &format!("({n}, 2), as {IRRADIANCE} has it,"), &array));
        }
        let probe = |i: usize| SavedProbe {
            corners: [0, 1, 2].map(|k| corners[3 * i + k]),
            light: light[2 * i],
            variance: light[2 * i + 1],
            visible: visible[i],
            irradiance: irradiance[i],
        };
        let probes = (0..n).map(probe).collect();
        Ok(RefinementState { next: self.next, splits: read_edges(npz, SPLITS)?, floor, probes })
    }
}
