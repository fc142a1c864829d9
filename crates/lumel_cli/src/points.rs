//! Points to measure at.

use crate::args::MeasureArgs;
use crate::failure::hinted;
use anyhow::bail;
use glam::{DVec3, Vec3};
use lumel::Scene;
use lumel_basis::PointReceivers;
use lumel_export::{ArrayData, NpzReader};
use std::path::Path;

/// Points and their normals.
#[derive(Debug)]
pub(crate) struct Points {
    /// In world space, metres.
    pub(crate) positions: Vec<DVec3>,
    /// Of any non-zero length.
    pub(crate) normals: Vec<Vec3>,
}

impl Points {
    /// The points from the command line or from the file that it names.
    pub(crate) fn from_args(args: &MeasureArgs) -> anyhow::Result<Self> {
        if let Some(file) = &args.points_file {
            return Self::read(file);
        }
        let (positions, normals) = (args.points.clone(), args.normals.clone());
        if positions.len() != normals.len() {
            let message =
                format!("there are {} --point but {} --normal options", positions.len(), normals.len());
            return Err(hinted(message, "add one --normal for each --point, in the same order"));
        }
        Ok(Self { positions, normals })
    }

    fn read(path: &Path) -> anyhow::Result<Self> {
        let mut npz = NpzReader::open(path)?;
        let positions = vectors(&mut npz, "points")?;
        let normals: Vec<Vec3> = vectors(&mut npz, "normals")?.iter().map(|v| v.as_vec3()).collect();
        let (n, m) = (positions.len(), normals.len());
        if n != m {
            bail!("there are {n} points and {m} normals: {}", path.display());
        }
        if n == 0 {
            bail!("there are no points: {}", path.display());
        }
        Ok(Self { positions, normals })
    }

    /// The receivers at the points.
    pub(crate) fn receivers(&self, scene: &Scene) -> anyhow::Result<PointReceivers> {
        let pairs = self.positions.iter().copied().zip(self.normals.iter().copied());
        PointReceivers::new(scene, pairs)
            .map_err(|i| anyhow::anyhow!("point {i} is not finite, or its normal has no direction"))
    }
}

fn vectors(npz: &mut NpzReader, name: &str) -> anyhow::Result<Vec<DVec3>> {
    let array = npz.array(name)?;
    let numbers: Vec<f64> = match (&array.shape[..], array.data) {
        ([_, 3], ArrayData::F32(values)) => values.into_iter().map(f64::from).collect(),
        ([_, 3], ArrayData::F64(values)) => values,
        (shape, data) => bail!(
            "\"{name}\" has the shape {shape:?} of {}, not (n, 3) of <f4 or <f8: {}",
            data.descr(),
            npz.path().display()
        ),
    };
    Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
}
