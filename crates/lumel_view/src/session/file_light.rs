//! Light from files and into files.

use crate::mesh::Mesh;
use crate::selection::{Illumination, Layer};
use lumel::{LightFile, Solution, SolutionLayer};
use std::path::PathBuf;
use std::sync::Arc;

/// Light that was read from a file.
pub struct LoadedLight {
    pub(super) path: PathBuf,
    pub(super) file: LightFile,
    pub(super) mesh: Mesh,
    pub(super) usage: LightUse,
}

/// What to do with light from a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightUse {
    /// To be the light of the scene.
    Show,
    /// To be compared with.
    Compare,
}

/// A file that was written.
pub struct SavedFile {
    pub(super) path: PathBuf,
    /// The generation of the light that is in it, if it holds all of the light.
    pub(super) solution_of: Option<u64>,
    pub(super) what: String,
}

/// The light of a file, bounce by bounce where it tells them apart.
pub fn light_from(file: &LightFile) -> Illumination {
    match file {
        LightFile::Solution(solution) => light_of_solution(solution),
        LightFile::Rad(rad) => {
            Illumination { sum_only: Some(Arc::new(rad.irradiance())), ..Illumination::new() }
        }
    }
}

fn layer(layer: &SolutionLayer) -> Layer {
    let SolutionLayer { name, irradiance, directional } = layer.clone();
    Layer { name, values: Arc::new(irradiance), directional: directional.map(Arc::new), share: 1.0 }
}

fn light_of_solution(solution: &Solution) -> Illumination {
    let sum_only = solution.bounces.is_empty().then(|| Arc::new(solution.irradiance.clone()));
    Illumination {
        id: Illumination::new().id,
        bounces: solution.bounces.iter().cloned().map(Arc::new).collect(),
        current: None,
        tail: solution.tail.clone().map(Arc::new),
        sum_only,
        valid: Arc::new(solution.valid.clone()),
        standard_error: solution.standard_error.clone().map(Arc::new),
        layers: solution.layers.iter().map(layer).collect(),
        directional: solution.directional.clone().map(Arc::new),
        directional_before: None,
        points: None,
    }
}
