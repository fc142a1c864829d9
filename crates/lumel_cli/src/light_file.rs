//! Light from files, whichever format they have.

use crate::load::belongs_hint;
use anyhow::bail;
use glam::Vec3;
use lumel::{Scene, Solution, SolutionSelection};
use lumel_export::{RadFile, position_md5};
use std::path::Path;

/// A solution: ours, or one in the course's format.
pub(crate) enum LightFile {
    /// All bounces.
    Solution(Box<Solution>),
    /// The sum, of a mesh known by the MD5 of its positions.
    Rad(RadFile),
}

impl LightFile {
    /// Reads a file; its extension tells the format.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let is_rad = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("rad"));
        Ok(if is_rad {
            Self::Rad(RadFile::read(path)?)
        } else {
            Self::Solution(Box::new(Solution::load(path)?))
        })
    }

    /// Irradiance at the vertices of a scene that the file must belong to, W·m⁻².
    pub(crate) fn irradiance_for(
        path: &Path,
        scene: &Scene,
        selection: SolutionSelection,
    ) -> anyhow::Result<Fitting> {
        match Self::read(path)? {
            Self::Solution(solution) => {
                solution.check_belongs_to(scene).map_err(|error| {
                    belongs_hint(anyhow::Error::new(error).context(format!("cannot use {}", path.display())))
                })?;
                let same_lighting = solution.has_lighting_of(scene);
                let complete = solution.meta.complete;
                Ok(Fitting { irradiance: solution.select(selection)?.to_vec(), same_lighting, complete })
            }
            Self::Rad(rad) => {
                if selection != SolutionSelection::Sum {
                    bail!("a .rad file holds the sum of all bounces only: {}", path.display());
                }
                if !rad.matches(scene) {
                    let (values, vertices) = (rad.values.len(), scene.vertex_count());
                    return Err(belongs_hint(anyhow::anyhow!(
                        "the light of {values} vertices was computed for other positions than those of scene \
                         \"{}\" with {vertices} vertices: {}",
                        scene.name(),
                        path.display()
                    )));
                }
                Ok(Fitting { irradiance: rad.irradiance(), same_lighting: true, complete: true })
            }
        }
    }

    /// Number of vertices.
    pub(crate) fn vertex_count(&self) -> usize {
        match self {
            Self::Solution(solution) => solution.vertex_count(),
            Self::Rad(rad) => rad.values.len(),
        }
    }

    /// All light, W·m⁻² per vertex.
    pub(crate) fn sum(&self) -> Vec<Vec3> {
        match self {
            Self::Solution(solution) => solution.sum().to_vec(),
            Self::Rad(rad) => rad.irradiance(),
        }
    }

    /// Each bounce; none where the file does not tell them apart.
    pub(crate) fn bounces(&self) -> &[Vec<Vec3>] {
        match self {
            Self::Solution(solution) => &solution.bounces,
            Self::Rad(_) => &[],
        }
    }

    /// Whether a vertex was measured.
    pub(crate) fn is_valid(&self, vertex: usize) -> bool {
        match self {
            Self::Solution(solution) => solution.valid[vertex],
            Self::Rad(_) => true,
        }
    }

    /// The scene in words, for messages.
    pub(crate) fn scene_label(&self) -> String {
        let n = self.vertex_count();
        match self {
            Self::Solution(solution) => format!("scene \"{}\" with {n} vertices", solution.meta.scene),
            Self::Rad(rad) => format!("a mesh with {n} vertices and MD5 {}", rad.position_md5),
        }
    }

    /// Whether both are light on the same vertices.
    pub(crate) fn same_vertices_as(&self, other: &Self) -> bool {
        let same = match (self, other) {
            (Self::Solution(a), Self::Solution(b)) => a.meta.geometry_hash == b.meta.geometry_hash,
            (Self::Solution(a), Self::Rad(b)) | (Self::Rad(b), Self::Solution(a)) => {
                position_md5(&a.positions) == b.position_md5
            }
            (Self::Rad(a), Self::Rad(b)) => a.position_md5 == b.position_md5,
        };
        same && self.vertex_count() == other.vertex_count()
    }
}

/// Light that fits a scene.
pub(crate) struct Fitting {
    /// At the vertices, W·m⁻².
    pub(crate) irradiance: Vec<Vec3>,
    /// Whether materials and lights are those of the bake, as far as the file tells.
    pub(crate) same_lighting: bool,
    /// Whether the bake was finished.
    pub(crate) complete: bool,
}
