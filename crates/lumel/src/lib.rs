//! Diffuse global illumination for meshes: open a scene, bake it, measure it.
//!
//! ```
//! use lumel::{Baker, Control, Settings, Silent, SolveState};
//! use std::sync::Arc;
//!
//! let opened = lumel::open("furnace", &lumel::OpenOptions::default())?;
//! let (scene, _warnings) = opened.builder.build()?;
//! let settings = Settings { indirect_samples: 1, ..Settings::default() };
//! let baker = Baker::new(Arc::new(scene), settings);
//! let mut state = SolveState::new();
//! baker.run(&mut state, &Control::default(), &Silent)?;
//! let solution = baker.solution(&state);
//! assert_eq!(solution.irradiance.len(), solution.positions.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod baker;
mod dark;
mod difference;
mod light_file;
mod measure;
mod method;
mod open;
mod progress;
mod project;
mod reading;
mod resume;
mod samples;
mod settings;
pub mod spec;
mod surfaces;
mod target;
mod workload;

pub use baker::Baker;
pub use difference::{Difference, Percentiles};
pub use light_file::{Fitting, LightFile, LightFileError};
pub use lumel_accel::{Bvh, RayTracer};
pub use lumel_export::{RadFile, Solution, SolutionSelection};
pub use lumel_import::PathPolicy;
pub use lumel_sample::SamplerKind;
pub use lumel_scene::{Camera, Light, RectLight, Scene, SceneBuilder, Warnings};
pub use lumel_solve::{Accuracy, CONFIDENCE_95, Ended, Errors, Target};
pub use lumel_solve::{Observer, Silent, Snapshot, SolveError, SolveState, Step};
pub use lumel_transport::{Control, EmitterSampling, LightSampling, TransportError};
pub use measure::{PointMeasurement, measure_points, vertex_errors};
pub use method::Method;
pub use open::{OpenError, OpenOptions, Opened, open};
pub use progress::{Progress, Tracker};
pub use project::{CameraEntry, LightEntry, MaterialEntry, Project, ProjectError, SlotEntry};
pub use reading::Reading;
pub use resume::ResumeError;
pub use settings::{
    BasisKind, BounceLimit, Memory, Preset, Settings, SettingsError, SettingsPatch, Share, SolverKind, Tail,
    TargetError,
};
pub use workload::Remainder;

/// The table of all settings: names, help, bounds and defaults, for programs that let users choose them.
pub mod setting {
    pub use crate::settings::table::*;
    pub use crate::settings::{About, Bounds, Choice, Influence, Slot, Value};
}
