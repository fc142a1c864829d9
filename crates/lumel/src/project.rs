//! Project files: a scene with its lights, cameras and settings.

use crate::settings::SettingsPatch;
use glam::Vec3;
use lumel_scene::{Camera, Radiance, RectLight};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The content of a `NAME.lumel.toml`.
///
/// ```
/// let text = r#"
///     builtin = "cornell-box"       # or: scene = "room.glb", relative to this file
///     max_edge = 0.05               # metres
///
///     [[light]]
///     center = [0.0, 1.9, 0.0]
///     u = [0.2, 0.0, 0.0]
///     v = [0.0, 0.0, -0.2]
///     radiance = [10.0, 9.0, 8.0]
///
///     [[camera]]
///     name = "door"
///     position = [0.0, 1.0, 3.0]
///     target = [0.0, 1.0, 0.0]
///     fov_deg = 50.0
///
///     [bake]
///     preset = "draft"
///     bounces = "all"
/// "#;
/// let project: lumel::Project = text.parse().unwrap();
/// assert_eq!(project.lights.len(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// The mesh file, relative to the project file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<PathBuf>,
    /// The built-in scene, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub builtin: Option<String>,
    /// Levels of refinement of a built-in scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subdivide: Option<u32>,
    /// Longest edge after tessellation, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_edge: Option<f32>,
    /// Names of materials that have two sides, whatever the mesh file says; `"*"` for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub two_sided: Vec<String>,
    /// Radiance from outside the scene, W·m⁻²·sr⁻¹.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<Vec3>,
    /// Lights; when there are any they replace those of the mesh file.
    #[serde(default, rename = "light", skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightEntry>,
    /// Viewpoints, before those of the mesh file.
    #[serde(default, rename = "camera", skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<CameraEntry>,
    /// Settings of the bake.
    #[serde(default)]
    pub bake: SettingsPatch,
}

/// A rectangle light in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightEntry {
    /// Centre, metres.
    pub center: Vec3,
    /// Half of one edge.
    pub u: Vec3,
    /// Half of the other; light leaves on the `u × v` side.
    pub v: Vec3,
    /// Emitted radiance, W·m⁻²·sr⁻¹.
    pub radiance: Vec3,
    /// An image that multiplies the radiance, relative to the project file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<PathBuf>,
}

/// A viewpoint in a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraEntry {
    /// Name.
    pub name: String,
    /// Position, metres.
    pub position: Vec3,
    /// A point it looks at.
    pub target: Vec3,
    /// What is up.
    #[serde(default = "up")]
    pub up: Vec3,
    /// Vertical field of view, degrees.
    #[serde(default = "fov_deg")]
    pub fov_deg: f32,
}

fn up() -> Vec3 {
    Vec3::Y
}

fn fov_deg() -> f32 {
    60.0
}

/// Why a project file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// It cannot be read.
    #[error("cannot read project file {}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// It says something that makes no sense.
    #[error("{}: {message}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What makes no sense.
        message: String,
    },
}

impl std::str::FromStr for Project {
    type Err = toml::de::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        toml::from_str(text)
    }
}

impl Project {
    /// Reads a project file.
    ///
    /// # Errors
    /// A file that cannot be read or that is no project; the message shows the line.
    pub fn read(path: &Path) -> Result<Self, ProjectError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ProjectError::Read { path: path.to_owned(), source })?;
        let invalid = |message: String| ProjectError::Invalid { path: path.to_owned(), message };
        let project: Self =
            text.parse().map_err(|e: toml::de::Error| invalid(e.to_string().trim_end().to_owned()))?;
        if project.scene.is_some() == project.builtin.is_some() {
            return Err(invalid(
                "name either a mesh file by `scene` or a built-in scene by `builtin`".into(),
            ));
        }
        Ok(project)
    }
}

impl LightEntry {
    /// The light, without its texture.
    pub fn light(&self) -> RectLight {
        let Self { center, u, v, radiance, .. } = *self;
        RectLight { center, u, v, radiance: Radiance(radiance), texture: None }
    }
}

impl CameraEntry {
    /// The camera.
    pub fn camera(&self) -> Camera {
        let view = Camera::looking_at(&self.name, self.position, self.target, self.fov_deg.to_radians());
        Camera { up: self.up, ..view }
    }
}
