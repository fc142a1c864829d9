//! Light from files, whichever format they have.

use glam::Vec3;
use lumel_basis::Coefficients;
use lumel_export::{
    RadFile, ReadError, ScatteredLight, Solution, SolutionError, SolutionSelection, position_md5,
};
use lumel_scene::Scene;
use std::path::{Path, PathBuf};

/// Light at vertices from a file: a solution of ours (`.npz`), or one in the course's format (`.rad`).
#[derive(Clone, Debug)]
pub enum LightFile {
    /// All bounces.
    Solution(Box<Solution>),
    /// The sum, of a mesh known by the MD5 of its positions.
    Rad(RadFile),
}

/// Why light from a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LightFileError {
    /// A solution that cannot be read, or that has no such bounce or layer.
    #[error(transparent)]
    Solution(#[from] SolutionError),
    /// A `.rad` file that cannot be read.
    #[error(transparent)]
    Rad(#[from] ReadError),
    /// A solution of another scene; the source names both.
    #[error("cannot use {}", path.display())]
    OtherScene {
        /// The file.
        path: PathBuf,
        /// How the scenes differ.
        source: SolutionError,
    },
    /// A `.rad` file of another mesh.
    #[error(
        "the light of {values} vertices was computed for other positions than those of scene \"{scene}\" with \
         {vertices} vertices: {}", path.display()
    )]
    OtherPositions {
        /// The file.
        path: PathBuf,
        /// How many values it has.
        values: usize,
        /// The name of the scene.
        scene: String,
        /// How many vertices that has.
        vertices: usize,
    },
    /// A part of the light from a format that has only the sum.
    #[error("a .rad file holds the sum of all bounces only: {}", path.display())]
    SumOnly {
        /// The file.
        path: PathBuf,
    },
}

impl LightFile {
    /// Reads a file; its extension tells the format.
    ///
    /// # Errors
    /// A file that is missing, damaged or of another format.
    pub fn read(path: &Path) -> Result<Self, LightFileError> {
        let is_rad = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("rad"));
        Ok(if is_rad {
            Self::Rad(RadFile::read(path)?)
        } else {
            Self::Solution(Box::new(Solution::load(path)?))
        })
    }

    /// Reads the light of a scene: computed for the same vertices in the same order, under whatever lights.
    ///
    /// # Errors
    /// As [`Self::read`], and light that belongs to another scene; the message names the file and both scenes.
    pub fn load_for(path: &Path, scene: &Scene) -> Result<Self, LightFileError> {
        let file = Self::read(path)?;
        let path = path.to_owned();
        match &file {
            Self::Solution(solution) => solution
                .check_belongs_to(scene)
                .map_err(|source| LightFileError::OtherScene { path, source })?,
            Self::Rad(rad) if !rad.matches(scene) => {
                let (values, vertices) = (rad.values.len(), scene.vertex_count());
                let scene = scene.name().to_owned();
                return Err(LightFileError::OtherPositions { path, values, scene, vertices });
            }
            Self::Rad(_) => {}
        }
        Ok(file)
    }

    /// Irradiance at the vertices of a scene that the file must belong to, W·m⁻².
    ///
    /// # Errors
    /// As [`Self::load_for`], and a bounce or a layer that the file does not have.
    pub fn irradiance_for(
        path: &Path,
        scene: &Scene,
        selection: &SolutionSelection,
    ) -> Result<Fitting, LightFileError> {
        match Self::load_for(path, scene)? {
            Self::Solution(solution) => Ok(Fitting {
                irradiance: solution.select(selection)?.to_vec(),
                directional: solution.select_directional(selection).cloned(),
                scattered: solution.scattered_light(scene, selection)?,
                same_lighting: solution.has_lighting_of(scene),
                complete: solution.meta.complete,
            }),
            Self::Rad(_) if *selection != SolutionSelection::Sum => {
                Err(LightFileError::SumOnly { path: path.to_owned() })
            }
            Self::Rad(rad) => Ok(Fitting {
                irradiance: rad.irradiance(),
                directional: None,
                scattered: None,
                same_lighting: true,
                complete: true,
            }),
        }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        match self {
            Self::Solution(solution) => solution.vertex_count(),
            Self::Rad(rad) => rad.values.len(),
        }
    }

    /// All light, W·m⁻² per vertex.
    pub fn sum(&self) -> Vec<Vec3> {
        match self {
            Self::Solution(solution) => solution.sum().to_vec(),
            Self::Rad(rad) => rad.irradiance(),
        }
    }

    /// Each bounce; none where the file does not tell them apart.
    pub fn bounces(&self) -> &[Vec<Vec3>] {
        match self {
            Self::Solution(solution) => &solution.bounces,
            Self::Rad(_) => &[],
        }
    }

    /// Whether a vertex was measured.
    pub fn is_valid(&self, vertex: usize) -> bool {
        match self {
            Self::Solution(solution) => solution.valid[vertex],
            Self::Rad(_) => true,
        }
    }

    /// The scene in words, for messages.
    pub fn scene_label(&self) -> String {
        let n = self.vertex_count();
        match self {
            Self::Solution(solution) => format!("scene \"{}\" with {n} vertices", solution.meta.scene),
            Self::Rad(rad) => format!("a mesh with {n} vertices and MD5 {}", rad.position_md5),
        }
    }

    /// Whether both are light on the same vertices.
    pub fn same_vertices_as(&self, other: &Self) -> bool {
        let same = match (self, other) {
            (Self::Solution(a), Self::Solution(b)) => a.meta.geometry_hash == b.meta.geometry_hash,
            (Self::Solution(a), Self::Rad(b)) | (Self::Rad(b), Self::Solution(a)) => {
                position_md5(a.positions.iter().copied()) == b.position_md5
            }
            (Self::Rad(a), Self::Rad(b)) => a.position_md5 == b.position_md5,
        };
        same && self.vertex_count() == other.vertex_count()
    }
}

/// Light that fits a scene.
#[derive(Clone, Debug)]
pub struct Fitting {
    /// At the vertices, W·m⁻².
    pub irradiance: Vec<Vec3>,
    /// The same by direction, if the file has it.
    pub directional: Option<Coefficients>,
    /// The same as the points have it that carried it, if they did.
    pub scattered: Option<ScatteredLight>,
    /// Whether materials and lights are those of the bake, as far as the file tells.
    pub same_lighting: bool,
    /// Whether the bake was finished.
    pub complete: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Baker, BounceLimit, Control, OpenOptions, Settings, Silent, SolveState};
    use std::error::Error;
    use std::sync::Arc;

    fn scene(name: &str) -> Arc<Scene> {
        Arc::new(crate::open(name, &OpenOptions::default()).unwrap().builder.build().unwrap().0)
    }

    /// The furnace, and its light as `a.npz` and `a.rad` in a folder.
    fn files() -> (Arc<Scene>, tempfile::TempDir, Solution) {
        let (scene, folder) = (scene("furnace"), tempfile::tempdir().unwrap());
        let settings =
            Settings { bounces: BounceLimit::Count(1), indirect_samples: 1, ..Settings::default() };
        let baker = Baker::new(Arc::clone(&scene), settings);
        let mut state = SolveState::new();
        baker.run(&mut state, &Control::default(), &Silent).unwrap();
        let solution = baker.solution(&state);
        solution.save(&folder.path().join("a.npz")).unwrap();
        let lighting = solution.lighting(&scene, &SolutionSelection::Sum).unwrap();
        RadFile::from_lighting(&scene, &lighting).unwrap().write(&folder.path().join("a.rad")).unwrap();
        (scene, folder, solution)
    }

    #[test]
    fn both_formats_give_the_light_of_their_scene() {
        let (scene, folder, solution) = files();
        let [npz, rad] = ["a.npz", "a.rad"].map(|name| folder.path().join(name));
        let sum = |path| LightFile::irradiance_for(path, &scene, &SolutionSelection::Sum).unwrap().irradiance;
        assert_eq!(sum(&npz), solution.irradiance);
        let worst =
            sum(&rad).iter().zip(&solution.irradiance).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{worst}");
        let [npz, rad] = [npz, rad].map(|path| LightFile::load_for(&path, &scene).unwrap());
        assert!(npz.same_vertices_as(&rad) && rad.same_vertices_as(&npz));
        assert_eq!((npz.bounces().len(), rad.bounces().len()), (2, 0));
    }

    #[test]
    fn light_of_another_scene_is_refused_by_file_and_both_scenes() {
        let (furnace, folder, _) = files();
        let sphere = scene("sphere");
        for name in ["a.npz", "a.rad"] {
            let error = LightFile::load_for(&folder.path().join(name), &sphere).unwrap_err();
            let text = format!("{error} {}", error.source().map(ToString::to_string).unwrap_or_default());
            let sizes = [&furnace, &sphere].map(|scene| format!("{} vertices", scene.vertex_count()));
            for part in [name, "\"sphere\"", "computed for", &sizes[0], &sizes[1]] {
                assert!(text.contains(part), "{part} in {text}");
            }
        }
    }

    #[test]
    fn bounces_that_a_file_does_not_have_are_refused() {
        let (scene, folder, solution) = files();
        let bounce = |name: &str, k| {
            let path = folder.path().join(name);
            LightFile::irradiance_for(&path, &scene, &SolutionSelection::Bounce(k)).map(|f| f.irradiance)
        };
        assert_eq!(bounce("a.npz", 1).unwrap(), solution.bounces[1]);
        assert!(bounce("a.npz", 2).unwrap_err().to_string().contains("no bounce 2"));
        let error = bounce("a.rad", 1).unwrap_err();
        assert!(matches!(error, LightFileError::SumOnly { .. }), "{error}");
        let error = bounce("b.npz", 1).unwrap_err().to_string();
        assert!(error.contains("b.npz"), "{error}");
    }
}
